//! `benchdog reproduce`: plans, simulates and reports the paper's evaluation.
//!
//! [`crate::reproduce`] lists the jobs and makes tables, pictures and conclusions from their results; [`runner`] runs a job
//! and caches its result. Equal runs write equal files, except `timing.csv`; durations are also printed.

mod circle;
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
        evaluation::{FrontRow, HoldRow, KINDS, Reproduction, Results},
        jobs::Job,
        markdown,
        paper::{self, Evaluation},
        picture,
        schedule::{Schedule, Scope},
        timing,
    },
    robot::Robot,
    scenario::LoadedScenario,
};
use runner::JobRunner;

/// Runs both evaluations and writes their results.
pub fn reproduce(args: &ReproduceArgs) -> Result<Exit, CliError> {
    let progress = Progress::counting("reading the operations", "")?;
    let out = args.folder();
    let (natural, printed) = (operations(args, Evaluation::Natural)?, operations(args, Evaluation::Printed)?);
    let Some(LoadedScenario { robot, .. }) = natural.first() else { return Ok(Exit::Met) };
    file::check_folder(&out)?;
    let of_natural = JobRunner::natural(robot, &out, args, &progress)?;
    let of_printed = of_natural.printed(&out.join(PRINTED));
    let folder = of_natural.folder();
    let folder = folder.display();
    progress.leaves(&format!("finished results are kept in {folder}, and the same command continues from them"));
    let [natural_jobs, printed_jobs] =
        [(&natural, Evaluation::Natural), (&printed, Evaluation::Printed)].map(|(operations, evaluation)| {
            let scope = if args.quick { Scope::quick(evaluation) } else { Scope::full(evaluation) };
            (Schedule::new(operations, &scope), scope)
        });
    let with_fronts = if args.quick { &[] } else { &natural[..] };
    let with_circle = !args.quick && args.filter.is_empty();
    let jobs = natural_jobs.0.jobs.len() + printed_jobs.0.jobs.len();
    progress.expect(jobs + with_fronts.len() + usize::from(with_circle));
    let results = threads::with_threads(args.jobs, || {
        Ok::<_, CliError>(Results {
            natural: evaluate(natural_jobs, natural.len(), &of_natural, args)?,
            printed: evaluate(printed_jobs, printed.len(), &of_printed, args)?,
            fronts: fronts(with_fronts, &of_natural)?,
            circle: if with_circle { Some(of_natural.circle()?) } else { None },
        })
    })??;
    progress.finish();
    write_results(&results, [&natural, &printed], robot, &out)?;
    output::report(&summary(&results, &out))?;
    let all = results.natural.first_seeds().chain(results.printed.first_seeds());
    Ok(all.map(exit_of).max().unwrap_or(Exit::Met))
}

/// The folder of the evaluation as printed, in that of the results.
const PRINTED: &str = "printed";

/// Runs the jobs of one evaluation.
fn evaluate(
    (schedule, scope): (Schedule, Scope),
    operations: usize,
    runner: &JobRunner<'_>,
    args: &ReproduceArgs,
) -> Result<Reproduction, CliError> {
    let rows = run_jobs(runner, &schedule.jobs)?;
    Ok(schedule.reproduction(rows, &scope, left_out(args, &scope, operations)))
}

/// The fronts of both comforts, one per operation.
fn fronts(operations: &[LoadedScenario], runner: &JobRunner<'_>) -> Result<Vec<FrontRow>, CliError> {
    let rows = parallel::map_in_parallel(operations, |operation| {
        let row = runner.front(&operation.scenario);
        runner.progress().advances(None);
        row
    });
    Ok(rows.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
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

/// The operations of an evaluation that pass a filter, or all without one.
fn operations(args: &ReproduceArgs, evaluation: Evaluation) -> Result<Vec<LoadedScenario>, CliError> {
    let asked = args.filter.join(", ");
    let filters = args.filter.iter().map(|text| Filter::new(text)).collect::<Result<Vec<_>, _>>()?;
    let all = evaluation.operations();
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
fn run_jobs(runner: &JobRunner<'_>, jobs: &[Job]) -> Result<Vec<HoldRow>, CliError> {
    let progress = runner.progress();
    // An error such as a full disk would repeat, so no job starts after the first one.
    let first_error: Mutex<Option<CliError>> = Mutex::new(None);
    runner.prepare(jobs);
    let rows = parallel::map_in_parallel(jobs, |job| {
        if first_error.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return None;
        }
        let name = runner.name(job);
        progress.begins(&name);
        match runner.run(job) {
            Ok(result) => {
                progress.advances(result.line(&name).as_deref());
                Some(result.row)
            }
            Err(error) => {
                first_error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                None
            }
        }
    });
    match first_error.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        // Without an error every job has a result.
        None => Ok(rows.into_iter().flatten().collect()),
    }
}

/// What this run leaves out of the whole evaluation; `None` if nothing.
fn left_out(args: &ReproduceArgs, scope: &Scope, operations: usize) -> Option<String> {
    let mut parts = Vec::new();
    if args.quick {
        let seeds = scope.random_seeds;
        parts.push(format!(
            "seeds of the random planner: {seeds}; no failing loads, sensitivity analysis, fronts and whole circle (`--quick`)"
        ));
    }
    if operations < paper::CUTS + paper::DRILLS {
        parts.push(format!("only {operations} of the operations, without the whole circle (`--filter`)"));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Writes all files, the report last: if it exists, the others are complete.
fn write_results(
    results: &Results,
    [natural, printed]: [&[LoadedScenario]; 2],
    robot: &Robot,
    out: &Path,
) -> Result<(), CliError> {
    file::remove(&out.join("report.md"))?;
    write_evaluation(&results.natural, natural, robot, out)?;
    let of_printed = out.join(PRINTED);
    file::remove(&of_printed.join("report.md"))?;
    write_evaluation(&results.printed, printed, robot, &of_printed)?;
    write_file(&of_printed.join("report.md"), markdown::printed_report(results).as_bytes())?;
    write_unless_empty(&out.join("front.csv"), results.fronts.is_empty(), || csv_files::front(results))?;
    let circle = results.circle.as_ref();
    write_unless_empty(&out.join("circle.csv"), circle.is_none(), || {
        circle.map_or_else(String::new, csv_files::circle)
    })?;
    write_file(&out.join("report.md"), markdown::report(results).as_bytes())?;
    Ok(())
}

/// Writes a file, or removes that of an earlier run if there is nothing to write.
fn write_unless_empty(path: &Path, is_empty: bool, text: impl FnOnce() -> String) -> Result<(), CliError> {
    if is_empty {
        file::remove(path)?
    } else {
        write_file(path, text().as_bytes())?
    }
    Ok(())
}

/// Writes the files of one evaluation but its report.
fn write_evaluation(
    reproduction: &Reproduction,
    operations: &[LoadedScenario],
    robot: &Robot,
    out: &Path,
) -> Result<(), CliError> {
    let write = |name: &str, text: &str| write_file(&out.join(name), text.as_bytes());
    write("table1.csv", &csv_files::table1(reproduction))?;
    write("plans.csv", &csv_files::plans(reproduction))?;
    write("postures.csv", &csv_files::postures(reproduction))?;
    write("effort.csv", &csv_files::effort(reproduction))?;
    write("physics.csv", &csv_files::physics(reproduction.first_seeds()))?;
    write("best_case.csv", &csv_files::physics(reproduction.best_case.iter()))?;
    write("random.csv", &csv_files::random(reproduction))?;
    write("timing.csv", &csv_files::timing(reproduction))?;
    let sensitivity = &reproduction.sensitivity;
    write_unless_empty(&out.join("by_muscles.csv"), reproduction.by_muscles.is_empty(), || {
        csv_files::physics(reproduction.by_muscles.iter())
    })?;
    write_unless_empty(&out.join("sensitivity.csv"), sensitivity.is_empty(), || csv_files::sensitivity(reproduction))?;
    for kind in KINDS {
        write_pictures(reproduction, kind, robot, &out.join("pictures"))?;
    }
    write_curve(operations, out)
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
fn summary(results: &Results, out: &Path) -> String {
    let mut text = String::new();
    for (evaluation, reproduction) in Evaluation::ALL.into_iter().zip([&results.natural, &results.printed]) {
        text.push_str(&of_evaluation(evaluation, reproduction));
    }
    text.push_str(&format!("written: {}\n", out.join("report.md").display()));
    text
}

/// The conclusions of one evaluation, what holds in simulation, and durations.
fn of_evaluation(evaluation: Evaluation, reproduction: &Reproduction) -> String {
    let (simulated, held) = reproduction
        .first_seeds()
        .fold((0, 0), |(simulated, held), row| (simulated + 1, held + usize::from(claims::holds(row))));
    let mut text = format!("{}\n", evaluation.name());
    for claim in claims::claims(reproduction) {
        let mark = if claim.holds { "yes" } else { "NO" };
        text.push_str(&format!("{mark:<4} {}: {}\n", claim.sentence, claim.figures));
    }
    text.push_str(&format!("{held} of {simulated} plans hold in simulation\n\n"));
    text.push_str(&timing::summary(reproduction));
    text.push('\n');
    text
}

impl ReproduceArgs {
    /// The folder of the results. By default a quick run does not overwrite those of a whole run.
    fn folder(&self) -> PathBuf {
        let default = if self.quick { "out/reproduce-quick" } else { "results" };
        self.out.clone().unwrap_or_else(|| default.into())
    }
}
