//! The required clearances of each part of the person (docs/method.md#35-clearances).

use super::PersonPart;
use crate::human::{BodyPart, Capsule, Side};

/// Required distance between person and robot, m. The tool must only not touch the robot.
const ROBOT_CLEARANCE_M: f64 = 0.05;
/// Required distance between person and board, m. Tool and working hand may touch the board; the working forearm must not.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_verdicts_states_the_clearances_to_the_person() {
        let page = include_str!("../../docs/verdicts.md").split_whitespace().collect::<Vec<_>>().join(" ");
        let [robot_mm, board_mm] = [ROBOT_CLEARANCE_M, BOARD_CLEARANCE_M].map(|m| 1e3 * m);
        let stated = format!("the robot at least {robot_mm} mm and the board at least {board_mm} mm from the person");
        assert!(page.contains(&stated), "docs/verdicts.md does not say {stated:?}");
    }
}
