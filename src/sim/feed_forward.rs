//! The torques that the arms' servos feed forward at the planned angles (docs/method.md#71-arms).

use crate::{
    check::{CheckedArm, CheckedPlan},
    statics::{ContactModel, StabilityWorkspace},
};

/// The torques that one arm feeds forward, N m.
#[derive(Clone, Debug)]
pub(super) struct FeedForward {
    /// For the weight of arm and gripper.
    pub arm_nm: Vec<f64>,
    /// For the arm's share of the board's weight.
    pub board_nm: Vec<f64>,
}

/// The torques of every arm of a plan. Each carries the share of the board's weight that it has in the compliant
/// equilibrium under the weight alone: the statics and the servos then agree on every torque, and a board that the hands
/// can carry does not sag. Without such an equilibrium the arms know of their own weight only.
pub(super) fn feed_forward(checked: &CheckedPlan<'_>, friction: f64) -> Vec<FeedForward> {
    let model = ContactModel::of_plan(checked, friction).ok();
    let carrying_nm = model.and_then(|model| StabilityWorkspace::new().carrying_torque_nm(&model).ok().flatten());
    let of_arm = |(number, arm): (usize, &CheckedArm<'_>)| {
        let arm_nm = arm.chain.gravity_torque_nm(&arm.hold.q_rad);
        let board_nm = match &carrying_nm {
            Some(carrying_nm) => carrying_nm[number].as_slice().to_vec(),
            None => vec![0.0; arm_nm.len()],
        };
        FeedForward { arm_nm: arm_nm.as_slice().to_vec(), board_nm }
    };
    checked.arms().iter().enumerate().map(of_arm).collect()
}
