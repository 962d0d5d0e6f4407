//! The planner, the check of its plans, and searches for several plans.

mod check;
mod comfort;
mod planner;
mod plans;
