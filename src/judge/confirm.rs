//! The confirmation of a verdict at shorter time steps (docs/method.md#812-confirmation).
//!
//! A simulation that passes a limit by a little, or fails it by a little, may decide otherwise at another time step. Such a
//! verdict is repeated at half the step, and at a quarter of it if the two differ. The caller runs the simulations.

use super::{judgement::Judgement, staged::StagedJudgement};
use crate::model::{
    measures::EventKind,
    verdict::{Check, CheckKind, Confirmation, StepVerdict, VerdictKind},
};

/// A margin below this share of the limit does not decide alone.
pub(super) const NEAR_SHARE: f64 = 0.1;

/// The same for a distance whose limit is 0, mm: a tenth of the default clearance.
pub(super) const NEAR_MM: f64 = 0.5;

/// Two limits that are crossed within this time do not decide alone which one comes first, s: 5 % of the default ramp.
pub(super) const TOGETHER_S: f64 = 0.05;

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
    run: impl FnMut(f64) -> Result<(T, Judgement), E>,
) -> Result<(T, Judgement), E> {
    let verdict = |(_, judgement): &(T, Judgement)| (judgement.verdict, None);
    let Deciding { run: (trace, mut judgement), confirmation, is_decided } =
        deciding(timestep_s, run, |(_, judgement)| doubt(judgement), verdict)?;
    if let Some(confirmation) = confirmation.as_ref().filter(|_| !is_decided) {
        take_back(&mut judgement, confirmation);
    }
    judgement.confirmation = confirmation;
    Ok((trace, judgement))
}

/// As [`confirmed`], for a staged plan: its verdict is confirmed if that of one of its stages would be. Two verdicts are the same
/// if the first stage that does not hold is the same as well. If the verdict depends on the time step, the first stage at which
/// half and quarter differ has no verdict, and is the last one.
///
/// # Errors
/// The first error of `run`.
pub fn confirmed_staged<T, E>(
    timestep_s: f64,
    run: impl FnMut(f64) -> Result<(T, StagedJudgement), E>,
) -> Result<(T, StagedJudgement), E> {
    let verdict = |(_, judgement): &(T, StagedJudgement)| {
        (judgement.verdict(), judgement.failed().map(|failed| failed.span.stage + 1))
    };
    let Deciding { run: (trace, mut judgement), confirmation, is_decided } =
        deciding(timestep_s, run, |(_, judgement)| doubt_of_stages(judgement), verdict)?;
    if let Some(confirmation) = confirmation.as_ref().filter(|_| !is_decided) {
        let differs = confirmation.runs[1..].iter().filter_map(|run| run.stage).min();
        judgement.stages.retain(|stage| differs.is_none_or(|differs| stage.span.stage < differs));
        if let Some(last) = judgement.stages.last_mut() {
            take_back(&mut last.judgement, confirmation);
        }
    }
    judgement.confirmation = confirmation;
    Ok((trace, judgement))
}

/// The run that decides.
struct Deciding<R> {
    run: R,
    /// All runs; `None` if the first one decides alone.
    confirmation: Option<Confirmation>,
    /// False if the verdict depends on the time step.
    is_decided: bool,
}

/// Runs at a time step, s, and if there is a `doubt`, at half of it and, if these two differ, at a quarter. `verdict` is that of a
/// run and the stage that decides it.
fn deciding<R, E>(
    timestep_s: f64,
    mut run: impl FnMut(f64) -> Result<R, E>,
    doubt: impl FnOnce(&R) -> Option<String>,
    verdict: impl Fn(&R) -> (VerdictKind, Option<usize>),
) -> Result<Deciding<R>, E> {
    let first = run(timestep_s)?;
    let Some(because) = doubt(&first) else { return Ok(Deciding { run: first, confirmation: None, is_decided: true }) };
    let of_run = |timestep_s: f64, run: &R| {
        let (verdict, stage) = verdict(run);
        StepVerdict { timestep_s, verdict, stage }
    };
    let agree = |a: &StepVerdict, b: &StepVerdict| (a.verdict, a.stage) == (b.verdict, b.stage);
    let half = run(timestep_s / 2.0)?;
    let mut runs = vec![of_run(timestep_s, &first), of_run(timestep_s / 2.0, &half)];
    if agree(&runs[0], &runs[1]) {
        return Ok(Deciding { run: first, confirmation: Some(Confirmation { because, runs }), is_decided: true });
    }
    // Traces of tasks are large.
    drop(first);
    runs.push(of_run(timestep_s / 4.0, &run(timestep_s / 4.0)?));
    let is_decided = agree(&runs[1], &runs[2]);
    Ok(Deciding { run: half, confirmation: Some(Confirmation { because, runs }), is_decided })
}

/// Takes a verdict back that depends on the time step.
fn take_back(judgement: &mut Judgement, confirmation: &Confirmation) {
    judgement.verdict = VerdictKind::NoVerdict;
    judgement.first_failure = None;
    judgement.reason = Some(format!("the verdict depends on the time step: {confirmation}"));
}

/// Why one of the stages does not decide alone; `None` if all do.
fn doubt_of_stages(judgement: &StagedJudgement) -> Option<String> {
    judgement
        .stages
        .iter()
        .find_map(|stage| Some(format!("stage {}: {}", stage.span.stage + 1, doubt(&stage.judgement)?)))
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
        judge::{StageJudgement, checks::check},
        model::{
            measures::{Event, Measures},
            staged_trace::StageSpan,
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

    /// The confirmed judgement of a staged plan whose stages have these slips at each step, and the number of runs.
    fn of_stages<const STAGES: usize>(slips_mm: &[[f64; STAGES]]) -> (StagedJudgement, usize) {
        let mut runs = 0;
        let run = |timestep_s: f64| {
            assert_eq!(timestep_s, 0.002 / f64::from(1 << runs));
            let judged = |stage: usize| StageJudgement {
                span: StageSpan { stage, first: stage, last: stage },
                judgement: slipped(slips_mm[runs][stage], stage as f64),
            };
            let failed = slips_mm[runs].iter().position(|&slip_mm| slip_mm > 1.0);
            let stages = (0..failed.map_or(STAGES, |failed| failed + 1)).map(judged).collect();
            runs += 1;
            Ok::<_, Infallible>(((), StagedJudgement { stages, confirmation: None }))
        };
        let Ok(((), judgement)) = confirmed_staged(0.002, run);
        (judgement, runs)
    }

    /// The verdict of a staged plan, and the first stage that does not hold, from 0.
    fn decided(judgement: &StagedJudgement) -> (VerdictKind, Option<usize>) {
        (judgement.verdict(), judgement.failed().map(|failed| failed.span.stage))
    }

    #[test]
    fn clear_stages_need_no_confirmation() {
        for slips_mm in [[0.0, 0.89, 0.0], [0.2, 0.3, 1.2]] {
            let (judgement, runs) = of_stages(&[slips_mm]);
            assert_eq!((runs, judgement.confirmation), (1, None), "{slips_mm:?}");
        }
    }

    #[test]
    fn a_stage_near_a_limit_is_confirmed_by_the_whole_plan_at_half_the_step() {
        let (judgement, runs) = of_stages(&[[0.1, 0.95, 0.2], [0.1, 0.97, 0.2]]);
        assert_eq!((decided(&judgement), runs), ((VerdictKind::Holds, None), 2));
        assert_eq!(judgement.stages[1].judgement.checks[0].value, 0.95);
        let said = judgement.confirmation.unwrap().to_string();
        assert!(said.starts_with("stage 2: slip 0.950 mm is within 10 % of"), "{said}");
        assert!(said.ends_with("2 ms holds, 1 ms holds"), "{said}");
        let (judgement, runs) = of_stages(&[[0.1, 1.05, 0.2], [0.1, 1.3, 0.2]]);
        assert_eq!((decided(&judgement), runs), ((VerdictKind::Slips, Some(1)), 2));
    }

    #[test]
    fn if_half_the_step_fails_in_another_stage_a_quarter_decides() {
        let (judgement, runs) = of_stages(&[[0.95, 2.0, 0.1], [1.05, 2.0, 0.1], [1.06, 2.0, 0.1]]);
        assert_eq!((decided(&judgement), runs), ((VerdictKind::Slips, Some(0)), 3));
        assert_eq!(judgement.stages[0].judgement.checks[0].value, 1.05);
        let said = judgement.confirmation.unwrap().to_string();
        assert!(said.ends_with("2 ms slips in stage 2, 1 ms slips in stage 1, 0.5 ms slips in stage 1"), "{said}");
    }

    #[test]
    fn the_first_stage_at_which_half_and_quarter_differ_has_no_verdict() {
        // Wherever the three runs fail: in one of them, or in different stages.
        for (slips_mm, stage) in [
            ([[0.1, 0.98, 0.1], [0.1, 1.02, 0.1], [0.1, 0.99, 0.1]], 1),
            ([[0.1, 1.02, 0.1], [0.1, 0.98, 0.1], [0.1, 1.01, 0.1]], 1),
            ([[0.1, 0.98, 0.1], [0.1, 0.98, 1.5], [1.5, 0.99, 0.1]], 0),
        ] {
            let (judgement, runs) = of_stages(&slips_mm);
            assert_eq!((decided(&judgement), runs), ((VerdictKind::NoVerdict, Some(stage)), 3), "{slips_mm:?}");
            let failed = &judgement.failed().unwrap().judgement;
            assert_eq!(failed.first_failure, None);
            let reason = failed.reason.as_ref().unwrap();
            assert!(reason.starts_with("the verdict depends on the time step: stage 2: slip "), "{reason}");
        }
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

    /// They have a limit as other checks, but whether the board is lost is no matter of a little.
    #[test]
    fn a_lost_board_is_near_to_no_limit() {
        for (kind, value, limit) in [(CheckKind::ContactLost, 0.0, 0.0), (CheckKind::Drop, 50.0, 50.0)] {
            assert!(!is_near(&check(kind, value, limit)), "{kind}");
        }
    }

    #[test]
    fn a_value_is_near_up_to_a_tenth_of_its_limit_on_either_side() {
        for (value_mm, near) in [(4.4, false), (4.5, true), (5.0, true), (5.5, true), (5.6, false)] {
            assert_eq!(is_near(&check(CheckKind::Slip, value_mm, 5.0)), near, "{value_mm}");
        }
    }
}
