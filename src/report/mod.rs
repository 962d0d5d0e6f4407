//! Reports of a run: console tables, an HTML page with plots, JSON and CSV for programs, JUnit for CI. One file per format.
//!
//! All functions are pure, from outcomes to text, except those of [`mod@file`], which write to the disk. Nothing here
//! changes a verdict, prints, or reads a clock. Durations are shown on the console only, so equal runs write equal files.

pub mod bodies;
pub(crate) mod columns;
pub mod compare;
pub mod comparison;
pub mod console;
pub(crate) mod csv_text;
pub mod curve;
pub mod file;
pub mod front;
pub mod hold;
pub mod html;
pub(crate) mod hull;
pub mod json;
#[cfg(feature = "cli")]
pub mod junit;
#[cfg(feature = "cli")]
pub mod maps;
pub mod muscles;
mod picture;
pub mod plans;
mod plot;
pub mod posture;
pub(crate) mod projection;
pub mod stages;
pub mod summary;
pub mod sweep;
pub mod task;
#[cfg(test)]
mod tests;
mod units;
mod xml;

use std::path::PathBuf;

use self::units::unit_suffix;
use crate::model::{
    measures::Measures,
    plan::PostureFigures,
    verdict::{Verdict, VerdictKind},
};

/// The outcome of one scenario or plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was planned and judged, or no plan was found.
    Judged {
        /// The verdict.
        verdict: Box<Verdict>,
        /// The compliant load factor that the plan predicts; `None` for a plan without a prediction.
        predicted_load_factor: Option<f64>,
        /// How the person stands and sees the work; `None` without a person.
        posture: Option<Box<PostureFigures>>,
        /// The scores of the person's posture in words; `None` for a plan without them.
        scores: Option<String>,
        /// The plan's clearance in words; `None` for a plan that does not state it.
        clearance: Option<String>,
        /// The judge's time series; `None` if nothing was simulated.
        measures: Option<Box<Measures>>,
        /// The scene as planned, or at the moment of failure; `None` without a plan.
        pictures: Option<Box<hold::HoldPictures>>,
        /// The recording's file, if one was written.
        recording: Option<PathBuf>,
    },
    /// It could not be judged, because of invalid input or a bug.
    Crashed {
        /// The scenario's name or file.
        name: String,
        /// The error message.
        message: String,
    },
    /// It was not run.
    Skipped {
        /// The scenario's name.
        name: String,
        /// The reason.
        reason: SkipReason,
    },
}

/// Why a scenario was not run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkipReason {
    /// `--filter` left it out.
    Filtered,
    /// Another scenario failed first, with `--fail-fast`.
    AfterFailure,
    /// The run was interrupted first.
    Interrupted,
}

impl std::fmt::Display for SkipReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Filtered => "left out by --filter",
            Self::AfterFailure => "not run after a failure, by --fail-fast",
            Self::Interrupted => "not finished before the interruption",
        })
    }
}

/// The kind of an outcome, by which outcomes are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Judged, with the expected verdict.
    Ok,
    /// Judged, with another verdict than expected.
    Failed,
    /// It could not be judged.
    Crashed,
    /// It was not run.
    Skipped,
}

impl Status {
    /// All values, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Ok, Self::Failed, Self::Crashed, Self::Skipped];

    /// The name in files and in the summary line of a table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Failed => "failed",
            Self::Crashed => "crashed",
            Self::Skipped => "skipped",
        }
    }

    /// The word in a table, in capitals for failures and errors.
    #[must_use]
    pub fn mark(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Failed => "FAIL",
            Self::Crashed => "ERROR",
            Self::Skipped => "skipped",
        }
    }
}

impl Outcome {
    /// The scenario's or plan's name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Judged { verdict, .. } => &verdict.name,
            Self::Crashed { name, .. } | Self::Skipped { name, .. } => name,
        }
    }

    /// The status.
    #[must_use]
    pub fn status(&self) -> Status {
        match self {
            Self::Judged { verdict, .. } if verdict.met => Status::Ok,
            Self::Judged { .. } => Status::Failed,
            Self::Crashed { .. } => Status::Crashed,
            Self::Skipped { .. } => Status::Skipped,
        }
    }

    /// The verdict, if it was judged.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        match self {
            Self::Judged { verdict, .. } => Some(verdict),
            Self::Crashed { .. } | Self::Skipped { .. } => None,
        }
    }

    /// The outcome in one line, such as `expected holds, found slips: ...`.
    #[must_use]
    pub fn sentence(&self) -> String {
        match self {
            Self::Judged { verdict, .. } if verdict.met => explanation(verdict),
            Self::Judged { verdict, .. } => {
                format!("expected {}, found {}: {}", verdict.expected, verdict.verdict, explanation(verdict))
            }
            Self::Crashed { message, .. } => message.clone(),
            Self::Skipped { reason, .. } => reason.to_string(),
        }
    }
}

/// The number of outcomes with this status.
fn number_of(outcomes: &[Outcome], status: Status) -> usize {
    outcomes.iter().filter(|outcome| outcome.status() == status).count()
}

/// The check that decided the verdict, such as `deflection 16.20 mm, limit 15 mm`, and the notes.
#[must_use]
pub fn explanation(verdict: &Verdict) -> String {
    let notes = verdict.notes.iter().map(|note| format!("; note: {note}"));
    std::iter::once(deciding(verdict)).chain(notes).collect()
}

/// The check that decided the verdict, such as `deflection 16.20 mm, limit 15 mm, first crossed at 1.320 s under 0.82 of the
/// load`.
fn deciding(verdict: &Verdict) -> String {
    if let Some(reason) = &verdict.reason {
        return reason.clone();
    }
    let Some(failure) = &verdict.first_failure else {
        return match verdict.verdict {
            VerdictKind::Holds => "every limit was kept".to_owned(),
            kind => kind.to_string(),
        };
    };
    let figures = verdict.check(failure.check).map_or(failure.check.to_string(), |check| {
        let (unit, bound) = (unit_suffix(check.name), if check.name.is_least() { "at least" } else { "limit" });
        format!("{} {:.2}{unit}, {bound} {}{unit}", check.name, check.value, check.limit)
    });
    format!("{figures}, first crossed at {:.3} s under {:.2} of the load", failure.time_s, failure.load_factor)
}
