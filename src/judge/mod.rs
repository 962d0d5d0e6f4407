//! The judge: compares a trace with its limits (docs/method.md#8-judgement).
//!
//!
//! A pure function of trace and limits. It must not depend on how the trace was made, on the planner's prediction or on
//! the expected verdict.

mod checks;
mod events;
mod failing_load;
mod fingerprint;
mod judgement;
mod measure;
mod self_checks;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

pub use failing_load::{FailingLoad, failing_load};
pub use fingerprint::fingerprint;
pub use judgement::Judgement;

use crate::model::{
    measures::Measures,
    scenario::Limits,
    trace::{ArmTrace, Phase, Sample, Trace},
    verdict::{Check, Failure, VerdictKind},
};

/// Judges a trace.
///
/// The reference is the last sample of settling (docs/method.md#81-reference-state); a board lost before that drops.
/// The samples from there to the end of the load are judged, those of the release are not. A value equal to its limit
/// passes. The earliest crossing determines the verdict; of several at the same sample the loss of the board comes
/// first, then the contacts (pad, slip, rotation), then the clearance, torque, deflection, the person and creep.
///
/// A trace that breaks down is judged up to its last valid sample. If a limit was crossed before, it determines the
/// verdict. Otherwise there is no verdict, as the effect of the rest of the load is unknown.
#[must_use]
pub fn judge(trace: &Trace, limits: &Limits) -> Judgement {
    if let Some(reason) = malformed(trace) {
        return no_verdict(trace, Measures::default(), Vec::new(), reason);
    }
    let ValidPart { samples, ends_because } = valid_part(trace);
    let reference = reference(samples);
    let measures = measure::measures(trace, &samples[reference..]);
    let judged = judged(samples, reference);
    if let Some(reason) = no_verdict_reason(trace, judged, ends_because.as_deref()) {
        return no_verdict(trace, measures, Vec::new(), reason);
    }
    let findings = checks::findings(trace, judged, &measures, limits, ends_because.is_none());
    let first = checks::first_failure(&findings);
    let decided = first.map_or(samples.len(), |(_, crossing)| reference + crossing.sample + 1);
    let self_checks = self_checks::self_checks(&samples[..decided]);
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
        peak_torque_ratio: peak_torque_ratio(&measures, judged.len()),
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

/// Index of the reference: the last sample of settling, or the first of a trace that never settled. If the board is
/// lost while settling, and the load never acts, it is the first sample after the last contact.
fn reference(samples: &[Sample]) -> usize {
    let settled = samples.iter().rposition(|sample| sample.phase == Phase::Settle).unwrap_or(0);
    if samples.iter().any(|sample| sample.phase.is_loaded()) {
        return settled;
    }
    let last_touch = samples.iter().rposition(Sample::has_contact).map_or(0, |last| last + 1);
    settled.min(last_touch)
}

/// The samples from the reference to the end of the load; to the end of the trace if the board was lost before the
/// load; empty if the load never acted for another reason.
fn judged(samples: &[Sample], reference: usize) -> &[Sample] {
    let end = samples.iter().rposition(|sample| sample.phase.is_loaded()).map(|last| last + 1);
    let lost = !samples[reference].has_contact();
    let end = end.unwrap_or(if lost { samples.len() } else { reference });
    &samples[reference..end.max(reference)]
}

fn peak_torque_ratio(measures: &Measures, count: usize) -> BTreeMap<String, f64> {
    let peak = |ratios: &[f64]| ratios[..count].iter().copied().fold(0.0, f64::max);
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
        fingerprint: fingerprint(trace),
        events: events::events_without_verdict(trace, &reason),
        reason: Some(reason),
        measures,
    }
}
