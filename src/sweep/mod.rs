//! Sweeps: many runs of one plan under deviations that are drawn at random (`docs/method.md#10-sweeps`).
//!
//! This module draws and counts; it neither predicts nor simulates.

pub mod agreement;
pub mod distribution;
pub mod draw;
pub mod estimate;
pub mod indices;
pub mod info;
pub mod interval;
pub mod points;
pub mod record;
pub mod screen;
pub mod summary;
pub mod table;

pub use draw::{ArmJoints, Dimension, Drawn, Draws};

#[cfg(test)]
mod tests;
