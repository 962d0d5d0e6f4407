//! A grasp of the board by all arms of a robot.

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

use crate::model::{board::Edge, frames::Pose, grasp::EdgeGrasp};

/// One arm's grasp and configuration.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ArmGrasp {
    /// Where the gripper is on the board.
    pub grasp: EdgeGrasp,
    /// Joint angles, rad.
    pub q_rad: Vec<f64>,
}

/// A pose of the board and the grasps that bring the arms to it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct BoardGrasp {
    /// Pose of the board in the world.
    pub x_wo: Pose,
    /// One entry per arm of the robot.
    pub arms: Vec<ArmGrasp>,
}

/// What refinement does not change about a grasp: the edge and the finger axis' sign of each arm. Arms beyond the fourth do
/// not count.
pub type GraspPattern = ArrayVec<(Edge, bool), 4>;

/// The pattern of a grasp.
pub fn pattern(arms: &[ArmGrasp]) -> GraspPattern {
    arms.iter().take(4).map(|arm| (arm.grasp.edge, arm.grasp.flipped)).collect()
}

/// The largest difference of a joint between two configurations of the same arms, rad.
pub fn largest_joint_difference_rad(one: &[ArmGrasp], other: &[ArmGrasp]) -> f64 {
    let joints = one.iter().zip(other).flat_map(|(a, b)| a.q_rad.iter().zip(&b.q_rad).map(|(a, b)| (a - b).abs()));
    joints.fold(0.0, f64::max)
}
