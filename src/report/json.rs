//! Plans and verdicts as JSON.

use serde::Serialize;

use super::Outcome;
use crate::model::{plan::Plan, verdict::Verdict};

/// A plan as an object, with a final newline.
#[must_use]
pub fn plan(plan: &Plan) -> String {
    pretty(plan)
}

/// A verdict as an object, with a final newline.
#[must_use]
pub fn verdict(verdict: &Verdict) -> String {
    pretty(verdict)
}

/// The verdicts of a run as an array, in order. Scenarios that crashed or were skipped have no verdict and are left out.
#[must_use]
pub fn verdicts(outcomes: &[Outcome]) -> String {
    pretty(&outcomes.iter().filter_map(Outcome::verdict).collect::<Vec<_>>())
}

/// A value in one line, with a final newline.
#[must_use]
pub fn line(value: &impl Serialize) -> String {
    // As for `pretty`.
    let mut text = serde_json::to_string(value).expect("answers have only string keys");
    text.push('\n');
    text
}

/// A value as indented JSON.
#[must_use]
pub fn pretty(value: &impl Serialize) -> String {
    // Serialisation fails only for maps whose keys are not strings; there are none.
    let mut text = serde_json::to_string_pretty(value).expect("reports have only string keys");
    text.push('\n');
    text
}
