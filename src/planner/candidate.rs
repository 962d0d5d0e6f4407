//! A candidate: the numbers that the search chooses, and the poses that follow from them.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Problem;
use crate::model::{frames::Pose, grasp::EdgeGrasp};

/// One hold and one answer of the person to it.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Angles of the person's working arm, rad.
    pub q_h_rad: [f64; 7],
    /// The person's heading: direction of x_B in W, rad from x_W.
    pub heading_rad: f64,
    /// Roll of the tool about its axis, rad; zero unless the operation leaves it free.
    pub roll_rad: f64,
    /// Position of the board's centre in W along x and y, m. Its height follows from the posture.
    pub p_wo_xy_m: [f64; 2],
    /// One entry an arm of the robot.
    pub holds: Vec<Hold>,
}

/// One arm's grasp and configuration.
#[derive(Clone, Debug)]
pub struct Hold {
    /// Where the gripper holds.
    pub grasp: EdgeGrasp,
    /// The arm's joint angles, rad.
    pub q_rad: Vec<f64>,
}

impl Candidate {
    /// The board's pose relative to the person: `X_BO = X_BT X_OT^-1`.
    fn x_bo(&self, problem: &Problem<'_>) -> Pose {
        let x_ot = problem.scenario.operation.rolled(self.roll_rad).x_ot;
        problem.human.tool_pose_b(&self.q_h_rad) * x_ot.inverse()
    }

    /// The board's pose in the world: the person stands on the floor, which fixes the height.
    pub fn x_wo(&self, problem: &Problem<'_>) -> Pose {
        let x_bo = self.x_bo(problem);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.heading_rad);
        let z_m = problem.map.robot.floor_z_m + x_bo.translation.z;
        let [x_m, y_m] = self.p_wo_xy_m;
        Isometry3::from_parts(Vector3::new(x_m, y_m, z_m).into(), turn * x_bo.rotation)
    }

    /// The person's pose in the world, upright on the floor: `X_WB = X_WO X_BO^-1`, whose tilt is zero.
    pub fn x_wb(&self, problem: &Problem<'_>) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.heading_rad);
        let p_bo_w = turn * self.x_bo(problem).translation.vector;
        let [x_m, y_m] = self.p_wo_xy_m;
        let position = Vector3::new(x_m - p_bo_w.x, y_m - p_bo_w.y, problem.map.robot.floor_z_m);
        Isometry3::from_parts(position.into(), turn)
    }
}
