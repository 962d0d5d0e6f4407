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
mod chunks;
mod crossings;
mod palette;
mod plots;
mod read;
mod rrd;
mod scene;
mod stored;
mod summary;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use nalgebra::Point3;
pub use read::{Peaks, RecordedPhase, RecordedRun, RecordedSummary, read_run, read_summary};
use rerun::{EntityPath, StoreId, StoreKind};

use self::chunks::Messages;
use crate::{
    model::{
        measures::{Event, Measures},
        plan::Plan,
        scenario::Scenario,
        trace::Trace,
        verdict::Verdict,
    },
    robot::Robot,
};

/// The name under which the viewer groups recordings.
const APPLICATION: &str = "benchdog";

/// The timeline of all that changes: time since the start of the simulation.
const TIMELINE: &str = "time";

/// What a recording is made of.
#[derive(Clone, Copy, Debug)]
pub struct RecordingInput<'a> {
    /// The robot of the plan.
    pub robot: &'a Robot,
    /// The scenario under which the plan was simulated.
    pub scenario: &'a Scenario,
    /// The plan that was simulated.
    pub plan: &'a Plan,
    /// What happened.
    pub trace: &'a Trace,
    /// The judge's series.
    pub measures: &'a Measures,
    /// The judge's events.
    pub events: &'a [Event],
    /// The verdict.
    pub verdict: &'a Verdict,
    /// The person in the posture of the plan; none when the plan has no person.
    pub person: Option<&'a PersonShape>,
}

/// The person as a picture needs them. They stand still: no person is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonShape {
    /// The body's parts.
    pub capsules: Vec<Capsule>,
    /// Middle of the palm that holds the tool, in W, m.
    pub palm_w: Point3<f64>,
    /// The points of the body from which the distance to the robot is measured, in W, m.
    pub points_w: Vec<Point3<f64>>,
}

/// A cylinder with round ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Centres of the round ends, in W, m.
    pub ends_w: [Point3<f64>; 2],
    /// Radius, m.
    pub radius_m: f64,
}

/// Why a recording could not be made or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The trace and the robot do not belong together.
    #[error("found arm \"{found}\" in the trace, expected one of {expected}")]
    UnknownArm {
        /// The arm of the trace.
        found: String,
        /// The robot's arms.
        expected: String,
    },
    /// The data could not be brought into rerun's format.
    #[error("failed to encode the recording: {0}")]
    Encode(Box<dyn std::error::Error + Send + Sync>),
    /// The file could not be read.
    #[error("failed to read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file is no recording of ours, or a damaged one.
    #[error("failed to read {}: {problem}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        problem: String,
    },
}

impl RecordError {
    /// True when a file is to blame and not what was to be recorded.
    pub fn is_about_a_file(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Invalid { .. })
    }

    fn encode(source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Encode(source.into())
    }
}

/// The bytes of a recording (`.rrd`) with the blueprint by which the viewer lays it out. Equal inputs give equal bytes.
///
/// # Errors
/// When the trace has an arm that the robot does not have.
pub fn encode(input: &RecordingInput) -> Result<Vec<u8>, RecordError> {
    let id = recording_id(input.verdict);
    let mut recording = Messages::new(StoreId::new(StoreKind::Recording, APPLICATION, id.as_str()));
    recording.log_static(&EntityPath::properties(), &rerun::RecordingInfo::new().with_name(&*input.verdict.name))?;
    scene::log(&mut recording, input)?;
    plots::log(&mut recording, input)?;
    summary::log(&mut recording, input)?;
    stored::log(&mut recording, input)?;
    let layout = Messages::new(StoreId::new(StoreKind::Blueprint, APPLICATION, format!("{id}-blueprint")));
    let layout = blueprint::messages(layout, input)?;
    rrd::bytes(recording.into_messages().into_iter().chain(layout))
}

/// Fixed by the verdict: recordings of equal runs are the same recording to the viewer.
fn recording_id(verdict: &Verdict) -> String {
    let fingerprint = verdict.fingerprint.get(..16).unwrap_or(&verdict.fingerprint);
    format!("{}-{fingerprint}", verdict.name)
}

/// An entity's path from its parts, whatever characters they contain.
fn entity(parts: &[&str]) -> EntityPath {
    EntityPath::new(parts.iter().map(|&part| part.into()).collect())
}
