//! The distances that each part of the person must keep (METHOD section 3).

use super::PersonPart;
use crate::human::{BodyPart, Capsule, Side};

/// Least distance between the person and the robot, m. The tool only must not touch.
const ROBOT_CLEARANCE_M: f64 = 0.05;
/// Least distance between the person and the board, m. Tool and working hand may touch it; the working forearm must not
/// penetrate it.
const BOARD_CLEARANCE_M: f64 = 0.02;

impl From<Capsule> for PersonPart {
    fn from(capsule: Capsule) -> Self {
        let robot_clearance_m = if capsule.name == BodyPart::Tool { 0.0 } else { ROBOT_CLEARANCE_M };
        let board_clearance_m = match capsule.name {
            BodyPart::Tool | BodyPart::Hand(Side::Working) => None,
            BodyPart::Forearm(Side::Working) => Some(0.0),
            _ => Some(BOARD_CLEARANCE_M),
        };
        let Capsule { name, p0_w, p1_w, radius_m } = capsule;
        Self { name, p0_w, p1_w, radius_m, robot_clearance_m, board_clearance_m }
    }
}
