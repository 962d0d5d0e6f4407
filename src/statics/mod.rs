//! How much load a hold stands (METHOD section 6).
//!
//! A hold is two pads a hand, pressed on a board, at the end of arms with limited torque. Two questions are asked of it:
//! which multiple of the operation *some* distribution of forces holds ([`StabilityWorkspace::load_factor`], a best
//! case), and which multiple the arms hold with the forces that their joints' springs lead to
//! ([`StabilityWorkspace::compliant_load_factor`]). The first comes with what limits it, what would help
//! ([`Sensitivity`]) and a proof ([`DualVector`]), and can be asked for of several loads and frictions at once
//! ([`StabilityWorkspace::robust_load_factor`]).
//!
//! Both are cone programs, and clarabel is used here alone; equilibria that are asked for by the thousand have a quicker
//! solver of their own (`interior_point`), held to clarabel by a test. What a small change of a hold does to them is
//! [`LocalEquilibrium`]. The module must never know how a hold was found, nor what a
//! simulation made of it. Its input, a [`ContactModel`], is plain geometry: the robot is met in `from_plan` only.
//!
//! # Accuracy
//! Ten plans of `benchdog plan` for the foam board of METHOD section 2, against the simulation (`tests/prediction.rs`):
//! five points of the circle cut with 30 N, five of the grid drilled with 15 N. Deflection at a tenth of the load, and
//! the load factor at failure with the limit that ends it; the simulation's by bisection to 0.1 %.
//!
//! | plan | deflection, mm | simulated | off by | load factor, ended by | simulated | off by |
//! |---|---|---|---|---|---|---|
//! | cut-01 | 0.525 | 0.527 | -0.3 % | 1.30, right hand: slip | 1.29 | +0.4 % |
//! | cut-04 | 0.534 | 0.533 | +0.2 % | 1.20, right hand: slip rotation | 1.15 | +3.8 % |
//! | cut-07 | 0.500 | 0.505 | -1.0 % | 1.31, right hand: slip | 1.31 | -0.4 % |
//! | cut-10 | 0.492 | 0.494 | -0.3 % | 1.51, right hand: slip | 1.53 | -1.1 % |
//! | cut-13 | 0.807 | 0.793 | +1.7 % | 1.44, deflection | 1.41 | +1.9 % |
//! | drill-1 | 0.178 | 0.181 | -1.9 % | 1.14, deflection | 1.16 | -1.8 % |
//! | drill-3 | 0.247 | 0.256 | -3.6 % | 1.10, deflection | 1.11 | -0.6 % |
//! | drill-5 | 0.377 | 0.381 | -1.1 % | 1.11, deflection | 1.08 | +2.0 % |
//! | drill-7 | 0.203 | 0.211 | -4.0 % | 1.16, deflection | 1.17 | -1.1 % |
//! | drill-9 | 0.124 | 0.131 | -4.9 % | 1.40, deflection | 1.42 | -1.4 % |
//!
//! Which limit ends the hold is predicted in all ten. What lies behind the larger differences:
//! - Light boards sit softly in the simulation's contacts: pads that tilt, as under a drill, give way by up to 5 %, or
//!   0.006 mm, more than predicted.
//! - In cut-04 and cut-13 a hand turns on the board already under a tenth of the load: with welded hands the deflection
//!   would be 0.387 and 0.593 mm. How far depends on how the hands came to rest, of which the statics know nothing: here
//!   they are loaded gently, and so they are in the simulation, which hands the board's weight over slowly.
//! - Once a hand of cut-04 turns, its rotation grows fast, and with it the difference between the two.
//!
//! How gravity on the arms changes with their angles (`dg/dq`) is part of the compliance; without it these load factors
//! would differ by half a per cent or less.
//!
//! # Conventions
//! Wrenches are those of the hands on the object unless said otherwise; axes and origin are O's. A twist is the pair of
//! the translation of O's origin (m) and the rotation vector (rad), in O axes, small.

mod certificate;
mod compliance;
mod compliant_load;
mod contact_model;
mod elastic;
mod equilibrium;
mod from_plan;
mod infeasibility;
mod interior_point;
mod layout;
mod load_factor;
mod local_equilibrium;
mod pad_cone;
mod patch;
mod prediction;
mod program;
mod robust;
mod sensitivity;
mod workspace;

pub use certificate::DualVector;
pub use compliance::{Twist, WeldedStiffness};
pub use compliant_load::{CompliantLoadFactor, LimitCrossing};
pub use contact_model::{ContactModel, ContactModelError, HandModel, PadModel};
pub use equilibrium::{CompliantResponse, Equilibrium, EquilibriumOutcome, ResponseOutcome};
pub use infeasibility::{Infeasibility, Mechanism};
pub use load_factor::{LoadFactor, LoadFactorOutcome};
pub use local_equilibrium::LocalEquilibrium;
pub use patch::{clip_to_rectangle, mean_distance_from_centre_m};
pub use program::MAX_LOAD_FACTOR;
pub use robust::{InternalForces, RobustLoadFactor, RobustOutcome, Variation};
pub use sensitivity::{HandSensitivity, Sensitivity};
pub use workspace::StabilityWorkspace;
