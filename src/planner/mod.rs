//! The search for a grasp that is comfortable for the person and stable under the tool's force (docs/method.md#3-planning).
//!
//! [`Planner`] is the way in. Candidates come from two precomputed maps: what the robot can grasp (`library`) and which
//! postures suit the person; exact checks filter them (`screen`, `evaluate`); sequential quadratic programming refines
//! the rest (`refine`). A plan usually starts from `warm_starts`, solutions of similar tasks. Every plan is checked
//! ([`verify()`]) before it is returned.
//!
//! The work of a search is counted in candidates, never in time: the same scenario and seed give the same plan, bit for bit.
//! This module never sees the result of a simulation.

mod assemble;
mod assessment;
mod candidate;
pub mod comparison;
mod configurations;
mod contact;
mod domain;
mod evaluate;
mod explain;
mod front;
mod library;
mod load_shift;
mod made_once;
mod map_store;
mod natural_boards;
mod near_miss;
mod normalise;
mod one_hold;
mod outcome;
mod params;
mod place_board;
#[allow(clippy::module_inception)]
mod planner;
mod problem;
pub mod qp;
mod random;
mod refine;
mod replan;
mod scores;
mod screen;
mod search;
mod second_search;
mod select;
mod stats;
pub mod task;
mod task_family;
mod transfer;
mod verify;
mod warm_starts;
mod watch;

pub use front::{Front, FrontPoint};
pub use map_store::{MapKind, MapLabel, MapSource, MapStore, write_robot};
pub use outcome::{
    EmptyLibrary, Infeasible, MOST_FRICTION, NearMiss, Outcome, PlanError, Remedy, UnnaturalHolds, Unreliable,
};
pub use place_board::{BOARD_DRAWS, PlacedBoard, place_board};
pub use planner::{Planner, Search};
pub use replan::{Motion, Replanned, Replanning};
pub use select::differ;
pub use verify::verify;
pub use watch::{Event, Part, Phase, Progress, Watch};
