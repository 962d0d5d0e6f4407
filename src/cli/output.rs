//! Standard output and standard error: a reader that closes early is no error.

use std::io::{ErrorKind, Write};

use super::exit::CliError;

/// Writes data to standard output.
///
/// # Errors
/// When it cannot be written for a reason other than a closed pipe.
pub fn print(text: &str) -> Result<(), CliError> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Writes a message to standard error; there is nobody to tell when that fails.
pub fn message(message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}
