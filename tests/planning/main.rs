//! The planner, the check of its plans, and searches for several plans.

#[path = "../common/mod.rs"]
mod common;
mod referee;
mod shared;

mod check;
mod clearance;
mod comfort;
mod infeasible;
mod natural;
mod planner;
mod plans;
