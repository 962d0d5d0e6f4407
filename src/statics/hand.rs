//! One hand of a grasp: two soft-finger pads, or a measured gripper, at the end of a compliant arm.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix6, Matrix6xX, Vector3};

use super::{
    hold::{HandWrench, Hold, MeasuredHold, PadPair},
    pad_model::PadModel,
    twist::Twist,
};
use crate::model::wrench::Wrench;

/// One hand of a grasp; everything in O axes unless noted.
#[derive(Clone, Debug, PartialEq)]
pub struct HandModel {
    /// The arm's name, such as `left`.
    pub name: String,
    /// The names of the arm's n joints, from the base outward.
    pub joints: Vec<String>,
    /// What it holds the board with.
    pub hold: Hold,
    /// The grasp point, between the pads, in O, m. The hand's wrench is taken about it.
    pub grasp_point_o: Vector3<f64>,
    /// Jacobian J of the grasp point, 6 x n, O axes: rows 0 to 2 its velocity (m/s), rows 3 to 5 the angular velocity
    /// (rad/s), for joint velocities in rad/s.
    pub jacobian_o: Matrix6xX<f64>,
    /// Joint torques g that hold arm and gripper against gravity, n, N m.
    pub gravity_torque_nm: DVector<f64>,
    /// Torque limit of each joint, n, N m.
    pub effort_nm: DVector<f64>,
    /// Stiffness K_q of each joint's position control, n, N m/rad.
    pub stiffness_nm_rad: DVector<f64>,
    /// `dg/dq`, n x n, N m/rad. The controller compensates gravity at the planned angles, so the change of the gravity
    /// torque with the angles adds to the joint stiffness.
    pub gravity_stiffness_nm_rad: DMatrix<f64>,
    /// What offsets of the joints would move the hand by if it held nothing, at the grasp point: `t = J (K_q + dg/dq)^-1 K_q d`
    /// with `d` the difference of true and measured angles (docs/method.md#68-compliant-equilibrium).
    pub offset: Twist,
}

impl HandModel {
    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Its pads; none of a measured gripper.
    #[must_use]
    pub fn pads(&self) -> &[PadModel] {
        self.pad_pair().map_or(&[], |pair| &pair.pads)
    }

    /// Its pads, to change them.
    pub fn pads_mut(&mut self) -> &mut [PadModel] {
        match &mut self.hold {
            Hold::Pads(pair) => &mut pair.pads,
            Hold::Measured(_) => &mut [],
        }
    }

    /// Its pads with their force; `None` for a measured gripper.
    #[must_use]
    pub fn pad_pair(&self) -> Option<&PadPair> {
        match &self.hold {
            Hold::Pads(pair) => Some(pair),
            Hold::Measured(_) => None,
        }
    }

    /// Its measured limits; `None` for pads.
    #[must_use]
    pub fn measured(&self) -> Option<&MeasuredHold> {
        match &self.hold {
            Hold::Pads(_) => None,
            Hold::Measured(measured) => Some(measured),
        }
    }

    /// Multiplies the grip force of its pads, or its measured limits, by a factor.
    pub fn scale_grip(&mut self, factor: f64) {
        match &mut self.hold {
            Hold::Pads(pair) => pair.grip_force_n *= factor,
            Hold::Measured(measured) => measured.limits = measured.limits.scaled(factor),
        }
    }

    /// The hand's wrench on the object about the grasp point in O axes.
    pub fn wrench_about_grasp_point(&self, wrench: &HandWrench) -> Wrench {
        match wrench {
            HandWrench::Measured(whole) => *whole,
            HandWrench::Pads(pads_p) => {
                let of_pads = self.pads().iter().zip(pads_p).map(|(pad, wrench_p)| pad.wrench_about_object(wrench_p));
                of_pads.reduce(|sum, of_pad| sum + of_pad).unwrap_or_default().about(&-self.grasp_point_o)
            }
        }
    }

    /// The ratio of the hand's wrench to measured limits; 0 for pads.
    #[must_use]
    pub fn grip_ratio(&self, wrench: &HandWrench) -> f64 {
        match (&self.hold, wrench) {
            (Hold::Measured(measured), HandWrench::Measured(whole)) => measured.limits.ratio(&measured.in_g(whole)),
            _ => 0.0,
        }
    }

    /// Joint torques `g + J' w` under its wrench on the object, N m.
    pub(super) fn joint_torque_nm(&self, wrench: &HandWrench) -> DVector<f64> {
        let wrench = self.wrench_about_grasp_point(wrench).to_vector();
        self.jacobian_o.tr_mul(&wrench) + &self.gravity_torque_nm
    }

    /// Sets the offset of the hand from those of its joints, rad.
    pub(super) fn set_offset(&mut self, joints_rad: &DVector<f64>) {
        let torque_nm = self.stiffness_nm_rad.component_mul(joints_rad);
        let moved = &self.jacobian_o * self.joint_deflection_rad(&torque_nm);
        self.offset = Twist::from_vector(&moved.fixed_rows::<6>(0).into_owned());
    }

    /// Compliance of arm and pads at the grasp point, `C = J (K_q + dg/dq)^-1 J' + C_pads`, 6 x 6, O axes (m/N, rad/(N
    /// m)): a wrench w on the faces of the pads displaces them by `C w`. Of a measured gripper `C_pads` is its own. NaN if `K_q + dg/dq` is not positive definite,
    /// which [`ContactModel::check`](super::ContactModel::check) rejects.
    #[must_use]
    pub fn compliance(&self) -> Matrix6<f64> {
        let arm = self.arm_compliance();
        self.hold_compliance().map_or(arm, |hold| arm + hold)
    }

    /// The part of the compliance between hand and board; `None` if it is rigid.
    pub(super) fn hold_compliance(&self) -> Option<Matrix6<f64>> {
        match &self.hold {
            Hold::Pads(_) => self.pad_compliance(),
            Hold::Measured(measured) => measured.compliance(),
        }
    }

    /// The arm's part of the compliance.
    fn arm_compliance(&self) -> Matrix6<f64> {
        let Some(factor) = self.stiffness_factor() else { return Matrix6::repeat(f64::NAN) };
        // As a product of L^-1 J' with itself the matrix is symmetric to the last bit.
        let mut half = self.jacobian_o.transpose();
        factor.l_dirty().solve_lower_triangular_mut(&mut half);
        Matrix6::from_iterator(half.tr_mul(&half).iter().copied())
    }

    /// Joint displacements `(K_q + dg/dq)^-1 tau`, rad, under joint torques tau, N m.
    pub(super) fn joint_deflection_rad(&self, torque_nm: &DVector<f64>) -> DVector<f64> {
        self.stiffness_factor().map_or_else(|| torque_nm * f64::NAN, |factor| factor.solve(torque_nm))
    }

    /// Cholesky factor of `K_q + dg/dq`; `None` if it is not positive definite.
    pub(super) fn stiffness_factor(&self) -> Option<Cholesky<f64, Dyn>> {
        let mut stiffness = self.gravity_stiffness_nm_rad.clone();
        for (joint, stiffness_nm_rad) in self.stiffness_nm_rad.iter().enumerate() {
            stiffness[(joint, joint)] += stiffness_nm_rad;
        }
        stiffness.cholesky()
    }
}
