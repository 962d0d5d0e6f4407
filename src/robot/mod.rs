//! Robots: a URDF and a description file, read into a tree of links with arms and grippers.
//!
//! Robots are data: a URDF (kinematics, inertia, primitive geometry) and a TOML description (arms, grippers, pads, stiffness,
//! allowed collisions, body points). No code depends on the name of a robot.

mod assemble;
pub mod bimanual;
pub mod chain;
mod description;
pub mod inverse;
mod load;
pub mod tree;
mod urdf;

pub use chain::Chain;
pub use inverse::{InverseKinematics, Solution};
pub use load::{BUILTIN, source_files};
pub use tree::{
    Arm, ArmState, BodyPoint, Finger, Gripper, Joint, JointKind, Link, Pad, PlacedShape, Robot, RobotError, Shape,
};
