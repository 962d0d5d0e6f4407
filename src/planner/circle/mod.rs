//! A whole circle that is cut: how a robot may hold the board for all of it.
//!
//! A cut along a circle is 16 operations (METHOD section 2). Three ways to hold the board for them, each with the person's
//! best answer to every point:
//! 1. [`one_hold`]: one hold that stays as it is;
//! 2. [`sequence`]: the hands keep their grasp and the arms move the board from point to point;
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
pub use one::one_hold;
pub use sequence::{Sequence, sequence};

use super::{Onlooker, PlanOutcome, RobotMap, plan_until};
use crate::{
    comfort::curve,
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

/// A plan for every point by itself: [`plan_until`] on each.
///
/// # Errors
/// As [`super::plan`].
pub fn separate(points: &[Scenario], map: &RobotMap, onlooker: &mut Onlooker<'_>) -> Result<PlansByPoint, HumanError> {
    let plan = |scenario| {
        Ok(match plan_until(scenario, map, &mut *onlooker)? {
            PlanOutcome::Found(plan) => Some(*plan),
            PlanOutcome::Infeasible(_) => None,
        })
    };
    points.iter().map(plan).collect()
}
