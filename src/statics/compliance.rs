//! How far the arms give way: small twists, each arm's compliance, and the hold as if the hands were welded to the
//! board.

use nalgebra::{Cholesky, Const, DVector, Dyn, Matrix3, Matrix6, Vector3, Vector6};

use super::contact_model::{ContactModel, HandModel};
use crate::model::wrench::Wrench;

/// The smallest ratio of two pivots of a compliance that still counts as invertible: rounding leaves about 1e-15 where
/// an exact figure would be 0, and no real arm's directions differ in stiffness by more than a million.
const SINGULAR_PIVOT_RATIO: f64 = 1e-10;

/// A small displacement of a rigid body: the translation of a stated point of it and the rotation vector, in O axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Translation of the stated point, m.
    pub linear: Vector3<f64>,
    /// Rotation vector, rad.
    pub angular: Vector3<f64>,
}

impl Twist {
    /// The same displacement, stated for the point that `lever` leads to from the present one:
    /// `t_q = t_p + theta x p_pq`.
    pub fn at(&self, lever: &Vector3<f64>) -> Self {
        Self { linear: self.linear + self.angular.cross(lever), angular: self.angular }
    }

    /// Work of a wrench about the same point, J for a twist in m and rad.
    pub fn work(&self, wrench: &Wrench) -> f64 {
        self.linear.dot(&wrench.force_n) + self.angular.dot(&wrench.moment_nm)
    }

    pub(super) fn from_vector(vector: &Vector6<f64>) -> Self {
        Self { linear: vector.fixed_rows::<3>(0).into(), angular: vector.fixed_rows::<3>(3).into() }
    }

    pub(super) fn to_vector(self) -> Vector6<f64> {
        let (t, r) = (self.linear, self.angular);
        Vector6::new(t.x, t.y, t.z, r.x, r.y, r.z)
    }
}

impl std::ops::Sub for Twist {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { linear: self.linear - other.linear, angular: self.angular - other.angular }
    }
}

impl HandModel {
    /// Compliance of the arm at the grasp point, `C = J (K_q + dg/dq)^-1 J'`, 6 x 6, O axes: the hand gives way by `C w`
    /// under a wrench `w` on it (m/N, rad/(N m)). Not a number when the joints' springs do not hold the arm itself, which
    /// [`ContactModel::check`] refuses.
    pub fn compliance(&self) -> Matrix6<f64> {
        let Some(factor) = self.spring_factor() else { return Matrix6::repeat(f64::NAN) };
        // L^-1 J': symmetric to the last bit.
        let mut half = self.jacobian_o.transpose();
        factor.l_dirty().solve_lower_triangular_mut(&mut half);
        Matrix6::from_iterator(half.tr_mul(&half).iter().copied())
    }

    /// The joints' displacement, rad, under torques on them, N m: `(K_q + dg/dq)^-1 tau`.
    pub(super) fn joint_deflection_rad(&self, torque_nm: &DVector<f64>) -> DVector<f64> {
        self.spring_factor().map_or_else(|| torque_nm * f64::NAN, |factor| factor.solve(torque_nm))
    }

    /// The factor of `K_q + dg/dq`; none unless it is positive definite.
    pub(super) fn spring_factor(&self) -> Option<Cholesky<f64, Dyn>> {
        let mut stiffness = self.gravity_stiffness_nm_rad.clone();
        for (joint, stiffness_nm_rad) in self.stiffness_nm_rad.iter().enumerate() {
            stiffness[(joint, joint)] += stiffness_nm_rad;
        }
        stiffness.cholesky()
    }
}

/// A hold whose hands are taken to be welded to the board: right as long as no pad is at its limit.
#[derive(Clone, Debug)]
pub struct WeldedStiffness {
    p_ot: Vector3<f64>,
    stiffness_t: Matrix6<f64>,
    factor: Cholesky<f64, Const<6>>,
    /// Of each hand: its stiffness at the grasp point, and the map of twists from the tool tip to the grasp point.
    hands: Vec<(Matrix6<f64>, Matrix6<f64>)>,
}

impl WeldedStiffness {
    /// `K_O = sum_i Ad_i' C_i^-1 Ad_i` about the tool tip (METHOD section 6), `Ad_i` taking the board's
    /// twist at the tool tip to that at the grasp point. None when an arm has a direction in which its joints' springs
    /// do not give way at all (fewer than six joints, or a singular posture): its stiffness there is not finite.
    pub fn new(model: &ContactModel) -> Option<Self> {
        let mut stiffness_t = Matrix6::zeros();
        let mut hands = Vec::with_capacity(model.hands.len());
        for hand in &model.hands {
            let stiffness = inverse(&hand.compliance())?;
            let map = twist_map(&(hand.grasp_point_o - model.p_ot));
            stiffness_t += map.transpose() * stiffness * map;
            hands.push((stiffness, map));
        }
        Some(Self { p_ot: model.p_ot, stiffness_t, factor: stiffness_t.cholesky()?, hands })
    }

    /// K_O about the tool tip in O axes, 6 x 6 (N/m, N, N m/rad).
    pub fn stiffness_about_tip(&self) -> Matrix6<f64> {
        self.stiffness_t
    }

    /// Displacement of the board, stated for the tool tip, under a wrench about O's origin: `delta = K_O^-1 w`.
    pub fn twist_at_tip(&self, wrench: &Wrench) -> Twist {
        let about_tip = wrench.about(&-self.p_ot).to_vector();
        Twist::from_vector(&self.factor.solve(&about_tip))
    }

    /// The wrench of each hand on the board, about its grasp point, in answer to a wrench on the board about O's origin:
    /// `-C_i^-1 Ad_i delta`.
    pub fn hand_wrenches(&self, wrench: &Wrench) -> Vec<Wrench> {
        let delta = self.twist_at_tip(wrench).to_vector();
        let answer = |(stiffness, map): &(Matrix6<f64>, Matrix6<f64>)| -(stiffness * (map * delta));
        self.hands
            .iter()
            .map(|hand| {
                let [fx, fy, fz, mx, my, mz] = answer(hand).into();
                Wrench::from([fx, fy, fz, mx, my, mz])
            })
            .collect()
    }
}

/// `[1, -[p]x; 0, 1]`: twists stated for a point to twists stated for the point p away from it.
fn twist_map(lever: &Vector3<f64>) -> Matrix6<f64> {
    let mut map = Matrix6::identity();
    map.fixed_view_mut::<3, 3>(0, 3).copy_from(&-lever.cross_matrix());
    map
}

/// The inverse of a positive definite compliance; none when it is singular but for rounding.
fn inverse(compliance: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    // Rotations measured at this lever, so that pivots compare.
    let lever = super::program::LENGTH_UNIT_M;
    let mut scale = Matrix6::identity();
    scale.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() * lever));
    let factor = (scale * compliance * scale).cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    let ratio = (pivots.min() / pivots.max()).powi(2);
    (ratio > SINGULAR_PIVOT_RATIO).then(|| scale * factor.inverse() * scale)
}
