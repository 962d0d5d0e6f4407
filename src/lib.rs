//! Benchdog plans and verifies the cooperative manipulation of a board: a robot with one or more arms holds the board while
//! a person drills or cuts it.
//!
//! # Problem
//!
//! A forceful operation is a wrench `w` that the person's tool exerts on the board at the tool's pose `X_OT`. Benchdog
//! searches for the board's pose `X_WO`, a grasp `X_OG` and joint angles `q_r` for each arm, and the person's pose `X_WB` and
//! arm angles `q_h`, that solve
//!
//! ```text
//! maximise    w_M muscular(q_h) + w_P peripersonal(q_h, X_WB, q_r)
//! subject to  inverse kinematics and joint limits of the robot and the person
//!             clearances between robot, board and person
//!             load factor of the grasp under w >= the required one, with and without compliance of the arms
//! ```
//!
//! where the two comforts are those of Chen, Figueredo and Dogar, *Planning for Muscular and Peripersonal-Space Comfort during
//! Human-Robot Forceful Collaboration* (Humanoids 2018). It then simulates the plan, or any other plan, as rigid bodies with
//! contacts, and judges slip, deflection, creep and joint torques against limits. The method is described in
//! `docs/method.md`.
//!
//! # Data flow
//!
//! ```text
//! scenario.toml -> Operation -> planner -> Plan -> simulation -> Trace -> judge -> Verdict -> report, recording
//!                                  ^ or a plan.json from another planner
//! ```
//!
//! | module | contents |
//! |---|---|
//! | [`model`] | types that the other modules exchange |
//! | [`check`] | a plan against its robot, tool and person |
//! | [`complete`] | the joint angles of arms whose grippers' poses are given |
//! | [`scenario`] | scenario and plan files: reading, checks, defaults |
//! | [`input`] | input files up to a limit of their size, and text from them in messages |
//! | [`robot`] | the robot from a URDF and a description file: kinematics, dynamics, inverse kinematics |
//! | [`human`] | the person: body, arm, strength, muscular and peripersonal comfort |
//! | [`statics`] | load factors of a grasp, with rigid and with compliant arms |
//! | [`collision`] | distances and overlaps of robot, board, tool and person |
//! | [`comfort`] | comfort of a grasp over the person's feasible responses |
//! | [`planner`] | search for comfortable and stable grasps |
//! | [`sim`] | rigid-body simulation of a plan |
//! | [`judge`] | verdict on a trace |
//! | `record` | rerun recordings (feature `recording`) |
//! | [`pipeline`] | the verdict on a plan, its recording, the runs of a sweep: check, simulation and judge joined |
//! | [`report`] | tables, HTML, JSON, CSV, JUnit |
//! | [`reproduce`] | the paper's evaluation: operations, jobs, tables, pictures, conclusions |
//! | `cli` | the commands (feature `cli`) |
//!
//! Linear algebra types are those of [`nalgebra`], which is re-exported.
//!
//! # Features
//!
//! - `cli` (default): the command line, the binary `benchdog` and JUnit reports.
//! - `recording` (default): recordings for the rerun viewer. It is most of a cold build.
//!
//! `default-features = false` gives the library alone.
//!
//! # Examples
//!
//! Simulate a plan and judge it by the default limits for its operation:
//!
//! ```
//! use std::path::Path;
//!
//! use benchdog::{check, judge, model::verdict::VerdictKind, scenario, sim};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let (plan, robot) = scenario::read_plan(Path::new("scenarios/plans/cut-rim-weak-grip.json"), None)?;
//! let scenario = scenario::default_for_plan(&plan, &robot);
//! let checked = check::CheckedPlan::new(&robot, &plan, &scenario.human, &scenario.tool)?;
//! let trace = sim::simulate(&checked, &sim::Conditions::of(&scenario))?;
//! let judgement = judge::judge(&trace, &scenario.limits);
//! assert_eq!(judgement.verdict, VerdictKind::Slips);
//! for check in judgement.checks.iter().filter(|check| !check.passed) {
//!     println!("{}: {:.2} {}, limit {} {}", check.name, check.value, check.unit, check.limit, check.unit);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Plan a scenario, which takes some seconds:
//!
//! ```no_run
//! use std::path::Path;
//!
//! use benchdog::{planner::{Outcome, Planner}, report, scenario};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let loaded = scenario::load(Path::new("scenarios/quickstart.toml"))?;
//! match Planner::new(&loaded.robot).plan(&loaded.scenario)? {
//!     Outcome::Found(plan) => report::file::write_whole(Path::new("plan.json"), report::json::plan(&plan).as_bytes())?,
//!     Outcome::Infeasible(why) => println!("no plan: {why}"),
//! }
//! # Ok(())
//! # }
//! ```
//!
//! An error of an input file names the file, the line and the key:
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

#[cfg(feature = "cache")]
pub mod cache;
pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod collision;
pub mod comfort;
pub mod compare;
pub mod complete;
pub mod human;
pub mod input;
pub mod judge;
pub mod model;
pub mod pipeline;
pub mod planner;
#[cfg(feature = "recording")]
pub mod record;
pub mod report;
pub mod reproduce;
pub mod robot;
#[cfg(feature = "mcap")]
pub mod ros;
pub mod scenario;
pub mod setup;
pub mod sim;
pub mod statics;
pub mod sweep;

pub use nalgebra;
