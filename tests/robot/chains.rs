//! The arms of the built-in robot, and what is asked of postures and solutions.

use std::sync::LazyLock;

use benchdog::{
    model::frames::Pose,
    robot::{Chain, inverse::RESIDUAL_TOLERANCE},
};
use proptest::strategy::Strategy;

use crate::common::baxter;

/// The left and the right arm, fingers closed.
pub fn chains() -> &'static [Chain; 2] {
    static CHAINS: LazyLock<[Chain; 2]> =
        LazyLock::new(|| ["left", "right"].map(|arm| Chain::new(baxter(), baxter().arm_index(arm).unwrap(), 0.0)));
    &CHAINS
}

/// Any posture within the limits of the left arm.
pub fn posture() -> impl Strategy<Value = Vec<f64>> {
    let [chain, _] = chains();
    chain.lower().iter().zip(chain.upper()).map(|(lower, upper)| *lower..*upper).collect::<Vec<_>>()
}

/// The posture of the other arm that is the mirror image: angles about axes in the mirror plane change sign.
pub fn mirrored(q_rad: &[f64]) -> Vec<f64> {
    q_rad.iter().zip([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]).map(|(q, sign)| q * sign).collect()
}

/// The largest difference of a joint.
pub fn distance_rad(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The norm of the error of the gripper's position and rotation, m and rad, as a solver computes it.
pub fn residual(chain: &Chain, target: &Pose, q_rad: &[f64]) -> f64 {
    let x_wg = chain.gripper_pose(q_rad);
    let position_m = (target.translation.vector - x_wg.translation.vector).norm();
    position_m.hypot((target.rotation * x_wg.rotation.inverse()).scaled_axis().norm())
}

/// Asserts that a posture is within its limits and puts the gripper at its target.
#[track_caller]
pub fn assert_solves(chain: &Chain, target: &Pose, q_rad: &[f64]) {
    assert!(chain.within_limits(q_rad, 0.0), "{q_rad:?}");
    let residual = residual(chain, target, q_rad);
    assert!(residual <= RESIDUAL_TOLERANCE, "{residual}");
}
