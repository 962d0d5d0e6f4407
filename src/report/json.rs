//! Plans and verdicts as JSON, for programs.

use serde::Serialize;

use super::Outcome;
use crate::model::{plan::Plan, verdict::Verdict};

/// A plan as an object, with a line's end.
pub fn plan(plan: &Plan) -> String {
    pretty(plan)
}

/// One verdict as an object, with a line's end.
pub fn verdict(verdict: &Verdict) -> String {
    pretty(verdict)
}

/// The verdicts of a run as an array, in its order. What crashed or was skipped has no verdict and is not in it.
pub fn verdicts(outcomes: &[Outcome]) -> String {
    pretty(&outcomes.iter().filter_map(Outcome::verdict).collect::<Vec<_>>())
}

pub(super) fn pretty(value: &impl Serialize) -> String {
    // Serialisation into a string fails only for maps with keys that are no strings, and ours have none.
    let mut text = serde_json::to_string_pretty(value).expect("reports have only string keys");
    text.push('\n');
    text
}
