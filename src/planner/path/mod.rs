//! Plans for a whole circle that is cut.
//!
//! A cut along a circle is 16 operations (docs/method.md#23-cutting). There are three ways to hold the board for them, each
//! with the person's best response at every point:
//! 1. [`Continuous::hold`]: one grasp and one pose of the board; it covers as many points as possible, then the least
//!    comfortable of them is optimised;
//! 2. [`Continuous::sequence`]: one grasp, and the arms move the board from point to point; it covers as many points as
//!    possible, then the sum of their objectives is optimised;
//! 3. [`CirclePlans::separate`]: a plan for every point by itself, which no robot can do without regrasping: the
//!    reference for the other two.
//!
//! A point may have no response: the knife turns once around the circle and the wrist does not.

mod coverage;
mod motion;
mod sequence;
mod single_grasp;

pub use super::params::task::STEP_RAD;
pub use motion::MotionStep;

use coverage::PathProblem;

use super::{
    library::{BoardGrasp, GraspLibrary},
    outcome::PlanError,
    watch::{Event, Phase, Watch, begin},
};
use crate::{
    comfort::{Response, curve},
    model::{operation::Operation, plan::Plan, scenario::Scenario},
};

/// Number of points of the circle.
pub const POINTS: usize = curve::POINTS;

/// A checked plan for every point of the circle; `None` where the point is not covered.
pub type PlansByPoint = Vec<Option<Plan>>;

/// The scenarios of the points, counter-clockwise from +x_O, named after the scenario and their number; `None` if it does not
/// cut a circle about the board's centre.
#[must_use]
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

/// The three ways to cut a circle.
#[derive(Clone, Debug)]
pub struct CirclePlans {
    /// The two ways without regrasping.
    pub continuous: Continuous,
    /// A plan for every point by itself.
    pub separate: PlansByPoint,
}

impl CirclePlans {
    /// True if there is no plan for any point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { continuous: Continuous { hold, sequence, .. }, separate } = self;
        [hold, sequence, separate].into_iter().flatten().all(Option::is_none)
    }
}

/// The two ways to cut a circle without regrasping.
#[derive(Clone, Debug)]
pub struct Continuous {
    /// One grasp: the plans have the same arms and the same board, each with the person's response to its point.
    pub hold: PlansByPoint,
    /// The sequence: all plans have the same grasp.
    pub sequence: PlansByPoint,
    /// The sequence's motion of arms and board from each point to the next, both ends included, also to and from points that
    /// are not covered. Empty if no grasp was found.
    pub motions: Vec<Vec<MotionStep>>,
}

/// Searches for one grasp and for a sequence that starts from it. After a stop it is what was found.
///
/// # Errors
/// When the scenario's person or tool is invalid.
pub fn continuous<'a>(
    points: &'a [Scenario],
    library: &'a GraspLibrary,
    watch: &'a dyn Watch,
) -> Result<Continuous, PlanError> {
    let nothing =
        || Continuous { hold: vec![None; points.len()], sequence: vec![None; points.len()], motions: Vec::new() };
    let Some(mut problem) = PathProblem::new(points, library, watch)? else { return Ok(nothing()) };
    let coverages = single_grasp::search(&mut problem);
    let Some(best) = coverages.first() else { return Ok(nothing()) };
    watch.tell(&Event::Found);
    let hold = plans(&mut problem, best.responses.iter().map(|response| (&best.grasp, *response)));
    begin(watch, Phase::Sequence);
    let Some(waypoints) = sequence::search(&mut problem, &coverages) else {
        return Ok(Continuous { hold, ..nothing() });
    };
    let sequence = plans(&mut problem, waypoints.iter().map(|waypoint| (&waypoint.grasp, waypoint.response)));
    let motions = sequence::motions(&problem, &waypoints);
    Ok(Continuous { hold, sequence, motions })
}

/// The plans of grasps and responses, each with the best response of the whole grid; after a stop with the response.
fn plans<'h>(
    problem: &mut PathProblem<'_>,
    covered: impl Iterator<Item = (&'h BoardGrasp, Option<Response>)>,
) -> PlansByPoint {
    let plan = |(point, (grasp, response)): (usize, (&BoardGrasp, Option<Response>))| {
        let response = problem.best_response(grasp, point, response?);
        problem.plan(grasp, point, &response)
    };
    covered.enumerate().map(plan).collect()
}
