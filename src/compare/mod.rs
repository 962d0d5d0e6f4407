//! What changed between two sets of results (`docs/method.md#106-comparison`): verdicts, figures and probabilities, those that got
//! worse apart from those that got better or only moved.

mod baseline;
mod changes;
mod noise;

pub use baseline::{Baseline, CRITERIA, CheckEntry, ScenarioEntry, SweepEntry};
pub use changes::{Change, ChangeKind, Comparison, compare};
pub use noise::{difference, quantile_error};
