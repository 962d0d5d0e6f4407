//! Errors of writing and reading recordings.

use std::path::PathBuf;

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

    pub(super) fn encode(source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Encode(source.into())
    }
}
