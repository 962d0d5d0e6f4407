//! The torques that the arms' servos feed forward at the planned angles (docs/method.md#71-arms).

use super::conditions::Conditions;
use crate::{
    check::{CheckedArm, CheckedPlan},
    statics::{ContactModel, StabilityWorkspace},
};

/// The torques that one arm feeds forward, N m.
#[derive(Clone, Debug)]
pub(super) struct FeedForward {
    /// For the weight of arm and gripper.
    pub arm_nm: Vec<f64>,
    /// For the arm's share of the board's weight, and for offsets of its joints.
    pub board_nm: Vec<f64>,
}

/// The torques of every arm of a plan. Each carries the share of the board's weight that it has in the compliant
/// equilibrium under the weight alone: the statics and the servos then agree on every torque, and a board that the hands
/// can carry does not sag. Without such an equilibrium the arms know of their own weight only.
///
/// A servo whose joint is `d` from the measured angle pulls with `k d` more than it would: that torque is part of `board_nm`,
/// since it acts on the board that the hands hold.
pub(super) fn feed_forward(checked: &CheckedPlan<'_>, conditions: &Conditions) -> Vec<FeedForward> {
    let model = ContactModel::of_plan(checked, conditions.friction).ok();
    let carrying_nm = model.and_then(|model| StabilityWorkspace::new().carrying_torque_nm(&model).ok().flatten());
    let of_arm = |(number, arm): (usize, &CheckedArm<'_>)| {
        let arm_nm = arm.chain.gravity_torque_nm(&arm.hold.q_rad);
        let mut board_nm = match &carrying_nm {
            Some(carrying_nm) => carrying_nm[number].as_slice().to_vec(),
            None => vec![0.0; arm_nm.len()],
        };
        if let Some(offset_deg) = conditions.uncertainty.joint_offset_deg.get(number) {
            let stiffness_nm_rad = &checked.robot().arms[arm.index].stiffness_nm_rad;
            for ((torque_nm, offset_deg), stiffness) in board_nm.iter_mut().zip(offset_deg).zip(stiffness_nm_rad) {
                *torque_nm += stiffness * conditions.uncertainty.joint_stiffness_scale * offset_deg.to_radians();
            }
        }
        FeedForward { arm_nm: arm_nm.as_slice().to_vec(), board_nm }
    };
    checked.arms().iter().enumerate().map(of_arm).collect()
}
