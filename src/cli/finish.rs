//! What happens to a run when it is over: its files are written, and all runs together are reported.

use std::path::Path;

use super::{
    args::{Format, RecordChoice, ReportArgs},
    exit::{CliError, Exit},
    output,
    pipeline::Run,
    recording,
};
use crate::{
    model::scenario::Scenario,
    report::{self, Outcome, SkipReason},
    robot::Robot,
};

/// How one run ended: what is reported of it and what it means for the exit code.
#[derive(Debug)]
pub struct FinishedRun {
    /// What is reported.
    pub outcome: Outcome,
    /// The exit code if it were the only one.
    pub exit: Exit,
    /// How long it took, s.
    pub wall_s: Option<f64>,
}

impl FinishedRun {
    /// Runs a job to its end, whatever that is: other scenarios must not suffer from an error or a bug in this one.
    ///
    /// # Errors
    /// When a file cannot be written, which is no scenario's own matter.
    pub fn catch(name: &str, job: impl FnOnce() -> Result<Self, CliError>) -> Result<Self, CliError> {
        let (exit, message) = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(job)) {
            Ok(Ok(ended)) => return Ok(ended),
            Ok(Err(error @ CliError::Write(_))) => return Err(error),
            Ok(Err(error)) => (error.exit(), error.to_string()),
            Err(panic) => (Exit::Bug, format!("this is a bug in benchdog: {}", panic_message(&*panic))),
        };
        let outcome = Outcome::Crashed { name: name.to_owned(), message };
        Ok(Self { outcome, exit, wall_s: None })
    }

    /// A scenario that is not run.
    pub fn skipped(name: &str, reason: SkipReason) -> Self {
        let exit = if reason == SkipReason::Interrupted { Exit::Interrupted } else { Exit::Met };
        Self { outcome: Outcome::Skipped { name: name.to_owned(), reason }, exit, wall_s: None }
    }
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without a message".into())
}

/// The reports on a whole run.
const REPORTS: [&str; 4] = ["report.html", "summary.csv", "summary.json", "junit.xml"];

/// Sees that results can be written, and takes away what an earlier run left of those that this one will write: if it is
/// killed, nothing must be there that could be taken for its result.
///
/// # Errors
/// When the folder cannot be written.
pub fn prepare<'a>(args: &ReportArgs, names: impl Iterator<Item = &'a str>) -> Result<(), CliError> {
    report::file::check_folder(&args.out)?;
    for name in REPORTS {
        report::file::remove(&args.out.join(name))?;
    }
    if let Some(path) = &args.junit {
        report::file::remove(path)?;
    }
    for name in names {
        report::file::remove(&args.out.join(name).join("verdict.json"))?;
    }
    Ok(())
}

/// Writes plan, recording and, last, verdict of a run into a folder of its name.
///
/// # Errors
/// When a file cannot be written.
pub fn write_run(run: Run, scenario: &Scenario, robot: &Robot, args: &ReportArgs) -> Result<FinishedRun, CliError> {
    let folder = args.out.join(&run.verdict.name);
    let wanted = match args.record {
        RecordChoice::Never => false,
        RecordChoice::Failed => !run.verdict.met,
        RecordChoice::Always => true,
    };
    let recording = if wanted { recording::encode(&run, scenario, robot)? } else { None };
    let plan = run.plan.as_ref().map(|plan| report::json::plan(plan).into_bytes());
    let recorded = recording.is_some();
    write_or_remove(&folder.join("plan.json"), plan)?;
    write_or_remove(&folder.join("recording.rrd"), recording)?;
    write_or_remove(&folder.join("verdict.json"), Some(report::json::verdict(&run.verdict).into_bytes()))?;
    let recording = recorded.then(|| folder.join("recording.rrd"));
    Ok(FinishedRun {
        exit: Exit::of(&run.verdict),
        wall_s: None,
        outcome: Outcome::Judged {
            measures: run.simulated.map(|(_, judgement)| Box::new(judgement.measures)),
            predicted_load_factor: run.plan.and_then(|plan| plan.stability).map(|s| s.compliant_load_factor),
            verdict: Box::new(run.verdict),
            recording,
        },
    })
}

/// Writes what a run brought forth; what an earlier run left in its place is removed, lest it be taken for this one's.
fn write_or_remove(path: &Path, bytes: Option<Vec<u8>>) -> Result<(), CliError> {
    match bytes {
        Some(bytes) => report::file::write_whole(path, &bytes)?,
        None => report::file::remove(path)?,
    }
    Ok(())
}

/// The table; a single run is shown with its checks.
fn text(outcomes: &[Outcome], wall_s: &[Option<f64>]) -> String {
    let mut text = report::console::table(outcomes, wall_s);
    if let [Outcome::Judged { verdict, recording, .. }] = outcomes {
        text.push('\n');
        text.push_str(&report::console::details(verdict, recording.as_deref()));
    }
    text
}

/// All that ended, as the reports need it.
pub struct RunSummary {
    /// What became of each.
    pub outcomes: Vec<Outcome>,
    /// How long each took, s.
    pub wall_s: Vec<Option<f64>>,
    /// How the command ends.
    pub exit: Exit,
}

impl From<Vec<FinishedRun>> for RunSummary {
    fn from(ended: Vec<FinishedRun>) -> Self {
        let exit = ended.iter().map(|ended| ended.exit).max().unwrap_or(Exit::Met);
        let (outcomes, wall_s) = ended.into_iter().map(|ended| (ended.outcome, ended.wall_s)).unzip();
        Self { outcomes, wall_s, exit }
    }
}

/// Reports on standard output and in the file of `--junit`.
///
/// # Errors
/// When the report cannot be written.
pub fn report(summary: &RunSummary, args: &ReportArgs) -> Result<(), CliError> {
    match args.format {
        Format::Human => output::print(&text(&summary.outcomes, &summary.wall_s))?,
        Format::Json => output::print(&report::json::verdicts(&summary.outcomes))?,
    }
    if let Some(path) = &args.junit {
        report::file::write_whole(path, report::junit::document(&summary.outcomes)?.as_bytes())?;
    }
    Ok(())
}

/// Writes the reports on a whole run into its folder.
///
/// # Errors
/// When one cannot be written.
pub fn write_reports(outcomes: &[Outcome], out: &Path) -> Result<(), CliError> {
    let bytes = [
        report::html::page(outcomes).into_bytes(),
        report::summary::csv(outcomes)?,
        report::summary::json(outcomes).into_bytes(),
        report::junit::document(outcomes)?.into_bytes(),
    ];
    for (name, bytes) in REPORTS.iter().zip(bytes) {
        report::file::write_whole(&out.join(name), &bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_one_run_is_a_bug_with_its_message() {
        let ended = FinishedRun::catch("bad-luck", || panic!("{}", "out of cheese")).unwrap();
        assert_eq!(ended.exit, Exit::Bug);
        let Outcome::Crashed { name, message } = ended.outcome else { panic!("a panic is a crash") };
        assert_eq!((name.as_str(), message.as_str()), ("bad-luck", "this is a bug in benchdog: out of cheese"));
    }
}
