//! What a run tells its reader: a table for the console, JSON for programs, JUnit for a CI job. One file a format.
//!
//! Pure functions from outcomes to text; only [`mod@file`] touches the disk. Nothing here may change a verdict, print, or
//! look at a clock.

pub mod console;
pub mod curve;
pub mod file;
pub mod json;
pub mod junit;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use crate::model::verdict::{CheckKind, Verdict, VerdictKind};

/// What became of one scenario or plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It was planned and judged, or proved to have no plan.
    Judged {
        /// The verdict.
        verdict: Verdict,
        /// The compliant load factor that the plan predicts; none for a plan without one.
        predicted_load_factor: Option<f64>,
        /// Where the recording was written.
        recording: Option<PathBuf>,
    },
    /// It could not be judged: bad input, or a bug.
    Crashed {
        /// The scenario's name or file.
        name: String,
        /// What went wrong.
        message: String,
    },
    /// It was left out by a filter.
    Skipped {
        /// The scenario's name.
        name: String,
    },
}

impl Outcome {
    /// The scenario's or plan's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Judged { verdict, .. } => &verdict.name,
            Self::Crashed { name, .. } | Self::Skipped { name } => name,
        }
    }
}

/// What decided the verdict, in words: `deflection 16.20 mm, limit 15 mm, first crossed at 1.320 s under 0.82 of the
/// load`.
pub fn explanation(verdict: &Verdict) -> String {
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
        let unit = unit_suffix(check.name);
        format!("{} {:.2}{unit}, limit {}{unit}", check.name, check.value, check.limit)
    });
    format!("{figures}, first crossed at {:.3} s under {:.2} of the load", failure.time_s, failure.load_factor)
}

/// The unit after a space; nothing for a ratio.
fn unit_suffix(kind: CheckKind) -> String {
    match kind.unit() {
        "1" => String::new(),
        unit => format!(" {unit}"),
    }
}
