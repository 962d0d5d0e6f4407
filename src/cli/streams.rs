//! `-` among the arguments: standard input in place of an input file, standard output in place of an output file.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

use super::{exit::CliError, output};
use crate::{input::STDIN, report};

/// The argument.
const DASH: &str = "-";

/// The parser of an input file's path: `-` is the standard input, which messages call `<stdin>`.
pub fn input_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().map(|path| if path == Path::new(DASH) { STDIN.into() } else { path })
}

/// True if a path is that of the standard input.
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new(STDIN)
}

/// The file of an option that writes one document, or `None` for `-`: the standard output.
pub fn file(output: &Path) -> Option<&Path> {
    Some(output).filter(|path| *path != Path::new(DASH))
}

/// Writes a document to the file of an option, or to the standard output.
///
/// # Errors
/// If it cannot be written.
pub fn write(document: &str, output: &Path) -> Result<(), CliError> {
    match file(output) {
        Some(path) => Ok(report::file::write_whole(path, document.as_bytes())?),
        None => output::print(document),
    }
}
