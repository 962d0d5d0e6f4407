//! Random grasps of one arm.

use rand_pcg::Pcg64;

use super::{
    grasp::ArmGrasp,
    grasping_robot::{GraspingArm, GraspingRobot},
};
use crate::{
    model::{board::Edge, frames::Pose, grasp::EdgeGrasp},
    planner::{domain, params::library::GRASP_ATTEMPTS},
};

/// A grasp of one arm on an edge of a board at a known pose, with a configuration; `None` if no drawn grasp is reached.
pub fn draw_arm_grasp(
    robot: &GraspingRobot,
    arm: &GraspingArm,
    edge: Edge,
    x_wo: &Pose,
    random: &mut Pcg64,
) -> Option<ArmGrasp> {
    let near = |x_og: &Pose| arm.reach().reaches(&arm.chain, &(x_wo * x_og));
    let grasp = draw_grasp(robot, arm, edge, near, random)?;
    let x_wg = x_wo * grasp.x_og(&robot.board);
    let mut seeds = arm.reach().seeds(&arm.chain, &x_wg);
    Some(ArmGrasp { grasp, q_rad: seeds.find_map(|seed| arm.inverse.near(&x_wg, &seed).found())? })
}

/// A grasp on an edge that fits the gripper and whose pose X_OG is accepted.
pub fn draw_grasp(
    robot: &GraspingRobot,
    arm: &GraspingArm,
    edge: Edge,
    accepts: impl Fn(&Pose) -> bool,
    random: &mut Pcg64,
) -> Option<EdgeGrasp> {
    (0..GRASP_ATTEMPTS)
        .map(|_| domain::draw_grasp(edge, &robot.board, arm.depth_m, random))
        // The clearance of the palm takes longest.
        .find(|grasp| {
            robot.has_pads_on_board(arm, grasp)
                && accepts(&grasp.x_og(&robot.board))
                && robot.keeps_palm_clear(arm, grasp)
        })
}
