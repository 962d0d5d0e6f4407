//! The types that the other modules exchange, and their form in files.
//!
//! This module depends on nalgebra, serde and schemars (for the JSON Schemas) and on no other module of this crate. It
//! contains no planning, simulation or judging code.

pub mod activation_colour;
pub mod board;
pub mod board_mesh;
pub mod expectation;
pub mod file_name;
pub mod frames;
pub mod grasp;
pub mod lateral;
pub mod load;
pub mod measures;
pub mod muscle_work;
mod omitted;
pub mod operation;
mod person;
pub mod plan;
pub mod plate;
pub mod polygon;
mod pose_form;
pub mod scenario;
pub mod staged_plan;
pub mod staged_trace;
pub mod staged_verdict;
pub mod stop;
pub mod sweep;
pub mod task;
pub mod tool_part;
pub mod tool_path;
pub mod trace;
pub mod uncertainty;
pub mod verdict;
pub mod wrench;
pub mod wrench_limits;

/// The file format: the only `format` number that this version writes and reads.
pub const FORMAT: u32 = 1;

/// Gravitational acceleration in W, m/s^2.
pub const GRAVITY_W: nalgebra::Vector3<f64> = nalgebra::Vector3::new(0.0, 0.0, -9.81);
