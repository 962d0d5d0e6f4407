//! `benchdog simulate`: simulates and judges plans from any planner.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::Instant,
};

use super::{
    args::{ReportArgs, SimulateArgs},
    batch::Batch,
    exit::{CliError, Exit},
    finish::{self, FinishedRun, RunSummary},
    inputs::Inputs,
    interrupt,
    out_folder::Values,
    output,
    progress::Progress,
    select, task, threads,
};
use crate::{
    pipeline::{self, parallel},
    report::{self, Outcome},
    scenario::{self, AnyPlan, FileText, LoadedPlan, PlanReader},
};

/// Simulates and judges plans under the given scenario, the one in each plan, or the defaults for its operation.
pub fn simulate(args: &SimulateArgs) -> Result<Exit, CliError> {
    let paths = select::plans(&args.plans)?;
    let [path] = &paths[..] else { return several(args, &paths) };
    let progress = Progress::begin("reading the plan", "")?;
    match scenario::load_any_plan(path, args.scenario.as_deref())? {
        AnyPlan::OneHold(plan) => one_hold(args, *plan, &progress),
        AnyPlan::Staged(plan) => task::simulate(args, &plan, &progress),
    }
}

fn one_hold(args: &SimulateArgs, loaded: LoadedPlan, progress: &Progress) -> Result<Exit, CliError> {
    let folder = folder_of(&loaded, args);
    check_outputs(&args.report, &loaded, &folder, &Inputs::new(&loaded.inputs))?;
    report::file::check_folder(&args.report.out.of_all())?;
    let start = Instant::now();
    let mut writing = None;
    let LoadedPlan { path, plan, filled_in, robot, scenario, .. } = loaded;
    let mut finished = FinishedRun::catch(&plan.name.clone(), || {
        progress.simulates();
        let run = pipeline::run_plan(&scenario, &robot, plan, &filled_in, progress)?;
        writing = Some(interrupt::writing());
        finish::write_run(run, &scenario, &robot, Some(&path), (&folder, &args.report))
    })?;
    finished.wall_s = Some(start.elapsed().as_secs_f64());
    progress.finish();
    if let Outcome::Crashed { name, message } = &finished.outcome {
        output::message(&format!("error: {name}: {message}"));
    }
    let summary = RunSummary::from(vec![finished]);
    finish::report(&summary, &args.report)?;
    drop(writing);
    Ok(summary.exit)
}

/// The folder of a plan's results.
fn folder_of(loaded: &LoadedPlan, args: &SimulateArgs) -> PathBuf {
    args.report.out.of_one(&Values::of(&loaded.scenario, Some(&loaded.plan)))
}

/// Refuses to overwrite an input file or another plan.
fn check_outputs(report: &ReportArgs, loaded: &LoadedPlan, folder: &Path, inputs: &Inputs) -> Result<(), CliError> {
    finish::protect(report, folder, Some(&loaded.path), inputs)?;
    finish::keep_other_plan(folder, &loaded.plan)
}

/// Simulates plans in parallel. All plans and the output folder are checked before the first one is simulated.
fn several(args: &SimulateArgs, paths: &[PathBuf]) -> Result<Exit, CliError> {
    let progress = Progress::counting("reading the plans", "the finished plans are reported")?;
    let plans = read(args, paths)?;
    let inputs: Vec<_> = plans.iter().flat_map(|loaded| loaded.inputs.clone()).collect();
    let inputs = Inputs::new(&inputs);
    let folders: Vec<_> = plans.iter().map(|loaded| folder_of(loaded, args)).collect();
    let names = plans.iter().map(|loaded| loaded.plan.name.as_str());
    finish::folders_differ(names.zip(folders.iter().map(PathBuf::as_path)))?;
    let mut planned = plans.iter().zip(&folders);
    planned.try_for_each(|(loaded, folder)| check_outputs(&args.report, loaded, folder, &inputs))?;
    report::file::check_folder(&args.report.out.of_all())?;
    let batch = Batch::new(progress, plans.len(), false);
    let run = |(loaded, folder): &(LoadedPlan, PathBuf)| {
        batch.run(&loaded.plan.name, || one_of_several(loaded, (folder, &args.report), batch.progress()))
    };
    let planned: Vec<_> = plans.into_iter().zip(folders).collect();
    let finished = threads::with_threads(args.jobs, || parallel::map_in_parallel(&planned, run))?;
    let summary = batch.end(finished)?;
    finish::report(&summary, &args.report)?;
    Ok(summary.exit)
}

fn one_of_several(
    loaded: &LoadedPlan,
    output: (&Path, &ReportArgs),
    progress: &Progress,
) -> Result<FinishedRun, CliError> {
    let LoadedPlan { path, plan, filled_in, robot, scenario, .. } = loaded;
    progress.simulates();
    let run = pipeline::run_plan(scenario, robot, plan.clone(), filled_in, progress)?;
    finish::write_run(run, scenario, robot, Some(path), output)
}

/// Reads plans, at least one of one hold. Those of tasks are left out if a folder or a pattern has found them, and refused if they were
/// named.
fn read(args: &SimulateArgs, paths: &[PathBuf]) -> Result<Vec<LoadedPlan>, CliError> {
    let of_scenario = args.scenario.as_deref().map(scenario::scenario_text).transpose()?.unwrap_or_default();
    let given = args.scenario.as_ref().map(|path| FileText { path, text: &of_scenario });
    let mut reader = PlanReader::new(given)?;
    let mut names = BTreeMap::<String, &Path>::new();
    let mut plans = Vec::new();
    for path in paths {
        let text = scenario::plan_text(path)?;
        let loaded = match reader.any(FileText { path, text: &text })? {
            AnyPlan::OneHold(loaded) => *loaded,
            AnyPlan::Staged(_) if args.plans.iter().any(|given| Path::new(given) == path) => {
                let path = path.display();
                let expected = "expected plans of one hold; give it to `benchdog simulate` alone";
                return Err(CliError::Usage(format!("{path}: found a plan of a task, {expected}")));
            }
            AnyPlan::Staged(_) => {
                let path = path.display();
                output::message(&format!("{path}: a plan of a task, left out: give it to `benchdog simulate` alone"));
                continue;
            }
        };
        let name = &loaded.plan.name;
        if let Some(other) = names.insert(name.clone(), path) {
            return Err(select::one_name_twice(path, name, other));
        }
        plans.push(loaded);
    }
    match plans.is_empty() {
        true => {
            Err(CliError::Usage("found only plans of tasks, expected plans of one hold, or one plan of a task".into()))
        }
        false => Ok(plans),
    }
}
