//! What a search returns: what it found, or why it found nothing.

use std::collections::BTreeMap;

use crate::{human::HumanError, model::plan::PostureConstraint};

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub enum Outcome<T> {
    /// What was searched for; it satisfies every constraint.
    Found(T),
    /// No candidate satisfied every constraint.
    Infeasible(Infeasible),
}

impl<T> Outcome<T> {
    /// Maps what was found.
    pub fn map<U>(self, of: impl FnOnce(T) -> U) -> Outcome<U> {
        match self {
            Self::Found(found) => Outcome::Found(of(found)),
            Self::Infeasible(why) => Outcome::Infeasible(why),
        }
    }

    /// What was found, or `None`.
    pub fn found(self) -> Option<T> {
        match self {
            Self::Found(found) => Some(found),
            Self::Infeasible(_) => None,
        }
    }
}

/// How often each constraint rejected a candidate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Infeasible {
    /// Number of candidates.
    pub candidates: u64,
    /// Each constraint that rejected candidates, with their number, in descending order.
    pub removed: Vec<(&'static str, u64)>,
    /// What a person without limits of posture and place could work on; `None` if the scenario has no such limits.
    pub unnatural: Option<UnnaturalHolds>,
}

/// Candidates that a person without limits of posture and place could work on, and how many of them break each limit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnnaturalHolds {
    /// Number of candidates.
    pub candidates: u64,
    /// Number that breaks each limit; a candidate may break several.
    pub broken: BTreeMap<PostureConstraint, u64>,
    /// Number whose person stands elsewhere than the scenario says.
    pub elsewhere: u64,
}

impl UnnaturalHolds {
    /// Counts a candidate and the limits that it breaks.
    pub(super) fn count(&mut self, broken: impl Iterator<Item = PostureConstraint>, elsewhere: bool) {
        self.candidates += 1;
        broken.for_each(|constraint| *self.broken.entry(constraint).or_default() += 1);
        self.elsewhere += u64::from(elsewhere);
    }
}

impl std::fmt::Display for UnnaturalHolds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.candidates == 0 {
            return write!(f, "even without limits of posture and place no hold was found that a person could work on");
        }
        let mut limits: Vec<_> = self.broken.iter().map(|(constraint, count)| (constraint.key(), *count)).collect();
        if self.elsewhere > 0 {
            limits.push(("place", self.elsewhere));
        }
        limits.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        write!(f, "of {} holds that a person without limits of posture and place could work on", self.candidates)?;
        // One that next to none breaks is not in the way.
        for (key, count) in limits.into_iter().filter(|(_, count)| 100 * count >= self.candidates) {
            let share = 100.0 * count as f64 / self.candidates as f64;
            write!(f, ", {share:.0} % break {key}")?;
        }
        Ok(())
    }
}

impl std::fmt::Display for Infeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "none of {} candidates kept every constraint", self.candidates)?;
        for (index, (what, count)) in self.removed.iter().enumerate() {
            let share = 100.0 * *count as f64 / self.candidates as f64;
            write!(f, "{} {share:.0} % {what}", if index == 0 { ":" } else { "," })?;
        }
        match &self.unnatural {
            Some(unnatural) => write!(f, "; {unnatural}"),
            None => Ok(()),
        }
    }
}

/// Why a scenario cannot be planned at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The scenario's person or tool is invalid.
    #[error("{0}")]
    Person(#[from] HumanError),
    /// A circle was asked for, and the operation is not a cut along one about the board's centre.
    #[error("the operation is not a cut along a circle about the board's centre")]
    NoCircle,
}

/// The first constraint that a candidate violates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rejection {
    /// The board is outside the search domain, or its worked face points away from the person's side.
    BoardPlace,
    /// No posture of the person that was drawn is natural.
    NaturalPosture,
    /// The person would stand elsewhere than the scenario says.
    PersonPlace,
    /// The person would not stand naturally or not see the work.
    Posture(PostureConstraint),
    /// A joint of the person needs more than its strength.
    Strength,
    /// The person cannot bring the tool to its pose.
    PersonReach,
    /// An arm of the robot cannot bring its gripper to the grasp.
    RobotReach,
    /// Two bodies touch or are closer than their clearance.
    Collision,
    /// The grasp does not resist the load.
    Stability,
    /// The robot comes closer to itself or to the board than its clearance under the load.
    LoadedCollision,
    /// The RULA score of the finished plan's posture exceeds its limit.
    Rula,
    /// The RULA score of arm and wrist of the finished plan's posture exceeds its limit.
    RulaArm,
    /// The REBA score of the finished plan's posture exceeds its limit.
    Reba,
    /// The check of the finished plan found a flaw.
    Verification,
    /// The candidate was not evaluated: the limit of evaluations was reached, or the search was stopped.
    NotEvaluated,
}

impl Rejection {
    /// The constraint in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::BoardPlace => "board outside the search domain",
            Self::NaturalPosture => "natural posture",
            Self::PersonPlace => "person's place",
            Self::Posture(constraint) => constraint.key(),
            Self::Strength => "person's strength",
            Self::PersonReach => "human reach",
            Self::RobotReach => "robot reach",
            Self::Collision => "collision or too close",
            Self::Stability => "stability",
            Self::LoadedCollision => "too close under the load",
            Self::Rula => "RULA score",
            Self::RulaArm => "RULA score of arm and wrist",
            Self::Reba => "REBA score",
            Self::Verification => "the check of the finished plan",
            Self::NotEvaluated => "not evaluated",
        }
    }
}
