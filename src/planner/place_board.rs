//! Where a board can be held by grasps that are given: the first pose of the search domain that the arms reach.

use rand_pcg::Pcg64;

use super::domain::SearchDomain;
use crate::{
    complete::{ArmTask, Completer, Completion, Effort, Reached, Target},
    model::{board::BoardShape, frames::Pose},
    robot::Robot,
};

/// Poses of the board that are tried: hundreds of times as many as one needs to find two grasps at opposite edges of the default
/// board, and some seconds where no pose fits.
pub const BOARD_DRAWS: usize = 10_000;

/// A board that is held.
#[derive(Clone, Debug)]
pub struct PlacedBoard {
    /// X_WO.
    pub x_wo: Pose,
    /// The angles of each arm, in the order of the grasps, rad.
    pub q_rad: Vec<Vec<f64>>,
    /// The number of the pose in the sequence of random ones, from 1.
    pub draw: usize,
}

/// The first of the search domain's poses, drawn with `seed`, at which every arm reaches its grasp and the robot keeps
/// `clearance_m` from itself and from the board; `None` if no one of [`BOARD_DRAWS`] is so. `grasps` are arms, as indices into
/// [`Robot::arms`], with X_OG. The person and the load have no part in it.
#[must_use]
pub fn place_board(
    robot: &Robot,
    board: &BoardShape,
    grasps: &[(usize, Pose)],
    clearance_m: f64,
    seed: u64,
) -> Option<PlacedBoard> {
    let completer = Completer::new(robot, board);
    let holding = grasps.iter().map(|&(arm, _)| &completer.chains()[arm]);
    let domain = SearchDomain::of(holding, robot.floor_z_m, robot.search_box);
    let mut random = Pcg64::new(seed.into(), 0);
    (1..=BOARD_DRAWS).find_map(|draw| {
        let x_wo = domain.draw_board(&mut random);
        let task = |&(arm, x_og): &(usize, Pose)| ArmTask {
            arm,
            target: Target::Gripper { x_wg: x_wo * x_og, seed_rad: None },
        };
        let tasks: Vec<_> = grasps.iter().map(task).collect();
        match completer.complete(&tasks, &x_wo, &[], clearance_m, Effort::QUICK) {
            Completion::Found(Reached { q_rad, contact: None }) => Some(PlacedBoard { x_wo, q_rad, draw }),
            _ => None,
        }
    })
}
