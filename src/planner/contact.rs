//! A candidate's grasp as a plan and the statics have it.

use super::{
    candidate::Candidate,
    library::{GraspingArm, GraspingRobot},
    problem::Problem,
};
use crate::{
    model::{
        frames::Pose,
        plan::{ArmHold, PlacedObject},
        scenario::{Grip, Scenario},
    },
    statics::{ContactModel, ContactModelError, HandModel, LoadCases},
};

/// The arms of a candidate as a plan lists them.
pub fn plan_arms(problem: &Problem<'_>, candidate: &Candidate) -> Vec<ArmHold> {
    let scenario = problem.scenario;
    let arms = problem.robot.arms.iter().zip(&candidate.arms);
    arms.map(|(arm, own)| ArmHold {
        name: arm.name.clone(),
        joints: arm.joints.clone(),
        q_rad: own.q_rad.clone(),
        x_og: own.grasp.x_og(&problem.robot.board),
        grip_force_n: problem.robot.robot.arms[arm.index].gripper.grip_force_n(scenario.grip.force_n),
    })
    .collect()
}

/// The board of a scenario at a pose.
pub fn placed_object(scenario: &Scenario, x_wo: Pose) -> PlacedObject {
    scenario.object.placed(x_wo)
}

/// The contact models of the hands that hold a board.
///
/// # Errors
/// If a pad is off the board.
pub fn hand_models(
    robot: &GraspingRobot,
    arms: &[ArmHold],
    object: &PlacedObject,
    friction: f64,
) -> Result<Vec<HandModel>, ContactModelError> {
    let hand = |(own, arm): (&ArmHold, &GraspingArm)| {
        HandModel::new(&robot.robot.arms[arm.index], &arm.chain, own, object, friction)
    };
    arms.iter().zip(&robot.arms).map(hand).collect()
}

/// The loads of a candidate's grasp with its contact model.
pub fn load_cases(problem: &Problem<'_>, candidate: &Candidate, x_wo: &Pose) -> Result<LoadCases, ContactModelError> {
    load_cases_with(problem, candidate, x_wo, &problem.scenario.grip)
}

/// The loads of a candidate's grasp with another grip force or friction than the scenario's.
pub fn load_cases_with(
    problem: &Problem<'_>,
    candidate: &Candidate,
    x_wo: &Pose,
    grip: &Grip,
) -> Result<LoadCases, ContactModelError> {
    let object = placed_object(problem.scenario, *x_wo);
    let mut arms = plan_arms(problem, candidate);
    for (own, arm) in arms.iter_mut().zip(&problem.robot.arms) {
        own.grip_force_n = problem.robot.robot.arms[arm.index].gripper.grip_force_n(grip.force_n);
    }
    let hands = hand_models(problem.robot, &arms, &object, grip.friction)?;
    let operation = problem.scenario.operation.rolled(candidate.work.roll_rad);
    let model = ContactModel::from_hands(hands, &object, &operation);
    Ok(LoadCases::new(model, &operation, &problem.scenario.load))
}
