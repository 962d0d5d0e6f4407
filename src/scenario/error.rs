//! What is wrong with an input file, and where.

use std::{
    fmt,
    path::{Path, PathBuf},
};

/// An input that cannot be used: the file, and where known the line and the key.
#[derive(Debug)]
pub struct InputError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1.
    pub line: Option<usize>,
    /// The key, such as `grip.force_n` or `arms[0].q_rad[3]`.
    pub key: Option<String>,
    /// What is wrong with it.
    pub kind: InputErrorKind,
}

/// What is wrong with an input.
#[derive(Debug, thiserror::Error)]
pub enum InputErrorKind {
    /// The file cannot be read.
    #[error("failed to read the file: {0}")]
    Read(#[from] std::io::Error),
    /// The text is not TOML or JSON of the expected form.
    #[error("{0}")]
    Syntax(String),
    /// A value that makes no sense.
    #[error("found {found}, expected {expected}")]
    Value {
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
    /// The robot cannot be loaded.
    #[error(transparent)]
    Robot(#[from] crate::robot::RobotError),
}

impl InputError {
    /// An error about a file as a whole.
    pub fn file(file: &Path, kind: impl Into<InputErrorKind>) -> Self {
        Self { file: file.to_owned(), line: None, key: None, kind: kind.into() }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(key) = &self.key {
            write!(f, ": {key}")?;
        }
        write!(f, ": {}", self.kind)
    }
}

impl std::error::Error for InputError {}

/// The text of a file.
pub(super) fn read_text(path: &Path) -> Result<String, InputError> {
    std::fs::read_to_string(path).map_err(|e| InputError::file(path, e))
}
