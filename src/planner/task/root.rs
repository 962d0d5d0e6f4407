//! The best hold of one piece alone, from which the holds of a task follow.

use super::{super::library::BoardGrasp, problem::Posture};

/// The best hold of one piece alone.
pub struct Root {
    pub piece: usize,
    pub grasp: BoardGrasp,
    pub posture: Posture,
    pub objective: f64,
}
