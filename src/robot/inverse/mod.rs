//! Inverse kinematics: the joint angles for a pose of the gripper.
//!
//! There are three solvers, chosen by the geometry of the chain: a closed form for arms whose axes intersect in pairs, one for
//! arms that decompose into position and rotation, and damped least squares for all other chains. A target that cannot be reached is an outcome, not an error.

mod branch;
mod closed_form;
mod decomposed;
mod general;
mod geometry;
mod kinematics;
mod manifold;
mod six_joints;
mod slice;
mod solution;
mod subproblems;
mod trace;

pub use branch::{Branch, BranchSample};
pub use closed_form::ClosedForm;
pub use decomposed::Decomposed;
pub use general::General;
pub use kinematics::InverseKinematics;
pub use manifold::SelfMotion;
pub use solution::{RESIDUAL_TOLERANCE, Solution};
