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

/// Why nothing was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Infeasible {
    /// Number of candidates that were tested. Each counts for the first constraint that it violates.
    pub candidates: u64,
    /// Each constraint that rejected candidates, with their number, in descending order; the sum is `candidates`.
    pub removed: Vec<(&'static str, u64)>,
    /// True if a limit of evaluations ended the search.
    pub ended_early: bool,
    /// True if a second, larger search with other random numbers found nothing either.
    pub searched_twice: bool,
    /// Why the robot has no grasp of the board at all; `None` if it has.
    pub library: Option<EmptyLibrary>,
    /// The most stable of the grasps that kept every constraint but stability; `None` without such a grasp.
    pub nearest: Option<Box<NearMiss>>,
    /// What a person without limits of posture and place could work on; `None` if the scenario has no such limits.
    pub unnatural: Option<UnnaturalHolds>,
    /// Plans were found, but none that holds with the wanted probability.
    pub unreliable: Option<Unreliable>,
}

/// How likely the plans hold that were found, where a probability is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreliable {
    /// The largest probability of a plan that was found.
    pub best: f64,
    /// The wanted probability.
    pub wanted: f64,
}

/// Why no grasp of the board was found, whatever the task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmptyLibrary {
    /// Each test at which draws failed, with their number, in descending order. A draw counts for the first test that it fails.
    pub failed: Vec<(String, u64)>,
    /// The collision that every draw has in which all arms reach the board; `None` if these collide in different ways.
    pub always: Option<String>,
}

/// The most stable of the grasps that kept every constraint but stability, and what would make it stable enough.
#[derive(Clone, Debug, PartialEq)]
pub struct NearMiss {
    /// The multiple of the load that the grasp resists within all limits of stability.
    pub load_factor: f64,
    /// The multiple that is required, safety factor included.
    pub required: f64,
    /// The limit that is crossed first as the load grows, such as `left upper pad: tilt`.
    pub first_limit: String,
    /// The smallest grip force with which this or a grasp nearly as near is stable enough; `None` if the grippers' largest does not
    /// do.
    pub grip_force: Option<Remedy>,
    /// The smallest friction with which one is; `None` if a friction of [`MOST_FRICTION`] does not do.
    pub friction: Option<Remedy>,
    /// The largest load with which one is, as a share of the load; `None` if the weight alone is too much.
    pub load_share: Option<f64>,
    /// Magnitude of the load's force, N; zero for a moment alone.
    pub force_n: f64,
}

/// A value that would do instead of the present one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// The present value.
    pub now: f64,
    /// The value that would do, rounded to the safe side.
    pub enough: f64,
}

/// The largest friction that is suggested: that of soft rubber on a clean dry board.
pub const MOST_FRICTION: f64 = 1.5;

/// Shares of a total in tenths of a percent that sum to exactly 100 %: each is rounded down, and those with the largest
/// remainders are rounded up (largest-remainder method). Zeros if the total is zero.
fn tenths_of_percent(counts: &[u64]) -> Vec<u64> {
    const WHOLE: u128 = 1_000;
    let total: u128 = counts.iter().map(|&count| u128::from(count)).sum();
    if total == 0 {
        return vec![0; counts.len()];
    }
    let scaled = counts.iter().map(|&count| u128::from(count) * WHOLE);
    let (mut shares, remainders): (Vec<_>, Vec<_>) = scaled.map(|count| (count / total, count % total)).unzip();
    let missing = WHOLE - shares.iter().sum::<u128>();
    let mut order: Vec<_> = (0..counts.len()).collect();
    order.sort_by_key(|&index| std::cmp::Reverse(remainders[index]));
    // Fewer are missing than there are remainders.
    order.into_iter().take(missing as usize).for_each(|index| shares[index] += 1);
    shares.into_iter().map(|share| share as u64).collect()
}

/// The most shares that a message lists.
const MOST_SHARES: usize = 8;

/// Writes counts as shares that sum to 100 %, such as `: 60.2 % stability, 39.8 % robot reach`. Shares that are rounded to zero are
/// left out.
fn write_shares<S: std::fmt::Display>(f: &mut std::fmt::Formatter<'_>, counts: &[(S, u64)]) -> std::fmt::Result {
    let shares = tenths_of_percent(&counts.iter().map(|&(_, count)| count).collect::<Vec<_>>());
    let written: Vec<_> = counts.iter().zip(shares).filter(|&(_, share)| share > 0).collect();
    // One that would be alone among the others is written itself.
    let listed = if written.len() > MOST_SHARES + 1 { MOST_SHARES } else { written.len() };
    for (index, ((what, _), share)) in written[..listed].iter().enumerate() {
        let mark = if index == 0 { ":" } else { "," };
        write!(f, "{mark} {}.{} % {what}", share / 10, share % 10)?;
    }
    let rest: u64 = written[listed..].iter().map(|(_, share)| share).sum();
    if rest > 0 {
        write!(f, ", {}.{} % {} others", rest / 10, rest % 10, written.len() - listed)?;
    }
    Ok(())
}

impl std::fmt::Display for EmptyLibrary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let draws: u64 = self.failed.iter().map(|(_, count)| count).sum();
        write!(f, "no grasp of this board was found in {draws} draws")?;
        write_shares(f, &self.failed)?;
        match &self.always {
            Some(always) => write!(f, "; {always} in every draw in which all arms reach the board"),
            None => Ok(()),
        }
    }
}

impl std::fmt::Display for NearMiss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { load_factor, required, first_limit, .. } = self;
        write!(
            f,
            "the nearest grasp resists {load_factor:.2} times the load, {required:.2} times is required (first limit: \
             {first_limit})"
        )?;
        let mut enough = Vec::new();
        if let Some(Remedy { now, enough: grip_n }) = self.grip_force {
            enough.push(format!("a grip force of {grip_n:.1} N instead of {now} N"));
        }
        if let Some(Remedy { now, enough: friction }) = self.friction {
            enough.push(format!("a friction of {friction:.2} instead of {now}"));
        }
        if let Some(share) = self.load_share {
            let force = match self.force_n {
                // Rounded down: a little more would be too much.
                force_n if force_n > 0.0 => format!(", {:.1} N", (10.0 * share * force_n).floor() / 10.0),
                _ => String::new(),
            };
            enough.push(format!("{:.1} % of the load{force}", 100.0 * share));
        }
        match enough.split_last() {
            None => Ok(()),
            Some((last, [])) => write!(f, "; {last} would do"),
            Some((last, others)) => write!(f, "; {} or {last} would do", others.join(", ")),
        }
    }
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
        if let Some(Unreliable { best, wanted }) = self.unreliable {
            return write!(f, "the best plan holds with probability {best:.3}, expected at least {wanted}");
        }
        match (&self.library, self.candidates) {
            (Some(library), _) => write!(f, "{library}")?,
            (None, 0) => write!(f, "no candidate was tested")?,
            (None, candidates) => {
                let searches = if self.searched_twice { " of two searches" } else { "" };
                write!(f, "none of {candidates} candidates{searches} kept every constraint")?;
                write_shares(f, &self.removed)?;
            }
        }
        if self.ended_early {
            write!(f, "; the search was ended before all candidates were tested")?;
        }
        if let Some(nearest) = &self.nearest {
            write!(f, "; {nearest}")?;
        }
        match &self.unnatural {
            Some(unnatural) if self.library.is_none() => write!(f, "; {unnatural}"),
            _ => Ok(()),
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
    /// The watch stopped the work before anything was found; nothing was kept.
    #[error("stopped before anything was found")]
    Stopped,
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
    /// The pads of a gripper lie partly off the board.
    Pads,
    /// An arm of the robot cannot bring its gripper to the grasp.
    RobotReach,
    /// A joint of the robot would move farther than it may from where it is.
    Motion,
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
            Self::Pads => "pads on the board",
            Self::RobotReach => "robot reach",
            Self::Motion => "motion of the robot's joints",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_the_whole_and_are_off_by_less_than_a_tenth() {
        let mut random = 1_u64;
        for length in 1..12 {
            for _ in 0..200 {
                let counts: Vec<u64> = (0..length)
                    .map(|_| {
                        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                        random >> (40 + (random >> 33) % 20)
                    })
                    .collect();
                let (shares, total) = (tenths_of_percent(&counts), counts.iter().sum::<u64>());
                if total == 0 {
                    continue;
                }
                assert_eq!(shares.iter().sum::<u64>(), 1_000, "{counts:?}");
                for (count, share) in counts.iter().zip(shares) {
                    assert!((*count as f64 / total as f64 * 1e3 - share as f64).abs() < 1.0, "{counts:?}");
                }
            }
        }
        assert_eq!(tenths_of_percent(&[0, 0]), [0, 0]);
        assert_eq!(tenths_of_percent(&[1, 1, 1]), [334, 333, 333]);
        // No overflow.
        assert_eq!(tenths_of_percent(&[u64::MAX / 2, u64::MAX / 2]), [500, 500]);
    }

    #[test]
    fn the_message_names_library_shares_and_nearest_miss() {
        let removed = vec![("stability", 2), ("robot reach", 1)];
        let why = Infeasible { candidates: 3, removed, searched_twice: true, ..Infeasible::default() };
        let text = "none of 3 candidates of two searches kept every constraint: 66.7 % stability, 33.3 % robot reach";
        assert_eq!(why.to_string(), text);
        let nearest = NearMiss {
            load_factor: 0.794,
            required: 1.1,
            first_limit: "left upper pad: tilt".into(),
            grip_force: Some(Remedy { now: 30.0, enough: 42.3 }),
            friction: None,
            load_share: Some(0.721),
            force_n: 30.0,
        };
        assert_eq!(
            nearest.to_string(),
            "the nearest grasp resists 0.79 times the load, 1.10 times is required (first limit: left upper pad: tilt); a \
             grip force of 42.3 N instead of 30 N or 72.1 % of the load, 21.6 N would do"
        );
        let why = Infeasible { nearest: Some(Box::new(nearest.clone())), ..why };
        assert_eq!(why.to_string(), format!("{text}; {nearest}"));
        let failed = vec![("the left arm does not reach the board".to_owned(), 3), ("a and b touch".to_owned(), 1)];
        let library = EmptyLibrary { failed, always: Some("a and b touch".into()) };
        let empty = Infeasible { library: Some(library), ..Infeasible::default() };
        assert_eq!(
            empty.to_string(),
            "no grasp of this board was found in 4 draws: 75.0 % the left arm does not reach the board, 25.0 % a and b \
             touch; a and b touch in every draw in which all arms reach the board"
        );
        let stopped = Infeasible { ended_early: true, ..Infeasible::default() };
        assert!(stopped.to_string().starts_with("no candidate was tested; the search was ended"));
    }
}
