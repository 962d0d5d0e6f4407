//! What the muscles of a person's arm do in a plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The work of the muscles of the working arm (`docs/method.md#4-muscular-comfort`): activations by static optimisation in a
/// musculoskeletal model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MuscleWork {
    /// Sum of the squares of all activations.
    pub effort: f64,
    /// The largest activation, 0 to 1.
    pub largest_activation: f64,
    /// How long the busiest muscle could hold, s: an estimate after Rohmert 1960. Absent up to an activation of 15 %, which
    /// that curve allows without end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub endurance_s: Option<f64>,
    /// The largest moment that the muscles cannot exert, N m; absent up to 0.1 N m. With it the arm is too weak.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing_nm: Option<f64>,
    /// The five busiest muscles.
    pub busiest: Vec<BusyMuscle>,
}

/// A muscle and its activation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BusyMuscle {
    /// Its name.
    pub name: String,
    /// Its activation, 0 to 1.
    pub activation: f64,
}
