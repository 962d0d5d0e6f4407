//! What is expected of a scenario.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::verdict::VerdictKind;

/// The expected result of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// The verdict that counts as a success.
    #[serde(default = "holds")]
    pub verdict: VerdictKind,
    /// The probability of the verdict that a sweep must show.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// The confidence of a sweep's interval, and with which the probability must be shown.
    #[serde(default = "usual_confidence", skip_serializing_if = "is_usual_confidence")]
    pub confidence: f64,
}

/// The default of [`Expectation::verdict`].
fn holds() -> VerdictKind {
    VerdictKind::Holds
}

/// The default of [`Expectation::confidence`].
fn usual_confidence() -> f64 {
    Expectation::CONFIDENCE
}

fn is_usual_confidence(confidence: &f64) -> bool {
    *confidence == Expectation::CONFIDENCE
}

impl Expectation {
    /// The confidence of an expectation that does not state it.
    pub const CONFIDENCE: f64 = 0.95;

    /// A verdict, without a probability.
    #[must_use]
    pub fn of(verdict: VerdictKind) -> Self {
        Self { verdict, probability: None, confidence: Self::CONFIDENCE }
    }
}

impl Default for Expectation {
    fn default() -> Self {
        Self::of(VerdictKind::Holds)
    }
}
