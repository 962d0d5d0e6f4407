//! How much load a hold stands (METHOD section 6).
//!
//! A hold is two pads a hand, pressed on a board, at the end of arms with limited torque. Two questions are asked of it:
//! which multiple of the operation *some* distribution of forces holds ([`StabilityWorkspace::load_factor`], a best
//! case), and which multiple the arms hold with the forces that their joints' springs lead to
//! ([`StabilityWorkspace::compliant_load_factor`]).
//!
//! Both are cone programs, and clarabel is used here alone. The module must never know how a hold was found, nor what a
//! simulation made of it. Its input, a [`Hold`], is plain geometry: the robot is met in `from_plan` only.
//!
//! # Conventions
//! Wrenches are those of the hands on the object unless said otherwise; axes and origin are O's. A twist is the pair of
//! the translation of O's origin (m) and the rotation vector (rad), in O axes, small.

mod bound;
mod certificate;
mod compliance;
mod compliant_load;
mod contact;
mod equilibrium;
mod from_plan;
mod hold;
mod layout;
mod load_factor;
mod patch;
mod prediction;
mod program;
mod robust;
mod sensitivity;
mod workspace;

pub use bound::{CannotHold, LostMotion};
pub use certificate::DualVector;
pub use compliance::{Twist, WeldedHold};
pub use compliant_load::{CompliantLoadFactor, Crossing};
pub use contact::{LimitShape, PadKind, WrenchLimits};
pub use equilibrium::{CompliantResponse, Equilibrium, EquilibriumOutcome, ResponseOutcome};
pub use hold::{HandModel, Hold, HoldError, PadModel};
pub use load_factor::{LoadFactor, LoadFactorOutcome};
pub use patch::{clip_to_rectangle, mean_distance_from_centre_m};
pub use program::MAX_LOAD_FACTOR;
pub use robust::{InternalForces, RobustLoadFactor, RobustOutcome, Variation};
pub use sensitivity::{HandSensitivity, Sensitivity};
pub use workspace::StabilityWorkspace;
