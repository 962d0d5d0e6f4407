//! What the draws of a grasp library failed at: the evidence if the library is empty.

use std::cmp::Reverse;

use serde::{Deserialize, Serialize};

use crate::{
    collision::Body,
    planner::outcome::{EmptyLibrary, Rejection},
    robot::Robot,
};

/// The test at which one draw failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DrawFailure {
    /// The robot has no arm.
    NoArm,
    /// No edge of the board is as long as a pad is wide.
    NoEdge,
    /// No drawn grasp of an arm has its pads on the board and its palm clear of it.
    Pads { arm: usize },
    /// The first arm brings the board nowhere into the search domain.
    Domain,
    /// A further arm does not reach the board, or not with its pads on it.
    Reach { arm: usize },
    /// Two bodies touch or are closer than their clearance; the first such pair counts.
    Collision { bodies: [Body; 2] },
}

/// Counts of the failed draws.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DrawFailures {
    counts: Vec<(DrawFailure, u64)>,
}

impl DrawFailures {
    /// Counts a failed draw.
    pub fn count(&mut self, failure: DrawFailure) {
        match self.counts.iter_mut().find(|(other, _)| *other == failure) {
            Some((_, count)) => *count += 1,
            None => self.counts.push((failure, 1)),
        }
    }

    /// True if every arm and link that they name is one of the robot's.
    pub fn are_of(&self, robot: &Robot) -> bool {
        let is_body = |body: &Body| match *body {
            Body::Link(link) => link < robot.links.len(),
            Body::Board | Body::Person(_) => true,
        };
        self.counts.iter().all(|(failure, _)| match failure {
            DrawFailure::NoArm | DrawFailure::NoEdge | DrawFailure::Domain => true,
            DrawFailure::Pads { arm } | DrawFailure::Reach { arm } => *arm < robot.arms.len(),
            DrawFailure::Collision { bodies } => bodies.iter().all(is_body),
        })
    }

    /// The number of failed draws by the constraint that they violate.
    pub fn rejections(&self) -> impl Iterator<Item = (Rejection, u64)> {
        self.counts.iter().map(|&(failure, count)| {
            let why = match failure {
                DrawFailure::NoArm | DrawFailure::Domain | DrawFailure::Reach { .. } => Rejection::RobotReach,
                DrawFailure::NoEdge | DrawFailure::Pads { .. } => Rejection::Pads,
                DrawFailure::Collision { .. } => Rejection::Collision,
            };
            (why, count)
        })
    }

    /// The evidence in words: how many draws failed at each test, the commonest first.
    pub fn evidence(&self, robot: &Robot) -> EmptyLibrary {
        let name = |arm: usize| &robot.arms[arm].name;
        let words = |&(failure, draws): &(DrawFailure, u64)| {
            let what = match failure {
                DrawFailure::NoArm => "the robot has no arm".to_owned(),
                DrawFailure::NoEdge => "every edge of the board is shorter than a pad is wide".to_owned(),
                DrawFailure::Pads { arm } => {
                    format!("the pads of the {} gripper lie partly off the board, or its palm is too close", name(arm))
                }
                DrawFailure::Domain => format!("the {} arm does not bring the board in front of the robot", name(0)),
                DrawFailure::Reach { arm } => format!("the {} arm does not reach the board", name(arm)),
                DrawFailure::Collision { bodies: [one, other] } => {
                    format!("{} and {} touch or are too close", one.describe(robot), other.describe(robot))
                }
            };
            (what, draws)
        };
        let mut failed: Vec<_> = self.counts.iter().map(words).collect();
        // A stable sort keeps equal counts in the order of the draws.
        failed.sort_by_key(|&(_, draws)| Reverse(draws));
        let is_collision = |failure: DrawFailure| matches!(failure, DrawFailure::Collision { .. });
        let mut collisions = self.counts.iter().filter(|(failure, _)| is_collision(*failure));
        let always = match (collisions.next(), collisions.next()) {
            (Some(only), None) => Some(words(only).0),
            _ => None,
        };
        EmptyLibrary { failed, always }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::paper;

    /// Collisions that every draw has are told as such; their share is that of all draws.
    #[test]
    fn links_that_always_collide_are_named() {
        let robot = paper::printed_operations()[0].load().unwrap().robot;
        let pair = DrawFailure::Collision { bodies: [Body::Link(1), Body::Link(2)] };
        let mut failures = DrawFailures::default();
        (0..93).for_each(|_| failures.count(pair));
        (0..7).for_each(|_| failures.count(DrawFailure::Reach { arm: 1 }));
        let evidence = failures.evidence(&robot);
        let [one, other] = [1, 2].map(|link: usize| &robot.links[link].name);
        assert_eq!(evidence.always, Some(format!("{one} and {other} touch or are too close")));
        let text = evidence.to_string();
        assert!(
            text.contains(&format!("100 draws: 93.0 % {one} and {other} touch or are too close, 7.0 % the ")),
            "{text}"
        );
        assert!(text.ends_with("too close in every draw in which all arms reach the board"), "{text}");
        // Two pairs: neither is always the reason.
        failures.count(DrawFailure::Collision { bodies: [Body::Link(1), Body::Board] });
        assert_eq!(failures.evidence(&robot).always, None);
        let by_reason: Vec<_> = failures.rejections().collect();
        assert_eq!(by_reason, [(Rejection::Collision, 93), (Rejection::RobotReach, 7), (Rejection::Collision, 1)]);
    }
}
