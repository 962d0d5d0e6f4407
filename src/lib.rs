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
//! | [`report`] | tables, a page with plots, JSON, CSV, JUnit |
//! | [`cli`] | the commands: they compose all of the above |
//!
//! # From a program
//! A plan of another planner, simulated and judged under a scenario's limits:
//!
//! ```
//! use std::path::Path;
//!
//! use benchdog::{judge, model::verdict::VerdictKind, scenario, sim};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (plan, robot) = scenario::read_plan(Path::new("scenarios/plans/cut-rim-weak-grip.json"), None)?;
//! let scenario = scenario::default_for_plan(&plan, &robot);
//! let trace = sim::simulate(&robot, &plan, &sim::Conditions::of(&scenario))?;
//! let judgement = judge::judge(&trace, &scenario.limits);
//! assert_eq!(judgement.verdict, VerdictKind::Slips);
//! for check in judgement.checks.iter().filter(|check| !check.passed) {
//!     println!("{}: {:.2} {}, limit {} {}", check.name, check.value, check.unit, check.limit, check.unit);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! A scenario, planned here (some seconds):
//!
//! ```no_run
//! use std::path::Path;
//!
//! use benchdog::{planner, planner::PlanOutcome, report, scenario};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let loaded = scenario::load(Path::new("scenarios/quickstart.toml"))?;
//! match planner::plan(&loaded.scenario, &loaded.robot)? {
//!     PlanOutcome::Found(plan) => report::file::write_whole(Path::new("plan.json"), report::json::plan(&plan).as_bytes())?,
//!     PlanOutcome::Infeasible(why) => println!("no plan: {why}"),
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Input that cannot be used is an error with the file, the line and the key:
//!
//! ```
//! use std::path::Path;
//!
//! let text = "format = 1\nname = \"x\"\n[operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = -1.0\n";
//! let error = benchdog::scenario::load_text(Path::new("x.toml"), text).unwrap_err();
//! assert_eq!(error.to_string(), "x.toml:6: operation.force_n: found -1, expected a positive number (N)");
//! ```

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
