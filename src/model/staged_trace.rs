//! The trace of a simulated staged plan.

use super::{frames::Pose, trace::Trace};

/// The samples of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageSpan {
    /// The number of the stage.
    pub stage: usize,
    /// Its first sample.
    pub first: usize,
    /// Its last sample.
    pub last: usize,
}

/// The trace of all stages that were simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct StagedTrace {
    /// The trace.
    pub trace: Trace,
    /// The samples of each stage, in their order; the last one may be incomplete.
    pub spans: Vec<StageSpan>,
    /// The planned pose of the board at each sample.
    pub x_wo_planned: Vec<Pose>,
    /// The piece that is worked on, or was last, at each sample.
    pub pieces: Vec<usize>,
}
