//! The person's response to a board that a robot holds, and its comfort (docs/method.md#33-the-persons-response).
//!
//! A grasp leaves the person a set of feasible responses, Q_h: standing place, heading, roll of the tool where it is free,
//! and swivel of the arm. [`best_response`] maximises the objective over Q_h, [`mean_response`] averages over its grid. This
//! module combines the person, collisions and both metrics; grasps and their stability are the planner's.

mod best_response;
pub mod curve;
mod mean_response;
mod posture;
mod query;
mod responses;
#[cfg(test)]
mod tests;

pub use best_response::{best_response, response_near};
pub use mean_response::mean_response;
pub use posture::{posture_comfort, use_mean_response, weighted};
pub use query::{ResponseQuery, robot_points_w};
pub use responses::Response;
