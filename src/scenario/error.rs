//! Errors of input files.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::input::{self, meant_by, meant_by_value, one_line, shown};

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
    #[error("{0}{hint}", hint = meant_by(.0))]
    Syntax(String),
    /// A value is not allowed.
    #[error("found {found}, expected {expected}{}", meant_by_value(found, expected))]
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
    /// Several faults of one file, at least two, in the order of their lines.
    #[error("{}", in_lines(.0))]
    Several(Vec<InputError>),
}

/// The most faults that a message lists.
const MOST_LISTED: usize = 20;

/// Faults in a line each, and their number.
fn in_lines(faults: &[InputError]) -> String {
    let mut lines: Vec<String> = faults.iter().take(MOST_LISTED).map(ToString::to_string).collect();
    let file = faults.first().map(|fault| one_line(&fault.file.display().to_string())).unwrap_or_default();
    let first = if faults.len() > MOST_LISTED {
        format!(", of which the first {MOST_LISTED} are listed")
    } else {
        String::new()
    };
    lines.push(format!("{} faults in {file}{first}", faults.len()));
    lines.join("\n")
}

impl InputError {
    /// An error of a file as a whole.
    pub fn file(file: &Path, kind: impl Into<InputErrorKind>) -> Self {
        Self { file: file.to_owned(), line: None, key: None, kind: kind.into() }
    }

    /// The faults of a file as one error.
    pub(super) fn several(file: &Path, mut faults: Vec<Self>) -> Self {
        faults.sort_by_key(|fault| fault.line);
        match faults.len() {
            1 => faults.remove(0),
            _ => Self::file(file, InputErrorKind::Several(faults)),
        }
    }

    /// Its faults, at least one: an error of several ones in parts, any other one itself.
    #[must_use]
    pub fn faults(&self) -> &[Self] {
        match &self.kind {
            InputErrorKind::Several(faults) if !faults.is_empty() => faults,
            _ => std::slice::from_ref(self),
        }
    }

    /// Without lines: of a text that no user has seen they say nothing.
    #[must_use]
    pub fn without_lines(mut self) -> Self {
        self.line = None;
        if let InputErrorKind::Several(faults) = &mut self.kind {
            faults.iter_mut().for_each(|fault| fault.line = None);
        }
        self
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let InputErrorKind::Several(_) = &self.kind {
            return self.kind.fmt(f);
        }
        f.write_str(&one_line(&self.file.display().to_string()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(key) = &self.key {
            write!(f, ": {}", shown(key))?;
        }
        match &self.kind {
            InputErrorKind::Value { found, expected } => {
                write!(f, ": found {}, expected {expected}{}", shown(found), meant_by_value(found, expected))
            }
            // Several faults are several lines, each of which is printable.
            InputErrorKind::Robot(error) => write!(f, ": {error}"),
            kind => write!(f, ": {}", one_line(&kind.to_string())),
        }
    }
}

impl std::error::Error for InputError {}

/// Reads a text file of at most this many bytes that an argument names.
pub(super) fn read_text(path: &Path, most_bytes: u64) -> Result<String, InputError> {
    let bytes = input::argument(path, most_bytes).map_err(|error| InputError::file(path, error))?;
    if bytes.starts_with(RECORDING) {
        let problem =
            "found a recording, expected text; `benchdog inspect` judges recordings, `benchdog view` shows them";
        return Err(InputError::file(path, InputErrorKind::Syntax(problem.to_owned())));
    }
    input::text_of(bytes).map_err(|error| InputError::file(path, error))
}

/// The first bytes of a recording of rerun.
const RECORDING: &[u8] = b"RRF2";
