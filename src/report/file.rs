//! Writes files atomically.

use std::{
    fs, io,
    io::Write as _,
    path::{Path, PathBuf},
};

/// A file or folder cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("failed to write {}: {source}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The cause.
    pub source: io::Error,
}

/// Writes a file atomically: to a temporary file in the same folder, which is then renamed. Creates missing folders and
/// replaces an existing file.
///
/// # Errors
/// If the file cannot be written; an existing file is then unchanged.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write(path, bytes).map_err(|source| WriteError { path: path.to_owned(), source })?;
    tracing::info!(file = %path.display(), bytes = bytes.len(), "wrote");
    Ok(())
}

/// Creates a folder and checks that files can be written to it. Called before a long computation whose results go there.
///
/// # Errors
/// If the folder cannot be created or written to.
pub fn check_folder(folder: &Path) -> Result<(), WriteError> {
    let probe = || {
        if folder.exists() && !folder.is_dir() {
            return Err(io::Error::other("found a file, expected a folder"));
        }
        fs::create_dir_all(folder)?;
        temporary().tempfile_in(folder).map(drop)
    };
    probe().map_err(|source| WriteError { path: folder.to_owned(), source })
}

/// Removes a file if it exists, so that results of an earlier run are not mistaken for those of this one.
///
/// # Errors
/// If it exists and cannot be removed.
pub fn remove(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(WriteError { path: path.to_owned(), source }),
        _ => Ok(()),
    }
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    fs::create_dir_all(directory)?;
    let mut file = temporary().tempfile_in(directory)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// A temporary file with the permissions of the user's umask. The default of the tempfile crate is readable by the owner
/// only.
#[cfg(unix)]
fn temporary() -> tempfile::Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt as _;
    let mut builder = named();
    builder.permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn temporary() -> tempfile::Builder<'static, 'static> {
    named()
}

/// True if a path is named as a temporary file is that a killed process has left.
#[must_use]
pub fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with(TEMPORARY[0]) && name.ends_with(TEMPORARY[1])
}

/// How the name of a temporary file begins and ends.
const TEMPORARY: [&str; 2] = [".benchdog-", ".part"];

/// If the process is killed, a hidden file with a telling name is left.
fn named() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]);
    builder
}
