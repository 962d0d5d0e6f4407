//! The search for a hold that is comfortable for the person and stable against the tool (METHOD section 3).
//!
//! The muscular comfort of a person depends on the posture of the arm alone: the tool's force is fixed in the tool, and
//! gravity does not change when the person turns on the spot. So the search starts from postures of the arm, which fix
//! the board's pose relative to the person, then places the two of them before the robot, chooses the grasps, and asks
//! the arms' inverse kinematics. Cheap tests come first and the stability program last. The best of many draws are
//! refined by small random steps that must keep every constraint.
//!
//! This module never sees a simulation's result; nothing here knows the clock.

mod assess;
mod candidate;
mod draw;
mod refine;
mod verify;

use rand_pcg::Pcg64;

use crate::{
    collision::CollisionModel,
    human::Human,
    model::{
        FORMAT,
        plan::{ArmHold, HumanPosture, PlacedObject, Plan, PlannerRecord},
        scenario::Scenario,
    },
    robot::{Chain, InverseKinematics, Robot},
};
use assess::{Assessment, Rejection, Tally};
use candidate::Candidate;
pub use verify::{Flaw, verify};

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
    collision: CollisionModel,
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
    fn new(scenario: &'a Scenario, robot: &'a Robot) -> Self {
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
        Self {
            scenario,
            robot,
            human: Human::new(&scenario.human, &scenario.tool),
            collision: CollisionModel::new(robot),
            arms,
        }
    }
}

/// Searches for the best hold of a scenario. The same scenario and seed give the same plan, bit by bit.
pub fn plan(scenario: &Scenario, robot: &Robot) -> PlanOutcome {
    let problem = Problem::new(scenario, robot);
    let mut tally = Tally::default();
    let mut random = Pcg64::new(u128::from(scenario.planner.seed), 0);
    let drawn = draw::best_candidates(&problem, &mut random, &mut tally);
    let Some((candidate, assessment)) = refine::refine(&problem, drawn, &mut random, &mut tally) else {
        return PlanOutcome::Infeasible(tally.into_infeasible());
    };
    PlanOutcome::Found(Box::new(assemble(&problem, &candidate, assessment, tally.candidates())))
}

/// The plan of a candidate that passed every test.
fn assemble(problem: &Problem<'_>, candidate: &Candidate, assessment: Assessment, evaluations: u64) -> Plan {
    let scenario = problem.scenario;
    let arms = problem
        .arms
        .iter()
        .zip(&candidate.holds)
        .map(|(arm, hold)| ArmHold {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            q_rad: hold.q_rad.clone(),
            x_og: hold.grasp.x_og(scenario.object.size_m),
            grip_force_n: scenario.grip.force_n,
        })
        .collect();
    Plan {
        format: FORMAT,
        name: scenario.name.clone(),
        robot: problem.robot.description.clone(),
        operation: scenario.operation.rolled(candidate.roll_rad),
        object: PlacedObject {
            size_m: scenario.object.size_m,
            mass_kg: scenario.object.mass_kg(),
            x_wo: candidate.x_wo(problem),
        },
        arms,
        human: Some(HumanPosture::new(&scenario.human, candidate.x_wb(problem), candidate.q_h_rad)),
        comfort: Some(assessment.comfort),
        stability: Some(assessment.stability),
        planner: Some(PlannerRecord {
            kind: scenario.planner.kind,
            seed: scenario.planner.seed,
            wall_ms: None,
            evaluations,
        }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    }
}
