//! The pairs of links that must not touch, and the distance that each can be asked to keep (docs/method.md#35-clearances).

use super::{link_shapes::LinkShapes, shapes::Measure};
use crate::robot::Robot;

/// Pairs with at most this many moving joints between their links have a largest distance: the design of the arm.
const JOINTS_BETWEEN: usize = 2;

/// Positions of each joint at which that distance is measured: its limits and three between them.
const POSITIONS: usize = 5;

/// The share of the largest distance that a pair may be asked to keep: more would leave hardly any angles to the joints
/// between its links.
const SHARE: f64 = 0.5;

/// Two links that must not touch.
#[derive(Clone, Debug)]
pub(super) struct SelfPair {
    /// Indices of the links, the lower one first.
    pub links: [usize; 2],
    /// The most that the pair can be asked to keep, m; infinite if more than two joints move the links relative to each other.
    most_m: f64,
}

impl SelfPair {
    /// The required distance, m, where `clearance_m` is asked for.
    pub fn required_m(&self, clearance_m: f64) -> f64 {
        clearance_m.min(self.most_m)
    }
}

/// All pairs of links with shapes but those that do not move against each other and the robot's allowed collisions.
pub(super) fn self_pairs(robot: &Robot, links: &[LinkShapes]) -> Vec<SelfPair> {
    let active = robot.active_joints();
    let carriers = robot.active_carriers();
    (0..links.len())
        .flat_map(|a| (a + 1..links.len()).map(move |b| [a, b]))
        .filter(|&[a, b]| !links[a].pieces.is_empty() && !links[b].pieces.is_empty() && carriers[a] != carriers[b])
        .filter(|pair| !robot.allowed_collisions.contains(pair))
        .map(|pair| SelfPair { links: pair, most_m: most_m(robot, &active, links, pair) })
        .collect()
}

/// A share of the largest distance of two links over the positions of the joints between them; infinite if these are many.
fn most_m(robot: &Robot, active: &[bool], links: &[LinkShapes], [a, b]: [usize; 2]) -> f64 {
    let joints = joints_between(robot, active, a, b);
    if joints.len() > JOINTS_BETWEEN {
        return f64::INFINITY;
    }
    let mut positions = robot.positions(&[]);
    let mut farthest_m = 0.0_f64;
    for number in 0..POSITIONS.pow(joints.len() as u32) {
        for (place, &joint) in joints.iter().enumerate() {
            let step = number / POSITIONS.pow(place as u32) % POSITIONS;
            let [low, high] = range(robot, joint);
            positions[joint] = low + (high - low) * step as f64 / (POSITIONS - 1) as f64;
        }
        let poses = robot.link_poses(&positions);
        let distance = links[a].distance_within(&poses[a], &links[b], &poses[b], f64::INFINITY, Measure::Distance);
        farthest_m = farthest_m.max(distance);
    }
    SHARE * farthest_m
}

/// The range of a joint, a whole turn if it has no limits.
fn range(robot: &Robot, joint: usize) -> [f64; 2] {
    use std::f64::consts::PI;
    let joint = &robot.joints[joint];
    [joint.lower.max(-PI), joint.upper.min(PI)]
}

/// The moving joints that are above one of two links and not above both.
fn joints_between(robot: &Robot, active: &[bool], a: usize, b: usize) -> Vec<usize> {
    let above = |link: usize| {
        let parent = |link: &usize| robot.links[*link].parent_joint.map(|joint| robot.joints[joint].parent_link);
        let links = std::iter::successors(Some(link), parent);
        let joints = links.filter_map(|link| robot.links[link].parent_joint);
        joints.filter(|&joint| active[joint]).collect::<Vec<_>>()
    };
    let [of_a, of_b] = [above(a), above(b)];
    let own = |own: &[usize], other: &[usize]| own.iter().copied().filter(|joint| !other.contains(joint)).collect();
    let [mut between, more]: [Vec<usize>; 2] = [own(&of_a, &of_b), own(&of_b, &of_a)];
    between.extend(more);
    between
}
