//! Runs a sweep in blocks. What is finished is kept in a journal, from which an interrupted sweep goes on.

use std::{
    collections::BTreeSet,
    fs::{self, File, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
};

use super::study::Study;
use crate::{
    cli::{exit::CliError, progress::Progress, threads},
    model::stop::Stop as _,
    report::file::WriteError,
    sweep::{record::RunRecord, table},
};

/// The runs after which the journal is written: some seconds.
const BLOCK: usize = 20;

/// The runs, in blocks, after which the width of the interval is looked at.
const BLOCKS_LOOKED_AT: usize = 5;

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
        let Ok(text) = fs::read_to_string(folder.join(JOURNAL)) else { return Vec::new() };
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

    fn add(&mut self, records: &[RunRecord]) -> Result<(), CliError> {
        let rows = table::rows(None, records)?;
        let written = self.file.write_all(&rows).and_then(|()| self.file.sync_data());
        written.map_err(|source| CliError::Write(WriteError { path: self.path.clone(), source }))
    }
}

/// Which runs there are, and when there are enough.
pub struct Extent<'a> {
    /// The indices, in increasing order.
    pub indices: Vec<u64>,
    /// True if the first runs are enough; asked after every fifth block.
    pub enough: &'a dyn Fn(&[RunRecord]) -> bool,
}

/// Runs what is not yet known. Returns the runs in the order of their indices; fewer after Ctrl-C, and if the first ones are
/// enough.
///
/// # Errors
/// If a simulation cannot be set up, or the journal cannot be written.
pub fn run(
    study: &Study<'_>,
    extent: &Extent<'_>,
    known: Vec<RunRecord>,
    journal: &mut Journal,
    progress: &Progress,
) -> Result<Vec<RunRecord>, CliError> {
    let wanted: BTreeSet<u64> = extent.indices.iter().copied().collect();
    let mut known: Vec<_> = known.into_iter().filter(|record| wanted.contains(&record.index)).collect();
    known.sort_unstable_by_key(|record| record.index);
    known.dedup_by_key(|record| record.index);
    let mut records: Vec<RunRecord> = Vec::with_capacity(extent.indices.len());
    let mut known = known.into_iter().peekable();
    for (number, block) in extent.indices.chunks(BLOCK).enumerate() {
        let mut from_journal = Vec::new();
        while let Some(record) = known.next_if(|record| block.last().is_some_and(|&last| record.index <= last)) {
            from_journal.push(record);
        }
        let has = |index: &u64| from_journal.iter().any(|record| record.index == *index);
        let missing: Vec<u64> = block.iter().copied().filter(|index| !has(index)).collect();
        let new = threads::map_in_parallel(&missing, |&index| {
            let record = study.run(index, progress);
            progress.advances(None);
            record
        });
        // After Ctrl-C the runs of this block that were finished are kept.
        let stopped = progress.is_stopped();
        let new: Vec<_> = new.into_iter().filter(|run| !(stopped && run.is_err())).collect::<Result<_, CliError>>()?;
        journal.add(&new)?;
        (0..from_journal.len()).for_each(|_| progress.advances(None));
        let before = records.len();
        records.extend(from_journal);
        records.extend(new);
        records[before..].sort_unstable_by_key(|record| record.index);
        if stopped || (number + 1).is_multiple_of(BLOCKS_LOOKED_AT) && (extent.enough)(&records) {
            break;
        }
    }
    Ok(records)
}
