//! Links whose meshes are better divided into convex parts: their hulls are in the way of other links, or of the board.

use std::collections::{BTreeMap, BTreeSet};

use super::pairs::{ALWAYS, Overlaps, adjacent};
use crate::{
    collision::{CollisionModel, board_between_pads},
    robot::{Robot, Shape},
};

/// The share of random postures from which on a hull that overlaps another link is in the way.
const IN_THE_WAY: f64 = 0.05;

/// A decomposition is worth its cost if it takes away this share of the overlaps of a pair.
const WORTH: f64 = 0.3;

/// Distance from a board in the gripper within which a link of the hand is in the way, m: the usual clearance.
const BOARD_CLEARANCE_M: f64 = 0.005;

/// How much farther from the board the parts of a mesh must be than its hull, m.
const FARTHER_M: f64 = 0.002;

/// Two links and the share of the random postures in which they overlap.
pub(super) type Often = ([usize; 2], f64);

/// The links with hulls of meshes that overlap others often, but not always, and not only their neighbours; or that are near a
/// board in the gripper. `often` is that of the robot.
pub(super) fn in_the_way(robot: &Robot, often: &[Often]) -> Vec<usize> {
    let is_hull = |link: &usize| {
        let shapes = &robot.links[*link].shapes;
        shapes.iter().any(|placed| matches!(placed.shape, Shape::Hull(_)))
    };
    let pairs = often.iter().flat_map(|(links, _)| *links);
    let links: BTreeSet<usize> = pairs.chain(near_boards(robot).into_keys()).filter(is_hull).collect();
    links.into_iter().collect()
}

/// Of the links that were decomposed those for which it was worth it. `often` is that of the robot with hulls.
pub(super) fn worth_decomposing(hulls: &Robot, often: &[Often], parts: &Robot, decomposed: &[usize]) -> Vec<usize> {
    let after: BTreeMap<[usize; 2], f64> = Overlaps::of(parts).shares.into_iter().collect();
    let better: Vec<[usize; 2]> = often
        .iter()
        .filter(|(links, before)| after.get(links).copied().unwrap_or_default() <= (1.0 - WORTH) * before)
        .map(|(links, _)| *links)
        .collect();
    let (before, after) = (near_boards(hulls), near_boards(parts));
    let is_farther = |link: &usize| {
        let after_m = after.get(link).copied().unwrap_or(BOARD_CLEARANCE_M);
        before.get(link).is_some_and(|before_m| after_m >= before_m + FARTHER_M)
    };
    let is_worth = |link: &usize| is_farther(link) || better.iter().any(|links| links.contains(link));
    decomposed.iter().copied().filter(is_worth).collect()
}

/// Pairs that are not neighbours and overlap often, but not always, and their shares of the random postures.
pub(super) fn often(robot: &Robot) -> Vec<Often> {
    let adjacent = adjacent(robot);
    let shares = Overlaps::of(robot).shares.into_iter();
    shares.filter(|(links, share)| (IN_THE_WAY..ALWAYS).contains(share) && !adjacent.contains(links)).collect()
}

/// The links of hands but fingers that are near a board which the pads cover to its edge, and their distances, m.
fn near_boards(robot: &Robot) -> BTreeMap<usize, f64> {
    let model = CollisionModel::new(robot);
    let x_wl = robot.link_poses(&robot.positions(&[]));
    let carriers = robot.carriers();
    let mut near = BTreeMap::new();
    for arm in &robot.arms {
        let gripper = &arm.gripper;
        let Some((board, x_go)) = board_between_pads(robot, arm) else { continue };
        let x_wo = x_wl[gripper.frame_link] * x_go;
        let hand = (0..robot.links.len()).filter(|&link| carriers[link] == carriers[gripper.frame_link]);
        for link in hand.filter(|&link| !robot.links[link].shapes.is_empty()) {
            let distance_m = model.link_to_board_m(link, &x_wl[link], &board, &x_wo);
            if distance_m < BOARD_CLEARANCE_M {
                near.insert(link, distance_m);
            }
        }
    }
    near
}
