//! Predictions of the statics against the simulation for ten plans: five cuts and five drills on the foam board
//! (docs/method.md#24-board). `cargo test --release --test pinch prediction -- --nocapture` prints both tables.

use std::{convert::Infallible, thread};

use benchdog::{
    judge::{Judgement, failing_load},
    model::{plan::Plan, scenario::Limits, verdict::VerdictKind},
    sim::{Conditions, simulate},
    statics::{CompliantResponse, ContactModel, LimitCrossing, ResponseOutcome, StabilityWorkspace},
};

use crate::{
    common::{baxter, checked, ten_plans},
    holds::{FRICTION, SETTINGS, judged_grasp, limits},
};

/// A share of the load at which most pads are far from their limits.
const SMALL_LOAD: f64 = 0.1;

struct Case {
    plan: Plan,
    hold: ContactModel,
    limits: Limits,
}

/// The ten plans with their contact models and limits.
fn cases() -> Vec<Case> {
    let case = |plan: Plan| {
        let hold = ContactModel::of_plan(&checked(baxter(), &plan), FRICTION).unwrap();
        let limits = limits(plan.operation.kind);
        Case { plan, hold, limits }
    };
    ten_plans().into_iter().map(case).collect()
}

/// The judgement under a multiple of the load.
fn simulated(case: &Case, load_factor: f64) -> Judgement {
    let trace =
        simulate(&checked(baxter(), &case.plan), &Conditions::new(FRICTION, SETTINGS).scaled(load_factor)).unwrap();
    judged_grasp(trace, &case.limits)
}

fn predicted(case: &Case, load_factor: f64) -> CompliantResponse {
    match StabilityWorkspace::new().response(&case.hold, load_factor).unwrap() {
        ResponseOutcome::Found(response) => *response,
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
    let cases = cases();
    let found = of_each(&cases, |case| {
        let deflection_mm = *simulated(case, SMALL_LOAD).measures.deflection_mm.last().unwrap();
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
fn simulated_failing_load(case: &Case, predicted: f64) -> (f64, VerdictKind) {
    let judged = |load_factor| Ok::<_, Infallible>(simulated(case, load_factor));
    let Ok(found) = failing_load(predicted, judged);
    (found.holds_at, found.judgement.verdict)
}

#[test]
fn failing_loads_are_predicted() {
    let cases = cases();
    let found = of_each(&cases, |case| {
        let found = StabilityWorkspace::new().compliant_load_factor(&case.hold, &case.limits).unwrap();
        let simulated = simulated_failing_load(case, found.load_factor);
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
