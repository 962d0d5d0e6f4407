//! Files that are written whole or not at all.

use std::{
    fs, io,
    io::Write as _,
    path::{Path, PathBuf},
};

/// Why a file or a folder could not be written.
#[derive(Debug, thiserror::Error)]
#[error("failed to write {}: {source}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The cause.
    pub source: io::Error,
}

/// Writes a file whole or not at all: beside its place under another name, then renamed. Directories that do not exist
/// are made; a file that does is replaced.
///
/// # Errors
/// When the disk refuses; the file is then as it was before.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write(path, bytes).map_err(|source| WriteError { path: path.to_owned(), source })
}

/// Makes a folder and finds out whether files can be written into it, before the work whose results go there.
///
/// # Errors
/// When the folder cannot be made or nothing can be written into it.
pub fn check_folder(folder: &Path) -> Result<(), WriteError> {
    let probe = || {
        if folder.exists() && !folder.is_dir() {
            return Err(io::Error::other("found a file, expected a folder"));
        }
        fs::create_dir_all(folder)?;
        beside().tempfile_in(folder).map(drop)
    };
    probe().map_err(|source| WriteError { path: folder.to_owned(), source })
}

/// Removes a file, if it is there: what an earlier run left must not be taken for this one's.
///
/// # Errors
/// When it is there and cannot be removed.
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
    let mut file = beside().tempfile_in(directory)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// A temporary file that becomes readable to whom the user's umask allows, as any file that a program writes; left to
/// itself the tempfile crate keeps it from all others.
#[cfg(unix)]
fn beside() -> tempfile::Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt as _;
    let mut builder = named();
    builder.permissions(fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn beside() -> tempfile::Builder<'static, 'static> {
    named()
}

/// What a killed process leaves behind is hidden and says what it is.
fn named() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".benchdog-").suffix(".part");
    builder
}
