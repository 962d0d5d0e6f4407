//! `benchdog reproduce`: the paper's evaluation, planned, simulated and reported.
//!
//! What is done stands in [`jobs`], what else it is done under in [`sensitivity`]; this file asks for it and writes what the
//! report makes of it. All that is committed is the same for equal runs; times go to `timing.csv` and the console.

mod jobs;
mod sensitivity;

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
    report::{
        self, file,
        reproduce::{self as evaluation, Hold, KINDS, Reproduction, Variant, claims, markdown, picture},
    },
    robot::Robot,
    scenario::{LoadedScenario, paper},
};
use jobs::{Job, Work, Workshop};

/// How much of the evaluation is done.
struct Extent {
    /// Seeds of the random planner.
    random_seeds: u64,
    /// Seeds of the random planner in the sensitivity analysis; none when it is left out.
    sensitivity_seeds: Option<u64>,
    /// What is done with the hold of the first seed.
    first: Work,
}

impl Extent {
    fn of(args: &ReproduceArgs) -> Self {
        if args.quick {
            Self { random_seeds: 3, sensitivity_seeds: None, first: Work::Simulate }
        } else {
            // METHOD section 3 asks for twenty at least. The analysis compares variants that share their seeds, so few do.
            Self { random_seeds: 20, sensitivity_seeds: Some(4), first: Work::FailingLoad }
        }
    }
}

/// Reproduces the paper's evaluation.
pub fn reproduce(args: &ReproduceArgs) -> Result<Exit, CliError> {
    let operations = operations(&args.filter)?;
    let Some(first) = operations.first() else { return Ok(Exit::Met) };
    let out = args.folder();
    file::check_folder(&out)?;
    interrupt::listen("what is done is kept, and the same command goes on from there")?;
    let extent = Extent::of(args);
    let tasks = Tasks::new(&operations, &extent);
    let workshop = Workshop::new(&first.robot, &out, args.record)?;
    let Some(holds) = threads::with_threads(args.jobs, || work_off(&workshop, &tasks.jobs))?? else {
        let folder = workshop.folder();
        let folder = folder.display();
        output::message(&format!("stopped: what is done is kept in {folder}, and the same command goes on from there"));
        return Ok(Exit::Interrupted);
    };
    let reproduction = tasks.reproduction(holds, &extent, left_out(args, operations.len()));
    write_results(&reproduction, &operations, &first.robot, &out)?;
    output::print(&for_people(&reproduction, &out))?;
    Ok(reproduction.first_seeds().map(exit_of).max().unwrap_or(Exit::Met))
}

/// What a hold means for the exit code.
fn exit_of(hold: &Hold) -> Exit {
    hold.verdict.as_ref().map_or(Exit::Infeasible, Exit::of)
}

/// The operations that the filters let through.
fn operations(filters: &[String]) -> Result<Vec<LoadedScenario>, CliError> {
    let asked = filters.join(", ");
    let filters = filters.iter().map(|text| Filter::new(text)).collect::<Result<Vec<_>, _>>()?;
    let all = paper::operations();
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

/// All that is to be done, in this order: the evaluation, operation by operation; the comfort planner's holds again, with the
/// paper's stability alone; the sensitivity analysis.
struct Tasks {
    jobs: Vec<Job>,
    evaluation: usize,
    best_case: usize,
    /// The name of each variant and how many jobs it has.
    variants: Vec<(&'static str, usize)>,
}

impl Tasks {
    fn new(operations: &[LoadedScenario], extent: &Extent) -> Self {
        let scenarios = || operations.iter().map(|operation| &operation.scenario);
        let mut jobs: Vec<Job> =
            scenarios().flat_map(|scenario| jobs::jobs_of(scenario, extent.random_seeds, extent.first)).collect();
        let evaluation = jobs.len();
        jobs.extend(scenarios().map(jobs::best_case));
        let mut variants = Vec::new();
        for variant in extent.sensitivity_seeds.map_or(&[][..], |_| &sensitivity::VARIANTS) {
            let before = jobs.len();
            for scenario in scenarios().filter(|scenario| sensitivity::looks_at(&scenario.name)) {
                jobs.extend(variant.jobs(scenario, extent.sensitivity_seeds.unwrap_or(0)));
            }
            variants.push((variant.name, jobs.len() - before));
        }
        Self { jobs, evaluation, best_case: operations.len(), variants }
    }

    /// What the report is made from; `holds` are those of the jobs in their order.
    fn reproduction(&self, holds: Vec<Hold>, extent: &Extent, left_out: Option<String>) -> Reproduction {
        let mut rest = holds.into_iter();
        let mut next = |count: usize| rest.by_ref().take(count).collect::<Vec<_>>();
        let (holds, best_case) = (next(self.evaluation), next(self.best_case));
        let mut sensitivity = Vec::new();
        if let Some(seeds) = extent.sensitivity_seeds {
            // The default's are the evaluation's own holds.
            let own = holds.iter().filter(|hold| hold.seed <= seeds && sensitivity::looks_at(&hold.operation));
            let default = ("as reproduced", own.cloned().collect::<Vec<_>>());
            let others = self.variants.iter().map(|&(name, count)| (name, next(count)));
            sensitivity = std::iter::once(default)
                .chain(others)
                .filter(|(_, holds)| !holds.is_empty())
                .map(|(name, holds)| Variant { name: name.to_owned(), holds })
                .collect();
        }
        Reproduction {
            holds,
            random_seeds: extent.random_seeds,
            best_case,
            sensitivity,
            sensitivity_seeds: extent.sensitivity_seeds.unwrap_or(0),
            left_out,
        }
    }
}

/// The holds of all jobs in their order; none when the user asked for an end before all had their turn.
fn work_off(workshop: &Workshop<'_>, jobs: &[Job]) -> Result<Option<Vec<Hold>>, CliError> {
    let progress = Progress::new(jobs.len());
    // A full disk is full for all: after the first error nothing more is begun.
    let broken: Mutex<Option<CliError>> = Mutex::new(None);
    workshop.prepare(jobs);
    let holds = threads::map_in_parallel(jobs, |job| {
        if interrupt::requested() || broken.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return None;
        }
        progress.begins(&job.name());
        match workshop.hold(job) {
            Ok(done) => {
                progress.advances(done.line(job).as_deref());
                Some(done.hold)
            }
            Err(error) => {
                broken.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                None
            }
        }
    });
    progress.finish();
    match broken.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(holds.into_iter().collect()),
    }
}

/// What a run that is not whole lacks, in words.
fn left_out(args: &ReproduceArgs, operations: usize) -> Option<String> {
    let mut lacks = Vec::new();
    if args.quick {
        let seeds = Extent::of(args).random_seeds;
        lacks.push(format!(
            "{seeds} seeds of the random planner, no search for failing loads and no sensitivity (`--quick`)"
        ));
    }
    if operations < paper::CUTS + paper::DRILLS {
        lacks.push(format!("{operations} of the operations (`--filter`)"));
    }
    (!lacks.is_empty()).then(|| lacks.join("; "))
}

/// Writes everything; the report last of all, so that where it stands all else does.
fn write_results(
    reproduction: &Reproduction,
    operations: &[LoadedScenario],
    robot: &Robot,
    out: &Path,
) -> Result<(), CliError> {
    let write = |name: &str, text: &str| file::write_whole(&out.join(name), text.as_bytes());
    file::remove(&out.join("report.md"))?;
    write("table1.csv", &evaluation::tables::table1(reproduction))?;
    write("plans.csv", &evaluation::tables::plans(reproduction))?;
    write("physics.csv", &evaluation::tables::physics(reproduction.first_seeds()))?;
    write("best_case.csv", &evaluation::tables::physics(reproduction.best_case.iter()))?;
    write("random.csv", &evaluation::tables::random(reproduction))?;
    write("timing.csv", &evaluation::tables::timing(reproduction))?;
    match reproduction.sensitivity.is_empty() {
        true => file::remove(&out.join("sensitivity.csv"))?,
        false => write("sensitivity.csv", &evaluation::tables::sensitivity(reproduction))?,
    }
    for kind in KINDS {
        write_pictures(reproduction, kind, robot, &out.join("pictures"))?;
    }
    write_curve(operations, out)?;
    write("report.md", &markdown::report(reproduction))?;
    Ok(())
}

/// A picture a planner, for one operation of a kind.
fn write_pictures(
    reproduction: &Reproduction,
    kind: OperationKind,
    robot: &Robot,
    folder: &Path,
) -> Result<(), CliError> {
    let Some(operation) = reproduction.drawn(kind) else { return Ok(()) };
    for hold in PlannerKind::ALL.iter().filter_map(|&planner| reproduction.hold(operation, planner)) {
        if let Some(plan) = &hold.plan {
            let svg = picture::svg(plan, robot, &markdown::picture_title(hold))?;
            file::write_whole(&folder.join(markdown::picture_name(hold)), svg.as_bytes())?;
        }
    }
    Ok(())
}

/// The muscular curve, of whichever cut is at hand: they all lie on one circle.
fn write_curve(operations: &[LoadedScenario], out: &Path) -> Result<(), CliError> {
    let Some(cut) = operations.iter().find(|o| o.scenario.operation.kind == OperationKind::Cut) else { return Ok(()) };
    let curve = curve::curve_of(cut)?;
    file::write_whole(&out.join("muscular_curve.csv"), report::curve::csv(&curve).as_bytes())?;
    file::write_whole(&out.join("muscular_curve.svg"), report::curve::svg(&curve).as_bytes())?;
    Ok(())
}

/// What is printed in the end.
fn for_people(reproduction: &Reproduction, out: &Path) -> String {
    let claims = claims::claims(reproduction);
    let (simulated, held) = reproduction
        .first_seeds()
        .fold((0, 0), |(simulated, held), hold| (simulated + 1, held + usize::from(claims::holds(hold))));
    let mut text = String::new();
    for claim in &claims {
        text.push_str(&format!(
            "{:<4} {}: {}\n",
            if claim.holds { "yes" } else { "NO" },
            claim.sentence,
            claim.figures
        ));
    }
    text.push_str(&format!("{held} of {simulated} holds stand in simulation\n\n"));
    text.push_str(&evaluation::timing::summary(reproduction));
    text.push_str(&format!("\nwritten: {}\n", out.join("report.md").display()));
    text
}

impl ReproduceArgs {
    /// Where the results go: a quick run does not take the place of the whole one.
    fn folder(&self) -> PathBuf {
        let default = if self.quick { "out/reproduce-quick" } else { "results" };
        self.out.clone().unwrap_or_else(|| default.into())
    }
}
