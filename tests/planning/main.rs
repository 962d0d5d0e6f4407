//! The planner, the check of its plans, and searches for several plans.

#[path = "../common/mod.rs"]
mod common;
mod referee;
#[path = "../common/serial.rs"]
mod serial;
mod shared;

mod check;
mod clearance;
mod comfort;
mod comparison;
mod infeasible;
mod kept_maps;
mod lateral;
mod many_arms;
mod muscles;
mod natural;
mod planner;
mod plans;
mod replan;
mod suction;
mod watch;
