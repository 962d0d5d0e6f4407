//! Replaces `recording` in a build without the feature `recording`.

use super::{exit::CliError, pipeline::Run};
use crate::{
    check::PiecePlan,
    judge::StageJudgement,
    model::{scenario::Scenario, staged_plan::StagedPlan, staged_trace::StagedTrace, staged_verdict::StagedVerdict},
    robot::Robot,
};

/// Always `None`.
pub fn encode(_: &Run, _: &Scenario, _: &Robot) -> Result<Option<Vec<u8>>, CliError> {
    Ok(None)
}

/// What a recording of a task would be made from.
#[allow(dead_code)]
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

/// Always `None`.
pub fn encode_task(_: &TaskRecording<'_>) -> Result<Option<Vec<u8>>, CliError> {
    Ok(None)
}
