//! The rerun recording of a run: what a reviewer opens months later to see the hold, its figures and its verdict.
//!
//! A recording never changes a verdict and never measures anything: it shows the trace and the judge's own series. The
//! bytes are a function of the input alone. For this the messages are built here with counted ids, and not by rerun's
//! `RecordingStream`, which draws ids from the clock and heeds environment variables.
//!
//! | entity | what it shows |
//! |---|---|
//! | `scene/...` | robot, board, operation, person, tool, pads and forces, in W |
//! | `plots/...` | slip, rotation, deflection, torque ratios, each beside its limit; load factor |
//! | `phases`, `events` | what happened when |
//! | `summary` | the verdict and the plan for a reader |
//! | `about`, `verdict` | the format's number and the verdict's JSON, for [`read_summary`] |
//! | `scenario`, `plan`, `trace/...` | the run itself, for [`read_run`] |
//!
//! The moment at which a limit is first crossed is marked at the same time stamp in four places: as a warning in `events`,
//! as a point on the series in `plots`, as a labelled point in the scene, and by the colour of the pads or the board
//! that crossed it.

mod blueprint;
mod crossings;
mod decode;
mod encode;
mod entity;
mod error;
mod frames;
mod input;
mod messages;
mod palette;
mod plots;
mod read;
mod rrd;
mod scene;
mod stored;
mod summary;
#[cfg(test)]
mod tests;

pub use encode::encode;
pub use error::RecordError;
pub use input::{Capsule, PersonShape, RecordingInput};
pub use read::{Peaks, RecordedPhase, RecordedRun, RecordedSummary, read_run, read_summary};
