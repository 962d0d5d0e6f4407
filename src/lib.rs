//! Benchdog plans how a two-armed robot holds a board that a person drills or cuts, and proves by simulation that the
//! hold stands.
//!
//! The way of the data, one direction and no way back:
//!
//! ```text
//! scenario.toml -> Operation -> planner -> Plan -> simulation -> Trace -> judge -> Verdict -> report, recording
//!                                  ^ or a plan.json written by anyone
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | [`model`] | the vocabulary that all others share |
//! | [`scenario`] | scenario and plan files: read, checked, completed |
//! | [`robot`] | a URDF and a description: kinematics, dynamics, inverse kinematics |
//! | [`human`] | the person: body, arm, strength, both comfort metrics |
//! | [`statics`] | how much load a hold stands: the stability program and the compliant equilibrium |
//! | [`collision`] | robot, board, tool and person: who touches whom |
//! | [`comfort`] | how comfortable a hold is: over all of the person's answers to it |
//! | [`planner`] | the search for a comfortable and stable hold |
//! | [`sim`] | the rapier simulation of a hold |
//! | [`judge`] | a trace against its limits |
//! | `record` | the rerun recording of a run (feature `recording`) |
//! | [`report`] | tables, JSON, JUnit |
//! | [`cli`] | the commands: they compose all of the above |

#![warn(missing_docs)]
#![forbid(unsafe_code)]

pub mod cli;
pub mod collision;
pub mod comfort;
pub mod human;
pub mod judge;
pub mod model;
pub mod planner;
#[cfg(feature = "recording")]
pub mod record;
pub mod report;
pub mod robot;
pub mod scenario;
pub mod sim;
pub mod statics;
