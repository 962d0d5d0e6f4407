//! The motion of arms that keep their grasp while the board goes from one pose to another.
//!
//! The board's centre moves along a line and its rotation about one axis; the joints are interpolated between the two
//! configurations and projected onto the grasps. Every step turns no joint by more than a few degrees, is within all joint
//! limits, and is free of collisions of robot and board. The person is left out: the knife is lifted and the person steps
//! back while the arms move. Speeds and torques are not computed.

use super::{
    super::{
        library::{ArmGrasp, BoardGrasp, GraspingRobot, largest_joint_difference_rad},
        params::path::{JUMP_RAD, STEP_M, STEP_RAD},
    },
    coverage::PathProblem,
};
use crate::model::frames::Pose;

/// A pose on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionStep {
    /// The board's pose.
    pub x_wo: Pose,
    /// Joint angles of each arm, rad.
    pub q_rad: Vec<Vec<f64>>,
}

/// The steps from one pose to another with the same grasp, both ends included; `None` if a step cannot be made.
pub fn between(problem: &PathProblem<'_>, from: &BoardGrasp, to: &BoardGrasp) -> Option<Vec<MotionStep>> {
    let steps = steps(&from.x_wo, &to.x_wo, largest_joint_difference_rad(&from.arms, &to.arms));
    let mut path = vec![step(from)];
    let mut here = from.clone();
    for number in 1..=steps {
        let share = number as f64 / steps as f64;
        let seeds = from.arms.iter().zip(&to.arms).map(|(from, to)| {
            from.q_rad.iter().zip(&to.q_rad).map(|(from, to)| from + share * (to - from)).collect::<Vec<_>>()
        });
        let there = if number == steps {
            to.clone()
        } else {
            reached(&problem.library.robot, &here, interpolated(&from.x_wo, &to.x_wo, share), seeds)?
        };
        if largest_joint_difference_rad(&here.arms, &there.arms) > JUMP_RAD || !problem.is_clear(&there) {
            return None;
        }
        path.push(step(&there));
        here = there;
    }
    Some(path)
}

/// The grasp after the board has moved to a pose step by step with the least motion of each arm; `None` if an arm cannot follow.
pub fn followed(problem: &PathProblem<'_>, from: &BoardGrasp, x_wo: &Pose) -> Option<BoardGrasp> {
    let steps = steps(&from.x_wo, x_wo, 0.0);
    let mut here = from.clone();
    for number in 1..=steps {
        let pose = interpolated(&from.x_wo, x_wo, number as f64 / steps as f64);
        let seeds: Vec<_> = here.arms.iter().map(|arm| arm.q_rad.clone()).collect();
        here = reached(&problem.library.robot, &here, pose, seeds.into_iter())?;
    }
    problem.is_clear(&here).then_some(here)
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

fn step(grasp: &BoardGrasp) -> MotionStep {
    MotionStep { x_wo: grasp.x_wo, q_rad: grasp.arms.iter().map(|arm| arm.q_rad.clone()).collect() }
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
