//! The contact model of a grasp: hands, pads, weight and load as plain geometry, the input of every solver of this
//! module.

use nalgebra::Vector3;

use super::{
    hand::HandModel,
    hold::{Hold, MeasuredHold},
    pad_model::PadModel,
};
use crate::model::wrench::Wrench;

/// The largest number of hands.
pub(super) const MAX_HANDS: usize = 4;

/// A board held by one to four hands under its weight and an operation (docs/method.md#61-contact-model).
#[derive(Clone, Debug, PartialEq)]
pub struct ContactModel {
    /// The hands.
    pub hands: Vec<HandModel>,
    /// The object's weight, about O's origin in O axes.
    pub weight: Wrench,
    /// The operation's wrench at load factor 1, about O's origin in O axes.
    pub load: Wrench,
    /// The tool tip in O, m. Deflection is measured there.
    pub p_ot: Vector3<f64>,
}

/// Why a contact model is invalid. A grasp that is too weak is not an error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactModelError {
    /// Too few or too many hands.
    #[error("found {0} hands, expected 1 to {MAX_HANDS}")]
    HandCount(usize),
    /// An array whose length is not the number of joints.
    #[error("{hand} hand: found {found} entries of {what}, expected one for each of {expected} joints")]
    JointCount {
        /// The hand.
        hand: String,
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The number of joints.
        expected: usize,
    },
    /// A value outside its range, or not finite.
    #[error("{place}: found {what} {found}, expected {expected}")]
    Value {
        /// The hand or pad.
        place: String,
        /// The quantity.
        what: &'static str,
        /// Its value.
        found: f64,
        /// Its range.
        expected: &'static str,
    },
    /// A wrench, point or pose that is not finite.
    #[error("{place}: found a {what} that is not finite")]
    NotFinite {
        /// The hand, pad or object.
        place: String,
        /// The quantity.
        what: &'static str,
    },
    /// No variation of load and friction to evaluate.
    #[error("found no variations, expected at least one")]
    NoVariations,
    /// `K_q + dg/dq` is not positive definite: the joints cannot hold the arm's own weight.
    #[error("{0} hand: the joints' springs are too soft for the arm's own weight")]
    TooSoft(String),
    /// Measured limits that are not finite or do not enclose 0.
    #[error("{0} gripper: found wrench limits that do not enclose 0, expected finite ones below and above it")]
    Limits(String),
    /// No part of a pad lies on the board's face.
    #[error("{hand} {pad} pad: no part of it lies on the board")]
    PadOffBoard {
        /// The hand.
        hand: String,
        /// The pad.
        pad: String,
    },
}

impl ContactModel {
    /// Checks dimensions and ranges.
    ///
    /// # Errors
    /// The first invalid value, and where it is.
    pub fn check(&self) -> Result<(), ContactModelError> {
        if self.hands.is_empty() || self.hands.len() > MAX_HANDS {
            return Err(ContactModelError::HandCount(self.hands.len()));
        }
        let finite = [
            ("weight", self.weight.is_finite()),
            ("load", self.load.is_finite()),
            ("tool tip", self.p_ot.iter().all(|v| v.is_finite())),
        ];
        if let Some((what, _)) = finite.into_iter().find(|(_, finite)| !finite) {
            return Err(ContactModelError::NotFinite { place: "object".into(), what });
        }
        self.hands.iter().try_for_each(check_hand)
    }
}

fn check_hand(hand: &HandModel) -> Result<(), ContactModelError> {
    let expected = hand.dof();
    let lengths = [
        ("the jacobian's columns", hand.jacobian_o.ncols()),
        ("gravity torque", hand.gravity_torque_nm.len()),
        ("effort", hand.effort_nm.len()),
        ("stiffness", hand.stiffness_nm_rad.len()),
        ("gravity stiffness (rows)", hand.gravity_stiffness_nm_rad.nrows()),
        ("gravity stiffness (columns)", hand.gravity_stiffness_nm_rad.ncols()),
    ];
    if let Some((what, found)) = lengths.into_iter().find(|(_, found)| *found != expected) {
        return Err(ContactModelError::JointCount { hand: hand.name.clone(), what, found, expected });
    }
    let place = || format!("{} hand", hand.name);
    let finite = [
        ("jacobian", hand.jacobian_o.iter().all(|v| v.is_finite())),
        ("gravity torque", hand.gravity_torque_nm.iter().all(|v| v.is_finite())),
        ("gravity stiffness", hand.gravity_stiffness_nm_rad.iter().all(|v| v.is_finite())),
        ("offset", hand.offset.to_vector().iter().all(|v| v.is_finite())),
        ("grasp point", hand.grasp_point_o.iter().all(|v| v.is_finite())),
    ];
    if let Some((what, _)) = finite.into_iter().find(|(_, finite)| !finite) {
        return Err(ContactModelError::NotFinite { place: place(), what });
    }
    let positive = |what, found: f64| {
        let good = found.is_finite() && found > 0.0;
        if good {
            Ok(())
        } else {
            Err(ContactModelError::Value { place: place(), what, found, expected: "more than 0" })
        }
    };
    match &hand.hold {
        Hold::Pads(pair) => positive("grip force", pair.grip_force_n)?,
        Hold::Measured(measured) => check_measured(hand, measured)?,
    }
    hand.effort_nm.iter().try_for_each(|&effort| positive("effort", effort))?;
    hand.stiffness_nm_rad.iter().try_for_each(|&stiffness| positive("stiffness", stiffness))?;
    if hand.stiffness_factor().is_none() {
        return Err(ContactModelError::TooSoft(hand.name.clone()));
    }
    hand.pads().iter().try_for_each(|pad| check_pad(hand, pad))
}

fn check_measured(hand: &HandModel, measured: &MeasuredHold) -> Result<(), ContactModelError> {
    let place = || format!("{} gripper", hand.name);
    if !measured.rotation_og.coords.iter().all(|v| v.is_finite()) {
        return Err(ContactModelError::NotFinite { place: place(), what: "rotation" });
    }
    if !measured.limits.is_valid() {
        return Err(ContactModelError::Limits(hand.name.clone()));
    }
    let odd =
        measured.stiffness.and_then(|of| of.into_iter().copied().find(|value| !(value.is_finite() && *value > 0.0)));
    odd.map_or(Ok(()), |found| {
        Err(ContactModelError::Value { place: place(), what: "stiffness", found, expected: "more than 0" })
    })
}

fn check_pad(hand: &HandModel, pad: &PadModel) -> Result<(), ContactModelError> {
    let place = || format!("{} {} pad", hand.name, pad.name);
    let translation = pad.x_op.translation.vector;
    if !translation.iter().chain(pad.x_op.rotation.coords.iter()).all(|v| v.is_finite()) {
        return Err(ContactModelError::NotFinite { place: place(), what: "pose" });
    }
    if let Some(&found) = pad.half_sides_m.iter().find(|side| !(side.is_finite() && **side > 0.0)) {
        return Err(ContactModelError::Value { place: place(), what: "half side", found, expected: "more than 0 m" });
    }
    if !(pad.friction.is_finite() && pad.friction >= 0.0) {
        return Err(ContactModelError::Value {
            place: place(),
            what: "friction",
            found: pad.friction,
            expected: "0 or more",
        });
    }
    if let Some(found) = pad.stiffness_n_m.filter(|stiffness| !(stiffness.is_finite() && *stiffness > 0.0)) {
        return Err(ContactModelError::Value { place: place(), what: "stiffness", found, expected: "more than 0 N/m" });
    }
    Ok(())
}
