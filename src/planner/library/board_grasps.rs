//! Grasps of a board at a known pose: some are drawn for every arm by itself, and those that are reached are combined.

use std::collections::HashSet;

use rand_pcg::Pcg64;

use super::{
    draws::draw_arm_grasp,
    entry::LibraryEntry,
    failures::DrawFailure,
    grasp::{ArmGrasp, BoardGrasp, pattern},
    grasping_robot::{GraspingArm, GraspingRobot},
};
use crate::{
    collision::{Body, Violation},
    model::{board::Edge, frames::Pose},
    planner::{
        domain::draw_edge,
        params::{
            library::{GRASPS_PER_ARM, RESAMPLED_PER_PATTERN},
            per_pattern,
        },
    },
};

/// Collision-free grasps of a board at a pose: at most a few with one pattern, and of more than two arms at most one for each
/// grasp of the first arm. The second arm's edge is the first one's or opposite to it (docs/method.md#25-edge-grasps). Without any,
/// the test at which the board failed.
pub fn grasps_of_board(
    robot: &GraspingRobot,
    x_wo: &Pose,
    random: &mut Pcg64,
) -> Result<Vec<LibraryEntry>, DrawFailure> {
    combined(robot, x_wo, &|[first, second]| second == first || second == robot.opposite(first), random)
}

/// The same with the second arm at any edge.
pub fn grasps_on_any_edges(
    robot: &GraspingRobot,
    x_wo: &Pose,
    random: &mut Pcg64,
) -> Result<Vec<LibraryEntry>, DrawFailure> {
    combined(robot, x_wo, &|_| true, random)
}

fn combined(
    robot: &GraspingRobot,
    x_wo: &Pose,
    edges_match: &dyn Fn([Edge; 2]) -> bool,
    random: &mut Pcg64,
) -> Result<Vec<LibraryEntry>, DrawFailure> {
    let reached: Vec<_> = robot.arms.iter().map(|arm| reached_grasps(robot, arm, x_wo, random)).collect();
    if let Some(arm) = reached.iter().position(Vec::is_empty) {
        return Err(DrawFailure::Reach { arm });
    }
    let mut combinations = Combinations::new(&reached, edges_match);
    let mut entries: Vec<LibraryEntry> = Vec::new();
    let mut patterns = Vec::new();
    let most_alike = per_pattern(RESAMPLED_PER_PATTERN, robot.arms.len());
    // Without any combination the second arm reaches no edge that matches the first one's.
    let mut failure = DrawFailure::Reach { arm: 1 };
    while let Some(arms) = combinations.next() {
        let pattern = pattern(&arms);
        if patterns.iter().filter(|other| **other == pattern).count() >= most_alike {
            combinations.advance(arms.len() - 1);
            continue;
        }
        let link_poses = robot.link_poses(&arms);
        let last = arms.len() - 1;
        match robot.collision.first_violation(&robot.scene(&link_poses, *x_wo)) {
            None => {
                patterns.push(pattern);
                entries.push(LibraryEntry::new(robot, BoardGrasp { x_wo: *x_wo, arms }, &link_poses));
                combinations.advance(if last < 2 { last } else { 0 });
            }
            Some(violation) => {
                failure = DrawFailure::Collision { bodies: violation.bodies };
                match arms_of(robot, &violation)[..] {
                    [] => break,
                    [arm] => combinations.exclude(arm),
                    [one, other, ..] => combinations.exclude_pair([one, other]),
                }
            }
        }
    }
    if entries.is_empty() { Err(failure) } else { Ok(entries) }
}

/// The drawn grasps of one arm that it reaches, with configurations.
fn reached_grasps(robot: &GraspingRobot, arm: &GraspingArm, x_wo: &Pose, random: &mut Pcg64) -> Vec<ArmGrasp> {
    let draw = |_| {
        let edge = draw_edge(&robot.edges, random)?;
        draw_arm_grasp(robot, arm, edge, x_wo, random)
    };
    let count = GRASPS_PER_ARM[robot.arms.len().min(GRASPS_PER_ARM.len()) - 1];
    (0..count).filter_map(draw).collect()
}

/// The arms that take part in a violation.
fn arms_of(robot: &GraspingRobot, violation: &Violation) -> Vec<usize> {
    let mut arms: Vec<_> = violation
        .bodies
        .iter()
        .filter_map(|body| match *body {
            Body::Link(link) => robot.moved_by[link].map(|(arm, _)| arm),
            Body::Board | Body::Person(_) => None,
        })
        .collect();
    arms.dedup();
    arms
}

/// Every choice of one grasp per arm in which the edges of the first two arms match, in lexicographic order, without those that
/// contain what was excluded.
struct Combinations<'a> {
    reached: &'a [Vec<ArmGrasp>],
    /// True if the second gripper may hold the second edge beside the first.
    edges_match: &'a dyn Fn([Edge; 2]) -> bool,
    /// The present choice, as indices; `None` at the end.
    numbers: Option<Vec<usize>>,
    /// Grasps of each arm that are excluded whatever the other arms do.
    excluded: Vec<Vec<bool>>,
    /// Pairs of grasps that are excluded, each as arm and index, the lower arm first.
    excluded_pairs: HashSet<[(usize, usize); 2]>,
}

impl<'a> Combinations<'a> {
    /// Every arm has a grasp.
    fn new(reached: &'a [Vec<ArmGrasp>], edges_match: &'a dyn Fn([Edge; 2]) -> bool) -> Self {
        Self {
            reached,
            edges_match,
            numbers: (!reached.is_empty()).then(|| vec![0; reached.len()]),
            excluded: reached.iter().map(|grasps| vec![false; grasps.len()]).collect(),
            excluded_pairs: HashSet::new(),
        }
    }

    /// The present choice, or the first one after it that is not excluded.
    fn next(&mut self) -> Option<Vec<ArmGrasp>> {
        while let Some(arm) = self.first_excluded(self.numbers.as_ref()?) {
            self.advance(arm);
        }
        let numbers = self.numbers.as_ref()?;
        Some(numbers.iter().zip(self.reached).map(|(&number, grasps)| grasps[number].clone()).collect())
    }

    /// The first arm whose grasp is excluded by itself or beside those of the arms before it.
    fn first_excluded(&self, numbers: &[usize]) -> Option<usize> {
        (0..numbers.len()).find(|&arm| {
            let beside = |other: usize| [(other, numbers[other]), (arm, numbers[arm])];
            self.excluded[arm][numbers[arm]]
                || (arm == 1
                    && !(self.edges_match)([0, 1].map(|arm: usize| self.reached[arm][numbers[arm]].grasp.edge)))
                || (0..arm).any(|other| self.excluded_pairs.contains(&beside(other)))
        })
    }

    /// Goes to the next grasp of an arm, with the first grasps of the arms after it.
    fn advance(&mut self, arm: usize) {
        let Some(numbers) = &mut self.numbers else { return };
        numbers[arm + 1..].fill(0);
        let next = (0..=arm).rev().find(|&arm| {
            numbers[arm] = (numbers[arm] + 1) % self.reached[arm].len();
            numbers[arm] > 0
        });
        if next.is_none() {
            self.numbers = None;
        }
    }

    /// Excludes the present grasp of an arm.
    fn exclude(&mut self, arm: usize) {
        if let Some(numbers) = &self.numbers {
            self.excluded[arm][numbers[arm]] = true;
        }
    }

    /// Excludes the present grasps of two arms beside each other.
    fn exclude_pair(&mut self, mut arms: [usize; 2]) {
        arms.sort_unstable();
        if let Some(numbers) = &self.numbers {
            self.excluded_pairs.insert(arms.map(|arm| (arm, numbers[arm])));
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::model::{board::QUARTERS, grasp::EdgeGrasp};

    /// The grasps of several arms: the edge of each, and its number as the depth.
    fn reached(edges: &[Vec<usize>]) -> Vec<Vec<ArmGrasp>> {
        let grasp = |(number, edge): (usize, &usize)| ArmGrasp {
            grasp: EdgeGrasp {
                edge: Edge(*edge),
                along_m: 0.0,
                depth_m: number as f64,
                angle_rad: 0.0,
                flipped: false,
            },
            q_rad: Vec::new(),
        };
        edges.iter().map(|edges| edges.iter().enumerate().map(grasp).collect()).collect()
    }

    /// Patterns times the limit of each are as many for one arm as for two.
    #[test]
    fn one_arm_has_as_many_candidates_as_two() {
        let sides = [false, true];
        // A box has four edges; the second arm holds the first one's edge or the opposite one.
        let one = QUARTERS * sides.len();
        let two = QUARTERS * 2 * sides.len() * sides.len();
        assert_eq!(one * per_pattern(3, 1), two * per_pattern(3, 2));
        assert_eq!(per_pattern(3, 3), 3);
    }

    proptest! {
        /// Grasps that collide by themselves and in pairs are known only from tests of whole combinations. What passes is what a
        /// test of every combination would pass, in the same order, and no pair is tested twice.
        #[test]
        fn combinations_are_those_without_a_colliding_part(
            edges in prop::collection::vec(prop::collection::vec(0..4_usize, 1..6), 1..=4), seed in any::<u64>(),
        ) {
            let reached = reached(&edges);
            // Drawn collisions of an arm's grasp (a = b), and of two arms' grasps.
            let collides = |(a, i): (usize, usize), (b, j): (usize, usize)| {
                let mixed = (((a * 8 + i) * 8 + b) * 8 + j) as u64;
                seed.rotate_left(mixed as u32 % 61).wrapping_mul(mixed | 1) >> 61 == 0
            };
            let collision = |numbers: &[usize]| {
                let own = |arm: usize| (arm, numbers[arm]);
                let pairs = (0..numbers.len()).flat_map(|b| (0..=b).map(move |a| (a, b)));
                pairs.into_iter().find(|&(a, b)| collides(own(a), own(b)))
            };
            let opposite = |Edge(edge): Edge| Edge((edge + 2) % QUARTERS);
            let edges_match = |[first, second]: [Edge; 2]| second == first || second == opposite(first);
            let mut combinations = Combinations::new(&reached, &edges_match);
            let (mut passed, mut tests) = (Vec::new(), 0);
            while let Some(arms) = combinations.next() {
                tests += 1;
                let numbers: Vec<usize> = arms.iter().map(|arm| arm.grasp.depth_m as usize).collect();
                match collision(&numbers) {
                    None => {
                        combinations.advance(numbers.len() - 1);
                        passed.push(numbers);
                    }
                    Some((a, b)) if a == b => combinations.exclude(a),
                    Some((a, b)) => combinations.exclude_pair([b, a]),
                }
            }
            let mut every = vec![Vec::new()];
            for grasps in &edges {
                every = every.iter().flat_map(|numbers: &Vec<usize>| {
                    (0..grasps.len()).map(move |number| [&numbers[..], &[number]].concat())
                }).collect();
            }
            every.retain(|numbers| {
                let edge = |arm: usize| Edge(edges[arm][numbers[arm]]);
                (numbers.len() < 2 || edges_match([edge(0), edge(1)])) && collision(numbers).is_none()
            });
            let sizes: Vec<usize> = edges.iter().map(Vec::len).collect();
            let pairs: usize = (0..sizes.len()).map(|b| sizes[b] * (1 + sizes[..b].iter().sum::<usize>())).sum();
            prop_assert!(tests <= every.len() + pairs);
            prop_assert_eq!(passed, every);
        }
    }
}
