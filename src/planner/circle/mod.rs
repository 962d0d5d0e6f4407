//! A whole circle that is cut: how a robot may hold the board for all of it.
//!
//! A cut along a circle is 16 operations (METHOD section 2). Three ways to hold the board for them, each with the person's
//! best answer to every point:
//! 1. [`Continuous::hold`]: one hold that stays as it is; the most points, and then the worst of them, decide;
//! 2. [`Continuous::sequence`]: the hands keep their grasp and the arms move the board from point to point; the most points,
//!    and then the sum of what they are worth, decide;
//! 3. [`separate`]: a plan for every point as if it were the only one, which no robot can do without letting go: what the
//!    other two are compared with.
//!
//! A point may have no answer: the knife turns once around the circle and the wrist does not. Each way then serves as many
//! points as it finds. This module knows neither clock nor files.

mod motion;
mod one;
mod sequence;
mod serve;

pub use motion::{MotionStep, STEP_RAD};

use serve::Circle;

use super::{Onlooker, PlanOutcome, RobotMap, WorkMap, bank::KnownHold, plan_with};
use crate::{
    comfort::{Answer, curve},
    human::HumanError,
    model::{operation::Operation, plan::Plan, scenario::Scenario},
};

/// How many points of the circle are cut.
pub const POINTS: usize = curve::POINTS;

/// For every point of the circle its plan, checked from scratch; none where the way does not serve the point.
pub type PlansByPoint = Vec<Option<Plan>>;

/// The scenarios of the points, counter-clockwise from +x_O, named after the scenario and their number; none when it cuts no
/// circle.
pub fn points(scenario: &Scenario) -> Option<Vec<Scenario>> {
    let radius_m = scenario.operation.circle_radius_m()?;
    let force_n = scenario.operation.wrench_o.force_n.norm();
    let thickness_m = scenario.object.size_m[2];
    let point = |index: usize| Scenario {
        name: format!("{}-{}", scenario.name, index + 1),
        operation: Operation::cut_on_circle(radius_m, curve::angle_rad(index), force_n, thickness_m),
        ..scenario.clone()
    };
    Some((0..POINTS).map(point).collect())
}

/// Both ways to cut the circle without letting go.
#[derive(Clone, Debug)]
pub struct Continuous {
    /// One hold: the plans have the same arms and the same board, and each has the person's answer to its point.
    pub hold: PlansByPoint,
    /// The sequence: the grasps of all plans are the same.
    pub sequence: PlansByPoint,
    /// The sequence's motion of arms and board from each point to the next, both ends included; also to and from points
    /// that are not served. Empty when there is no hold at all.
    pub motions: Vec<Vec<MotionStep>>,
}

/// Searches for one hold and for a sequence that starts from it; how, and what that does not guarantee, stands in the
/// modules of the two. The onlooker may end the search; the best so far is the result then.
///
/// # Errors
/// As [`super::plan`].
pub fn continuous(points: &[Scenario], map: &RobotMap, onlooker: &mut Onlooker<'_>) -> Result<Continuous, HumanError> {
    let nothing =
        || Continuous { hold: vec![None; points.len()], sequence: vec![None; points.len()], motions: Vec::new() };
    let Some(mut circle) = Circle::new(points, map)? else { return Ok(nothing()) };
    let holds = one::holds(&mut circle, onlooker);
    let Some(best) = holds.first() else { return Ok(nothing()) };
    let hold = plans(&mut circle, best.answers.iter().map(|answer| (&best.hold, *answer)))?;
    let stops = sequence::best(&mut circle, &holds, onlooker).unwrap_or_default();
    let sequence = plans(&mut circle, stops.iter().map(|stop| (&stop.hold, stop.answer)))?;
    let motions = sequence::motions(&circle, &stops);
    Ok(Continuous { hold, sequence, motions })
}

/// The plans of holds and answers, each with the best answer of all.
fn plans<'h>(
    circle: &mut Circle<'_>,
    answered: impl Iterator<Item = (&'h KnownHold, Option<Answer>)>,
) -> Result<PlansByPoint, HumanError> {
    let plan = |(point, (hold, answer)): (usize, (&KnownHold, Option<Answer>))| {
        let Some(answer) = answer else { return Ok(None) };
        let answer = circle.best_answer(hold, point, answer);
        circle.plan(hold, point, &answer)
    };
    answered.enumerate().map(plan).collect()
}

/// A plan for every point by itself: [`plan_with`] on each.
///
/// # Errors
/// As [`super::plan`].
pub fn separate(points: &[Scenario], map: &RobotMap, onlooker: &mut Onlooker<'_>) -> Result<PlansByPoint, HumanError> {
    let Some(first) = points.first() else { return Ok(Vec::new()) };
    let work = WorkMap::new(first, map)?;
    let plan = |scenario| {
        Ok(match plan_with(scenario, map, &work, &mut *onlooker)? {
            PlanOutcome::Found(plan) => Some(*plan),
            PlanOutcome::Infeasible(_) => None,
        })
    };
    points.iter().map(plan).collect()
}
