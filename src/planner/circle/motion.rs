//! The motion of arms that keep their grasp while the board goes from one pose to another.
//!
//! The board's centre moves in a line and its rotation about one axis; the joints are those between the two configurations
//! that bring the hands exactly to their grasps. Every step turns no joint by more than a few degrees, ends within all
//! joint limits, and is free of collisions of robot and board. The person is not part of it: the knife is lifted and the
//! person steps back while the arms move. Speeds and torques on the way are not looked at.

use std::f64::consts::PI;

use super::super::{RobotMap, bank::KnownHold, candidate::Hold};
use super::serve::Circle;
use crate::model::frames::Pose;

/// A motion is tested at steps of at most about this much of any joint or of the board's rotation, rad: 2 degrees.
pub const STEP_RAD: f64 = 2.0 * PI / 180.0;
/// ... and this much of the board's centre, m.
const STEP_M: f64 = 0.01;
/// The most that bending a step onto the grasps may make of it, rad: a jump to another configuration is longer.
const JUMP_RAD: f64 = 3.0 * STEP_RAD;

/// A pose on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionStep {
    /// The board's pose.
    pub x_wo: Pose,
    /// Joint angles of each arm, rad.
    pub q_rad: Vec<Vec<f64>>,
}

/// The steps from one hold to another with the same grasps, both ends included; none when a step cannot be made.
pub fn between(circle: &Circle<'_>, from: &KnownHold, to: &KnownHold) -> Option<Vec<MotionStep>> {
    let steps = steps(&from.x_wo, &to.x_wo, joints_apart(from, to));
    let mut path = vec![step(from)];
    let mut here = from.clone();
    for number in 1..=steps {
        let share = number as f64 / steps as f64;
        let seeds = from.holds.iter().zip(&to.holds).map(|(from, to)| {
            from.q_rad.iter().zip(&to.q_rad).map(|(from, to)| from + share * (to - from)).collect::<Vec<_>>()
        });
        let there = match number == steps {
            true => to.clone(),
            false => reached(circle.map, &here, pose_between(&from.x_wo, &to.x_wo, share), seeds)?,
        };
        if joints_apart(&here, &there) > JUMP_RAD || !circle.is_clear(&there) {
            return None;
        }
        path.push(step(&there));
        here = there;
    }
    Some(path)
}

/// The hold that follows from moving the board there step by step, each arm by as little as may be; none when it cannot.
pub fn followed(circle: &Circle<'_>, from: &KnownHold, x_wo: &Pose) -> Option<KnownHold> {
    let steps = steps(&from.x_wo, x_wo, 0.0);
    let mut here = from.clone();
    for number in 1..=steps {
        let pose = pose_between(&from.x_wo, x_wo, number as f64 / steps as f64);
        let seeds: Vec<_> = here.holds.iter().map(|hold| hold.q_rad.clone()).collect();
        here = reached(circle.map, &here, pose, seeds.into_iter())?;
    }
    circle.is_clear(&here).then_some(here)
}

/// The same grasps with the board in another pose, each arm near its seed.
fn reached(map: &RobotMap, hold: &KnownHold, x_wo: Pose, seeds: impl Iterator<Item = Vec<f64>>) -> Option<KnownHold> {
    let arms = map.arms.iter().zip(&hold.holds).zip(seeds);
    let holds = arms.map(|((arm, hold), seed)| {
        let q_rad = arm.inverse.near(&(x_wo * hold.grasp.x_og(map.size_m)), &seed).found()?;
        Some(Hold { grasp: hold.grasp, q_rad })
    });
    Some(KnownHold { x_wo, holds: holds.collect::<Option<_>>()? })
}

fn step(hold: &KnownHold) -> MotionStep {
    MotionStep { x_wo: hold.x_wo, q_rad: hold.holds.iter().map(|hold| hold.q_rad.clone()).collect() }
}

fn steps(from: &Pose, to: &Pose, joints_rad: f64) -> usize {
    let turn_rad = from.rotation.angle_to(&to.rotation);
    let shift_m = (to.translation.vector - from.translation.vector).norm();
    (joints_rad.max(turn_rad) / STEP_RAD).max(shift_m / STEP_M).ceil() as usize
}

/// The largest difference of a joint, rad.
pub fn joints_apart(one: &KnownHold, other: &KnownHold) -> f64 {
    let arms = one.holds.iter().zip(&other.holds);
    let joints = arms.flat_map(|(a, b)| a.q_rad.iter().zip(&b.q_rad).map(|(a, b)| (a - b).abs()));
    joints.fold(0.0, f64::max)
}

fn pose_between(from: &Pose, to: &Pose, share: f64) -> Pose {
    // Turns of a half circle have no shortest way; the board's domain has none.
    from.try_lerp_slerp(to, share, 1e-9).unwrap_or(*from)
}
