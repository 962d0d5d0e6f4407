//! With what a gripper holds a board.

use nalgebra::Vector6;

use crate::model::wrench_limits::WrenchLimits;

/// With what a gripper holds a board.
#[derive(Clone, Debug, PartialEq)]
pub enum Holding {
    /// Two pads that press on the board's faces: friction and pressure limit what they hold.
    Pads(PadGrip),
    /// Whatever it is, it was measured as a whole.
    Measured(MeasuredGrip),
}

/// The pads of a gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadGrip {
    /// Maximum force of each finger, N.
    pub max_force_n: f64,
    /// Force of each finger where a scenario has none, N.
    pub grip_force_n: Option<f64>,
    /// Coulomb friction coefficient of its pads and a board where a scenario has none.
    pub friction: Option<f64>,
    /// Stiffness of one pad along its normal, N/m; `None` for rigid pads (docs/method.md#612-pad-compliance).
    pub pad_stiffness_n_m: Option<f64>,
}

/// A gripper that holds a board rigidly until the wrench leaves measured limits (docs/method.md#613-measured-grippers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredGrip {
    /// Limits of its wrench on the board about the grasp point in G axes.
    pub limits: WrenchLimits,
    /// Stiffness between hand and board along and about the axes of G through the grasp point, N/m and N m/rad; `None` if it is
    /// rigid.
    pub stiffness: Option<Vector6<f64>>,
}

impl Holding {
    /// The pads; `None` for a measured gripper.
    #[must_use]
    pub fn pads(&self) -> Option<&PadGrip> {
        match self {
            Self::Pads(pads) => Some(pads),
            Self::Measured(_) => None,
        }
    }

    /// The pads, to change them; `None` for a measured gripper.
    pub fn pads_mut(&mut self) -> Option<&mut PadGrip> {
        match self {
            Self::Pads(pads) => Some(pads),
            Self::Measured(_) => None,
        }
    }

    /// The measured limits; `None` for pads.
    #[must_use]
    pub fn measured(&self) -> Option<&MeasuredGrip> {
        match self {
            Self::Pads(_) => None,
            Self::Measured(measured) => Some(measured),
        }
    }
}
