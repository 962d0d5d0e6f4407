//! Reads the verdict, or the whole run, from a recording.

use std::{
    collections::BTreeMap,
    io,
    path::{Path, PathBuf},
};

use rerun::log::Chunk;

use super::{
    decode::{HEADER, check_header, chunks, document, json, texts, times_s},
    error::RecordError,
    plots::{FAILURE, LIMIT, NOT_JUDGED, without_time},
    stored,
    summary::{ABOUT, About},
};
use crate::{
    input::{self, MOST_RECORDING, guarded},
    model::{FORMAT, plan::Plan, scenario::Scenario, trace::Trace, verdict::Verdict},
};

/// The verdict and the main figures of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedSummary {
    /// The recorded verdict.
    pub verdict: Verdict,
    /// The largest value of each series outside releases of the load.
    pub peaks: Peaks,
    /// The phases of the simulation.
    pub phases: Vec<RecordedPhase>,
    /// Events: time, s, and text.
    pub events: Vec<(f64, String)>,
    /// Time of the last sample, s.
    pub end_s: f64,
}

/// The largest values of the series from the hand-over on, without the time in which a load is released.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Slip of each hand, mm.
    pub slip_mm: BTreeMap<String, f64>,
    /// Rotation of each hand, degrees.
    pub rotation_deg: BTreeMap<String, f64>,
    /// Deflection of the tool point, mm.
    pub deflection_mm: f64,
    /// Torque divided by its limit, for each joint.
    pub torque_ratio: BTreeMap<String, f64>,
}

/// One phase of the simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPhase {
    /// The name.
    pub name: String,
    /// Time of its first sample, s.
    pub start_s: f64,
}

/// The run in a recording, sufficient to judge it again.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedRun {
    /// The scenario under which the plan was simulated.
    pub scenario: Scenario,
    /// The plan.
    pub plan: Plan,
    /// The recorded verdict.
    pub verdict: Verdict,
    /// The trace, equal to that of the simulation bit by bit.
    pub trace: Trace,
}

/// A file with a recording of Benchdog. It is read once, since it may be a pipe.
pub struct Recording {
    path: PathBuf,
    chunks: Vec<Chunk>,
}

impl Recording {
    /// Reads a file and checks its format.
    ///
    /// # Errors
    /// As for [`read_summary`].
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let test = |header: &[u8]| check_header(header).map_err(Unread::Problem);
        let bytes = input::bytes_if(path, MOST_RECORDING, HEADER as u64, test).map_err(|unread| match unread {
            Unread::File(source) => RecordError::Read { path: path.to_owned(), source },
            Unread::Problem(problem) => RecordError::Invalid { path: path.to_owned(), problem },
        })?;
        let decoded = guarded(|| {
            let chunks = chunks(&bytes)?;
            check_format(&chunks)?;
            Ok(chunks)
        });
        let chunks = decoded.map_err(|problem| RecordError::Invalid { path: path.to_owned(), problem })?;
        Ok(Self { path: path.to_owned(), chunks })
    }

    /// The verdict and the main figures.
    ///
    /// # Errors
    /// As for [`read_summary`].
    pub fn summary(&self) -> Result<RecordedSummary, RecordError> {
        self.extract(summary)
    }

    /// The whole run.
    ///
    /// # Errors
    /// As for [`read_summary`].
    pub fn run(&self) -> Result<RecordedRun, RecordError> {
        self.extract(|chunks| {
            let (scenario, plan) = stored::scenario_and_plan(chunks)?;
            Ok(RecordedRun { scenario, plan, verdict: json(chunks, "verdict")?, trace: stored::trace(chunks)? })
        })
    }

    fn extract<T>(&self, from: impl FnOnce(&[Chunk]) -> Result<T, String>) -> Result<T, RecordError> {
        guarded(|| from(&self.chunks)).map_err(|problem| RecordError::Invalid { path: self.path.clone(), problem })
    }
}

/// Why a file was not read.
enum Unread {
    File(io::Error),
    Problem(String),
}

impl From<io::Error> for Unread {
    fn from(error: io::Error) -> Self {
        Self::File(error)
    }
}

/// Reads the run from a recording of Benchdog.
///
/// # Errors
/// As for [`read_summary`].
pub fn read_run(path: &Path) -> Result<RecordedRun, RecordError> {
    Recording::read(path)?.run()
}

/// Reads the verdict and the main figures from a recording of Benchdog.
///
/// # Errors
/// If the file cannot be read, is not a rerun recording, was written by another program or another version of the format,
/// or is truncated or damaged.
pub fn read_summary(path: &Path) -> Result<RecordedSummary, RecordError> {
    Recording::read(path)?.summary()
}

/// Checks the format version, before any data whose form depends on it.
fn check_format(chunks: &[Chunk]) -> Result<(), String> {
    let about = document(chunks, ABOUT).and_then(|json| serde_json::from_str::<About>(&json).ok());
    let own = env!("CARGO_PKG_VERSION");
    let expected = format!("expected format {FORMAT}, the only one that benchdog {own} reads");
    match about {
        Some(About { format: FORMAT, .. }) => Ok(()),
        Some(About { format, benchdog }) => {
            Err(format!("found a recording of format {format}, made by benchdog {benchdog}, {expected}"))
        }
        None => Err(format!("found a recording without a format version, {expected}")),
    }
}

fn summary(chunks: &[Chunk]) -> Result<RecordedSummary, String> {
    let verdict = json(chunks, "verdict")?;
    let phases: Vec<RecordedPhase> = texts(chunks, "phases", &rerun::StateChange::descriptor_state())
        .map(|(start_s, name)| RecordedPhase { name, start_s })
        .collect();
    Ok(RecordedSummary {
        verdict,
        peaks: peaks(chunks, &phases),
        events: texts(chunks, "events", &rerun::TextLog::descriptor_text())
            .map(|(time_s, text)| (time_s, without_time(&text)))
            .collect(),
        end_s: chunks.iter().flat_map(times_s).fold(0.0, f64::max),
        phases,
    })
}

/// The largest values of all series outside releases of the load.
fn peaks(chunks: &[Chunk], phases: &[RecordedPhase]) -> Peaks {
    let mut peaks = Peaks::default();
    for chunk in chunks {
        let parts: Vec<String> = chunk.entity_path().iter().map(|part| part.unescaped_str().to_owned()).collect();
        let [folder, plot, series] = parts.as_slice() else { continue };
        if folder != "plots" || [LIMIT, FAILURE].contains(&series.as_str()) || series.ends_with(NOT_JUDGED) {
            continue;
        }
        let Some(peak) = peak(chunk, phases) else { continue };
        let hand = || series.trim_end_matches(" hand").to_owned();
        match plot.as_str() {
            "slip" => drop(peaks.slip_mm.insert(hand(), peak)),
            "rotation" => drop(peaks.rotation_deg.insert(hand(), peak)),
            "deflection" => peaks.deflection_mm = peak,
            "torque" => drop(peaks.torque_ratio.insert(series.clone(), peak)),
            _ => {}
        }
    }
    peaks
}

/// The largest scalar of a chunk outside releases of the load; `None` in a chunk without scalars.
fn peak(chunk: &Chunk, phases: &[RecordedPhase]) -> Option<f64> {
    let is_released = |time_s: f64| {
        let phase = phases.partition_point(|phase| phase.start_s <= time_s).checked_sub(1).map(|last| &phases[last]);
        phase.is_some_and(|phase| phase.name == "release")
    };
    let component = rerun::Scalars::descriptor_scalars().component;
    let values = chunk.iter_slices::<f64>(component).map(|slice| slice.first().copied());
    times_s(chunk)
        .into_iter()
        .zip(values)
        .filter(|(time_s, _)| !is_released(*time_s))
        .filter_map(|(_, value)| value)
        .reduce(f64::max)
}
