//! The search for a hold that is comfortable for the person and stable against the tool's force (METHOD section 3).
//!
//! Two maps propose: what a robot can hold with boards of one size ([`RobotMap`], made once for all operations), and how
//! comfortable the person's postures are, by what they ask of the board's pose. Exact kinematics, collisions and stability
//! dispose of their best pairs, cheap tests first; sequential quadratic steps refine what is left, stability included. So a
//! kind of work is practised in a few places on the board ([`WorkMap`], made once for all others), and a plan begins with
//! what was good there, made to fit. The random planner draws instead. A normalised objective has the planners of either
//! comfort alone say first what the comforts are over. With `comfort.person = "average"` the best of the
//! holds found are ranked by the mean comfort of all answers to them. Every plan is checked from scratch before it is
//! returned.
//!
//! Effort is counted in candidates, never in time: the same scenario and seed give the same plan, bit by bit. This module
//! never sees a simulation's result; nothing here knows the clock.

mod answer;
mod assess;
mod bank;
mod candidate;
pub mod circle;
mod effort;
mod focus;
mod front;
mod optima;
mod person_map;
mod propose;
mod random;
mod reach;
mod refine;
mod robot_map;
mod top;
mod verify;
mod watch;
mod work_map;

use rand_pcg::Pcg64;

use crate::{
    comfort,
    human::{Human, HumanError},
    model::{
        FORMAT,
        operation::Operation,
        plan::{Comfort, HumanPosture, PlacedObject, Plan, PlannerRecord},
        scenario::{ComfortSettings, PlannerKind, PlannerSettings, Scenario},
        wrench::Wrench,
    },
    robot::Robot,
    statics::{ContactModel, StabilityWorkspace},
};
use assess::{Configured, Feasible, Rejection, Tally};
use candidate::{Candidate, Placed};
use effort::Effort;
pub use front::{Front, FrontOutcome, FrontPoint, front};
pub use optima::with_optima;
use person_map::PersonMap;
pub use robot_map::RobotMap;
pub use top::{TopOutcome, differ, top};
pub use verify::{Flaw, first_touch, verify};
use watch::{Count, Watch};
pub use watch::{Onlooker, Progress, nobody};
pub use work_map::{WorkMap, same_work};

/// What the search came to.
#[derive(Clone, Debug)]
pub enum PlanOutcome {
    /// A plan that keeps every constraint.
    Found(Box<Plan>),
    /// No candidate kept every constraint.
    Infeasible(Infeasible),
}

/// Which constraint removed how many candidates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Infeasible {
    /// How many candidates were drawn.
    pub candidates: u64,
    /// Each constraint that removed some, the most frequent first.
    pub removed: Vec<(&'static str, u64)>,
}

impl std::fmt::Display for Infeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "none of {} candidates kept every constraint", self.candidates)?;
        for (index, (what, count)) in self.removed.iter().enumerate() {
            let share = 100.0 * *count as f64 / self.candidates as f64;
            write!(f, "{} {share:.0} % {what}", if index == 0 { ":" } else { "," })?;
        }
        Ok(())
    }
}

/// Everything that is the same for all candidates of one scenario.
struct Problem<'a> {
    scenario: &'a Scenario,
    map: &'a RobotMap,
    /// The person's map, where one is at hand.
    person: Option<&'a PersonMap>,
    human: Human,
    /// What the search maximises: the scenario's comfort with the weights of its planner.
    objective: ComfortSettings,
    /// The operation's wrench about the tool tip in T axes, where it does not change.
    wrench_t: Wrench,
    stability: StabilityWorkspace,
    /// Who looks on.
    watch: Watch<'a>,
}

impl<'a> Problem<'a> {
    fn new(scenario: &'a Scenario, map: &'a RobotMap, watch: Watch<'a>) -> Result<Self, HumanError> {
        Ok(Self {
            scenario,
            map,
            person: None,
            human: Human::new(&scenario.human, &scenario.tool)?,
            objective: scenario.planner.kind.objective(scenario.comfort),
            wrench_t: wrench_t(&scenario.operation),
            stability: StabilityWorkspace::new(),
            watch,
        })
    }
}

/// An operation's wrench about the tool tip in T axes.
fn wrench_t(operation: &Operation) -> Wrench {
    let to_tool = operation.x_ot.rotation.inverse();
    Wrench::new(to_tool * operation.wrench_o.force_n, to_tool * operation.wrench_o.moment_nm)
}

/// Searches for the best hold of a scenario. The same scenario and seed give the same plan, bit by bit.
///
/// # Errors
/// When the scenario's person or tool is none; a scenario that was read from a file is checked for that.
pub fn plan(scenario: &Scenario, robot: &Robot) -> Result<PlanOutcome, HumanError> {
    plan_on(scenario, &RobotMap::new(robot, scenario.object.size_m))
}

/// As [`plan`], on a map of the scenario's robot and size of board that is at hand.
///
/// # Errors
/// As [`plan`].
pub fn plan_on(scenario: &Scenario, map: &RobotMap) -> Result<PlanOutcome, HumanError> {
    plan_until(scenario, map, &mut nobody)
}

/// As [`plan_until`], with the map of the scenario's kind of work at hand; one that does not serve it is not used.
///
/// # Errors
/// As [`plan`].
pub fn plan_with<'a>(
    scenario: &'a Scenario,
    map: &'a RobotMap,
    work: &'a WorkMap,
    onlooker: &'a mut Onlooker<'a>,
) -> Result<PlanOutcome, HumanError> {
    if !work.serves(scenario) {
        return plan_until(scenario, map, onlooker);
    }
    let normalised;
    let scenario = match &work.alone {
        Some(alone) => match optima::found(scenario, map, alone)? {
            Ok(found) => {
                normalised = found;
                &normalised
            }
            Err(why) => return Ok(PlanOutcome::Infeasible(why)),
        },
        None => scenario,
    };
    let count = Count::of_at_most(scenario.planner.evaluations);
    let mut problem = Problem::new(scenario, map, Watch::new(count.clone(), onlooker))?;
    problem.person = work.person.as_ref();
    let mut tally = Tally::new(count);
    for found in search(&mut problem, work, &Effort::of(scenario.planner.budget), &mut tally) {
        if let Some(plan) = checked(&mut problem, &found, &mut tally)? {
            return Ok(PlanOutcome::Found(Box::new(plan)));
        }
    }
    Ok(PlanOutcome::Infeasible(tally.into_infeasible()))
}

/// As [`plan_on`], with somebody who looks on: told of every better hold, and asked with every candidate whether to go on.
/// Once stopped, the best hold so far is assembled and checked like any other. An onlooker who never stops the search has
/// the plan of [`plan_on`], bit by bit.
///
/// # Errors
/// As [`plan`].
pub fn plan_until<'a>(
    scenario: &'a Scenario,
    map: &'a RobotMap,
    onlooker: &'a mut Onlooker<'a>,
) -> Result<PlanOutcome, HumanError> {
    plan_with(scenario, map, &WorkMap::new(scenario, map)?, onlooker)
}

/// The holds that the scenario's planner finds, the best first.
fn search(problem: &mut Problem<'_>, work: &WorkMap, effort: &Effort, tally: &mut Tally) -> Vec<Feasible> {
    let PlannerSettings { kind, seed, .. } = problem.scenario.planner;
    let found = if kind == PlannerKind::Random {
        random::draw(problem, &mut Pcg64::new(u128::from(seed), 0), tally).into_iter().collect()
    } else {
        let mut starts = work.starts(problem, effort.known_starts, tally);
        match &effort.known_heats {
            Some(heats) if !starts.is_empty() => refine::refine(problem, starts, heats, tally),
            _ => {
                starts.extend(propose::best_candidates(problem, &problem.map.bank, effort, tally));
                refine::refine(problem, starts, &effort.heats, tally)
            }
        }
    };
    answer::rank(problem, found)
}

/// The plan of a hold, when the check from scratch confirms it. The check takes nothing from the search but the plan, so
/// what both accept can be trusted.
fn checked(problem: &mut Problem<'_>, found: &Feasible, tally: &mut Tally) -> Result<Option<Plan>, HumanError> {
    let Some(plan) = assemble(problem, found, tally.candidates()) else {
        tally.remove(Rejection::Stability);
        return Ok(None);
    };
    if verify(&plan, problem.scenario, &problem.map.robot)?.is_empty() {
        return Ok(Some(plan));
    }
    tally.remove(Rejection::Verification);
    Ok(None)
}

/// The plan of a candidate that passed every test; none when its stability cannot be stated.
fn assemble(problem: &mut Problem<'_>, found: &Feasible, evaluations: u64) -> Option<Plan> {
    let Feasible { candidate, configured: Configured { placed, .. }, comfort, .. } = found;
    assemble_placed(problem, candidate, placed, comfort, evaluations)
}

/// As [`assemble`], with the poses of board and person given: those that follow from a candidate differ by rounding.
fn assemble_placed(
    problem: &mut Problem<'_>,
    candidate: &Candidate,
    &Placed { x_wo, x_wb }: &Placed,
    comfort: &Comfort,
    evaluations: u64,
) -> Option<Plan> {
    let scenario = problem.scenario;
    let PlannerSettings { kind, seed, .. } = scenario.planner;
    let operation = scenario.operation.rolled(candidate.roll_rad);
    let object = PlacedObject { size_m: scenario.object.size_m, mass_kg: scenario.object.mass_kg(), x_wo };
    let arms = assess::arm_holds(problem, candidate);
    let hold = ContactModel::from_plan(&problem.map.robot, &arms, &object, &operation, scenario.grip.friction).ok()?;
    Some(Plan {
        format: FORMAT,
        name: scenario.name.clone(),
        robot: problem.map.robot.description.clone(),
        operation,
        object,
        arms,
        human: Some(HumanPosture::new(&scenario.human, x_wb, candidate.q_h_rad)),
        comfort: Some(comfort::weighted(*comfort, &scenario.comfort)),
        stability: Some(problem.stability.predict(&hold, &scenario.limits).ok()??),
        planner: Some(PlannerRecord { kind, seed, wall_ms: None, map_ms: None, evaluations }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    })
}
