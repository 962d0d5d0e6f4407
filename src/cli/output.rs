//! Standard output and standard error. A closed pipe is not an error.

use std::io::{ErrorKind, Write};

use super::exit::CliError;
use crate::input::{self, printable};

/// Writes text to standard output, with control characters in it escaped.
///
/// # Errors
/// If it cannot be written for a reason other than a closed pipe.
pub fn print(text: &str) -> Result<(), CliError> {
    match std::io::stdout().lock().write_all(printable(text).as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Writes a message to standard error, with control characters in it escaped and long lines cut. A failure to do so is ignored.
pub fn message(message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", input::message(message));
}

/// A name as that of a file: letters, digits, `-`, `_` and `.`, and others as `-`.
pub fn file_stem(name: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    name.chars().map(keep).collect::<String>().trim_start_matches('.').to_owned()
}

/// A note as it is written to standard error.
pub fn note(note: &str) -> String {
    format!("note: {note}")
}

/// Writes notes to standard error.
pub fn notes(notes: &[String]) {
    notes.iter().for_each(|text| message(&note(text)));
}
