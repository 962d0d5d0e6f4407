//! Input files are never overwritten or removed: every command that writes files calls [`protect`] before it does anything
//! else.

use std::path::{Path, PathBuf};

use super::exit::CliError;

/// Refuses to write to an input file.
///
/// # Errors
/// If one of the outputs is one of the inputs, whatever paths lead to it.
pub fn protect(inputs: &[PathBuf], outputs: impl IntoIterator<Item = PathBuf>) -> Result<(), CliError> {
    let inputs: Vec<_> = inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
    // An output that does not exist yet has no canonical path, and is not an input.
    let is_input = |path: &PathBuf| path.canonicalize().is_ok_and(|path| inputs.contains(&path));
    match outputs.into_iter().find(is_input) {
        Some(path) => Err(CliError::OverwritesInput(path)),
        None => Ok(()),
    }
}

/// True if both paths lead to the same existing file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
