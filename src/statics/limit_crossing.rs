//! Limits of a compliant response: torque, the wrench of measured grippers, deflection and slip.

use super::{contact_model::ContactModel, equilibrium::CompliantResponse};
use crate::model::scenario::Limits;

/// The first limit that is crossed as the load grows.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LimitCrossing {
    /// No forces within the pads' limits balance the object any more.
    NoEquilibrium {
        /// The pads' limits that bind, strongest first; empty if the weight alone cannot be held.
        binding: Vec<String>,
    },
    /// A joint torque exceeds its limit times the allowed ratio.
    Torque {
        /// The joint.
        joint: String,
    },
    /// The wrench of a measured gripper leaves its limits: it lets go.
    GripWrench {
        /// The hand.
        hand: String,
    },
    /// The tool tip deflects too far.
    Deflection,
    /// A hand slides on the board.
    Slip {
        /// The hand.
        hand: String,
    },
    /// A hand turns on the board.
    SlipRotation {
        /// The hand.
        hand: String,
    },
    /// The solver stopped early; nothing is known beyond.
    Unknown {
        /// The solver's status.
        status: String,
    },
}

impl std::fmt::Display for LimitCrossing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoEquilibrium { binding } if binding.is_empty() => f.write_str("weight: no equilibrium"),
            Self::NoEquilibrium { binding } => f.write_str(&binding.join(", ")),
            Self::Torque { joint } => write!(f, "{joint}: torque"),
            Self::GripWrench { hand } => write!(f, "{hand} gripper: wrench"),
            Self::Deflection => f.write_str("deflection"),
            Self::Slip { hand } => write!(f, "{hand} hand: slip"),
            Self::SlipRotation { hand } => write!(f, "{hand} hand: slip rotation"),
            Self::Unknown { status } => write!(f, "unknown: {status}"),
        }
    }
}

impl CompliantResponse {
    /// The largest ratio of a torque, measured wrench, deflection or slip to its limit. Creep takes time and is not included.
    #[must_use]
    pub fn utilisation(&self, model: &ContactModel, limits: &Limits) -> f64 {
        self.worst_limit(model, limits).0
    }

    /// The largest ratio of a torque, measured wrench, deflection or slip to its limit, and that limit; it is crossed if the ratio is
    /// above 1.
    #[must_use]
    pub fn worst_limit(&self, model: &ContactModel, limits: &Limits) -> (f64, LimitCrossing) {
        let (hand, joint, torque) = self.equilibrium.largest_torque_ratio(model);
        let joint = model.hands[hand].joints.get(joint).cloned().unwrap_or_default();
        let mut worst = (torque / limits.torque_ratio, LimitCrossing::Torque { joint });
        let mut consider = |ratio: f64, crossing: &dyn Fn() -> LimitCrossing| {
            if ratio > worst.0 {
                worst = (ratio, crossing());
            }
        };
        consider(self.deflection_mm() / limits.deflection_mm, &|| LimitCrossing::Deflection);
        for (hand, wrench) in model.hands.iter().zip(&self.equilibrium.hand_wrenches) {
            consider(hand.grip_ratio(wrench), &|| LimitCrossing::GripWrench { hand: hand.name.clone() });
        }
        for (hand, slip) in model.hands.iter().zip(&self.slip) {
            let name = || hand.name.clone();
            consider(slip.linear.norm() * 1e3 / limits.slip_mm, &|| LimitCrossing::Slip { hand: name() });
            let turned = slip.angular.norm().to_degrees() / limits.slip_deg;
            consider(turned, &|| LimitCrossing::SlipRotation { hand: name() });
        }
        worst
    }
}
