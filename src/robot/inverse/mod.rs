//! Inverse kinematics: the joint angles for a pose of the gripper.
//!
//! There are two solvers: a closed form for arms whose axes intersect in pairs, chosen by the geometry of the chain, and damped
//! least squares for all other chains. A target that cannot be reached is an outcome, not an error.

mod branch;
mod closed_form;
mod general;
mod geometry;
mod kinematics;
mod manifold;
mod slice;
mod solution;
mod trace;

pub use branch::{Branch, BranchSample};
pub use closed_form::ClosedForm;
pub use general::General;
pub use kinematics::InverseKinematics;
pub use manifold::SelfMotion;
pub use solution::{RESIDUAL_TOLERANCE, Solution};
