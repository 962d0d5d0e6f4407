//! The simulation: a hundred steps of two arms with the foam board of the quickstart under half of a cut's load, the
//! same with one arm, and a whole run with its judgement.

use std::{hint::black_box, path::Path};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    judge::judge,
    model::{
        plan::Plan,
        scenario::{Limits, Person, SimulationSettings},
    },
    robot::Robot,
    scenario::read_plan,
    sim::{Conditions, SimScene, blank_sample, simulate},
};
use criterion::{Criterion, criterion_group, criterion_main};

/// docs/method.md#76-robot-figures.
const FRICTION: f64 = 0.6;
/// docs/method.md#810-default-limits, for a cut.
const LIMITS: Limits = Limits::CUT;

fn checked<'a>(robot: &'a Robot, plan: &'a Plan) -> CheckedPlan<'a> {
    CheckedPlan::new(robot, plan, &Person::default(), &default_tool(plan.operation.kind))
        .expect("the repository's plans are valid")
}

fn sim(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    let (two_arms, robot) = read_plan(&path, None).expect("the repository's plans can be read");
    let mut one_arm = two_arms.clone();
    one_arm.arms.truncate(1);
    let conditions = Conditions::new(FRICTION, SimulationSettings::default());
    for (name, plan) in [("two arms", &two_arms), ("one arm", &one_arm)] {
        let checked = checked(&robot, plan);
        let mut scene = SimScene::new(&checked, &conditions).expect("the repository's plans are holds");
        let mut sample = blank_sample(&checked);
        criterion.bench_function(&format!("100 steps/{name}"), |bencher| {
            bencher.iter(|| {
                for _ in 0..100 {
                    scene.step(black_box(0.5));
                    scene.observe(&mut sample);
                }
                black_box(&sample);
            });
        });
    }
    let checked = checked(&robot, &two_arms);
    criterion.benchmark_group("run").sample_size(10).bench_function("simulate and judge 3 s", |bencher| {
        bencher.iter(|| judge(&simulate(&checked, &conditions).expect("a hold"), &LIMITS));
    });
}

criterion_group!(benches, sim);
criterion_main!(benches);
