//! The folder of a sweep.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{arrow, journal::JOURNAL, journal::Journal};
use crate::{
    cli::{
        exit::{CliError, Exit},
        format::Format,
        interrupt, output,
        progress::Progress,
    },
    input::{self, MOST_DOCUMENT, MOST_RECORDING},
    report::{self, file::write_whole},
    sweep::{
        info::SweepInfo,
        record::RunRecord,
        summary::{SweepSummary, summarise},
        table,
    },
};

/// The runs, as text.
pub const RUNS: &str = "runs.csv";
/// The plan that was simulated.
pub const PLAN: &str = "plan.json";
/// What the sweep is and what came of it: the last file of a folder.
pub const SUMMARY: &str = "sweep.json";
/// The runs in the Arrow format.
const ARROW: &str = "runs.arrow";
const REPORT: &str = "report.html";
const JUNIT: &str = "junit.xml";
/// The recordings of the worst runs.
const RECORDINGS: &str = "recordings";

/// The folder of a sweep.
pub struct SweepFolder {
    path: PathBuf,
}

impl SweepFolder {
    /// The folder at a path.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A file of it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// All files that are written to it but recordings.
    pub fn files(&self) -> [PathBuf; 7] {
        [RUNS, ARROW, PLAN, REPORT, JUNIT, JOURNAL, SUMMARY].map(|name| self.file(name))
    }

    /// The recording of a run.
    pub fn recording(&self, index: u64) -> PathBuf {
        self.path.join(RECORDINGS).join(recording_name(index))
    }

    /// The runs that the folder has of the sweep with this key: of an unfinished one, or of a finished one with other `--runs`.
    pub fn known_runs(&self, key: &str, header: &[String]) -> Vec<RunRecord> {
        let unfinished = Journal::read(&self.path, key, header);
        if !unfinished.is_empty() {
            return unfinished;
        }
        let same = self.summary().is_some_and(|summary| summary.info.key() == key);
        let text = || input::kept(&self.file(RUNS), MOST_RECORDING).and_then(input::text_of).ok();
        table::read(&same.then(text).flatten().unwrap_or_default(), header, false).unwrap_or_default()
    }

    /// The summary of a finished sweep, if it can be read.
    fn summary(&self) -> Option<SweepSummary> {
        serde_json::from_slice(&input::kept(&self.file(SUMMARY), MOST_DOCUMENT).ok()?).ok()
    }

    /// Removes what an earlier sweep left, so that it is not mistaken for this one's.
    ///
    /// # Errors
    /// If a file cannot be removed.
    pub fn begin(&self) -> Result<(), CliError> {
        for name in [SUMMARY, JUNIT, REPORT, ARROW] {
            report::file::remove(&self.file(name))?;
        }
        Ok(())
    }

    /// Writes everything, last the summary, and prints it. `recording` gives the bytes of a run's recording.
    ///
    /// # Errors
    /// If a file cannot be written, or a recording not be made.
    pub fn write(
        &self,
        info: &SweepInfo,
        records: &[RunRecord],
        plan: &[u8],
        recording: &dyn Fn(u64) -> Result<Option<Vec<u8>>, CliError>,
        format: Format,
        progress: &Progress,
    ) -> Result<Exit, CliError> {
        let header = info.header();
        let summary = summarise(info, records);
        self.remove_recordings(&summary.worst_runs())?;
        for index in summary.worst_runs() {
            if let Some(bytes) = recording(index)? {
                write_whole(&self.recording(index), &bytes)?;
            }
        }
        let _writing = interrupt::writing();
        let recorded =
            |index: u64| self.recording(index).exists().then(|| format!("{RECORDINGS}/{}", recording_name(index)));
        write_whole(&self.file(PLAN), plan)?;
        write_whole(&self.file(RUNS), &table::rows(Some(&header), records)?)?;
        write_whole(&self.file(ARROW), &arrow::bytes(&header, records)?)?;
        write_whole(&self.file(REPORT), report::sweep::report_page(&summary, records, &recorded).as_bytes())?;
        write_whole(&self.file(JUNIT), report::sweep::junit(&summary)?.as_bytes())?;
        let json = report::json::pretty(&summary);
        write_whole(&self.file(SUMMARY), json.as_bytes())?;
        report::file::remove(&self.file(JOURNAL))?;
        progress.finish();
        match format {
            Format::Human => output::report(&report::sweep::text(&summary))?,
            Format::Json => output::print(&json)?,
        }
        Ok(if summary.is_met() { Exit::Met } else { Exit::NotMet })
    }

    /// Removes the recordings of other runs.
    fn remove_recordings(&self, wanted: &[u64]) -> Result<(), CliError> {
        let wanted: Vec<String> = wanted.iter().map(|&index| recording_name(index)).collect();
        let Ok(entries) = fs::read_dir(self.path.join(RECORDINGS)) else { return Ok(()) };
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with("run-") && name.ends_with(".rrd") && !wanted.contains(&name) {
                report::file::remove(&entry.path())?;
            }
        }
        Ok(())
    }
}

fn recording_name(index: u64) -> String {
    format!("run-{index:06}.rrd")
}
