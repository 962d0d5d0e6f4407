//! The check of a plan against its robot, person and tool (docs/method.md#34-constraints).
//!
//! [`CheckedPlan`] is built once from a plan and passed to everything that uses it: statics, simulation, export, recording and
//! the planner's own verification do not validate a plan again. Each fault is a typed [`Flaw`] that names its key. The
//! module does not know comfort, stability or files.

mod board;
pub mod bounds;
mod checked_plan;
mod flaw;
mod posture;
mod staged;
mod tolerances;

pub use board::check_plate;
pub use checked_plan::{CheckedArm, CheckedPerson, CheckedPlan, Contact, fingers_across};
pub use flaw::{Flaw, Flaws, ON_MATERIAL, off_material};
pub use staged::{PiecePlan, StagedFlaw, StagedStates, initial_plan};
pub use tolerances::{BOARD_SIDE_M, EXACT, FIGURE_TOLERANCE, GIVEN, ON_BOARD_M, POSTURE_DEG, POSTURE_M, PoseTolerance};
