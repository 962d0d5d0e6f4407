//! One pad of a hand.

use nalgebra::Matrix3;

use super::patch::mean_distance_from_centre_m;
use crate::model::{frames::Pose, wrench::Wrench};

/// One pad on the object: a soft finger with a rectangular patch (docs/method.md#62-pad-limits).
///
/// With `(ft1, ft2, fn)` the force and `(mt1, mt2, mn)` the moment on the object about the pad's centre in pad axes,
/// half sides a and b and the torsion radius e: `|(ft1, ft2, mn / e)| <= mu fn` (friction and torsion), `|mt1| <= b
/// fn`, `|mt2| <= a fn` (centre of pressure).
#[derive(Clone, Debug, PartialEq)]
pub struct PadModel {
    /// Which of the hand's pads it is, such as `upper`.
    pub name: String,
    /// X_OP, P at the centre of the part of the pad that lies on the face; z_P points into the object.
    pub x_op: Pose,
    /// Half sides of that part along x_P and y_P, m.
    pub half_sides_m: [f64; 2],
    /// Coulomb friction coefficient between pad and object.
    pub friction: f64,
    /// Stiffness of that part along z_P, N/m; `None` if it is rigid (docs/method.md#612-pad-compliance).
    pub stiffness_n_m: Option<f64>,
}

impl PadModel {
    /// Torsion radius e of the patch, m: the mean distance of its points from its centre.
    pub fn torsion_radius_m(&self) -> f64 {
        mean_distance_from_centre_m(self.half_sides_m)
    }

    /// R_OP.
    pub(super) fn rotation(&self) -> Matrix3<f64> {
        self.x_op.rotation.to_rotation_matrix().into_inner()
    }

    /// A wrench on the object about O's origin in O axes, from the same wrench about the pad's centre in pad axes.
    pub fn wrench_about_object(&self, wrench_p: &Wrench) -> Wrench {
        wrench_p.moved(&self.x_op)
    }
}
