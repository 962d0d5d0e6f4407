//! The search for a hold that is comfortable for the person and stable against the tool (METHOD section 3).
//!
//! The muscular comfort of a person depends on the posture of the arm alone: the tool's force is fixed in the tool, and
//! gravity does not change when the person turns on the spot. So the search starts from postures of the arm, which fix
//! the board's pose relative to the person, then places the two of them before the robot, chooses the grasps, and asks
//! the arms' inverse kinematics. Cheap tests come first and the stability program last. The best of many draws are
//! refined by small random steps that must keep every constraint. With `comfort.person = "average"` the best of the holds
//! found that way are ranked by the mean comfort of all answers to them.
//!
//! This module never sees a simulation's result; nothing here knows the clock.

mod answer;
mod assess;
mod candidate;
mod draw;
mod refine;
mod verify;

use rand_pcg::Pcg64;

use crate::{
    collision::CollisionModel,
    human::{Human, HumanError},
    model::{
        FORMAT,
        operation::Operation,
        plan::{HumanPosture, PlacedObject, Plan, PlannerRecord},
        scenario::{PlannerSettings, Scenario},
        wrench::Wrench,
    },
    robot::{Chain, InverseKinematics, Robot},
    statics::{Hold, StabilityWorkspace},
};
use assess::{Rejection, Tally};
use candidate::Candidate;
use draw::Feasible;
pub use verify::{Flaw, first_touch, verify};

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
    robot: &'a Robot,
    human: Human,
    /// The operation's wrench about the tool tip in T axes, where it does not change.
    wrench_t: Wrench,
    collision: CollisionModel,
    stability: StabilityWorkspace,
    arms: Vec<ProblemArm>,
}

/// An arm as the search needs it.
struct ProblemArm {
    index: usize,
    name: String,
    joints: Vec<String>,
    chain: Chain,
    inverse: InverseKinematics,
    finger_travel_m: [f64; 2],
}

impl<'a> Problem<'a> {
    fn new(scenario: &'a Scenario, robot: &'a Robot) -> Result<Self, HumanError> {
        let thickness_m = scenario.object.size_m[2];
        let arms = robot
            .arms
            .iter()
            .enumerate()
            .map(|(index, arm)| {
                let finger_travel_m = [0, 1].map(|finger| arm.gripper.travel_for_gap_m(finger, thickness_m));
                let chain = Chain::new(robot, index, finger_travel_m[0]);
                ProblemArm {
                    index,
                    name: arm.name.clone(),
                    joints: arm.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
                    inverse: InverseKinematics::for_chain(&chain),
                    chain,
                    finger_travel_m,
                }
            })
            .collect();
        let Operation { wrench_o, x_ot, .. } = scenario.operation;
        let to_tool = x_ot.rotation.inverse();
        Ok(Self {
            scenario,
            robot,
            human: Human::new(&scenario.human, &scenario.tool)?,
            wrench_t: Wrench::new(to_tool * wrench_o.force_n, to_tool * wrench_o.moment_nm),
            collision: CollisionModel::new(robot),
            stability: StabilityWorkspace::new(),
            arms,
        })
    }
}

/// Searches for the best hold of a scenario. The same scenario and seed give the same plan, bit by bit.
///
/// # Errors
/// When the scenario's person or tool is none; a scenario that was read from a file is checked for that.
pub fn plan(scenario: &Scenario, robot: &Robot) -> Result<PlanOutcome, HumanError> {
    let mut problem = Problem::new(scenario, robot)?;
    let mut tally = Tally::default();
    let mut random = Pcg64::new(u128::from(scenario.planner.seed), 0);
    let drawn = draw::best_candidates(&mut problem, &mut random, &mut tally);
    let refined = refine::refine(&mut problem, drawn, &mut random, &mut tally);
    for found in answer::rank(&problem, refined) {
        let Some(plan) = assemble(&mut problem, &found, tally.candidates()) else {
            tally.remove(Rejection::Stability);
            continue;
        };
        // The check takes nothing from the search but the plan, so what both accept can be trusted.
        if verify(&plan, scenario, robot)?.is_empty() {
            return Ok(PlanOutcome::Found(Box::new(plan)));
        }
        tally.remove(Rejection::Verification);
    }
    Ok(PlanOutcome::Infeasible(tally.into_infeasible()))
}

/// The plan of a candidate that passed every test; none when its stability cannot be stated.
fn assemble(problem: &mut Problem<'_>, found: &Feasible, evaluations: u64) -> Option<Plan> {
    let scenario = problem.scenario;
    let Feasible { candidate, comfort } = found;
    let PlannerSettings { kind, seed, .. } = scenario.planner;
    let operation = scenario.operation.rolled(candidate.roll_rad);
    let x_wo = candidate.x_wo(problem);
    let object = PlacedObject { size_m: scenario.object.size_m, mass_kg: scenario.object.mass_kg(), x_wo };
    let arms = assess::arm_holds(problem, candidate);
    let hold = Hold::from_plan(problem.robot, &arms, &object, &operation, scenario.grip.friction).ok()?;
    Some(Plan {
        format: FORMAT,
        name: scenario.name.clone(),
        robot: problem.robot.description.clone(),
        operation,
        object,
        arms,
        human: Some(HumanPosture::new(&scenario.human, candidate.x_wb(problem), candidate.q_h_rad)),
        comfort: Some(*comfort),
        stability: Some(problem.stability.predict(&hold, &scenario.limits).ok()??),
        planner: Some(PlannerRecord { kind, seed, wall_ms: None, evaluations }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    })
}
