//! The vocabulary: what the parts of Benchdog say to each other, and how it is written to files.
//!
//! Every other module speaks in these types and none of them knows another module's internals, so this one must never
//! know how a plan is found, simulated or judged. It uses nalgebra, serde and schemars (for the JSON Schemas), and
//! nothing of ours.

pub mod frames;
pub mod grasp;
pub mod load;
pub mod measures;
pub mod operation;
pub mod plan;
pub mod scenario;
pub mod trace;
pub mod verdict;
pub mod wrench;

/// The `format` number that this build writes, and the only one that it reads.
pub const FORMAT: u32 = 1;

/// Standard gravity's direction and size in the world frame W, m/s^2.
pub const GRAVITY_W: nalgebra::Vector3<f64> = nalgebra::Vector3::new(0.0, 0.0, -9.81);
