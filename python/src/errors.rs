//! Errors of the library as exceptions of the package.

use std::path::Path;

use benchdog::{
    pipeline::{RunError, sweep::OptionError},
    planner::PlanError,
    scenario::{InputError, InputErrorKind},
};
use pyo3::{PyErr, exceptions::PyKeyboardInterrupt, import_exception};

import_exception!(benchdog._errors, Error);
import_exception!(benchdog._errors, Infeasible);

/// Stands for the file of a dict in messages.
pub const DICT: &str = "<dict>";

/// An exception `benchdog.Error` in parts.
#[derive(Default)]
pub struct Fault {
    /// The whole message, as the command prints it.
    pub text: String,
    /// The file.
    pub file: Option<String>,
    /// The line, from 1.
    pub line: Option<usize>,
    /// The key.
    pub key: Option<String>,
    /// The value found.
    pub found: Option<String>,
    /// The values allowed.
    pub expected: Option<String>,
    /// What is wrong, without file, line and key.
    pub message: String,
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        let Fault { text, file, line, key, found, expected, message } = fault;
        Error::new_err((text, file, line, key, found, expected, message))
    }
}

/// An invalid value of an argument.
pub fn argument(key: &str, found: impl ToString, expected: impl ToString) -> PyErr {
    let (found, expected) = (found.to_string(), expected.to_string());
    let message = format!("found {found}, expected {expected}");
    let text = format!("{key}: {message}");
    Fault { text, key: Some(key.to_owned()), found: Some(found), expected: Some(expected), message, ..Fault::default() }
        .into()
}

/// An error without a place.
pub fn other(error: impl ToString) -> PyErr {
    let text = error.to_string();
    Fault { message: text.clone(), text, ..Fault::default() }.into()
}

/// An error of an input file. One of a dict has no line: that would be one of its text as TOML or JSON. Of several faults the text has
/// all, and the parts are those of the first.
pub fn input(error: InputError) -> PyErr {
    let error = if error.file == Path::new(DICT) { error.without_lines() } else { error };
    let text = error.to_string();
    let Some(first) = error.faults().first() else { return other(text) };
    let (found, expected) = match &first.kind {
        InputErrorKind::Value { found, expected } => (Some(found.clone()), Some(expected.clone())),
        _ => (None, None),
    };
    let message = first.kind.to_string();
    let file = Some(first.file.display().to_string());
    Fault { text, file, line: first.line, key: first.key.clone(), found, expected, message }.into()
}

/// An error of a search. One that was stopped is not read: the exception that stopped it is.
pub fn planning(error: PlanError) -> PyErr {
    match error {
        PlanError::Stopped => PyKeyboardInterrupt::new_err(()),
        error => other(error),
    }
}

/// An error of a simulation.
pub fn running(error: RunError) -> PyErr {
    if error.is_stop() { PyKeyboardInterrupt::new_err(()) } else { other(error) }
}

/// An option of a sweep that is not valid.
pub fn option(error: OptionError) -> PyErr {
    argument(error.name, error.found, error.expected)
}
