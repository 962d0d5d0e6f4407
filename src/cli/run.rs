//! `benchdog run`: plans, simulates, judges, records and reports scenarios.

use std::path::PathBuf;

use super::{
    args::RunArgs,
    batch::Batch,
    exit::{CliError, Exit},
    finish::{self, FinishedRun},
    inputs::Inputs,
    out_folder::Values,
    planners::Planners,
    progress::Progress,
    select::{self, Selected},
    threads,
};
use crate::{
    model::verdict::VerdictKind,
    pipeline::{self, Run, parallel, verdict_without_simulation},
    planner,
    report::SkipReason,
    scenario::LoadedScenario,
};

/// Runs scenarios. All scenarios and the output folder are checked before the first one is planned.
pub fn run(args: &RunArgs) -> Result<Exit, CliError> {
    let progress = Progress::counting("reading the scenarios", "the finished scenarios are reported")?;
    let scenarios = select::scenarios(&args.scenarios, &args.filter, &args.planner)?;
    let wanted: Vec<_> = scenarios.iter().filter(|selected| selected.wanted).collect();
    let inputs: Vec<_> = scenarios.iter().flat_map(|selected| selected.loaded.inputs.clone()).collect();
    let protected = Inputs::new(&inputs);
    finish::protect_from_reports(&args.report, &protected)?;
    let folders: Vec<_> = wanted.iter().map(|selected| folder_of(&selected.loaded, args)).collect();
    let names = wanted.iter().map(|selected| selected.loaded.scenario.name.as_str());
    finish::folders_differ(names.zip(folders.iter().map(PathBuf::as_path)))?;
    for (Selected { loaded, .. }, folder) in wanted.iter().zip(&folders) {
        finish::protect(&args.report, folder, loaded.plan_path().as_deref(), &protected)?;
    }
    finish::prepare(&args.report, folders.iter().map(PathBuf::as_path))?;
    let planners = Planners::new(args.cache).robust(args.planner.robust);
    let batch = Batch::new(progress, wanted.len(), args.fail_fast);
    let runner = Runner { args, planners, progress: batch.progress() };
    let to_be_planned = wanted.iter().map(|selected| &selected.loaded).filter(|loaded| loaded.plan.is_none());
    let to_be_planned: Vec<_> = to_be_planned.map(|loaded| (&loaded.robot, &loaded.scenario)).collect();
    let run_or_skip = |selected: &Selected| {
        let name = &selected.loaded.scenario.name;
        match selected.wanted {
            true => batch.run(name, || runner.run(&selected.loaded)),
            false => FinishedRun::skipped(name, SkipReason::Filtered),
        }
    };
    let finished = threads::with_threads(args.jobs, || {
        runner.planners.prepare(&to_be_planned, runner.progress);
        parallel::map_in_parallel(&scenarios, run_or_skip)
    })?;
    let summary = batch.end(finished)?;
    // The table first: it must not depend on a disk that is full by now.
    finish::report(&summary, &args.report)?;
    finish::write_reports(&summary.outcomes, &args.report.out.of_all())?;
    Ok(summary.exit)
}

/// The folder of a scenario's results.
fn folder_of(loaded: &LoadedScenario, args: &RunArgs) -> PathBuf {
    args.report.out.of_one(&Values::of(&loaded.scenario, None))
}

/// What the scenarios of a run share.
struct Runner<'a> {
    args: &'a RunArgs,
    planners: Planners,
    progress: &'a Progress,
}

impl Runner<'_> {
    fn run(&self, loaded: &LoadedScenario) -> Result<FinishedRun, CliError> {
        let run = self.planned_and_judged(loaded)?;
        let output = (&*folder_of(loaded, self.args), &self.args.report);
        finish::write_run(run, &loaded.scenario, &loaded.robot, loaded.plan_path().as_deref(), output)
    }

    /// Plans a scenario unless it names a plan, simulates the plan and judges it.
    fn planned_and_judged(&self, loaded: &LoadedScenario) -> Result<Run, CliError> {
        let scenario = &loaded.scenario;
        let plan = match &loaded.plan {
            Some(plan) => plan.clone(),
            None => match self.planners.timed_plan(scenario, &loaded.robot, self.progress)? {
                planner::Outcome::Found(plan) => plan,
                planner::Outcome::Infeasible(why) => {
                    let verdict = verdict_without_simulation(scenario, VerdictKind::Infeasible, why.to_string());
                    return Ok(Run { verdict, posture: None, plan: None, simulated: None });
                }
            },
        };
        self.progress.simulates();
        Ok(pipeline::run_plan(scenario, &loaded.robot, plan, &loaded.filled_in, self.progress)?)
    }
}
