//! Errors of writing and reading recordings.

use std::path::PathBuf;

use crate::input::one_line;

/// A recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The trace has an arm that the robot does not have.
    #[error("found arm \"{found}\" in the trace, expected one of {expected}")]
    UnknownArm {
        /// The arm in the trace.
        found: String,
        /// The robot's arms.
        expected: String,
    },
    /// The data cannot be encoded.
    #[error("failed to encode the recording: {0}")]
    Encode(Box<dyn std::error::Error + Send + Sync>),
    /// The file cannot be read.
    #[error("failed to read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file is not a recording of Benchdog, or is damaged.
    #[error("failed to read {}: {}", path.display(), one_line(problem))]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What was found and what was expected.
        problem: String,
    },
}

impl RecordError {
    /// True if the cause is a file and not the recorded data.
    pub fn is_about_a_file(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Invalid { .. })
    }

    pub(super) fn encode(source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Encode(source.into())
    }
}
