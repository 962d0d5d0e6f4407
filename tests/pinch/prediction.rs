//! Predictions of the statics against the simulation for ten plans: five cuts and five drills on the foam board
//! (docs/method.md#24-board). `cargo test --release --test pinch prediction -- --nocapture` prints both tables.

use std::{convert::Infallible, fs, path::Path, thread};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    judge::{Judgement, failing_load, judge},
    model::{
        operation::OperationKind,
        plan::Plan,
        scenario::{Limits, SimulationSettings},
        verdict::VerdictKind,
    },
    robot::Robot,
    scenario::read_plan,
    sim::{Conditions, simulate},
    statics::{CompliantResponse, ContactModel, LimitCrossing, ResponseOutcome, StabilityWorkspace},
};

/// docs/method.md#76-robot-figures.
const FRICTION: f64 = 0.6;

/// A share of the load at which most pads are far from their limits.
const SMALL_LOAD: f64 = 0.1;

/// Settings without the release, which is not judged.
const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.5, ramp_s: 1.0, hold_s: 1.0, release_s: 0.0, timestep_s: 0.002 };

struct Case {
    plan: Plan,
    hold: ContactModel,
    limits: Limits,
}

/// The check of a plan with the usual tool for its operation.
fn checked<'a>(robot: &'a Robot, plan: &'a Plan) -> CheckedPlan<'a> {
    CheckedPlan::new(robot, plan, &default_tool(plan.operation.kind)).unwrap()
}

/// The plans of `tests/data/holds` in the order of their names: object, arms and operation as `benchdog plan` wrote
/// them.
fn cases() -> (Robot, Vec<Case>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/holds");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert_eq!(paths.len(), 10);
    let (_, robot) = read_plan(&paths[0], None).unwrap();
    let cases = paths.iter().map(|path| {
        let (plan, _) = read_plan(path, Some(&robot)).unwrap();
        let hold = ContactModel::of_plan(&checked(&robot, &plan), FRICTION).unwrap();
        let limits = limits(plan.operation.kind);
        Case { plan, hold, limits }
    });
    let cases = cases.collect();
    (robot, cases)
}

/// docs/method.md#810-default-limits.
fn limits(kind: OperationKind) -> Limits {
    let deflection_mm = if kind == OperationKind::Drill { 5.0 } else { 15.0 };
    Limits { slip_mm: 1.0, slip_deg: 2.0, deflection_mm, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 }
}

/// The judgement under a multiple of the load.
fn simulated(robot: &Robot, case: &Case, load_factor: f64) -> Judgement {
    let trace =
        simulate(&checked(robot, &case.plan), &Conditions::new(FRICTION, SETTINGS).scaled(load_factor)).unwrap();
    judge(&trace, &case.limits)
}

fn predicted(case: &Case, load_factor: f64) -> CompliantResponse {
    match StabilityWorkspace::new().response(&case.hold, load_factor).unwrap() {
        ResponseOutcome::Found(response) => response,
        other => panic!("{}: {other:?}", case.plan.name),
    }
}

/// The result of each case, two at a time.
fn of_each<T: Send>(cases: &[Case], result: impl Fn(&Case) -> T + Sync) -> Vec<T> {
    let half = |cases: &[Case]| cases.iter().map(&result).collect::<Vec<_>>();
    let (first, second) = cases.split_at(cases.len() / 2);
    thread::scope(|scope| {
        let second = scope.spawn(|| half(second));
        let mut results = half(first);
        results.extend(second.join().unwrap());
        results
    })
}

#[test]
fn small_deflections_are_predicted() {
    let (robot, cases) = cases();
    let found = of_each(&cases, |case| {
        let deflection_mm = *simulated(&robot, case, SMALL_LOAD).measures.deflection_mm.last().unwrap();
        (predicted(case, SMALL_LOAD).deflection_mm(), deflection_mm)
    });
    let mut too_far = Vec::new();
    for (case, (predicted, simulated)) in cases.iter().zip(found) {
        let (name, off) = (&case.plan.name, predicted / simulated - 1.0);
        println!("| {name} | {predicted:.4} | {simulated:.4} | {:+.1} % |", 100.0 * off);
        // Contact compliance in the simulation, and pads of five contacts instead of a face, cause up to 4.5 %.
        if off.abs() > 0.05 {
            too_far.push(name.as_str());
        }
    }
    assert!(too_far.is_empty(), "{too_far:?}");
}

/// The simulated load factor and the verdict at failure, as `benchdog margin` finds them.
fn simulated_failing_load(robot: &Robot, case: &Case, predicted: f64) -> (f64, VerdictKind) {
    let judged = |load_factor| Ok::<_, Infallible>(simulated(robot, case, load_factor));
    let Ok(found) = failing_load(predicted, judged);
    (found.holds_at, found.judgement.verdict)
}

#[test]
fn failing_loads_are_predicted() {
    let (robot, cases) = cases();
    let found = of_each(&cases, |case| {
        let found = StabilityWorkspace::new().compliant_load_factor(&case.hold, &case.limits).unwrap();
        let simulated = simulated_failing_load(&robot, case, found.load_factor);
        (found, simulated)
    });
    let mut too_far = Vec::new();
    for (case, (predicted, (simulated, by))) in cases.iter().zip(found) {
        let (name, off) = (&case.plan.name, predicted.load_factor / simulated - 1.0);
        let limit = predicted.first_limit.as_ref().map(ToString::to_string).unwrap_or_default();
        let factor = predicted.load_factor;
        println!("| {name} | {factor:.3} | {limit} | {simulated:.3} | {by} | {:+.1} % |", 100.0 * off);
        if off.abs() > 0.1 || !agree(predicted.first_limit.as_ref(), by) {
            too_far.push(name.as_str());
        }
    }
    assert!(too_far.is_empty(), "{too_far:?}");
}

/// True if the predicted limit is the one that ended the simulation.
fn agree(limit: Option<&LimitCrossing>, by: VerdictKind) -> bool {
    matches!(
        (limit, by),
        (Some(LimitCrossing::Deflection), VerdictKind::Deflects)
            | (Some(LimitCrossing::Slip { .. }), VerdictKind::Slips)
            | (Some(LimitCrossing::SlipRotation { .. }), VerdictKind::Pivots)
            | (Some(LimitCrossing::Torque { .. }), VerdictKind::Saturates)
    )
}
