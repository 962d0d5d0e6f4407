//! Derivatives of the load factor by grip force, friction and torque limits.
//!
//! At the optimum of `min q'x, A x + s = b, s in K` with dual z, the derivative of the value by a parameter p of `A`
//! and `b` is `z'(dA/dp x - db/dp)` (envelope theorem), and `q'x = -lambda*`. Each parameter here appears in one or two
//! rows.

use nalgebra::DVector;

use super::{
    contact_model::ContactModel,
    hand::HandModel,
    solvers::{
        clarabel::RawSolution,
        cone_program::ConeProgram,
        layout::{HandLayout, HoldLayout, LimitLayout, PadLayout},
        units::FORCE_UNIT_N,
    },
};
use crate::model::wrench_limits::COMPONENTS;

/// Derivatives of the load factor lambda*. At a kink of lambda* they are between the derivatives of either side; at the
/// cap of 100 all are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The derivatives of each hand.
    pub hands: Vec<HandSensitivity>,
}

/// Derivatives of the load factor by the limits of one hand; nonnegative up to the solver's tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct HandSensitivity {
    /// `d lambda*/d F` by the grip force of each finger, 1/N; 0 for a measured gripper.
    pub per_grip_force_n: f64,
    /// `d lambda*/d mu` by the friction of each pad; 0 for a measured gripper.
    pub per_friction: [f64; 2],
    /// `d lambda*/d ln s` by a factor s of all limits of a measured gripper; 0 for pads.
    pub per_measured_limits: f64,
    /// `d lambda*/d tau_max` by the torque limit of each joint, n, 1/(N m).
    pub per_effort_nm: DVector<f64>,
}

/// The derivatives at a solution of the load program.
pub(super) fn of(model: &ContactModel, program: &ConeProgram, raw: &RawSolution<'_>) -> Sensitivity {
    let of_hand = |(hand, place): (&HandModel, &HandLayout)| {
        let none = HandSensitivity {
            per_grip_force_n: 0.0,
            per_friction: [0.0; 2],
            per_measured_limits: 0.0,
            per_effort_nm: of_efforts(hand, place, program, raw),
        };
        match &place.hold {
            HoldLayout::Pads(pair) => HandSensitivity {
                // The row is fn_1 + fn_2 = 2 F.
                per_grip_force_n: 2.0 * raw.z[pair.grip_row] / FORCE_UNIT_N,
                per_friction: pair.pads.each_ref().map(|pad| of_friction(pad, raw)),
                ..none
            },
            HoldLayout::Measured(limits) => {
                HandSensitivity { per_measured_limits: limit_terms(limits, raw).map(|(term, _)| term).sum(), ..none }
            }
            HoldLayout::Free => none,
        }
    };
    Sensitivity { hands: model.hands.iter().zip(program.layout.hands()).map(of_hand).collect() }
}

/// `d lambda* / d ln(limit)` of measured limits: of each component of a box, of all limits of an ellipsoid together. The rows
/// are divided by the limits, so the multipliers are the terms.
pub(super) fn limit_terms(limits: &LimitLayout, raw: &RawSolution<'_>) -> impl Iterator<Item = (f64, &'static str)> {
    let of_box = |component: usize| raw.z[limits.rows + component] + raw.z[limits.rows + 6 + component];
    let terms = match &limits.shares {
        Some(shares) => vec![(raw.z[shares.cone_rows], "wrench")],
        None => COMPONENTS.into_iter().enumerate().map(|(component, name)| (of_box(component), name)).collect(),
    };
    terms.into_iter()
}

/// mu is the coefficient of the normal force in the first row of the friction cone: `fn z_0`.
fn of_friction(place: &PadLayout, raw: &RawSolution<'_>) -> f64 {
    raw.x[place.variables + 2] * raw.z[place.friction_rows]
}

/// The torque rows are divided by tau_max: `(z+ + z-) / tau_max`.
fn of_efforts(hand: &HandModel, place: &HandLayout, program: &ConeProgram, raw: &RawSolution<'_>) -> DVector<f64> {
    DVector::from_fn(hand.dof(), |joint, _| {
        if !program.layout.has_torque_rows() {
            return 0.0;
        }
        let row = place.torque_rows + joint;
        (raw.z[row] + raw.z[row + hand.dof()]) / hand.effort_nm[joint]
    })
}
