//! What the statics predict against what the simulation shows, on ten planned holds: five cuts and five drills on the
//! foam board of METHOD section 2. `cargo test --release --test prediction -- --nocapture` prints both tables.

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

/// METHOD section 7.
const FRICTION: f64 = 0.6;

/// The share of the operation's load at which hardly any pad is near its limits.
const SMALL_LOAD: f64 = 0.1;

/// The settings of a run, without the release: it is not judged.
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

/// The plans of `tests/data/holds` in the order of their names: object, arms and operation as `benchdog plan` wrote them.
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

/// METHOD section 8.
fn limits(kind: OperationKind) -> Limits {
    let deflection_mm = if kind == OperationKind::Drill { 5.0 } else { 15.0 };
    Limits { slip_mm: 1.0, slip_deg: 2.0, deflection_mm, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 }
}

/// What the simulation makes of a multiple of the operation.
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

/// One answer a case, two at a time.
fn of_each<T: Send>(cases: &[Case], answer: impl Fn(&Case) -> T + Sync) -> Vec<T> {
    let half = |cases: &[Case]| cases.iter().map(&answer).collect::<Vec<_>>();
    let (first, second) = cases.split_at(cases.len() / 2);
    thread::scope(|scope| {
        let second = scope.spawn(|| half(second));
        let mut answers = half(first);
        answers.extend(second.join().unwrap());
        answers
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
        // What the contacts of the simulation give way, and pads of five points for a face, cost up to 4.5 %.
        if off.abs() > 0.05 {
            too_far.push(name.as_str());
        }
    }
    assert!(too_far.is_empty(), "{too_far:?}");
}

/// The load factor up to which the simulated hold stands, and what ends it, as `benchdog margin` finds them.
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

/// True when the limit that was predicted to end the hold is the one that did.
fn agree(limit: Option<&LimitCrossing>, by: VerdictKind) -> bool {
    matches!(
        (limit, by),
        (Some(LimitCrossing::Deflection), VerdictKind::Deflects)
            | (Some(LimitCrossing::Slip { .. }), VerdictKind::Slips)
            | (Some(LimitCrossing::SlipRotation { .. }), VerdictKind::Pivots)
            | (Some(LimitCrossing::Torque { .. }), VerdictKind::Saturates)
    )
}
