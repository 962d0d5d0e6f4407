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
    Ok(Ended {
        exit: Exit::of(&run.verdict),
        outcome: Outcome::Judged {
            predicted_load_factor: run.plan.and_then(|plan| plan.stability).map(|s| s.compliant_load_factor),
            verdict: run.verdict,
            recording,
        },
    })
}

/// Writes what a run brought forth; what an earlier run left in its place is removed, lest it be taken for this one's.
fn write_or_remove(path: &Path, bytes: Option<Vec<u8>>) -> Result<(), CliError> {
    match bytes {
        Some(bytes) => report::file::write_whole(path, &bytes)?,
        None => match std::fs::remove_file(path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                return Err(report::file::WriteError { path: path.to_owned(), source }.into());
            }
            _ => {}
        },
    }
    Ok(())
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
    match args.format {
        Format::Human => output::print(&for_people(&outcomes))?,
        Format::Json => output::print(&report::json::verdicts(&outcomes))?,
    }
    for outcome in &outcomes {
        if let Outcome::Crashed { name, message } = outcome {
            output::complain(&format!("error: {name}: {message}"));
        }
    }
    if let Some(path) = &args.junit {
        report::file::write_whole(path, report::junit::document(&outcomes)?.as_bytes())?;
    }
    Ok(exit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_one_run_is_a_bug_with_its_message() {
        let ended = Ended::catch("bad-luck", || panic!("{}", "out of cheese"));
        assert_eq!(ended.exit, Exit::Bug);
        let Outcome::Crashed { name, message } = ended.outcome else { panic!("a panic is a crash") };
        assert_eq!((name.as_str(), message.as_str()), ("bad-luck", "this is a bug in benchdog: out of cheese"));
    }
}
