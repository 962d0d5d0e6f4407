//! Makes the MCAP file of a run.

use super::{Run, RunError, task_recording::TaskRecording, task_series::TaskSeries};
use crate::{
    robot::Robot,
    ros::trace::{self, McapInput},
};

/// The bytes of a run's trace; `None` if nothing was simulated.
///
/// # Errors
/// If the file cannot be made.
pub fn encode(run: &Run, robot: &Robot) -> Result<Option<Vec<u8>>, RunError> {
    let Some((trace, judgement)) = &run.simulated else { return Ok(None) };
    let (measures, events, verdict) = (&judgement.measures, &judgement.events[..], &run.verdict);
    Ok(Some(trace::encode(&McapInput { robot, trace, measures, events, verdict })?))
}

/// The bytes of a task's trace, with a sample each 10 ms; `None` without a step.
///
/// # Errors
/// If the file cannot be made.
pub fn encode_task(task: &TaskRecording<'_>) -> Result<Option<Vec<u8>>, RunError> {
    let Some(TaskSeries { trace, measures, events, verdict }) = TaskSeries::of(task) else { return Ok(None) };
    let input = McapInput { robot: task.robot, trace: &trace, measures: &measures, events: &events, verdict: &verdict };
    Ok(Some(trace::encode(&input)?))
}
