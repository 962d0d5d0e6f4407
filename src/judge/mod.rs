//! The judge: a trace against its limits (METHOD section 8).
//!
//! A pure function. It must never know how a trace was made, what a planner predicted or what the author expects: a
//! verdict that depended on any of these would prove nothing.

mod checks;
mod events;
mod failing_load;
mod fingerprint;
mod measure;
mod self_checks;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

pub use failing_load::{FailingLoad, MAX_SIMULATED_FACTOR, failing_load};
pub use fingerprint::fingerprint;

use crate::model::{
    FORMAT,
    measures::{Event, Measures},
    scenario::Limits,
    trace::{Phase, Sample, Trace},
    verdict::{Check, Failure, Verdict, VerdictKind},
};

/// What the judge says about a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// What became of the hold.
    pub verdict: VerdictKind,
    /// Every limit, with what was found; empty without a verdict.
    pub checks: Vec<Check>,
    /// What the simulation made of the laws of mechanics; empty when the trace is malformed.
    pub self_checks: Vec<Check>,
    /// The first limit that was crossed.
    pub first_failure: Option<Failure>,
    /// Largest torque over limit of each joint, from the reference to the end of the load.
    pub peak_torque_ratio: BTreeMap<String, f64>,
    /// Why there is no verdict, in words.
    pub reason: Option<String>,
    /// SHA-256 of the trace.
    pub fingerprint: String,
    /// Phases and crossed limits, in the order of time.
    pub events: Vec<Event>,
    /// The series behind the checks; empty when the trace is malformed.
    pub measures: Measures,
}

impl Judgement {
    /// The verdict's file form, with what the judge itself must not know.
    pub fn to_verdict(
        &self,
        name: &str,
        expected: VerdictKind,
        seed: u64,
        versions: BTreeMap<String, String>,
    ) -> Verdict {
        Verdict {
            format: FORMAT,
            name: name.to_owned(),
            verdict: self.verdict,
            expected,
            met: self.verdict == expected && self.verdict != VerdictKind::NoVerdict,
            checks: self.checks.clone(),
            self_checks: self.self_checks.clone(),
            first_failure: self.first_failure.clone(),
            peak_torque_ratio: self.peak_torque_ratio.clone(),
            reason: self.reason.clone(),
            versions,
            seed,
            fingerprint: self.fingerprint.clone(),
        }
    }
}

/// Judges a simulated hold.
///
/// The reference is the last sample of settling; a board lost before that drops. What is judged reaches from there to the end of the load; the release
/// is not. A value at its limit keeps it. The earliest crossing names the verdict; of several at the same sample, the
/// loss of the board goes before the contacts (pad, slip, rotation), and these before torque, deflection, the person
/// and creep.
///
/// A trace that breaks down is judged as far as it can be believed: a limit that was crossed before names the verdict, for
/// nothing that comes later could take it back. Without such a crossing there is no verdict: what the rest
/// of the load would have done is not known.
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

/// The part of a trace that can be believed.
struct ValidPart<'a> {
    /// The samples, up to the last good one; never none.
    samples: &'a [Sample],
    /// Why there are no more although the load went on, in words; none when the trace ran to its end.
    ends_because: Option<String>,
}

/// The samples before the first number that is not finite, all of them when there is none; a simulation that broke down
/// has left out what came after. A trace whose very first sample is none is left to [`malformed`].
fn valid_part(trace: &Trace) -> ValidPart<'_> {
    match trace.samples.iter().position(|sample| !fingerprint::sample_is_finite(sample)) {
        Some(bad) => ValidPart { samples: &trace.samples[..bad], ends_because: Some(not_finite(&trace.samples[bad])) },
        None => ValidPart { samples: &trace.samples, ends_because: trace.broke_down.clone() },
    }
}

fn not_finite(sample: &Sample) -> String {
    format!("found a number that is not finite in the sample at {} s", sample.time_s)
}

/// Index of the reference: the last sample of settling, or the first of a trace that never settled. A board that is lost
/// while settling never meets the load: then it is the first sample in which no pad touches any more.
fn reference(samples: &[Sample]) -> usize {
    let settled = samples.iter().rposition(|sample| sample.phase == Phase::Settle).unwrap_or(0);
    if samples.iter().any(|sample| sample.phase.is_loaded()) {
        return settled;
    }
    let last_touch = samples.iter().rposition(Sample::has_contact).map_or(0, |last| last + 1);
    settled.min(last_touch)
}

/// The samples from the reference to the end of the load; to the end of the trace when the board was lost before the
/// load; none when the load never acted for another reason.
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

/// Why a trace cannot be measured: nothing in it, arms of different shapes, or nothing to measure from.
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

/// Why a well-formed trace allows no verdict whatever its limits; `ends_because` says why it was cut short, if so.
fn no_verdict_reason(trace: &Trace, judged: &[Sample], ends_because: Option<&str>) -> Option<String> {
    if !fingerprint::constants_are_finite(trace) {
        return Some("found a limit or a tool point that is not finite".to_owned());
    }
    let powerless = |arm: &crate::model::trace::ArmTrace| arm.effort_nm.iter().any(|&effort_nm| effort_nm <= 0.0);
    if let Some(arm) = trace.arms.iter().find(|arm| powerless(arm)) {
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
