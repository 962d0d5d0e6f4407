//! The motion of arms that keep their grasp while the board goes from one pose to another.
//!
//! The board's centre moves along a line and its rotation about one axis; the joints are interpolated between the two
//! configurations and projected onto the grasps. Every step turns no joint by more than a few degrees, is within all joint
//! limits, and is free of collisions of robot and board.

use super::super::{
    library::{ArmGrasp, BoardGrasp, GraspingRobot, largest_joint_difference_rad},
    params::task::{JUMP_RAD, STEP_M, STEP_RAD},
};
use crate::model::frames::Pose;

/// The steps from one pose to another with the same grasps, both ends included; `None` if a step cannot be made.
pub fn between(robot: &GraspingRobot, from: &BoardGrasp, to: &BoardGrasp) -> Option<Vec<BoardGrasp>> {
    let steps = steps(&from.x_wo, &to.x_wo, largest_joint_difference_rad(&from.arms, &to.arms));
    let mut path = vec![from.clone()];
    for number in 1..=steps {
        let share = number as f64 / steps as f64;
        let seeds = from.arms.iter().zip(&to.arms).map(|(from, to)| {
            from.q_rad.iter().zip(&to.q_rad).map(|(from, to)| from + share * (to - from)).collect::<Vec<_>>()
        });
        let here = &path[path.len() - 1];
        let there = if number == steps {
            to.clone()
        } else {
            reached(robot, here, interpolated(&from.x_wo, &to.x_wo, share), seeds)?
        };
        if largest_joint_difference_rad(&here.arms, &there.arms) > JUMP_RAD || !robot.is_clear(&there) {
            return None;
        }
        path.push(there);
    }
    Some(path)
}

/// The same grasp with the board at another pose, each arm near its seed.
fn reached(
    robot: &GraspingRobot,
    grasp: &BoardGrasp,
    x_wo: Pose,
    seeds: impl Iterator<Item = Vec<f64>>,
) -> Option<BoardGrasp> {
    let arms = robot.arms.iter().zip(&grasp.arms).zip(seeds);
    let arms = arms.map(|((arm, own), seed)| {
        let q_rad = arm.inverse.near(&(x_wo * own.grasp.x_og(&robot.board)), &seed).found()?;
        Some(ArmGrasp { grasp: own.grasp, q_rad })
    });
    Some(BoardGrasp { x_wo, arms: arms.collect::<Option<_>>()? })
}

fn steps(from: &Pose, to: &Pose, joints_rad: f64) -> usize {
    let turn_rad = from.rotation.angle_to(&to.rotation);
    let shift_m = (to.translation.vector - from.translation.vector).norm();
    (joints_rad.max(turn_rad) / STEP_RAD).max(shift_m / STEP_M).ceil() as usize
}

fn interpolated(from: &Pose, to: &Pose, share: f64) -> Pose {
    // Only turns of exactly half a circle have no shortest way.
    from.try_lerp_slerp(to, share, 1e-9).unwrap_or(*from)
}
