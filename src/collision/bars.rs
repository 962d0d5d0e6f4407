//! How near the bars of a gripper's linkage may come to the board: nearer than other links, since they carry the pads.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::{BoardBody, CollisionModel};
use crate::{
    model::{board::BoardShape, frames::Pose},
    robot::{Arm, Robot},
};

/// The share of its distance from a board that the pads just cover which a bar may be asked to keep, as of two links that are
/// always near each other (docs/method.md#35-clearances).
const SHARE: f64 = 0.5;

/// Width and height of that board, m: wider than a hand.
const BOARD_M: f64 = 0.3;

/// A board as thick as the gap between an arm's pads with the fingers at rest, which the pads just cover, and its pose in G;
/// `None` for a suction cup.
pub fn board_between_pads(robot: &Robot, arm: &Arm) -> Option<(BoardBody, Pose)> {
    let gripper = &arm.gripper;
    let pad = &gripper.fingers.first()?.pad;
    let gap_m: f64 = gripper
        .fingers
        .iter()
        .map(|finger| finger.pad.offset_m + finger.opening_sign * (robot.joints[finger.joint].rest - finger.closed_m))
        .sum();
    let edge_z_m = pad.centre_m[1] - pad.size_m[1] / 2.0;
    let board = BoardBody::new(&BoardShape::cuboid([BOARD_M, BOARD_M, gap_m.max(0.001)]));
    // z_O along y_G; the board reaches forward from the rear edge of the pads.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let centre_g = Point3::new(0.0, 0.0, edge_z_m + BOARD_M / 2.0);
    Some((board, Isometry3::from_parts(centre_g.into(), turn)))
}

impl CollisionModel {
    /// For each bar of a linkage that is beside a board between the pads the most that it can be asked to keep from it, m.
    pub(super) fn bars(&self, robot: &Robot) -> Vec<(usize, f64)> {
        let x_wl = robot.link_poses(&robot.positions(&[]));
        let of_arm = |arm: &Arm| {
            let Some((board, x_go)) = board_between_pads(robot, arm) else { return Vec::new() };
            let x_wo = x_wl[arm.gripper.frame_link] * x_go;
            let distance_m = |bar: usize| (bar, self.link_to_board_m(bar, &x_wl[bar], &board, &x_wo));
            robot.bars(arm).into_iter().map(distance_m).collect::<Vec<_>>()
        };
        // A bar that is in such a board is in the way as any other link is.
        let beside = robot.arms.iter().flat_map(of_arm).filter(|(_, distance_m)| *distance_m > 0.0);
        beside.map(|(bar, distance_m)| (bar, SHARE * distance_m)).collect()
    }
}
