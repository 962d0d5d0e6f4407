//! The command line.

use std::{ffi::OsString, io::Write as _};

use pyo3::prelude::*;

/// Runs the command that these arguments say, of which the first is the program's name, and gives its exit code. Once in a process: it
/// handles Ctrl-C as the program does, and may end the process.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| {
        let exit = benchdog::cli::run_command(arguments);
        // A program's standard output is flushed at its end, that of a module is not. A closed pipe is no error.
        let _ = std::io::stdout().flush();
        exit.code()
    })
}
