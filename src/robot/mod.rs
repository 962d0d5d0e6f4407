//! Robots: a URDF and a description file, read into a tree of links with arms and grippers.
//!
//! Robots are data: a URDF (kinematics, inertia, geometry) and a TOML description (arms, grippers, pads, stiffness,
//! allowed collisions, body points). No code depends on the name of a robot.

mod assemble;
pub mod bimanual;
pub mod chain;
mod description;
mod faces;
mod faults;
mod geometry;
mod holding;
pub mod inverse;
mod linkage;
mod load;
mod mesh;
mod mesh_file;
mod packages;
pub mod tree;
mod urdf;

pub use chain::Chain;
pub use faults::{Fault, Faults, RobotError};
pub use geometry::{MeshFile, PlacedShape, Shape, TriangleMesh, Visual, VisualGeometry};
pub use holding::{Holding, MeasuredGrip, PadGrip};
pub use inverse::{InverseKinematics, Solution};
pub use load::BUILTIN;
pub use mesh::{DrawnForm, DrawnPart, MeshPart};
pub use packages::Packages;
pub use tree::{
    Arm, ArmState, BodyPoint, Cup, Face, Finger, Gripper, Joint, JointKind, Link, Linkage, Mimic, Pad, Robot,
    RobotOptions, SearchBox,
};
