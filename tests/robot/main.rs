//! The robot model: description files, kinematics and dynamics against a reference, inverse kinematics, collisions.

mod chains;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/serial.rs"]
mod serial;

mod collision;
mod decomposed;
mod description;
mod inverse_kinematics;
mod mechanisms;
mod reference;
mod self_motion;
mod setup;
