//! What happens to a run when it is over: its files are written, and all runs together are reported.

use super::{
    args::{Format, RecordChoice, ReportArgs},
    exit::{CliError, Exit},
    output,
    pipeline::Run,
    recording,
};
use crate::{
    model::scenario::Scenario,
    report::{self, Outcome},
    robot::Robot,
};

/// How one run ended: what is reported of it and what it means for the exit code.
#[derive(Debug)]
pub struct Ended {
    /// What is reported.
    pub outcome: Outcome,
    /// The exit code if it were the only one.
    pub exit: Exit,
}

impl Ended {
    /// Runs a job to its end, whatever that is: other scenarios must not suffer from an error or a bug in this one.
    pub fn catch(name: &str, job: impl FnOnce() -> Result<Self, CliError>) -> Self {
        let (exit, message) = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(job)) {
            Ok(Ok(ended)) => return ended,
            Ok(Err(error)) => (error.exit(), error.to_string()),
            Err(panic) => (Exit::Bug, format!("this is a bug in benchdog: {}", panic_message(&*panic))),
        };
        Self { outcome: Outcome::Crashed { name: name.to_owned(), message }, exit }
    }
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without a message".into())
}

/// Writes plan, verdict and recording of a run into a folder of its name.
///
/// # Errors
/// When a file cannot be written.
pub fn finish(run: Run, scenario: &Scenario, robot: &Robot, args: &ReportArgs) -> Result<Ended, CliError> {
    let folder = args.out.join(&run.verdict.name);
    if let Some(plan) = &run.plan {
        report::file::write_whole(&folder.join("plan.json"), report::json::plan(plan).as_bytes())?;
    }
    let wanted = match args.record {
        RecordChoice::Never => false,
        RecordChoice::Failed => !run.verdict.met,
        RecordChoice::Always => true,
    };
    let recording = if wanted { recording::write(&run, scenario, robot, &folder)? } else { None };
    report::file::write_whole(&folder.join("verdict.json"), report::json::verdict(&run.verdict).as_bytes())?;
    Ok(Ended {
        exit: Exit::of(&run.verdict),
        outcome: Outcome::Judged {
            predicted_load_factor: run.plan.and_then(|plan| plan.stability).map(|s| s.compliant_load_factor),
            verdict: run.verdict,
            recording,
        },
    })
}

/// The table; a single run is shown with its checks.
fn for_people(outcomes: &[Outcome]) -> String {
    let mut text = report::console::table(outcomes);
    if let [Outcome::Judged { verdict, recording, .. }] = outcomes {
        text.push('\n');
        text.push_str(&report::console::details(verdict, recording.as_deref()));
    }
    text
}

/// Reports runs on standard output and in the JUnit file, and says how the command ended.
///
/// # Errors
/// When the report cannot be written.
pub fn report(ended: Vec<Ended>, args: &ReportArgs) -> Result<Exit, CliError> {
    let exit = ended.iter().map(|ended| ended.exit).max().unwrap_or(Exit::Met);
    let outcomes: Vec<_> = ended.into_iter().map(|ended| ended.outcome).collect();
    if let Some(path) = &args.junit {
        report::file::write_whole(path, report::junit::document(&outcomes)?.as_bytes())?;
    }
    match args.format {
        Format::Human => output::print(&for_people(&outcomes))?,
        Format::Json => output::print(&report::json::verdicts(&outcomes))?,
    }
    for outcome in &outcomes {
        if let Outcome::Crashed { message, .. } = outcome {
            output::complain(&format!("error: {message}"));
        }
    }
    Ok(exit)
}
