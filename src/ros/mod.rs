//! Traces as ROS 2 messages in MCAP files, which Foxglove and ROS tools read without further types, and measured wrenches from such
//! files.
//!
//! [`mod@cdr`] encodes and decodes the values of messages, `schemas` has the definitions of their types, [`trace::encode`] writes a
//! trace, [`wrench::series`] reads wrenches. All messages have the time of the simulation, or that of the measurement.

pub mod cdr;
mod messages;
mod schemas;
mod summary_order;
#[cfg(test)]
mod tests;
pub mod trace;
pub mod wrench;

/// An error in writing an MCAP file.
#[derive(Debug, thiserror::Error)]
#[error("failed to encode the trace as MCAP: {0}")]
pub struct EncodeError(#[from] mcap::McapError);
