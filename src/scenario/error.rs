//! Errors of input files.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::input::{self, one_line, shown};

/// An error of an input file.
#[derive(Debug)]
pub struct InputError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1, if known.
    pub line: Option<usize>,
    /// The key, if known, such as `grip.force_n` or `arms[0].q_rad[3]`.
    pub key: Option<String>,
    /// The kind of error.
    pub kind: InputErrorKind,
}

/// The kind of an [`InputError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputErrorKind {
    /// The file cannot be read.
    #[error("failed to read the file: {0}")]
    Read(#[from] std::io::Error),
    /// The text is not valid TOML or JSON, or has an unknown or missing key or a value of the wrong type.
    #[error("{0}")]
    Syntax(String),
    /// A value is not allowed.
    #[error("found {found}, expected {expected}")]
    Value {
        /// The value found.
        found: String,
        /// The values allowed.
        expected: String,
    },
    /// A file that the key names cannot be read.
    #[error("failed to read {}: {source}", path.display())]
    Named {
        /// The named file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The robot cannot be loaded.
    #[error(transparent)]
    Robot(#[from] crate::robot::RobotError),
}

impl InputError {
    /// An error of a file as a whole.
    pub fn file(file: &Path, kind: impl Into<InputErrorKind>) -> Self {
        Self { file: file.to_owned(), line: None, key: None, kind: kind.into() }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(&self.file.display().to_string()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(key) = &self.key {
            write!(f, ": {}", shown(key))?;
        }
        match &self.kind {
            InputErrorKind::Value { found, expected } => write!(f, ": found {}, expected {expected}", shown(found)),
            // Several faults are several lines, each of which is printable.
            InputErrorKind::Robot(error) => write!(f, ": {error}"),
            kind => write!(f, ": {}", one_line(&kind.to_string())),
        }
    }
}

impl std::error::Error for InputError {}

/// Reads a text file of at most this many bytes.
pub(super) fn read_text(path: &Path, most_bytes: u64) -> Result<String, InputError> {
    input::text(path, most_bytes).map_err(|error| InputError::file(path, error))
}
