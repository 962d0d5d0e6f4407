//! Writes the files of finished runs and reports on them.

use std::{
    collections::BTreeMap,
    io::ErrorKind,
    path::{Path, PathBuf},
};

use super::{
    args::ReportArgs,
    exit::{CliError, Exit},
    format::Format,
    inputs::{Inputs, is_same_file},
    output,
};
use crate::{
    input::{self, MOST_DOCUMENT},
    model::{file_name::REPORTS, plan::Plan, scenario::Scenario},
    pipeline::{Run, mcap, recording},
    report::{
        self, Outcome, SkipReason,
        hold::{HoldPictures, Holding, SimulatedHold},
    },
    robot::Robot,
};

/// One finished, failed or skipped run.
#[derive(Debug)]
pub struct FinishedRun {
    /// The outcome for reports.
    pub outcome: Outcome,
    /// The command's result if this were its only run.
    pub exit: Exit,
    /// Duration, s.
    pub wall_s: Option<f64>,
}

impl FinishedRun {
    /// Runs a job and turns its errors and panics into an outcome, so that they do not affect other scenarios.
    ///
    /// # Errors
    /// If a file cannot be written: this affects all scenarios.
    pub fn catch(name: &str, job: impl FnOnce() -> Result<Self, CliError>) -> Result<Self, CliError> {
        let (exit, message) = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(job)) {
            Ok(Ok(ended)) => return Ok(ended),
            Ok(Err(error @ CliError::Write(_))) => return Err(error),
            Ok(Err(error)) if error.is_stop() => return Ok(Self::skipped(name, SkipReason::Interrupted)),
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

/// The files of a run.
struct RunFiles {
    plan: PathBuf,
    recording: PathBuf,
    mcap: PathBuf,
    verdict: PathBuf,
}

impl RunFiles {
    /// The files of a run in its folder.
    fn new(folder: &Path) -> Self {
        Self {
            plan: folder.join("plan.json"),
            recording: folder.join("recording.rrd"),
            mcap: folder.join("trace.mcap"),
            verdict: folder.join("verdict.json"),
        }
    }
}

/// Refuses to overwrite input files with those of a run. The plan that is simulated may be in the place of its own copy:
/// `plan_file` is where it was read from.
///
/// # Errors
/// If a file of the run is one of the inputs.
pub fn protect(args: &ReportArgs, folder: &Path, plan_file: Option<&Path>, inputs: &Inputs) -> Result<(), CliError> {
    let RunFiles { plan, recording, mcap, verdict } = RunFiles::new(folder);
    let is_own = plan_file.is_some_and(|file| is_same_file(file, &plan));
    let outputs = [recording, mcap, verdict].into_iter().chain((!is_own).then_some(plan)).chain(args.junit.clone());
    inputs.protect(outputs)
}

/// Refuses to overwrite input files with the reports on all runs.
///
/// # Errors
/// If a report is one of the inputs.
pub fn protect_from_reports(args: &ReportArgs, inputs: &Inputs) -> Result<(), CliError> {
    inputs.protect(REPORTS.map(|name| args.out.of_all().join(name)))
}

/// Refuses a template of `--out` with which two scenarios would have one folder.
///
/// # Errors
/// If two folders are the same.
pub fn folders_differ<'a>(folders: impl IntoIterator<Item = (&'a str, &'a Path)>) -> Result<(), CliError> {
    let mut names = BTreeMap::new();
    for (name, folder) in folders {
        if let Some(other) = names.insert(folder, name) {
            let folder = folder.display();
            let problem = "expected another folder for each, such as with {name}";
            return Err(CliError::Usage(format!("--out: found the folder {folder} for {other} and {name}, {problem}")));
        }
    }
    Ok(())
}

/// Refuses to replace a plan that Benchdog made by another plan of the same name: the file may be the only copy. The copy of
/// a plan that was given is replaced, so that an edited plan can be simulated again.
///
/// # Errors
/// If there is another plan.
pub fn keep_other_plan(folder: &Path, plan: &Plan) -> Result<(), CliError> {
    let path = RunFiles::new(folder).plan;
    let bytes = match input::kept(&path, MOST_DOCUMENT) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::FileTooLarge => return Err(CliError::OverwritesPlan(path)),
        Err(_) => return Ok(()),
    };
    match serde_json::from_slice::<Plan>(&bytes) {
        Ok(other) if other.planner.is_none() || without_durations(&other) == without_durations(plan) => Ok(()),
        _ => Err(CliError::OverwritesPlan(path)),
    }
}

/// A plan without the values in which equal runs differ.
fn without_durations(plan: &Plan) -> Plan {
    let mut plan = plan.clone();
    if let Some(planner) = &mut plan.planner {
        (planner.wall_ms, planner.map_ms) = (None, None);
    }
    plan
}

/// Checks that results can be written, and removes reports and verdicts of an earlier run, so that they cannot be mistaken
/// for results of this one if it is killed.
///
/// # Errors
/// If the folder cannot be written.
pub fn prepare<'a>(args: &ReportArgs, folders: impl Iterator<Item = &'a Path>) -> Result<(), CliError> {
    let of_all = args.out.of_all();
    report::file::check_folder(&of_all)?;
    for name in REPORTS {
        report::file::remove(&of_all.join(name))?;
    }
    if let Some(path) = &args.junit {
        report::file::remove(path)?;
    }
    for folder in folders {
        report::file::remove(&RunFiles::new(folder).verdict)?;
    }
    Ok(())
}

/// Writes plan, recording, MCAP file and, last, verdict of a run into its folder. A plan that was read from its place
/// there, `plan_file`, is left as it is.
///
/// # Errors
/// If a file cannot be written.
pub fn write_run(
    run: Run,
    scenario: &Scenario,
    robot: &Robot,
    plan_file: Option<&Path>,
    (folder, args): (&Path, &ReportArgs),
) -> Result<FinishedRun, CliError> {
    let files = RunFiles::new(folder);
    let recording = if args.record.wants(run.verdict.met) { recording::encode(&run, scenario, robot)? } else { None };
    let mcap = if args.mcap { mcap::encode(&run, robot)? } else { None };
    let plan = run.plan.as_ref().map(|plan| report::json::plan(plan).into_bytes());
    let recorded = recording.is_some();
    if !plan_file.is_some_and(|file| is_same_file(file, &files.plan)) {
        write_or_remove(&files.plan, plan)?;
    }
    write_or_remove(&files.recording, recording)?;
    write_or_remove(&files.mcap, mcap)?;
    write_or_remove(&files.verdict, Some(report::json::verdict(&run.verdict).into_bytes()))?;
    let recording = recorded.then_some(files.recording);
    let pictures = pictures(&run, scenario, robot)?;
    Ok(FinishedRun {
        exit: Exit::of(&run.verdict),
        wall_s: None,
        outcome: Outcome::Judged {
            pictures,
            measures: run.simulated.map(|(_, judgement)| Box::new(judgement.measures)),
            clearance: run.plan.as_ref().and_then(|plan| plan.clearance.as_ref()).map(ToString::to_string),
            scores: run.plan.as_ref().and_then(|plan| plan.comfort?.scores()),
            predicted_load_factor: run.plan.and_then(|plan| plan.stability).map(|s| s.compliant_load_factor),
            verdict: Box::new(run.verdict),
            posture: run.posture.map(Box::new),
            recording,
        },
    })
}

/// The pictures of a run for reports; `None` without a plan.
fn pictures(run: &Run, scenario: &Scenario, robot: &Robot) -> Result<Option<Box<HoldPictures>>, CliError> {
    let Some(plan) = &run.plan else { return Ok(None) };
    let simulated = run.simulated.as_ref().map(|(trace, judgement)| SimulatedHold {
        trace,
        measures: &judgement.measures,
        events: &judgement.events,
    });
    let holding = Holding { plan, robot, person: scenario.human, tool: scenario.tool };
    Ok(Some(Box::new(HoldPictures::new(&holding, simulated, &run.verdict)?)))
}

/// Writes a file of a run, or removes that of an earlier run if this one has none.
fn write_or_remove(path: &Path, bytes: Option<Vec<u8>>) -> Result<(), CliError> {
    match bytes {
        Some(bytes) => report::file::write_whole(path, &bytes)?,
        None => report::file::remove(path)?,
    }
    Ok(())
}

/// The table of outcomes; for a single run also its checks; a hint if a verdict is not the expected one.
fn text(outcomes: &[Outcome], wall_s: &[Option<f64>]) -> String {
    let mut text = report::console::table(outcomes, wall_s);
    if let [Outcome::Judged { verdict, posture, recording, .. }] = outcomes {
        text.push('\n');
        text.push_str(&report::console::details(verdict, posture.as_deref(), recording.as_deref()));
    }
    let unexpected = outcomes.iter().filter_map(Outcome::verdict).filter(|verdict| !verdict.met);
    text.push_str(&report::console::hint(unexpected.map(|verdict| verdict.verdict)));
    text
}

/// All finished runs, in the form that reports need.
pub struct RunSummary {
    /// The outcome of each run.
    pub outcomes: Vec<Outcome>,
    /// The duration of each run, s.
    pub wall_s: Vec<Option<f64>>,
    /// The command's result.
    pub exit: Exit,
}

impl From<Vec<FinishedRun>> for RunSummary {
    fn from(ended: Vec<FinishedRun>) -> Self {
        let exit = ended.iter().map(|ended| ended.exit).max().unwrap_or(Exit::Met);
        let (outcomes, wall_s) = ended.into_iter().map(|ended| (ended.outcome, ended.wall_s)).unzip();
        Self { outcomes, wall_s, exit }
    }
}

/// Writes the report to standard output and to the file of `--junit`.
///
/// # Errors
/// If the report cannot be written.
pub fn report(summary: &RunSummary, args: &ReportArgs) -> Result<(), CliError> {
    match args.format {
        Format::Human => output::report(&text(&summary.outcomes, &summary.wall_s))?,
        Format::Json => output::print(&report::json::verdicts(&summary.outcomes))?,
    }
    if let Some(path) = &args.junit {
        report::file::write_whole(path, report::junit::document(&summary.outcomes)?.as_bytes())?;
    }
    Ok(())
}

/// Writes the reports into the output folder.
///
/// # Errors
/// If one cannot be written.
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
