//! What the search for a staged plan is given.

use super::super::{library::GraspingRobot, watch::Watch};
use crate::model::{plan::Plan, scenario::Scenario, task::Task};

/// What a search is given.
pub struct TaskSearch<'a> {
    /// The task.
    pub task: &'a Task,
    /// The scenario of the task; its operation is that of the first piece.
    pub scenario: &'a Scenario,
    /// The scenarios of the pieces.
    pub pieces: &'a [Scenario],
    /// The best plans of pieces by themselves.
    pub separate: &'a [Option<Plan>],
    /// The robot, prepared for the board.
    pub robot: &'a GraspingRobot,
    /// Is told of the search, and may stop it.
    pub watch: &'a dyn Watch,
}
