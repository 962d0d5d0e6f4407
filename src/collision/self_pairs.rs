//! The pairs of links that must not touch, and the distance that each can be asked to keep (docs/method.md#35-clearances).

use std::collections::BTreeMap;

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
    let mut allowed = robot.allowed_collisions.clone();
    allowed.sort_unstable();
    let with_shapes: Vec<usize> = (0..links.len()).filter(|&link| !links[link].pieces.is_empty()).collect();
    let mut pairs = Vec::new();
    // What moves two links against each other follows from the joints that carry them.
    let mut of_carriers: BTreeMap<[Option<usize>; 2], Vec<usize>> = BTreeMap::new();
    for (place, &a) in with_shapes.iter().enumerate() {
        for &b in &with_shapes[place + 1..] {
            if carriers[a] != carriers[b] && allowed.binary_search(&[a, b]).is_err() {
                of_carriers.entry([carriers[a], carriers[b]]).or_default().push(pairs.len());
                pairs.push(SelfPair { links: [a, b], most_m: f64::INFINITY });
            }
        }
    }
    for places in of_carriers.values() {
        let [a, b] = pairs[places[0]].links;
        let joints = joints_between(robot, &active, a, b);
        if joints.len() <= JOINTS_BETWEEN {
            set_most(robot, links, &joints, places, &mut pairs);
        }
    }
    pairs
}

/// Sets the most that pairs can be asked to keep, which the same joints move: a share of their largest distance over the positions
/// of these.
fn set_most(robot: &Robot, links: &[LinkShapes], joints: &[usize], places: &[usize], pairs: &mut [SelfPair]) {
    let mut positions = robot.positions(&[]);
    let mut farthest_m = vec![0.0_f64; places.len()];
    for number in 0..POSITIONS.pow(joints.len() as u32) {
        for (place, &joint) in joints.iter().enumerate() {
            let step = number / POSITIONS.pow(place as u32) % POSITIONS;
            let [low, high] = range(robot, joint);
            positions[joint] = low + (high - low) * step as f64 / (POSITIONS - 1) as f64;
        }
        let poses = robot.link_poses(&positions);
        for (farthest_m, &place) in farthest_m.iter_mut().zip(places) {
            let [a, b] = pairs[place].links;
            let distance = links[a].distance_within(&poses[a], &links[b], &poses[b], f64::INFINITY, Measure::Distance);
            *farthest_m = farthest_m.max(distance);
        }
    }
    for (farthest_m, &place) in farthest_m.iter().zip(places) {
        pairs[place].most_m = SHARE * farthest_m;
    }
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
