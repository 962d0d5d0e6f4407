//! `benchdog reproduce`: plans, simulates and reports the paper's evaluation.
//!
//! [`crate::reproduce`] lists the jobs and makes tables, pictures and conclusions from their results; [`runner`] runs a job
//! and caches its result. Equal runs write equal files, except `timing.csv`; durations are also printed.

mod runner;

use std::{
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use super::{
    args::ReproduceArgs,
    curve,
    exit::{CliError, Exit},
    interrupt, output,
    progress::Progress,
    select::Filter,
    threads,
};
use crate::{
    model::{operation::OperationKind, scenario::PlannerKind},
    pipeline::parallel,
    report::{
        self,
        file::{self, WriteError},
    },
    reproduce::{
        claims, csv_files,
        evaluation::{HoldRow, KINDS, Reproduction},
        jobs::Job,
        markdown, paper, picture,
        schedule::{Schedule, Scope},
        timing,
    },
    robot::Robot,
    scenario::LoadedScenario,
};
use runner::JobRunner;

/// Runs the evaluation and writes its results.
pub fn reproduce(args: &ReproduceArgs) -> Result<Exit, CliError> {
    let progress = Progress::counting("reading the operations", "")?;
    let operations = operations(args)?;
    let Some(first) = operations.first() else { return Ok(Exit::Met) };
    let out = args.folder();
    file::check_folder(&out)?;
    let scope = args.scope();
    let schedule = Schedule::new(&operations, &scope);
    let runner = JobRunner::new(&first.robot, &out, args, &progress)?;
    let folder = runner.folder();
    let folder = folder.display();
    progress.leaves(&format!("finished results are kept in {folder}, and the same command continues from them"));
    let rows = threads::with_threads(args.jobs, || run_jobs(&runner, &schedule.jobs, &progress))??;
    let reproduction = schedule.reproduction(rows, &scope, left_out(args, operations.len()));
    if args.natural {
        write_natural_results(&reproduction, &first.robot, &out)?;
    } else {
        write_results(&reproduction, &operations, &first.robot, &out)?;
    }
    output::report(&summary(&reproduction, &out))?;
    Ok(reproduction.first_seeds().map(exit_of).max().unwrap_or(Exit::Met))
}

/// Writes a file that Ctrl-C leaves whole.
fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let _writing = interrupt::writing();
    file::write_whole(path, bytes)
}

/// The exit code for one result.
fn exit_of(row: &HoldRow) -> Exit {
    row.verdict.as_ref().map_or(Exit::Infeasible, Exit::of)
}

/// The operations that pass a filter, or all without one.
fn operations(args: &ReproduceArgs) -> Result<Vec<LoadedScenario>, CliError> {
    let asked = args.filter.join(", ");
    let filters = args.filter.iter().map(|text| Filter::new(text)).collect::<Result<Vec<_>, _>>()?;
    let all = if args.natural { paper::natural_operations() } else { paper::operations() };
    let wanted = |name: &str| filters.is_empty() || filters.iter().any(|filter| filter.passes(name));
    let operations: Vec<_> =
        all.iter().filter(|operation| wanted(&operation.name)).map(|o| o.load()).collect::<Result<_, _>>()?;
    if operations.is_empty() {
        let known: Vec<_> = all.into_iter().map(|operation| operation.name).collect();
        let known = known.join(", ");
        let message = format!("--filter {asked}: found no operation that passes, expected one of {known}");
        return Err(CliError::Usage(message));
    }
    Ok(operations)
}

/// Runs all jobs and returns their results in order.
fn run_jobs(runner: &JobRunner<'_>, jobs: &[Job], progress: &Progress) -> Result<Vec<HoldRow>, CliError> {
    progress.expect(jobs.len());
    // An error such as a full disk would repeat, so no job starts after the first one.
    let first_error: Mutex<Option<CliError>> = Mutex::new(None);
    runner.prepare(jobs);
    let rows = parallel::map_in_parallel(jobs, |job| {
        if first_error.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return None;
        }
        progress.begins(&job.name());
        match runner.run(job) {
            Ok(result) => {
                progress.advances(result.line(job).as_deref());
                Some(result.row)
            }
            Err(error) => {
                first_error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                None
            }
        }
    });
    progress.finish();
    match first_error.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        // Without an error every job has a result.
        None => Ok(rows.into_iter().flatten().collect()),
    }
}

/// What this run leaves out of the whole evaluation; `None` if nothing.
fn left_out(args: &ReproduceArgs, operations: usize) -> Option<String> {
    let mut parts = Vec::new();
    if args.quick {
        let seeds = args.scope().random_seeds;
        parts.push(format!(
            "{seeds} seeds of the random planner, no search for failing loads and no sensitivity analysis (`--quick`)"
        ));
    }
    if operations < paper::CUTS + paper::DRILLS {
        parts.push(format!("only {operations} of the operations (`--filter`)"));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Writes all files, the report last: if it exists, the others are complete.
fn write_results(
    reproduction: &Reproduction,
    operations: &[LoadedScenario],
    robot: &Robot,
    out: &Path,
) -> Result<(), CliError> {
    let write = |name: &str, text: &str| write_file(&out.join(name), text.as_bytes());
    file::remove(&out.join("report.md"))?;
    write("table1.csv", &csv_files::table1(reproduction))?;
    write("plans.csv", &csv_files::plans(reproduction))?;
    write("physics.csv", &csv_files::physics(reproduction.first_seeds()))?;
    write("best_case.csv", &csv_files::physics(reproduction.best_case.iter()))?;
    write("random.csv", &csv_files::random(reproduction))?;
    write("timing.csv", &csv_files::timing(reproduction))?;
    match reproduction.sensitivity.is_empty() {
        true => file::remove(&out.join("sensitivity.csv"))?,
        false => write("sensitivity.csv", &csv_files::sensitivity(reproduction))?,
    }
    for kind in KINDS {
        write_pictures(reproduction, kind, robot, &out.join("pictures"))?;
    }
    write_curve(operations, out)?;
    write("report.md", &markdown::report(reproduction))?;
    Ok(())
}

/// Writes all files of the evaluation for a person who stands naturally, the report last.
fn write_natural_results(reproduction: &Reproduction, robot: &Robot, out: &Path) -> Result<(), CliError> {
    let write = |name: &str, text: &str| write_file(&out.join(name), text.as_bytes());
    file::remove(&out.join("report.md"))?;
    write("table1.csv", &csv_files::table1(reproduction))?;
    write("plans.csv", &csv_files::plans(reproduction))?;
    write("postures.csv", &csv_files::postures(reproduction))?;
    write("physics.csv", &csv_files::physics(reproduction.first_seeds()))?;
    write("random.csv", &csv_files::random(reproduction))?;
    write("timing.csv", &csv_files::timing(reproduction))?;
    for kind in KINDS {
        write_pictures(reproduction, kind, robot, &out.join("pictures"))?;
    }
    write("report.md", &markdown::natural_report(reproduction))?;
    Ok(())
}

/// Writes one picture per planner, for one operation of this kind.
fn write_pictures(
    reproduction: &Reproduction,
    kind: OperationKind,
    robot: &Robot,
    folder: &Path,
) -> Result<(), CliError> {
    let Some(operation) = reproduction.drawn(kind) else { return Ok(()) };
    for row in PlannerKind::ALL.iter().filter_map(|&planner| reproduction.hold(operation, planner)) {
        if let Some(plan) = &row.plan {
            let svg = picture::svg(plan, robot, &markdown::picture_title(row))?;
            write_file(&folder.join(markdown::picture_name(row)), svg.as_bytes())?;
        }
    }
    Ok(())
}

/// Writes the muscular comfort along the circle. Any cut will do: all of them are on one circle.
fn write_curve(operations: &[LoadedScenario], out: &Path) -> Result<(), CliError> {
    let Some(cut) = operations.iter().find(|o| o.scenario.operation.kind == OperationKind::Cut) else { return Ok(()) };
    let curve = curve::curve_of(cut)?;
    write_file(&out.join("muscular_curve.csv"), report::curve::csv(&curve).as_bytes())?;
    write_file(&out.join("muscular_curve.svg"), report::curve::svg(&curve).as_bytes())?;
    Ok(())
}

/// The text that is printed at the end.
fn summary(reproduction: &Reproduction, out: &Path) -> String {
    let claims = claims::claims(reproduction);
    let (simulated, held) = reproduction
        .first_seeds()
        .fold((0, 0), |(simulated, held), row| (simulated + 1, held + usize::from(claims::holds(row))));
    let mut text = String::new();
    for claim in &claims {
        text.push_str(&format!(
            "{:<4} {}: {}\n",
            if claim.holds { "yes" } else { "NO" },
            claim.sentence,
            claim.figures
        ));
    }
    text.push_str(&format!("{held} of {simulated} plans hold in simulation\n\n"));
    text.push_str(&timing::summary(reproduction));
    text.push_str(&format!("\nwritten: {}\n", out.join("report.md").display()));
    text
}

impl ReproduceArgs {
    fn scope(&self) -> Scope {
        let usual = if self.quick { Scope::quick() } else { Scope::full() };
        if self.natural { Scope::natural(usual.random_seeds) } else { usual }
    }

    /// The folder of the results. By default a quick run does not overwrite those of a whole run.
    fn folder(&self) -> PathBuf {
        let default = match (self.quick, self.natural) {
            (false, false) => "results",
            (false, true) => "results/natural",
            (true, false) => "out/reproduce-quick",
            (true, true) => "out/reproduce-quick-natural",
        };
        self.out.clone().unwrap_or_else(|| default.into())
    }
}
