//! Checks whether the scene of a plan can be built.

use nalgebra::Vector3;

use super::error::SimError;
use crate::{
    model::{
        frames::Pose,
        plan::{ArmHold, Plan},
    },
    robot::Robot,
};

/// Largest distance of a hand from the planned pose, m: a plan written with three decimals may be off by this much, and
/// it is small compared to the pad.
const HAND_TOLERANCE_M: f64 = 1e-3;

/// Largest rotation of a hand from the planned pose, rad: 0.1 degrees.
const HAND_TOLERANCE_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// An arm of the plan.
pub(super) struct Holding<'a> {
    /// An index into [`Robot::arms`].
    pub arm_index: usize,
    /// Its part of the plan.
    pub hold: &'a ArmHold,
}

/// The robot's arms that hold the board, each with its part of the plan.
pub(super) fn holds<'a>(robot: &'a Robot, plan: &'a Plan) -> Result<Vec<Holding<'a>>, SimError> {
    board(plan)?;
    let mut holds: Vec<Holding> = Vec::with_capacity(plan.arms.len());
    for hold in &plan.arms {
        if holds.iter().any(|other| other.hold.name == hold.name) {
            return Err(SimError::ArmTwice { arm: hold.name.clone() });
        }
        holds.push(holding(robot, plan, hold)?);
    }
    if holds.is_empty() { Err(SimError::NoArm) } else { Ok(holds) }
}

/// Checks the board's size and mass, and the operation's wrench.
fn board(plan: &Plan) -> Result<(), SimError> {
    let keys = ["object.size_m[0]", "object.size_m[1]", "object.size_m[2]"];
    for (key, found) in keys.into_iter().zip(plan.object.size_m).chain([("object.mass_kg", plan.object.mass_kg)]) {
        if !(found.is_finite() && found > 0.0) {
            return Err(SimError::Board { key, found });
        }
    }
    if plan.operation.wrench_o.is_finite() { Ok(()) } else { Err(SimError::Wrench) }
}

/// Checks one arm's part of the plan against the robot.
fn holding<'a>(robot: &'a Robot, plan: &Plan, hold: &'a ArmHold) -> Result<Holding<'a>, SimError> {
    let arm_index = robot.arm_index(&hold.name).ok_or_else(|| SimError::UnknownArm {
        found: hold.name.clone(),
        expected: robot.arms.iter().map(|arm| arm.name.as_str()).collect::<Vec<_>>().join(", "),
    })?;
    let arm = &robot.arms[arm_index];
    let names: Vec<&str> = arm.joints.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
    if hold.joints != names {
        return Err(SimError::Joints {
            arm: hold.name.clone(),
            found: hold.joints.join(", "),
            expected: names.join(", "),
        });
    }
    if hold.q_rad.len() != names.len() || !hold.q_rad.iter().all(|q| q.is_finite()) {
        return Err(SimError::Angles { arm: hold.name.clone(), found: hold.q_rad.len(), expected: names.len() });
    }
    let max_n = arm.gripper.max_force_n;
    if !(hold.grip_force_n > 0.0 && hold.grip_force_n <= max_n) {
        return Err(SimError::GripForce { arm: hold.name.clone(), found_n: hold.grip_force_n, max_n });
    }
    let thickness_m = plan.object.size_m[2];
    let [closed_m, open_m] = arm.gripper.opening_m;
    if !(closed_m <= thickness_m && thickness_m <= open_m) {
        return Err(SimError::Opening { arm: hold.name.clone(), thickness_m, closed_m: closed_m.max(0.0), open_m });
    }
    straddles(hold)?;
    Ok(Holding { arm_index, hold })
}

/// Checks that the fingers close on the two faces of the board and G is in its middle plane.
fn straddles(hold: &ArmHold) -> Result<(), SimError> {
    let off_rad = (hold.x_og.rotation * Vector3::y()).z.abs().min(1.0).acos();
    let off_m = hold.x_og.translation.vector.z.abs();
    // NaN is refused.
    if off_rad <= HAND_TOLERANCE_RAD && off_m <= HAND_TOLERANCE_M {
        return Ok(());
    }
    Err(SimError::Astride { arm: hold.name.clone(), off_mm: off_m * 1e3, off_deg: off_rad.to_degrees() })
}

/// Checks that the arm's angles put its gripper at the planned grasp pose.
pub(super) fn hand_is_where_planned(hold: &ArmHold, x_wo: &Pose, x_wg: &Pose) -> Result<(), SimError> {
    let off = (x_wo * hold.x_og).inverse() * x_wg;
    let (off_m, off_rad) = (off.translation.vector.norm(), off.rotation.angle());
    // NaN is refused.
    if off_m <= HAND_TOLERANCE_M && off_rad <= HAND_TOLERANCE_RAD {
        return Ok(());
    }
    Err(SimError::HandOff { arm: hold.name.clone(), off_mm: off_m * 1e3, off_deg: off_rad.to_degrees() })
}
