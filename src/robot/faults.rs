//! Errors of loading a robot: all faults of its files at once.

use std::{fmt, ops::Range};

use crate::input::{did_you_mean, one_line};

/// An error of loading a robot.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// A file could not be read.
    #[error("failed to read {path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// The cause.
        source: std::io::Error,
    },
    /// Neither a built-in robot nor a file.
    #[error(
        "found robot \"{found}\", expected a built-in robot ({builtin}) or the path of a description file{}",
        hint(found, builtin)
    )]
    Unknown {
        /// The name or path.
        found: String,
        /// The built-in names.
        builtin: String,
    },
    /// A description or URDF that cannot be used.
    #[error("{0}")]
    Invalid(Faults),
}

/// What a user of an unknown robot may have meant.
fn hint(found: &str, builtin: &str) -> String {
    match found.rsplit('.').next() {
        Some("urdf") => format!("; `benchdog robot new {found} -o robot.toml` writes the description of a URDF"),
        Some("xacro") => {
            "; `xacro FILE -o robot.urdf` makes a URDF, and `benchdog robot new robot.urdf -o robot.toml` its description".to_owned()
        }
        Some("yaml" | "yml") => "; descriptions are in TOML".to_owned(),
        _ => did_you_mean(found, builtin.split(", ")),
    }
}

/// What is wrong with a robot's files, in the order of the lines; at least one fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults {
    faults: Vec<Fault>,
}

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file.
    pub file: String,
    /// The line, counted from 1, where a file has lines that matter.
    pub line: Option<usize>,
    /// The key, the link or the joint, what was found and what was expected.
    pub problem: String,
}

impl Faults {
    /// All faults.
    #[must_use]
    pub fn all(&self) -> &[Fault] {
        &self.faults
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, problem) = (one_line(&self.file), one_line(&self.problem));
        match self.line {
            Some(line) => write!(f, "{file}: line {line}: {problem}"),
            None => write!(f, "{file}: {problem}"),
        }
    }
}

/// The most faults of a list: a generated file may have thousands of the same kind.
const MOST_LISTED: usize = 100;

/// One fault as it is, several as a list.
impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let [fault] = &self.faults[..] {
            return fault.fmt(f);
        }
        write!(f, "{} faults", self.faults.len())?;
        self.faults.iter().take(MOST_LISTED).try_for_each(|fault| write!(f, "\n  {fault}"))?;
        match self.faults.len().saturating_sub(MOST_LISTED) {
            0 => Ok(()),
            more => write!(f, "\n  and {more} more"),
        }
    }
}

/// A text with the name of its file, for messages.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// A fault at a position of this text.
    pub fn fault(&self, span: Range<usize>, problem: impl Into<String>) -> Fault {
        let line = 1 + self.text.bytes().take(span.start).filter(|&byte| byte == b'\n').count();
        Fault { file: self.file.into(), line: Some(line), problem: problem.into() }
    }
}

/// Collects faults while the rest is read.
#[derive(Default)]
pub(super) struct Collector {
    faults: Vec<Fault>,
}

impl Collector {
    pub fn add(&mut self, fault: Fault) {
        self.faults.push(fault);
    }

    /// A fault of a file without lines.
    pub fn add_to(&mut self, file: &str, problem: impl Into<String>) {
        self.add(Fault { file: file.into(), line: None, problem: problem.into() });
    }

    /// The value, or `None` with the problem kept.
    pub fn keep<T>(&mut self, file: &str, result: Result<T, String>) -> Option<T> {
        result.map_err(|problem| self.add_to(file, problem)).ok()
    }

    /// Several faults of a file without lines.
    pub fn extend(&mut self, file: &str, problems: impl IntoIterator<Item = String>) {
        problems.into_iter().for_each(|problem| self.add_to(file, problem));
    }

    /// The faults of another collector.
    pub fn append(&mut self, mut other: Self) {
        self.faults.append(&mut other.faults);
    }

    /// True without faults.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// The error that has these faults.
    pub fn into_error(mut self) -> RobotError {
        // In the order of the lines; those of the URDF, which has none, come first.
        self.faults.sort_by_key(|fault| fault.line);
        RobotError::Invalid(Faults { faults: self.faults })
    }
}
