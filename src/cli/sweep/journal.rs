//! The journal of a sweep: what is finished is kept in it, and an interrupted sweep goes on from it.

use std::{
    fs::{File, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
};

use crate::{
    cli::exit::CliError,
    input::{self, MOST_RECORDING},
    report::file::WriteError,
    sweep::{record::RunRecord, table},
};

/// The name of the journal in the folder of a sweep.
pub const JOURNAL: &str = "runs.part";

/// The finished runs of a sweep that is not finished: the fingerprint of the sweep in the first line, then the table.
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// The runs of an unfinished sweep in a folder; none without a journal, or with that of another sweep.
    pub fn read(folder: &Path, fingerprint: &str, header: &[String]) -> Vec<RunRecord> {
        let Ok(text) = input::kept(&folder.join(JOURNAL), MOST_RECORDING).and_then(input::text_of) else {
            return Vec::new();
        };
        let Some((first, rows)) = text.split_once('\n') else { return Vec::new() };
        if first != fingerprint {
            return Vec::new();
        }
        table::read(rows, header, true).unwrap_or_default()
    }

    /// Begins a journal with the runs that are known.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn begin(folder: &Path, fingerprint: &str, header: &[String], known: &[RunRecord]) -> Result<Self, CliError> {
        let path = folder.join(JOURNAL);
        let rows = table::rows(Some(header), known)?;
        crate::report::file::write_whole(&path, &[format!("{fingerprint}\n").as_bytes(), &rows].concat())?;
        let file = OpenOptions::new().append(true).open(&path);
        let file = file.map_err(|source| WriteError { path: path.clone(), source })?;
        Ok(Self { path, file })
    }

    /// Adds finished runs.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn add(&mut self, records: &[RunRecord]) -> Result<(), CliError> {
        let rows = table::rows(None, records)?;
        let written = self.file.write_all(&rows).and_then(|()| self.file.sync_data());
        written.map_err(|source| CliError::Write(WriteError { path: self.path.clone(), source }))
    }
}
