//! Input files are never overwritten or removed, and what cannot be written is found out first: every command that writes files
//! calls [`protect`] before it does anything else.

use std::{
    collections::BTreeSet,
    path::{Component, Path, PathBuf},
};

use super::exit::CliError;
use crate::model::file_name::MOST_OF_FILE_SYSTEM;

/// Refuses to write to an input file, and to paths that cannot be files.
///
/// # Errors
/// As for [`Inputs::protect`].
pub fn protect(inputs: &[PathBuf], outputs: impl IntoIterator<Item = PathBuf>) -> Result<(), CliError> {
    Inputs::new(inputs).protect(outputs)
}

/// The input files of a command, whatever paths lead to them.
pub struct Inputs(BTreeSet<PathBuf>);

impl Inputs {
    /// Those of these paths that exist.
    pub fn new(paths: &[PathBuf]) -> Self {
        Self(paths.iter().filter_map(|path| path.canonicalize().ok()).collect())
    }

    /// Refuses to write to one of them, and to paths that cannot be files.
    ///
    /// # Errors
    /// If one of the outputs is an input; if it cannot be a file; or if two outputs are the same file, or one is the folder of the
    /// other.
    pub fn protect(&self, outputs: impl IntoIterator<Item = PathBuf>) -> Result<(), CliError> {
        let outputs: Vec<PathBuf> = outputs.into_iter().collect();
        // An output that does not exist yet has no canonical path, and is not an input.
        let is_input = |path: &&PathBuf| path.canonicalize().is_ok_and(|path| self.0.contains(&path));
        if let Some(path) = outputs.iter().find(is_input) {
            return Err(CliError::OverwritesInput(path.clone()));
        }
        for (place, path) in outputs.iter().enumerate() {
            let other = outputs[..place].iter().find(|other| path.starts_with(other) || other.starts_with(path));
            let problem = match other {
                Some(other) if other == path => "this command writes another file there".to_owned(),
                Some(other) => format!("this command also writes {}", other.display()),
                None => {
                    can_be_file(path)?;
                    continue;
                }
            };
            return Err(CliError::NoFile { path: path.clone(), problem });
        }
        Ok(())
    }
}

/// Requires a path that can be a file: with names that are short enough, and below folders.
fn can_be_file(path: &Path) -> Result<(), CliError> {
    let refused = |path: &Path, problem: String| Err(CliError::NoFile { path: path.to_owned(), problem });
    let lengths = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.as_encoded_bytes().len()),
        _ => None,
    });
    if let Some(length) = lengths.max().filter(|length| *length > MOST_OF_FILE_SYSTEM) {
        return refused(path, format!("found a name of {length} bytes, expected at most {MOST_OF_FILE_SYSTEM}"));
    }
    if path.is_dir() {
        return refused(path, "found a folder, expected a file".to_owned());
    }
    let mut above = path.ancestors().skip(1).filter(|above| !above.as_os_str().is_empty());
    match above.find(|above| above.exists()) {
        Some(nearest) if !nearest.is_dir() => refused(nearest, "found a file, expected a folder".to_owned()),
        _ => Ok(()),
    }
}

/// True if both paths lead to the same existing file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
