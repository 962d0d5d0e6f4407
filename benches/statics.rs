//! The statics on holds by Baxter: a cut of 30 N at the rim of a foam board, and a drill of 40 N on a long lever.

use std::{hint::black_box, path::Path};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    model::scenario::Limits,
    scenario::read_plan,
    statics::{ContactModel, EquilibriumSolver, StabilityWorkspace},
};
use criterion::{Criterion, criterion_group, criterion_main};

/// METHOD sections 7 and 8.
const FRICTION: f64 = 0.6;
const LIMITS: Limits =
    Limits { slip_mm: 1.0, slip_deg: 2.0, deflection_mm: 15.0, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 };

fn holds() -> Vec<(&'static str, ContactModel)> {
    ["cut-rim", "long-lever"]
        .into_iter()
        .map(|name| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/plans/{name}.json"));
            let (plan, robot) = read_plan(&path, None).expect("the repository's plans can be read");
            let checked = CheckedPlan::new(&robot, &plan, &default_tool(plan.operation.kind));
            let checked = checked.expect("the repository's plans are valid");
            let hold = ContactModel::of_plan(&checked, FRICTION);
            (name, hold.expect("the repository's plans are holds"))
        })
        .collect()
}

fn statics(criterion: &mut Criterion) {
    // Warm: memory and symbolic factorisation are there after the first hold.
    let mut workspace = StabilityWorkspace::new();
    for (name, hold) in holds() {
        let mut bench = |what: &str, run: &mut dyn FnMut()| {
            criterion.bench_function(&format!("{what}/{name}"), |bencher| bencher.iter(&mut *run));
        };
        bench("necessary test", &mut || _ = black_box(black_box(&hold).infeasibility(1.0)));
        bench("load factor", &mut || _ = black_box(workspace.load_factor(black_box(&hold))));
        bench("compliant equilibrium", &mut || {
            _ = black_box(workspace.equilibrium(black_box(&hold), 0.5, EquilibriumSolver::InteriorPoint))
        });
        bench("compliant load factor", &mut || {
            _ = black_box(workspace.compliant_load_factor(black_box(&hold), &LIMITS))
        });
    }
}

criterion_group!(benches, statics);
criterion_main!(benches);
