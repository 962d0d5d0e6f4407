//! Pairs of links that may overlap, from random postures (as MoveIt's setup assistant finds them) or from an SRDF.
//!
//! Pairs that never met in the sample stay checked, other than in MoveIt: bounding spheres make them cheap, and a sample
//! proves nothing.

use std::collections::{BTreeMap, BTreeSet};

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::{
    collision::CollisionModel,
    robot::{ArmState, Robot},
};

/// Number of random postures.
const SAMPLES: usize = 2_000;

/// Seed of the postures.
const SEED: u64 = 1;

/// The share of postures from which on an overlap is taken for one of the shapes and not of the parts.
pub(super) const ALWAYS: f64 = 0.95;

/// For links with at most so many joints between them: the share of postures from which on an overlap is taken for one of the
/// shapes. The limits of few joints keep the parts themselves apart; every other joint of most arms only rolls.
const OFTEN: [(usize, f64); 2] = [(2, 0.10), (3, 0.20)];

/// Neighbours that are nearer than this in the middle of their range are so by design, m: the usual clearance.
const NEIGHBOURS_M: f64 = 0.005;

/// Why a pair may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// They overlap or are as near as parts of one joint, and one joint moves one link against the other.
    Adjacent,
    /// They overlap in nearly all postures.
    Always,
    /// They overlap often, and few joints are between them.
    Often,
    /// They overlap with all arms in the middle of their ranges.
    Middle,
    /// The SRDF says so.
    Srdf,
}

impl Reason {
    /// For comments: `overlap in nearly all postures`.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Adjacent => "neighbours: one joint moves one against the other",
            Self::Always => "overlap in nearly all of 2,000 random postures",
            Self::Often => {
                "few joints apart, and overlap in over 10 % (two joints) or 20 % (three) of random postures: shapes larger than \
                 their parts"
            }
            Self::Middle => {
                "overlap with the arms in the middle of their ranges: check that the parts do not touch there"
            }
            Self::Srdf => "disabled by the SRDF",
        }
    }
}

/// Two links that may overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllowedPair {
    /// Indices of the links, the lower one first.
    pub links: [usize; 2],
    /// Why.
    pub reason: Reason,
}

/// The joint angles of all arms in the middle of their ranges.
pub fn middle(robot: &Robot) -> Vec<Vec<f64>> {
    let of_joint = |&joint: &usize| (robot.joints[joint].lower + robot.joints[joint].upper) / 2.0;
    robot.arms.iter().map(|arm| arm.joints.iter().map(of_joint).collect()).collect()
}

/// The joint positions of all arms at these angles, with grippers at a share of the travel of their fingers.
pub fn positions(robot: &Robot, q_rad: &[Vec<f64>], open: f64) -> Vec<f64> {
    let states = robot.arms.iter().enumerate().zip(q_rad).map(|((arm, of), q_rad)| ArmState {
        arm,
        q_rad,
        finger_travel_m: [0, 1]
            .map(|finger| of.gripper.fingers.get(finger).map_or(0.0, |finger| open * finger.max_travel_m)),
    });
    robot.positions(&states.collect::<Vec<_>>())
}

/// The pairs that may overlap of a robot whose description allows none yet. `disabled` has those of an SRDF.
pub(super) fn allowed(robot: &Robot, disabled: Option<&[[String; 2]]>) -> Vec<AllowedPair> {
    let model = CollisionModel::new(robot);
    let mut reasons: BTreeMap<[usize; 2], Reason> = BTreeMap::new();
    if let Some(disabled) = disabled {
        let index = |name: &String| robot.link_index(name);
        let pairs = disabled.iter().filter_map(|[a, b]| Some([index(a)?, index(b)?]));
        let known = model.link_pairs();
        for [a, b] in pairs.filter(|[a, b]| a != b) {
            let links = [a.min(b), a.max(b)];
            if known.contains(&links) {
                reasons.insert(links, Reason::Srdf);
            }
        }
    }
    let adjacent = adjacent(robot);
    let near = OFTEN.map(|(joints, share)| (apart(robot, joints), share));
    for (links, share) in overlaps(robot, &model).shares {
        if adjacent.contains(&links) {
            reasons.entry(links).or_insert(Reason::Adjacent);
        } else if share >= ALWAYS {
            reasons.entry(links).or_insert(Reason::Always);
        } else if near.iter().any(|(pairs, least)| share >= *least && pairs.contains(&links)) {
            reasons.entry(links).or_insert(Reason::Often);
        }
    }
    let in_the_middle = robot.link_poses(&positions(robot, &middle(robot), 0.5));
    let near = model.links_nearer_than(&in_the_middle, NEIGHBOURS_M);
    for links in near.into_iter().filter(|links| adjacent.contains(links)) {
        reasons.entry(links).or_insert(Reason::Adjacent);
    }
    for links in model.overlapping_links(&in_the_middle) {
        reasons.entry(links).or_insert(Reason::Middle);
    }
    reasons.into_iter().map(|(links, reason)| AllowedPair { links, reason }).collect()
}

/// How often links overlap in random postures.
#[derive(Clone, Debug)]
pub struct Overlaps {
    /// Share of the postures without an overlap.
    pub free: f64,
    /// The pairs of links that overlap, with the share of the postures in which they do, most frequent first.
    pub shares: Vec<([usize; 2], f64)>,
}

impl Overlaps {
    /// Of the pairs of links that must not touch, in 2,000 random postures of arms and grippers.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        overlaps(robot, &CollisionModel::new(robot))
    }
}

fn overlaps(robot: &Robot, model: &CollisionModel) -> Overlaps {
    let mut random = Pcg64::new(SEED.into(), 0);
    let mut counts: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut free = 0;
    for _ in 0..SAMPLES {
        let draw = |&joint: &usize, random: &mut Pcg64| {
            let joint = &robot.joints[joint];
            joint.lower + (joint.upper - joint.lower) * random.random::<f64>()
        };
        let q_rad: Vec<Vec<f64>> =
            robot.arms.iter().map(|arm| arm.joints.iter().map(|joint| draw(joint, &mut random)).collect()).collect();
        let open = random.random::<f64>();
        let found = model.overlapping_links(&robot.link_poses(&positions(robot, &q_rad, open)));
        free += usize::from(found.is_empty());
        found.into_iter().for_each(|links| *counts.entry(links).or_default() += 1);
    }
    let share = |count: usize| count as f64 / SAMPLES as f64;
    let mut shares: Vec<_> = counts.into_iter().map(|(links, count)| (links, share(count))).collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    Overlaps { free: share(free), shares }
}

/// Pairs of neighbours: one joint moves one against the other, directly or through fixed joints; or they are the two fingers
/// of one gripper, which meet when it closes.
pub(super) fn adjacent(robot: &Robot) -> BTreeSet<[usize; 2]> {
    let mut pairs = apart(robot, 1);
    let carriers = robot.active_carriers();
    let carried =
        |joint: usize| (0..robot.links.len()).filter(|&link| carriers[link] == Some(joint)).collect::<Vec<_>>();
    for arm in &robot.arms {
        let [first, second] = arm.gripper.fingers.as_slice() else { continue };
        let [first, second] = [first, second].map(|finger| carried(finger.joint));
        pairs.extend(first.iter().flat_map(|&a| second.iter().map(move |&b| [a.min(b), a.max(b)])));
    }
    pairs
}

/// Pairs of links, one behind the other, with one to `most` moving joints between them.
fn apart(robot: &Robot, most: usize) -> BTreeSet<[usize; 2]> {
    let carriers = robot.active_carriers();
    // The carriers of a link, and of the links that carry these, from the link to the root, which has none.
    let above = |link: usize| {
        let next = |carrier: &Option<usize>| carrier.map(|joint| carriers[robot.joints[joint].parent_link]);
        std::iter::successors(Some(carriers[link]), next).collect::<Vec<_>>()
    };
    let above: Vec<Vec<Option<usize>>> = (0..robot.links.len()).map(above).collect();
    let is_behind = |a: usize, b: usize| above[b].iter().take(most + 1).skip(1).any(|&carrier| carrier == carriers[a]);
    let links = robot.links.len();
    let pairs = (0..links).flat_map(|a| (a + 1..links).map(move |b| [a, b]));
    pairs.filter(|&[a, b]| is_behind(a, b) || is_behind(b, a)).collect()
}
