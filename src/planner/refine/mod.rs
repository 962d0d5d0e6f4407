//! Local refinement: from a feasible candidate to a local optimum.
//!
//! Sequential quadratic programming with a trust region ([`sqp`]). Objective and constraints are linearised along the free
//! variables: the person's joints, heading and place, the tool's roll, each grasp along its edge, in depth and angle, and
//! each arm's redundancy; the arms' joints follow the board. A quadratic program gives the best step that satisfies all
//! linearised constraints; the step is made exact by inverse kinematics.

mod jacobian;
mod linearization;
mod repair;
mod sqp;
mod variables;

pub use repair::repair;
pub use sqp::refine;
