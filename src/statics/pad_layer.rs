//! The compliance of a hand's pads (docs/method.md#612-pad-compliance).
//!
//! A pad is a uniform elastic layer between finger and board: a foundation of independent springs (Winkler) with the
//! normal stiffness `k` in total, and `k_t` along its face. Its stiffness stays that of the whole layer while all of it is
//! pressed, up to a third of the tilting moment that the pad holds. The two pads of a hand act in parallel, since the
//! fingers move together; both are in series with the arm.

use nalgebra::{Matrix6, Vector6};

use super::{
    hand::HandModel,
    hold::{Hold, PadPair},
    pad_model::PadModel,
    welded::twist_map,
};
use crate::model::frames::Pose;

/// Poisson's ratio of the pads' material: rubber does not change its volume.
const POISSON: f64 = 0.5;

/// Stiffness along the face over that along the normal, `2 (1 - nu) / (2 - nu)` (Mindlin 1949, for two bodies in contact
/// without slip): two thirds.
const TANGENTIAL_SHARE: f64 = 2.0 * (1.0 - POISSON) / (2.0 - POISSON);

impl PadModel {
    /// Stiffness about the pad's centre in pad axes, 6 (N/m, N m/rad): its matrix is diagonal.
    fn layer_stiffness(&self) -> Option<Vector6<f64>> {
        let normal = self.stiffness_n_m?;
        let along = TANGENTIAL_SHARE * normal;
        let [a2, b2] = self.half_sides_m.map(|half| half * half / 3.0);
        Some(Vector6::new(along, along, normal, normal * b2, normal * a2, along * (a2 + b2)))
    }
}

impl HandModel {
    /// Stiffness of the layers between the hand and the board about the origin of a frame F and in its axes, 6 x 6 (N/m, N,
    /// N m/rad); `None` if a pad is rigid.
    #[must_use]
    pub fn pad_stiffness(&self, x_of: &Pose) -> Option<Matrix6<f64>> {
        let mut stiffness = Matrix6::zeros();
        for pad in self.pads() {
            let x_fp = x_of.inverse() * pad.x_op;
            let mut to_pad = Matrix6::zeros();
            let r_pf = x_fp.rotation.inverse().to_rotation_matrix();
            to_pad.fixed_view_mut::<3, 3>(0, 0).copy_from(r_pf.matrix());
            to_pad.fixed_view_mut::<3, 3>(3, 3).copy_from(r_pf.matrix());
            let map = to_pad * twist_map(&x_fp.translation.vector);
            stiffness += map.transpose() * Matrix6::from_diagonal(&pad.layer_stiffness()?) * map;
        }
        Some(stiffness)
    }

    /// The frame D in which the stiffness between hand and board is diagonal, in O, and that diagonal along and about its axes,
    /// N/m and N m/rad; `None` if it is rigid. Of two opposite pads of one size D is in the middle between their centres with
    /// the axes of the first, of a measured gripper at the grasp point with the axes of G.
    #[must_use]
    pub fn springs(&self) -> Option<(Pose, Vector6<f64>)> {
        match &self.hold {
            Hold::Pads(PadPair { pads, .. }) => {
                let [first, second] = pads.each_ref().map(|pad| pad.x_op);
                let middle_o = (first.translation.vector + second.translation.vector) / 2.0;
                let x_od = Pose::from_parts(middle_o.into(), first.rotation);
                Some((x_od, self.pad_stiffness(&x_od)?.diagonal()))
            }
            Hold::Measured(measured) => {
                Some((Pose::from_parts(self.grasp_point_o.into(), measured.rotation_og), measured.stiffness?))
            }
        }
    }

    /// Compliance of the pads at the grasp point, 6 x 6, O axes (m/N, rad/(N m)); `None` if a pad is rigid. NaN for a
    /// stiffness that [`ContactModel::check`](super::ContactModel::check) rejects.
    #[must_use]
    pub fn pad_compliance(&self) -> Option<Matrix6<f64>> {
        let [x, y, z] = self.grasp_point_o.into();
        let stiffness = self.pad_stiffness(&Pose::translation(x, y, z))?;
        let Some(factor) = stiffness.cholesky() else { return Some(Matrix6::repeat(f64::NAN)) };
        // As a product of L^-1 with itself the matrix is symmetric to the last bit.
        let mut half = Matrix6::identity();
        factor.l_dirty().solve_lower_triangular_mut(&mut half);
        Some(half.tr_mul(&half))
    }
}
