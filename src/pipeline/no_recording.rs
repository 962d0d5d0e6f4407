//! Replaces `recording` in a build without the feature `recording`.

use super::{Run, RunError, task_recording::TaskRecording};
use crate::{model::scenario::Scenario, robot::Robot};

/// Always `None`.
pub fn encode(_: &Run, _: &Scenario, _: &Robot) -> Result<Option<Vec<u8>>, RunError> {
    Ok(None)
}

/// Always `None`.
pub fn encode_task(_: &TaskRecording<'_>) -> Result<Option<Vec<u8>>, RunError> {
    Ok(None)
}
