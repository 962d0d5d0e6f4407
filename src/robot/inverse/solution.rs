//! The result of inverse kinematics, and when two solutions are the same.

use std::f64::consts::TAU;

use crate::model::frames::Pose;

/// Tolerance of a solution: m in position and rad in orientation.
pub const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Solutions that differ by less in every joint are the same, rad.
const SAME_SOLUTION_RAD: f64 = 1e-6;

/// The result of a search for one solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Solution {
    /// Angles within the limits, rad; the error of the gripper pose is at most [`RESIDUAL_TOLERANCE`].
    Found(Vec<f64>),
    /// The target is farther from the first joint than the chain's reach.
    OutOfReach {
        /// Distance of the target from the first joint, m.
        distance_m: f64,
        /// The chain's reach, m.
        reach_m: f64,
    },
    /// The search did not converge: there is no solution, or none was found.
    NotFound {
        /// Pose error of the best angles: norm of m and rad together.
        residual: f64,
    },
    /// The target or the seed is not finite, or the seed has the wrong length.
    Malformed,
}

impl Solution {
    /// The angles of a solution, rad.
    pub fn found(self) -> Option<Vec<f64>> {
        match self {
            Self::Found(q_rad) => Some(q_rad),
            Self::OutOfReach { .. } | Self::NotFound { .. } | Self::Malformed => None,
        }
    }
}

/// True if every number of a pose is finite.
pub(super) fn is_finite(pose: &Pose) -> bool {
    pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|v| v.is_finite())
}

/// True if the solutions contain these angles.
pub(super) fn contains(solutions: &[Vec<f64>], q_rad: &[f64]) -> bool {
    let same = |other: &Vec<f64>| other.iter().zip(q_rad).all(|(a, b)| (a - b).abs() < SAME_SOLUTION_RAD);
    solutions.iter().any(same)
}

/// The angle plus full turns that is within the limits, the nearest to their middle if there are several, rad.
pub(super) fn turned_into(angle_rad: f64, [lower, upper]: [f64; 2], tolerance_rad: f64) -> Option<f64> {
    let turned = angle_rad + ((0.5 * (lower + upper) - angle_rad) / TAU).round() * TAU;
    (lower - tolerance_rad..=upper + tolerance_rad).contains(&turned).then_some(turned)
}
