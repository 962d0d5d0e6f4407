//! The robot: a URDF and a description file beside it, read into a tree of links with arms and grippers.
//!
//! Robots are data. Nothing here names one: a robot is a URDF (kinematics, inertia, primitive geometry) and a TOML
//! description (arms, grippers, pads, stiffness, allowed collisions, body points). This module knows nothing of boards,
//! persons or plans.

mod assemble;
pub mod bimanual;
pub mod chain;
mod description;
pub mod inverse;
mod posture;
pub mod tree;
mod urdf;

pub use chain::Chain;
pub use description::{BUILTIN, source_files};
pub use inverse::{InverseKinematics, Solution};
pub use tree::{
    Arm, ArmState, BodyPoint, Finger, Gripper, Joint, JointKind, Link, Pad, PlacedShape, Robot, RobotError, Shape,
};
