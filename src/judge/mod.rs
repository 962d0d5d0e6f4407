//! The judge: compares a trace with its limits (docs/method.md#8-judgement).
//!
//! A pure function of trace and limits. It must not depend on how the trace was made, on the planner's prediction or on
//! the expected verdict.

mod checks;
mod confirm;
mod events;
mod failing_load;
mod fingerprint;
mod judgement;
mod measure;
mod self_checks;
mod staged;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

pub use confirm::{confirmed, confirmed_staged};
pub use failing_load::{FailingLoad, failing_load};
pub use fingerprint::fingerprint;
pub use judgement::{CRITERIA, Judgement};
pub use staged::{StageJudgement, StagedJudgement, judge_staged};

use crate::model::{
    measures::Measures,
    scenario::Limits,
    trace::{ArmTrace, Phase, Sample, Trace},
    verdict::{Check, Failure, VerdictKind},
};

/// Judges a trace.
///
/// Judged are the samples from the hand-over of the board (docs/method.md#81-reference-states) to the end of the load, or to
/// the sample at which the board is lost: what follows tells nothing about the hold. A value equal to its limit passes. The
/// earliest crossing determines the verdict; of several at the same sample the loss of the board comes first, then the
/// contacts (measured gripper, pad, slip, rotation), then the clearance, torque, sag, deflection, the person and creep.
///
/// A trace that breaks down is judged up to its last valid sample. If a limit was crossed before, it determines the
/// verdict. Otherwise there is no verdict, as the effect of the rest of the load is unknown.
#[must_use]
pub fn judge(trace: &Trace, limits: &Limits) -> Judgement {
    if let Some(reason) = malformed(trace) {
        return no_verdict(trace, Measures::default(), Vec::new(), reason);
    }
    let ValidPart { samples, ends_because } = valid_part(trace);
    let hand_over = hand_over(samples);
    let settled = last_of(samples, Phase::Settle).unwrap_or(0).max(hand_over);
    let mut measures = measure::measures(trace, &samples[hand_over..], settled - hand_over);
    let Judged { samples: judged, is_lost } = judged(&samples[hand_over..], &measures);
    measures.judged = judged.len();
    if let Some(reason) = no_verdict_reason(trace, judged, ends_because.as_deref()) {
        return no_verdict(trace, measures, Vec::new(), reason);
    }
    let findings = checks::findings(trace, judged, &measures, limits, ends_because.is_none() && !is_lost);
    let first = checks::first_failure(&findings);
    let decided = first.map_or(hand_over + judged.len(), |(_, crossing)| hand_over + crossing.sample + 1);
    let self_checks = self_checks::self_checks(trace, samples, decided, hand_over);
    let unfinished = ends_because.clone().filter(|_| first.is_none());
    if let Some(reason) = unfinished.or_else(|| self_checks::failed_self_checks(&self_checks)) {
        return no_verdict(trace, measures, self_checks, reason);
    }
    Judgement {
        verdict: first.map_or(VerdictKind::Holds, |(finding, _)| finding.check.name.verdict()),
        first_failure: first.map(|(finding, crossing)| Failure {
            check: finding.check.name,
            time_s: judged[crossing.sample].time_s,
            load_factor: judged[crossing.sample].load_factor,
        }),
        peak_torque_ratio: peak_torque_ratio(&measures),
        confirmation: None,
        reason: None,
        fingerprint: fingerprint(trace),
        events: events::events(trace, samples, judged, &findings, ends_because.as_deref()),
        self_checks,
        checks: findings.into_iter().map(|finding| finding.check).collect(),
        measures,
    }
}

/// The valid part of a trace.
struct ValidPart<'a> {
    /// The samples up to the last valid one; at least one.
    samples: &'a [Sample],
    /// Why the trace ends early; `None` if it is complete.
    ends_because: Option<String>,
}

/// The samples before the first number that is not finite. The trace of a simulation that broke down ends there
/// already. [`malformed`] handles a trace with an invalid first sample.
fn valid_part(trace: &Trace) -> ValidPart<'_> {
    match trace.samples.iter().position(|sample| !fingerprint::sample_is_finite(sample)) {
        Some(bad) => ValidPart { samples: &trace.samples[..bad], ends_because: Some(not_finite(&trace.samples[bad])) },
        None => ValidPart { samples: &trace.samples, ends_because: trace.broke_down.clone() },
    }
}

fn not_finite(sample: &Sample) -> String {
    format!("found a number that is not finite in the sample at {} s", sample.time_s)
}

/// Index of the hand-over: the end of the closing of the grippers or, if that is shorter than a step, the first sample with
/// contact, since there are no forces before the first step.
fn hand_over(samples: &[Sample]) -> usize {
    last_of(samples, Phase::Grip).or_else(|| samples.iter().position(Sample::has_contact)).unwrap_or(0)
}

/// Index of the last sample of a phase.
fn last_of(samples: &[Sample], phase: Phase) -> Option<usize> {
    samples.iter().rposition(|sample| sample.phase == phase)
}

/// The judged samples.
struct Judged<'a> {
    samples: &'a [Sample],
    /// True if the board is lost at the last one.
    is_lost: bool,
}

/// The judged ones of the samples since the hand-over: up to the end of the load, or the sample at which the board is lost.
/// Without a load only a loss can be judged, so there are no judged samples if the board is held to the end.
fn judged<'a>(samples: &'a [Sample], measures: &Measures) -> Judged<'a> {
    let dropped = |index: usize| measures.hands.iter().any(|hand| hand.slip_mm[index] > checks::DROP_MM);
    let lost = (0..samples.len()).find(|&index| !samples[index].has_contact() || dropped(index));
    let end = samples.iter().rposition(|sample| sample.phase.is_judged()).map(|last| last + 1);
    match (lost.map(|lost| lost + 1), end) {
        (Some(lost), end) if end.is_none_or(|end| lost <= end) => Judged { samples: &samples[..lost], is_lost: true },
        (_, end) => Judged { samples: &samples[..end.unwrap_or(0)], is_lost: false },
    }
}

fn peak_torque_ratio(measures: &Measures) -> BTreeMap<String, f64> {
    let peak = |ratios: &[f64]| ratios[..measures.judged].iter().copied().fold(0.0, f64::max);
    measures.joints.iter().map(|joint| (joint.name.clone(), peak(&joint.torque_ratio))).collect()
}

/// Why a trace is malformed: it is empty, its samples have different shapes, or its first sample is not finite.
fn malformed(trace: &Trace) -> Option<String> {
    let Some(first) = trace.samples.first() else {
        return Some(trace.broke_down.clone().unwrap_or_else(|| "the trace is empty".to_owned()));
    };
    let shapes_agree = |sample: &Sample| {
        sample.arms.len() == trace.arms.len()
            && sample.arms.iter().zip(&trace.arms).all(|(found, arm)| {
                found.torque_demanded_nm.len() == arm.joints.len()
                    && found.pads.len() == arm.pads.len()
                    && (arm.wrench_limits.is_some() || found.grip_wrench_g.is_none())
                    && arm.effort_nm.len() == arm.joints.len()
            })
    };
    if let Some(odd) = trace.samples.iter().find(|sample| !shapes_agree(sample)) {
        return Some(format!("the sample at {} s does not have one entry an arm, joint and pad", odd.time_s));
    }
    (!fingerprint::sample_is_finite(first)).then(|| not_finite(first))
}

/// Why a well-formed trace allows no verdict at any limits. `ends_because` says why it ends early, if it does.
fn no_verdict_reason(trace: &Trace, judged: &[Sample], ends_because: Option<&str>) -> Option<String> {
    if !fingerprint::constants_are_finite(trace) {
        return Some("found a limit or a tool point that is not finite".to_owned());
    }
    let lacks_torque = |arm: &ArmTrace| arm.effort_nm.iter().any(|&effort_nm| effort_nm <= 0.0);
    let unlimited = |arm: &&ArmTrace| arm.wrench_limits.is_some_and(|limits| !limits.is_valid());
    if let Some(arm) = trace.arms.iter().find(unlimited) {
        return Some(format!("found wrench limits of the {} gripper that do not enclose 0", arm.name));
    }
    if let Some(arm) = trace.arms.iter().find(|arm| lacks_torque(arm)) {
        return Some(format!("found a joint of the {} arm without torque, expected positive limits", arm.name));
    }
    if judged.is_empty() {
        return Some(ends_because.unwrap_or("the load never acted").to_owned());
    }
    None
}

fn no_verdict(trace: &Trace, measures: Measures, self_checks: Vec<Check>, reason: String) -> Judgement {
    Judgement {
        verdict: VerdictKind::NoVerdict,
        checks: Vec::new(),
        self_checks,
        first_failure: None,
        peak_torque_ratio: BTreeMap::new(),
        confirmation: None,
        fingerprint: fingerprint(trace),
        events: events::events_without_verdict(trace, &reason),
        reason: Some(reason),
        measures,
    }
}
