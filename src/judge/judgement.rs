//! The judgement of a trace.

use std::collections::BTreeMap;

use crate::model::{
    FORMAT,
    measures::{Event, Measures},
    verdict::{Check, Confirmation, Failure, Verdict, VerdictKind},
};

/// The number of the criteria, `criteria` in verdicts: raised when a check, a fixed limit, the order or the confirmation changes such
/// that a verdict may differ (docs/verdicts.md has a line for each number).
pub const CRITERIA: u32 = 1;

/// The judgement of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: VerdictKind,
    /// Value, limit and margin of every check; empty without a verdict.
    pub checks: Vec<Check>,
    /// The self-checks of the simulation; empty if the trace is malformed.
    pub self_checks: Vec<Check>,
    /// The first limit that was crossed.
    pub first_failure: Option<Failure>,
    /// Largest torque over limit of each joint, over the judged samples.
    pub peak_torque_ratio: BTreeMap<String, f64>,
    /// Simulations at shorter time steps, if there were any, see [`confirmed`](super::confirmed).
    pub confirmation: Option<Confirmation>,
    /// Why there is no verdict.
    pub reason: Option<String>,
    /// SHA-256 of the trace.
    pub fingerprint: String,
    /// Phases and crossed limits, in the order of time.
    pub events: Vec<Event>,
    /// The series behind the checks; empty if the trace is malformed.
    pub measures: Measures,
}

impl Judgement {
    /// The contents of a verdict file. Name, expectation, seed and versions do not influence the judgement.
    #[must_use]
    pub fn to_verdict(
        &self,
        name: &str,
        expected: VerdictKind,
        seed: u64,
        versions: BTreeMap<String, String>,
    ) -> Verdict {
        Verdict {
            format: FORMAT,
            criteria: CRITERIA,
            name: name.to_owned(),
            verdict: self.verdict,
            expected,
            met: self.verdict == expected && self.verdict != VerdictKind::NoVerdict,
            checks: self.checks.clone(),
            self_checks: self.self_checks.clone(),
            first_failure: self.first_failure.clone(),
            peak_torque_ratio: self.peak_torque_ratio.clone(),
            confirmation: self.confirmation.clone(),
            reason: self.reason.clone(),
            notes: Vec::new(),
            muscles: None,
            versions,
            seed,
            fingerprint: self.fingerprint.clone(),
        }
    }
}
