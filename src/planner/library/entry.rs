//! A grasp of a library with what screening asks about it.

use nalgebra::Point3;

use super::{grasp::BoardGrasp, grasping_robot::GraspingRobot, postures::Posture};
use crate::{comfort, model::frames::Pose, planner::params::library::COARSE_STRIDE};

/// A grasp of a library, with what screening asks about it.
#[derive(Clone, Debug)]
pub struct LibraryEntry {
    pub grasp: BoardGrasp,
    /// The robot's points of the peripersonal metric, W.
    pub robot_points_w: Vec<Point3<f64>>,
    /// Some of them, for a first ranking.
    pub coarse_points_w: Vec<Point3<f64>>,
    /// The posture that the board was put for; it responds to the grasp exactly.
    pub posture: Option<Posture>,
}

impl LibraryEntry {
    /// An entry from a grasp and the poses of the robot's links in it.
    pub fn new(robot: &GraspingRobot, grasp: BoardGrasp, link_poses: &[Pose]) -> Self {
        let robot_points_w = comfort::robot_points_w(&robot.robot, link_poses);
        let coarse_points_w = robot_points_w.iter().step_by(COARSE_STRIDE).copied().collect();
        Self { grasp, robot_points_w, coarse_points_w, posture: None }
    }
}
