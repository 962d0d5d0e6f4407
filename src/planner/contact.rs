//! A candidate's grasp as a plan and the statics have it.

use super::{candidate::Candidate, problem::Problem};
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
    let hands: Result<Vec<_>, _> = plan_arms(problem, candidate)
        .into_iter()
        .zip(&problem.robot.arms)
        .map(|(own, arm)| {
            let of_robot = &problem.robot.robot.arms[arm.index];
            let own = ArmHold { grip_force_n: of_robot.gripper.grip_force_n(grip.force_n), ..own };
            HandModel::new(of_robot, &arm.chain, &own, &object, grip.friction)
        })
        .collect();
    let operation = problem.scenario.operation.rolled(candidate.work.roll_rad);
    let model = ContactModel::from_hands(hands?, &object, &operation);
    Ok(LoadCases::new(model, &operation, &problem.scenario.load))
}
