//! A candidate: the numbers that the search chooses, and the poses that follow from them.

use arrayvec::ArrayVec;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Problem;
use crate::model::{
    frames::Pose,
    grasp::{Edge, EdgeGrasp},
};

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

/// What a candidate says of the person, the tool and the board's place: all but how the robot holds it.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    pub q_h_rad: [f64; 7],
    pub heading_rad: f64,
    pub roll_rad: f64,
    pub p_wo_xy_m: [f64; 2],
}

/// Where board and person are.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    pub x_wo: Pose,
    pub x_wb: Pose,
}

impl Stance {
    /// The board's pose in the world, whose height follows from the floor that the person stands on, and the person's,
    /// upright on that floor: `X_WB = X_WO X_BO^-1`, whose tilt is zero.
    pub fn placed(&self, problem: &Problem<'_>) -> Placed {
        // The board's pose relative to the person: X_BO = X_BT X_OT^-1.
        let x_ot = problem.scenario.operation.rolled(self.roll_rad).x_ot;
        let x_bo = problem.human.tool_pose_b(&self.q_h_rad) * x_ot.inverse();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.heading_rad);
        let floor_z_m = problem.map.robot.floor_z_m;
        let p_bo_w = turn * x_bo.translation.vector;
        let [x_m, y_m] = self.p_wo_xy_m;
        Placed {
            x_wo: Isometry3::from_parts(Vector3::new(x_m, y_m, floor_z_m + p_bo_w.z).into(), turn * x_bo.rotation),
            x_wb: Isometry3::from_parts(Vector3::new(x_m - p_bo_w.x, y_m - p_bo_w.y, floor_z_m).into(), turn),
        }
    }
}

/// What a climb does not change about a hold: for each hand the edge that it holds and which way up it is. Hands beyond the
/// fourth do not count.
pub type HoldKind = ArrayVec<(Edge, bool), 4>;

/// The kind of a hold.
pub fn hold_kind(holds: &[Hold]) -> HoldKind {
    holds.iter().take(4).map(|hold| (hold.grasp.edge, hold.grasp.flipped)).collect()
}

impl Candidate {
    /// See [`hold_kind`].
    pub fn kind(&self) -> HoldKind {
        hold_kind(&self.holds)
    }

    /// The kind of a hold with the board turned by quarters until the first hand is at +x_O.
    pub fn kind_unturned(&self) -> HoldKind {
        let mut kind = self.kind();
        while kind.first().is_some_and(|(edge, _)| *edge != Edge::PlusX) {
            kind.iter_mut().for_each(|(edge, _)| *edge = edge.turned(1));
        }
        kind
    }

    /// All but how the robot holds the board.
    pub fn stance(&self) -> Stance {
        let Self { q_h_rad, heading_rad, roll_rad, p_wo_xy_m, .. } = *self;
        Stance { q_h_rad, heading_rad, roll_rad, p_wo_xy_m }
    }

    /// Where board and person are.
    pub fn placed(&self, problem: &Problem<'_>) -> Placed {
        self.stance().placed(problem)
    }

    /// The board's pose in the world.
    pub fn x_wo(&self, problem: &Problem<'_>) -> Pose {
        self.placed(problem).x_wo
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_unturned_is_the_same_for_all_turns_of_the_board() {
        let hold = |edge, flipped| Hold {
            grasp: EdgeGrasp { edge, along_m: 0.0, depth_m: 0.03, angle_rad: 0.0, flipped },
            q_rad: Vec::new(),
        };
        let kind = |edges: [Edge; 2]| {
            let holds = vec![hold(edges[0], true), hold(edges[1], false)];
            Candidate { q_h_rad: [0.0; 7], heading_rad: 0.0, roll_rad: 0.0, p_wo_xy_m: [0.0; 2], holds }.kind_unturned()
        };
        for quarters in 0..4 {
            let turned = |edge: Edge| edge.turned(quarters);
            assert_eq!(kind([Edge::PlusY, Edge::PlusY].map(turned)), kind([Edge::PlusX, Edge::PlusX]));
            assert_eq!(kind([Edge::PlusX, Edge::MinusX].map(turned)), kind([Edge::MinusY, Edge::PlusY]));
        }
        assert_ne!(kind([Edge::PlusX, Edge::PlusX]), kind([Edge::PlusX, Edge::MinusX]));
    }
}
