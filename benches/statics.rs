//! The statics on grasps by Baxter: a cut of 30 N at the rim of a foam board, and a drill of 40 N on a long lever. The
//! group `equilibrium` compares the dense interior point with clarabel on the same programs.

use std::{hint::black_box, path::Path};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    model::scenario::{Limits, Person},
    scenario::read_plan,
    statics::{ContactModel, EquilibriumOutcome, EquilibriumSolver, StabilityWorkspace},
};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// Friction of pad and board, docs/method.md#76-robot-figures.
const FRICTION: f64 = 0.6;
/// docs/method.md#810-default-limits.
const LIMITS: Limits = Limits::CUT;

/// The load factor of the equilibria.
const LOAD_FACTOR: f64 = 0.5;

fn models() -> Vec<(&'static str, ContactModel)> {
    ["cut-rim", "long-lever"]
        .into_iter()
        .map(|name| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/plans/{name}.json"));
            let (plan, robot) = read_plan(&path, None).expect("the repository's plans can be read");
            let checked = CheckedPlan::new(&robot, &plan, &Person::default(), &default_tool(plan.operation.kind));
            let checked = checked.expect("the repository's plans are valid");
            let model = ContactModel::of_plan(&checked, FRICTION);
            (name, model.expect("the repository's plans have a contact model"))
        })
        .collect()
}

fn statics(criterion: &mut Criterion) {
    // Warm: memory and symbolic factorisation are reused after the first model.
    let mut workspace = StabilityWorkspace::new();
    for (name, model) in models() {
        let mut bench = |what: &str, run: &mut dyn FnMut()| {
            criterion.bench_function(&format!("{what}/{name}"), |bencher| bencher.iter(&mut *run));
        };
        bench("necessary test", &mut || _ = black_box(black_box(&model).infeasibility(1.0)));
        bench("load factor", &mut || _ = black_box(workspace.load_factor(black_box(&model))));
        bench("compliant load factor", &mut || {
            _ = black_box(workspace.compliant_load_factor(black_box(&model), &LIMITS))
        });
    }
}

fn equilibrium(criterion: &mut Criterion) {
    let mut workspace = StabilityWorkspace::new();
    let mut group = criterion.benchmark_group("equilibrium");
    for (name, model) in models() {
        for solver in [EquilibriumSolver::InteriorPoint, EquilibriumSolver::Clarabel] {
            let found = workspace.equilibrium(&model, LOAD_FACTOR, solver).expect("a valid contact model");
            assert!(matches!(found, EquilibriumOutcome::Found(_)), "{name}, {solver:?}: {found:?}");
            group.bench_function(BenchmarkId::new(format!("{solver:?}"), name), |bencher| {
                bencher.iter(|| black_box(workspace.equilibrium(black_box(&model), LOAD_FACTOR, solver)));
            });
        }
    }
}

criterion_group!(benches, statics, equilibrium);
criterion_main!(benches);
