//! Statics of a grasp under load: which multiple of a load the hands resist (docs/method.md#6-stability).
//!
//! A [`ContactModel`] is plain geometry: hands with two soft-finger pads each, on a board, at the end of compliant arms
//! with torque limits. Two load factors are computed:
//! - [`StabilityWorkspace::load_factor`], lambda*: the largest multiple of the load that *some* distribution of forces
//!   balances. It comes with the binding limits, their [`Sensitivity`] and a certificate ([`DualVector`]), and there is
//!   a variant for a set of loads and frictions, [`StabilityWorkspace::robust_load_factor`].
//! - [`StabilityWorkspace::compliant_load_factor`]: the largest multiple at which the equilibrium of the compliant arms
//!   keeps every limit.
//!
//! [`LoadCases`] are the loads with a sideways push of unknown direction; the worst of them counts.
//!
//! Both are cone programs. clarabel is used in this module alone; equilibria, which planners solve by the thousand,
//! have a faster solver of our own (`solvers::interior_point`), compared with clarabel by a test. [`LocalEquilibrium`]
//! gives the first-order effect of small changes of the contact model. This module depends neither on how a grasp was
//! found nor on its simulation. Only `from_plan` uses the robot model.
//!
//! # Accuracy
//! Ten plans of `benchdog plan` for the foam board (docs/method.md#24-board) against the simulation
//! (`tests/pinch/prediction.rs`): five points of the circle cut with 30 N, five of the grid drilled with 15 N. Deflection at
//! a tenth of the load, and the load factor at failure with the limit that ends it; the simulation's by bisection to
//! 0.1 %.
//!
//! | plan | deflection, mm | simulated | off by | load factor, ended by | simulated | off by |
//! |---|---|---|---|---|---|---|
//! | cut-01 | 0.525 | 0.525 | 0.0 % | 1.30, right hand: slip | 1.30 | -0.3 % |
//! | cut-04 | 0.534 | 0.552 | -3.2 % | 1.20, right hand: slip rotation | 1.15 | +4.1 % |
//! | cut-07 | 0.500 | 0.503 | -0.5 % | 1.31, right hand: slip | 1.31 | -0.2 % |
//! | cut-10 | 0.492 | 0.493 | -0.2 % | 1.51, right hand: slip | 1.52 | -0.9 % |
//! | cut-13 | 0.807 | 0.824 | -2.1 % | 1.44, deflection | 1.41 | +2.3 % |
//! | drill-1 | 0.178 | 0.180 | -1.1 % | 1.14, deflection | 1.16 | -1.4 % |
//! | drill-3 | 0.247 | 0.250 | -1.4 % | 1.10, deflection | 1.10 | -0.3 % |
//! | drill-5 | 0.377 | 0.379 | -0.6 % | 1.11, deflection | 1.08 | +2.3 % |
//! | drill-7 | 0.203 | 0.206 | -1.8 % | 1.16, deflection | 1.17 | -0.9 % |
//! | drill-9 | 0.124 | 0.127 | -2.3 % | 1.40, deflection | 1.41 | -0.9 % |
//!
//! The limit that ends the grasp is predicted in all ten. Sources of the larger differences:
//! - Contacts yield a little in the simulation: pads that tilt, as under a drill, by up to 2.3 %, or 0.003 mm, more than
//!   predicted.
//! - In cut-04 and cut-13 a hand turns on the board at a tenth of the load already: with welded hands the deflection
//!   would be 0.387 and 0.593 mm. How far depends on how the hands came to rest, which the statics do not model: they
//!   assume a slowly applied weight, and the simulation applies the board's weight slowly, too.
//! - Once a hand of cut-04 turns, its rotation grows fast, and with it the difference.
//!
//! The change of the arms' gravity torque with their angles (`dg/dq`) is part of the compliance; without it these load
//! factors would change by half a per cent or less.
//!
//! # Conventions
//! Wrenches are those of the hands on the object unless noted, about O's origin in O axes. A twist is a small
//! displacement: the translation of O's origin (m) and the rotation vector (rad), in O axes.

mod bending;
mod carrying;
mod certificate;
mod compliant_load;
mod contact_model;
mod elastic;
mod equilibrium;
mod from_plan;
mod hand;
mod hold;
mod infeasibility;
mod lateral;
mod limit_crossing;
mod load_factor;
mod local_equilibrium;
mod pad_layer;
mod pad_model;
mod patch;
mod prediction;
mod robust;
mod sensitivity;
mod solvers;
#[cfg(test)]
mod tests;
mod twist;
mod welded;
mod workspace;

pub use bending::{Bending, Strip, bending, bending_note};
pub use certificate::DualVector;
pub use compliant_load::CompliantLoadFactor;
pub use contact_model::{ContactModel, ContactModelError};
pub use equilibrium::{CompliantResponse, Equilibrium, EquilibriumOutcome, ResponseOutcome};
pub use hand::HandModel;
pub use hold::{HandWrench, Hold, MeasuredHold, PadPair};
pub use infeasibility::{Infeasibility, Mechanism};
pub use lateral::LoadCases;
pub use limit_crossing::LimitCrossing;
pub use load_factor::{LoadFactor, LoadFactorOutcome};
pub use local_equilibrium::LocalEquilibrium;
pub use pad_model::PadModel;
pub use patch::mean_distance_from_centre_m;
pub use prediction::{CaseAssessment, Prediction};
pub use robust::{InternalForces, RobustLoadFactor, RobustOutcome, Variation};
pub use sensitivity::{HandSensitivity, Sensitivity};
pub use solvers::cone_program::MAX_LOAD_FACTOR;
pub use twist::Twist;
pub use welded::WeldedStiffness;
pub use workspace::{AtRest, EquilibriumSolver, StabilityWorkspace};
