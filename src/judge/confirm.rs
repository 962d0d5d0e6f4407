//! The confirmation of a verdict at shorter time steps (docs/method.md#812-confirmation).
//!
//! A simulation that passes a limit by a little, or fails it by a little, may decide otherwise at another time step. Such a
//! verdict is repeated at half the step, and at a quarter of it if the two differ. The caller runs the simulations.

use super::judgement::Judgement;
use crate::model::{
    measures::EventKind,
    verdict::{Check, CheckKind, Confirmation, StepVerdict, VerdictKind},
};

/// A margin below this share of the limit does not decide alone.
const NEAR_SHARE: f64 = 0.1;

/// The same for a distance whose limit is 0, mm: a tenth of the default clearance.
const NEAR_MM: f64 = 0.5;

/// Two limits that are crossed within this time do not decide alone which one comes first, s: 5 % of the default ramp.
const TOGETHER_S: f64 = 0.05;

/// The judgement of a plan at a time step, confirmed at half of it if it is near to a limit or its simulation is invalid.
/// `run` simulates at a time step, s, and judges; what it returns beside the judgement is handed back.
///
/// - If half the step gives the same verdict, it stands, with the figures of the first run.
/// - Otherwise a quarter decides: if it agrees with the half, that verdict stands, with the figures of the half.
/// - Otherwise the verdict depends on the time step, and there is no verdict.
///
/// # Errors
/// The first error of `run`.
pub fn confirmed<T, E>(
    timestep_s: f64,
    mut run: impl FnMut(f64) -> Result<(T, Judgement), E>,
) -> Result<(T, Judgement), E> {
    let (first_trace, mut first) = run(timestep_s)?;
    let Some(because) = doubt(&first) else { return Ok((first_trace, first)) };
    let mut runs = vec![StepVerdict { timestep_s, verdict: first.verdict }];
    let (half_trace, mut half) = run(timestep_s / 2.0)?;
    runs.push(StepVerdict { timestep_s: timestep_s / 2.0, verdict: half.verdict });
    if half.verdict == first.verdict {
        first.confirmation = Some(Confirmation { because, runs });
        return Ok((first_trace, first));
    }
    let (_, quarter) = run(timestep_s / 4.0)?;
    runs.push(StepVerdict { timestep_s: timestep_s / 4.0, verdict: quarter.verdict });
    let confirmation = Confirmation { because, runs };
    if quarter.verdict != half.verdict {
        half.verdict = VerdictKind::NoVerdict;
        half.first_failure = None;
        half.reason = Some(format!("the verdict depends on the time step: {confirmation}"));
    }
    half.confirmation = Some(confirmation);
    Ok((half_trace, half))
}

/// Why a judgement does not decide alone; `None` if it does.
fn doubt(judgement: &Judgement) -> Option<String> {
    match (judgement.verdict, &judgement.first_failure) {
        // Without self-checks nothing was simulated long enough for a shorter step to help.
        (VerdictKind::NoVerdict, _) => {
            let failed = judgement.self_checks.iter().any(|check| !check.passed);
            judgement.reason.clone().filter(|_| failed)
        }
        (_, None) => judgement.checks.iter().find(|check| is_near(check)).map(near),
        (verdict, Some(failure)) => {
            let failed = judgement.checks.iter().find(|check| check.name == failure.check)?;
            if is_near(failed) {
                return Some(near(failed));
            }
            let together = |other: CheckKind| {
                judgement.events.iter().any(|event| {
                    event.kind == EventKind::LimitCrossed(other) && event.time_s - failure.time_s <= TOGETHER_S
                })
            };
            let other = judgement.checks.iter().map(|check| check.name);
            let other = other.filter(|kind| kind.verdict() != verdict).find(|kind| together(*kind))?;
            Some(format!("the limits of {} and {other} are crossed within {} ms", failure.check, 1e3 * TOGETHER_S))
        }
    }
}

/// True if a value is near to its limit, on either side.
fn is_near(check: &Check) -> bool {
    let near = match check.name {
        // The board is lost or it is not.
        CheckKind::ContactLost | CheckKind::Drop => return false,
        _ if check.limit == 0.0 => NEAR_MM,
        _ => NEAR_SHARE * check.limit,
    };
    check.margin.abs() <= near
}

fn near(check: &Check) -> String {
    let Check { name, value, limit, .. } = check;
    let unit = if check.unit == "1" { String::new() } else { format!(" {}", check.unit) };
    if *limit == 0.0 {
        return format!("{name} {value:.3}{unit} is within {NEAR_MM} mm of its limit");
    }
    format!("{name} {value:.3}{unit} is within {:.0} % of its limit of {limit}{unit}", 100.0 * NEAR_SHARE)
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeMap, convert::Infallible};

    use super::*;
    use crate::{
        judge::checks::check,
        model::{
            measures::{Event, Measures},
            verdict::Failure,
        },
    };

    /// A judgement with this slip, mm, and a limit of 1 mm; a slip above it fails at `at_s`.
    fn slipped(slip_mm: f64, at_s: f64) -> Judgement {
        let slip = check(CheckKind::Slip, slip_mm, 1.0);
        let fails = !slip.passed;
        Judgement {
            verdict: if fails { VerdictKind::Slips } else { VerdictKind::Holds },
            checks: vec![slip],
            self_checks: Vec::new(),
            first_failure: fails.then_some(Failure { check: CheckKind::Slip, time_s: at_s, load_factor: 1.0 }),
            peak_torque_ratio: BTreeMap::new(),
            confirmation: None,
            reason: None,
            fingerprint: String::new(),
            events: Vec::new(),
            measures: Measures::default(),
        }
    }

    /// The confirmed judgement of a plan with these slips at each step, and the number of runs.
    fn of(slips_mm: &[f64]) -> (Judgement, usize) {
        let mut runs = 0;
        let run = |timestep_s: f64| {
            // Each run halves the step.
            assert_eq!(timestep_s, 0.002 / f64::from(1 << runs));
            let judgement = slipped(slips_mm[runs], 1.0);
            runs += 1;
            Ok::<_, Infallible>(((), judgement))
        };
        let Ok(((), judgement)) = confirmed(0.002, run);
        (judgement, runs)
    }

    #[test]
    fn a_clear_verdict_needs_no_confirmation() {
        for slip_mm in [0.0, 0.89, 1.11, 20.0] {
            let (judgement, runs) = of(&[slip_mm]);
            assert_eq!((runs, judgement.confirmation), (1, None), "{slip_mm}");
        }
    }

    #[test]
    fn a_verdict_near_a_limit_stands_if_half_the_step_agrees() {
        for (slips_mm, verdict) in [([0.95, 0.97], VerdictKind::Holds), ([1.05, 1.3], VerdictKind::Slips)] {
            let (judgement, runs) = of(&slips_mm);
            assert_eq!((judgement.verdict, runs), (verdict, 2));
            assert_eq!(judgement.checks[0].value, slips_mm[0]);
            let said = judgement.confirmation.unwrap().to_string();
            assert!(said.ends_with(&format!("of its limit of 1 mm: 2 ms {verdict}, 1 ms {verdict}")), "{said}");
        }
    }

    #[test]
    fn if_half_the_step_differs_a_quarter_decides() {
        let (judgement, runs) = of(&[1.05, 0.95, 0.93]);
        assert_eq!((judgement.verdict, runs, judgement.checks[0].value), (VerdictKind::Holds, 3, 0.95));
        let (judgement, runs) = of(&[0.98, 1.02, 0.99]);
        assert_eq!((judgement.verdict, judgement.first_failure, runs), (VerdictKind::NoVerdict, None, 3));
        assert!(judgement.reason.unwrap().ends_with("2 ms holds, 1 ms slips, 0.5 ms holds"));
    }

    #[test]
    fn limits_that_are_crossed_together_need_a_confirmation() {
        for (later_s, doubted) in [(0.04, true), (0.06, false)] {
            let mut judgement = slipped(3.0, 1.0);
            judgement.checks.push(check(CheckKind::SlipRotation, 9.0, 2.0));
            let kind = EventKind::LimitCrossed(CheckKind::SlipRotation);
            judgement.events.push(Event { time_s: 1.0 + later_s, kind, text: String::new(), what: String::new() });
            assert_eq!(doubt(&judgement).is_some(), doubted);
        }
    }

    #[test]
    fn an_invalid_simulation_is_repeated_and_an_unfinished_one_is_not() {
        let mut judgement = slipped(0.0, 1.0);
        judgement.verdict = VerdictKind::NoVerdict;
        judgement.reason = Some("the simulation is not valid: chatter".into());
        assert_eq!(doubt(&judgement), None);
        judgement.self_checks.push(check(CheckKind::Chatter, 0.5, 0.1));
        assert_eq!(doubt(&judgement), judgement.reason);
    }

    #[test]
    fn a_distance_with_a_limit_of_zero_is_near_within_half_a_millimetre() {
        for (kind, value_mm, near) in [
            (CheckKind::Clearance, 0.4, true),
            (CheckKind::Clearance, 3.0, false),
            (CheckKind::PersonOverlap, -0.4, true),
            (CheckKind::PersonOverlap, -48.0, false),
        ] {
            assert_eq!(is_near(&check(kind, value_mm, 0.0)), near, "{kind} {value_mm}");
        }
    }
}
