//! What one run of a sweep leaves.

use serde::{Deserialize, Serialize};

use crate::model::verdict::{CheckKind, VerdictKind};

/// One run of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunRecord {
    /// Its index, from 0.
    pub index: u64,
    /// The drawn values, one a dimension.
    pub values: Vec<f64>,
    /// What the statics predict; `None` without a prediction.
    pub predicted: Option<PredictedRun>,
    /// How the verdict was found.
    pub decided: Decided,
    /// The verdict.
    pub verdict: VerdictKind,
    /// What was simulated; `None` if nothing was.
    pub measured: Option<MeasuredRun>,
}

/// How the verdict of a run was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decided {
    /// Simulated, since the prediction was near to a limit or there is no screen.
    Simulated,
    /// Simulated as a random check, though the statics would have decided it.
    Audited,
    /// By the statics alone.
    Predicted,
}

impl Decided {
    /// The name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Audited => "audited",
            Self::Predicted => "predicted",
        }
    }
}

/// What the statics predict for a run under its deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PredictedRun {
    /// The compliant load factor.
    pub load_factor: f64,
    /// The deflection under the load, mm; infinite if no forces balance it.
    pub deflection_mm: f64,
}

/// What was simulated in a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredRun {
    /// Largest translation of a hand on the board, mm.
    pub slip_mm: f64,
    /// Largest rotation of a hand on the board, degrees.
    pub slip_deg: f64,
    /// Largest displacement of the tool point under the load, mm.
    pub deflection_mm: f64,
    /// Largest demanded torque divided by its limit.
    pub torque_ratio: f64,
    /// The multiple of the planned load at the first crossing of a limit; `None` if none was crossed.
    pub failed_at: Option<f64>,
    /// The check whose limit was crossed first.
    pub first_check: Option<CheckKind>,
}
