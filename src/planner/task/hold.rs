//! A hold that a task may use.

use super::super::library::BoardGrasp;

/// A grasp of the board at a pose.
#[derive(Clone)]
pub struct Hold {
    pub grasp: BoardGrasp,
    /// The number of its board pose; `None` at a level pose, where no piece is served.
    pub place: Option<usize>,
    /// The number of its grip.
    pub grip: usize,
}
