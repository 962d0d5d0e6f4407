//! The rerun recording of a run: scene, plots, events and verdict for the viewer, and the whole trace.
//!
//! A recording shows the trace and the judge's time series; it computes no measures and never changes a verdict. Equal
//! inputs give equal bytes. Therefore messages are built here with sequential ids, not by rerun's `RecordingStream`, which
//! takes ids from the clock and reads environment variables.
//!
//! | entity | content |
//! |---|---|
//! | `scene/...` | robot, board, operation, tool, pads and forces, in W |
//! | `scene/person/...` | body, eyes, line of sight, the sector in front of the person, in W |
//! | `scene/person/muscles/...` | the muscles of the working arm by region, coloured by activation |
//! | `muscles/...` | chart of the busiest muscles |
//! | `plots/...` | slip, rotation, deflection, torque ratios, each with its limit; load factor |
//! | `phases`, `events` | phases of the simulation; limits crossed and other events |
//! | `summary` | verdict and plan as Markdown |
//! | `about`, `verdict` | format version and verdict as JSON, read by [`read_summary`] |
//! | `scenario`, `plan`, `trace/...` | scenario, plan and trace, read by [`read_run`] |
//!
//! The first crossing of a limit is marked at its time in four places: a warning in `events`, a point on the series in
//! `plots`, a labelled point in the scene, and the colour of the pads or the board.

mod blueprint;
mod camera;
mod crossings;
mod decode;
mod encode;
mod entity;
mod error;
mod frames;
mod input;
mod lengths;
mod messages;
mod muscles;
mod palette;
mod person;
mod plate;
mod plots;
mod poses;
mod posture;
mod read;
mod robot;
mod rrd;
mod scene;
mod stored;
mod summary;
#[cfg(test)]
mod tests;

pub use encode::encode;
pub use error::RecordError;
pub use input::{Capsule, PersonShape, RecordingInput};
pub use posture::encode_posture;
pub use read::{Peaks, RecordedPhase, RecordedRun, RecordedSummary, Recording, read_run, read_summary};
