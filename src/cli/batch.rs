//! Several runs of one command in parallel: each is timed and shown, a panic ends that run alone, and an error that affects all, such as a
//! full disk, ends the batch.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use super::{
    exit::{CliError, Exit},
    finish::{FinishedRun, RunSummary},
    interrupt,
    progress::Progress,
};
use crate::report::{Outcome, SkipReason};

/// What the runs of a batch share.
pub struct Batch {
    progress: Arc<Progress>,
    /// True if no run begins after one whose expectation was not met.
    fail_fast: bool,
    /// True after an expectation was not met.
    failed: AtomicBool,
    /// The first error that affects all runs.
    fatal: Mutex<Option<CliError>>,
}

impl Batch {
    /// A batch of this many runs.
    pub fn new(progress: Arc<Progress>, runs: usize, fail_fast: bool) -> Self {
        progress.expect(runs);
        progress.keep();
        Self { progress, fail_fast, failed: AtomicBool::new(false), fatal: Mutex::new(None) }
    }

    /// Where the runs are shown.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Does a run, unless the batch is to end.
    pub fn run(&self, name: &str, work: impl FnOnce() -> Result<FinishedRun, CliError>) -> FinishedRun {
        if let Some(reason) = self.reason_to_skip() {
            return FinishedRun::skipped(name, reason);
        }
        self.progress.begins(name);
        let start = Instant::now();
        let mut finished = match FinishedRun::catch(name, work) {
            Ok(finished) => finished,
            Err(error) => {
                self.fatal.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                return FinishedRun::skipped(name, SkipReason::AfterFailure);
            }
        };
        let wall_s = start.elapsed().as_secs_f64();
        finished.wall_s = Some(wall_s);
        self.failed.fetch_or(finished.exit != Exit::Met, Ordering::SeqCst);
        match finished.outcome {
            Outcome::Skipped { .. } => self.progress.advances(None),
            _ => self.progress.ends(&finished.outcome, wall_s),
        }
        finished
    }

    fn reason_to_skip(&self) -> Option<SkipReason> {
        let fatal = || self.fatal.lock().unwrap_or_else(PoisonError::into_inner).is_some();
        if interrupt::requested() {
            Some(SkipReason::Interrupted)
        } else if fatal() || self.fail_fast && self.failed.load(Ordering::SeqCst) {
            Some(SkipReason::AfterFailure)
        } else {
            None
        }
    }

    /// The summary of the runs.
    ///
    /// # Errors
    /// The error that ended the batch.
    pub fn end(self, finished: Vec<FinishedRun>) -> Result<RunSummary, CliError> {
        self.progress.finish();
        match self.fatal.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(RunSummary::from(finished)),
        }
    }
}
