//! Several good holds that differ, for somebody who wants a choice.

use super::{
    Count, Effort, Infeasible, Onlooker, Problem, RobotMap, Tally, Watch, WorkMap, assemble, search, verify,
    with_optima,
};
use crate::{
    human::HumanError,
    model::{
        grasp::Edge,
        plan::{ArmHold, Plan},
        scenario::Scenario,
    },
};

/// Two boards whose centres are farther apart than this are held in different places, m.
pub const APART_M: f64 = 0.05;
/// Two boards turned against each other by more than this are held differently, rad: 15 degrees.
pub const APART_RAD: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// An arm with a joint that is farther off than this is in another configuration, rad: 30 degrees.
pub const JOINT_APART_RAD: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// Starts of the search for every plan that is wanted: neighbouring starts climb to the same hold.
const STARTS_A_PLAN: usize = 4;

/// True when two plans are different holds: an arm holds another edge, the board is apart by more than `APART_M` or
/// `APART_RAD`, or a joint of the robot by more than `JOINT_APART_RAD`. How the person stands does not count.
pub fn differ(one: &Plan, other: &Plan) -> bool {
    let (a, b) = (&one.object.x_wo, &other.object.x_wo);
    let apart = (a.translation.vector - b.translation.vector).norm() > APART_M;
    let turned = a.rotation.angle_to(&b.rotation) > APART_RAD;
    let arms_differ = |(a, b): (&ArmHold, &ArmHold)| {
        let joint = a.q_rad.iter().zip(&b.q_rad).any(|(a, b)| (a - b).abs() > JOINT_APART_RAD);
        joint || Edge::of(&a.x_og, one.object.size_m) != Edge::of(&b.x_og, other.object.size_m)
    };
    apart || turned || one.arms.len() != other.arms.len() || one.arms.iter().zip(&other.arms).any(arms_differ)
}

/// What a search for several holds came to.
#[derive(Clone, Debug)]
pub enum TopOutcome {
    /// Plans that differ and keep every constraint, the best first: at least one, perhaps fewer than were asked for.
    Found(Vec<Plan>),
    /// No candidate kept every constraint.
    Infeasible(Infeasible),
}

/// The best `wanted` plans that [`differ`] from one another. The search is that of [`super::plan_on`] from more starts, the
/// more the more plans are wanted, so its best is mostly that plan or better. Every plan is checked from scratch. It does
/// not guarantee that no better hold lies between those that it found. With `comfort.person = "average"` only the few holds
/// that are compared by their mean are candidates.
///
/// # Errors
/// As [`super::plan`].
pub fn top<'a>(
    scenario: &'a Scenario,
    map: &'a RobotMap,
    wanted: usize,
    onlooker: &'a mut Onlooker<'a>,
) -> Result<TopOutcome, HumanError> {
    let normalised = match with_optima(scenario, map)? {
        Ok(scenario) => scenario,
        Err(why) => return Ok(TopOutcome::Infeasible(why)),
    };
    let scenario = &normalised;
    let work = WorkMap::new(scenario, map)?;
    let count = Count::of_at_most(scenario.planner.evaluations);
    let mut problem = Problem::new(scenario, map, Watch::new(count.clone(), onlooker))?;
    problem.person = work.person.as_ref();
    let mut tally = Tally::new(count);
    let effort = Effort::of(scenario.planner.budget);
    let starts = effort.starts.max(STARTS_A_PLAN.saturating_mul(wanted));
    let mut effort = Effort { starts, known_heats: None, ..effort };
    effort.heats.iter_mut().for_each(|heat| heat.climbs = heat.climbs.max(2 * wanted) + effort.known_starts);
    let mut plans: Vec<Plan> = Vec::with_capacity(wanted);
    for found in search(&mut problem, &work, &effort, &mut tally) {
        if plans.len() == wanted {
            break;
        }
        // Cheap beside the check from scratch: what does not differ is left out before.
        let Some(plan) = assemble(&mut problem, &found, tally.candidates()) else { continue };
        if plans.iter().all(|other| differ(other, &plan)) && verify(&plan, scenario, &map.robot)?.is_empty() {
            plans.push(plan);
        }
    }
    Ok(if plans.is_empty() { TopOutcome::Infeasible(tally.into_infeasible()) } else { TopOutcome::Found(plans) })
}
