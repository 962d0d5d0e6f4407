//! What a hand holds the board with, and the wrench that it exerts.

use nalgebra::{Matrix6, UnitQuaternion, Vector6};

use super::pad_model::PadModel;
use crate::model::{wrench::Wrench, wrench_limits::WrenchLimits};

/// What a hand holds the board with.
#[derive(Clone, Debug, PartialEq)]
pub enum Hold {
    /// Two pads that press on its faces.
    Pads(PadPair),
    /// A gripper that was measured as a whole: rigid, or elastic with a given stiffness, within measured limits
    /// (docs/method.md#613-measured-grippers).
    Measured(MeasuredHold),
}

/// Two pads whose fingers are coupled.
#[derive(Clone, Debug, PartialEq)]
pub struct PadPair {
    /// The pads.
    pub pads: [PadModel; 2],
    /// Force F that pushes each finger, N. The two normal forces add up to 2 F.
    pub grip_force_n: f64,
}

/// A gripper with measured limits.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredHold {
    /// R_OG: the axes of the limits and of the stiffness.
    pub rotation_og: UnitQuaternion<f64>,
    /// Limits of the wrench on the object about the grasp point in G axes.
    pub limits: WrenchLimits,
    /// Stiffness along and about the axes of G through the grasp point, N/m and N m/rad; `None` if it is rigid.
    pub stiffness: Option<Vector6<f64>>,
}

impl MeasuredHold {
    /// A wrench about the grasp point in G axes, from O axes.
    #[must_use]
    pub fn in_g(&self, wrench_o: &Wrench) -> Wrench {
        let back = self.rotation_og.inverse();
        Wrench::new(back * wrench_o.force_n, back * wrench_o.moment_nm)
    }

    /// Compliance between hand and board at the grasp point, 6 x 6, O axes (m/N, rad/(N m)); `None` if it is rigid.
    pub(super) fn compliance(&self) -> Option<Matrix6<f64>> {
        let stiffness = self.stiffness?;
        let rotation = self.rotation_og.to_rotation_matrix();
        let mut turn = Matrix6::zeros();
        turn.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation.matrix());
        turn.fixed_view_mut::<3, 3>(3, 3).copy_from(rotation.matrix());
        // As a product of a matrix with itself it is symmetric to the last bit.
        let half = turn * Matrix6::from_diagonal(&stiffness.map(|stiffness| 1.0 / stiffness.sqrt()));
        Some(half * half.transpose())
    }
}

/// The wrench of a hand on the object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandWrench {
    /// Of each of its pads, about the pad's centre in pad axes.
    Pads([Wrench; 2]),
    /// Of a measured gripper, about the grasp point in O axes.
    Measured(Wrench),
}

impl HandWrench {
    /// Those of the pads; none of a measured gripper.
    #[must_use]
    pub fn of_pads(&self) -> &[Wrench] {
        match self {
            Self::Pads(pads) => pads,
            Self::Measured(_) => &[],
        }
    }
}
