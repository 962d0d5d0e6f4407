//! The results that are compared, small enough for a repository: a baseline file.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    model::{
        FORMAT,
        verdict::{CheckKind, Verdict, VerdictKind},
    },
    sweep::{
        info::Fingerprints,
        summary::{QUANTILES, SweepSummary},
    },
};

/// Results by name. Equal results give equal files, and a change of a result is a change of its lines.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// The file format, 1.
    pub format: u32,
    /// Versions of Benchdog, of the engines and of the criteria of judgement.
    pub versions: BTreeMap<String, String>,
    /// Scenarios and plans with their verdicts.
    #[serde(default)]
    pub scenarios: BTreeMap<String, ScenarioEntry>,
    /// Sweeps.
    #[serde(default)]
    pub sweeps: BTreeMap<String, SweepEntry>,
}

/// The verdict on a scenario or plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioEntry {
    /// The verdict.
    pub verdict: VerdictKind,
    /// Whether it is the expected one.
    pub met: bool,
    /// The checks.
    pub checks: BTreeMap<CheckKind, CheckEntry>,
}

/// A check of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckEntry {
    /// The worst value.
    pub value: f64,
    /// Its limit.
    pub limit: f64,
    /// What is left of the limit.
    pub margin: f64,
}

/// A sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepEntry {
    /// The verdict whose probability it is.
    pub expected: VerdictKind,
    /// The probability of the expected verdict.
    pub probability: f64,
    /// The confidence of its interval.
    pub confidence: f64,
    /// The lower end of its interval.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The number of runs.
    pub runs: u64,
    /// Whether the expected probability is shown; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub met: Option<bool>,
    /// True if the statics decided some runs: figures are then those of the runs near to failing.
    pub screened: bool,
    /// Figures of the sweep by name, such as `deflection_mm 95 %`, with their standard errors.
    pub figures: BTreeMap<String, [f64; 2]>,
    /// Program and inputs.
    pub fingerprints: Fingerprints,
}

/// The quantiles that are compared: places in [`QUANTILES`] with those of their neighbours, and names.
const COMPARED: [([usize; 3], &str); 2] = [([3, 4, 5], "50 %"), ([5, 6, 7], "95 %")];

/// The fewest runs whose quantiles are compared: of fewer the spread between quantiles tells little of their error.
const LEAST_RUNS: u64 = 20;

/// The name of the criteria among the versions.
pub const CRITERIA: &str = "criteria";

impl Baseline {
    /// Results without any.
    #[must_use]
    pub fn empty() -> Self {
        Self { format: FORMAT, ..Self::default() }
    }

    /// Adds a verdict. Returns false if there is one of this name already.
    #[must_use]
    pub fn add_verdict(&mut self, verdict: &Verdict) -> bool {
        self.versions.extend(verdict.versions.clone());
        // Verdicts from before the criteria were numbered have 0.
        if verdict.criteria > 0 {
            self.versions.insert(CRITERIA.to_owned(), verdict.criteria.to_string());
        }
        let checks = verdict
            .checks
            .iter()
            .map(|check| (check.name, CheckEntry { value: check.value, limit: check.limit, margin: check.margin }));
        let entry = ScenarioEntry { verdict: verdict.verdict, met: verdict.met, checks: checks.collect() };
        self.scenarios.insert(verdict.name.clone(), entry).is_none()
    }

    /// Adds a sweep. Returns false if there is one of this name already.
    #[must_use]
    pub fn add_sweep(&mut self, summary: &SweepSummary) -> bool {
        self.versions.extend(summary.info.versions.clone());
        let mut figures = BTreeMap::new();
        for of in summary.quantiles.iter().filter(|of| of.runs >= LEAST_RUNS) {
            for ([below, at, above], name) in COMPARED {
                let [low, high] = [of.values[below], of.values[above]];
                let spread = (high - low) / (QUANTILES[above] - QUANTILES[below]);
                let error = super::quantile_error(QUANTILES[at], of.runs, spread);
                figures.insert(format!("{} {name}", of.figure), [of.values[at], error]);
            }
        }
        let estimate = &summary.estimate;
        let entry = SweepEntry {
            expected: summary.info.expect.verdict,
            probability: estimate.probability,
            confidence: estimate.confidence,
            screened: summary.info.screen.is_some(),
            low: estimate.low,
            high: estimate.high,
            runs: summary.done,
            met: summary.met,
            figures,
            fingerprints: summary.info.fingerprints.clone(),
        };
        self.sweeps.insert(summary.info.name.clone(), entry).is_none()
    }

    /// True without results.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.scenarios.is_empty() && self.sweeps.is_empty()
    }
}
