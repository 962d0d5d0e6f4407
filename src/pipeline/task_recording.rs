//! What the recording of a task is made from, in builds with and without recordings.

use crate::{
    check::PiecePlan,
    judge::StageJudgement,
    model::{scenario::Scenario, staged_plan::StagedPlan, staged_trace::StagedTrace, staged_verdict::StagedVerdict},
    robot::Robot,
};

/// What a recording of a task is made from.
#[cfg_attr(not(any(feature = "recording", feature = "mcap")), allow(dead_code))]
pub struct TaskRecording<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The robot.
    pub robot: &'a Robot,
    /// The plan.
    pub plan: &'a StagedPlan,
    /// The plans of its pieces.
    pub pieces: &'a [PiecePlan],
    /// The verdict.
    pub verdict: &'a StagedVerdict,
    /// The trace.
    pub trace: &'a StagedTrace,
    /// The judgements of its stages.
    pub judgements: &'a [StageJudgement],
}
