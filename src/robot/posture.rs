//! How good a posture is for the arm itself: far from singularities, from joint limits and from the motors' limits.

use super::chain::Chain;
use crate::model::wrench::Wrench;

impl Chain {
    /// Yoshikawa's manipulability, `sqrt(det(J J'))`, of the Jacobian in metres and radians (T. Yoshikawa,
    /// "Manipulability of robotic mechanisms", 1985): zero where the gripper cannot be moved in every direction, and so
    /// always with fewer than six joints.
    pub fn manipulability(&self, q_rad: &[f64]) -> f64 {
        let jacobian = self.jacobian_w(q_rad);
        // Rounding may leave a determinant just below zero.
        (&jacobian * jacobian.transpose()).determinant().max(0.0).sqrt()
    }

    /// The distance of each joint from its nearer limit as a share of half its range: 1 in the middle, 0 at a limit,
    /// negative beyond.
    pub fn limit_distances(&self, q_rad: &[f64]) -> Vec<f64> {
        let limits = self.lower().iter().zip(self.upper());
        let distance = |(q, (lower, upper)): (&f64, (&f64, &f64))| (q - lower).min(upper - q) / (0.5 * (upper - lower));
        q_rad.iter().zip(limits).map(distance).collect()
    }

    /// The torques that hold the arm still while its gripper presses on its surroundings with this wrench, N m:
    /// `tau = g(q) + J' f`. The wrench is that which the gripper exerts, its moment about G's origin, in W axes.
    pub fn holding_torque_nm(&self, q_rad: &[f64], exerted_w: &Wrench) -> Vec<f64> {
        let torque_nm = self.gravity_torque_nm(q_rad) + self.jacobian_w(q_rad).tr_mul(&exerted_w.to_vector());
        torque_nm.iter().copied().collect()
    }

    /// What is left of each motor's torque under this wrench (see [`Chain::holding_torque_nm`]), as a share of its limit:
    /// 1 when it is idle, 0 at its limit, negative beyond.
    pub fn effort_distances(&self, q_rad: &[f64], exerted_w: &Wrench) -> Vec<f64> {
        let torque_nm = self.holding_torque_nm(q_rad, exerted_w);
        torque_nm.iter().zip(self.effort_nm()).map(|(torque_nm, limit_nm)| 1.0 - torque_nm.abs() / limit_nm).collect()
    }
}
