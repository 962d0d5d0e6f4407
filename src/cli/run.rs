//! `benchdog run`: plans, simulates, judges, records and reports scenarios.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use super::{
    args::RunArgs,
    exit::{CliError, Exit},
    finish::{self, FinishedRun, RunSummary},
    interrupt,
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
    report::{Outcome, SkipReason},
    scenario::LoadedScenario,
};

/// Runs scenarios. All scenarios and the output folder are checked before the first one is planned.
pub fn run(args: &RunArgs) -> Result<Exit, CliError> {
    let progress = Progress::counting("reading the scenarios", "the finished scenarios are reported")?;
    let scenarios = select::scenarios(&args.scenarios, &args.filter, &args.planner)?;
    let wanted: Vec<_> = scenarios.iter().filter(|selected| selected.wanted).collect();
    let inputs: Vec<_> = scenarios.iter().flat_map(|selected| selected.loaded.inputs.clone()).collect();
    finish::protect_from_reports(&args.report, &inputs)?;
    let folders: Vec<_> = wanted.iter().map(|selected| folder_of(&selected.loaded, args)).collect();
    let names = wanted.iter().map(|selected| selected.loaded.scenario.name.as_str());
    finish::folders_differ(names.zip(folders.iter().map(PathBuf::as_path)))?;
    for (Selected { loaded, .. }, folder) in wanted.iter().zip(&folders) {
        finish::protect(&args.report, folder, loaded.plan_path().as_deref(), &inputs)?;
    }
    finish::prepare(&args.report, folders.iter().map(PathBuf::as_path))?;
    progress.expect(wanted.len());
    progress.keep();
    let runner = Runner {
        args,
        planners: Planners::new(args.cache).robust(args.planner.robust),
        progress,
        failed: AtomicBool::new(false),
        fatal: Mutex::new(None),
    };
    let to_be_planned = wanted.iter().map(|selected| &selected.loaded).filter(|loaded| loaded.plan.is_none());
    let to_be_planned: Vec<_> = to_be_planned.map(|loaded| (&loaded.robot, &loaded.scenario)).collect();
    let finished = threads::with_threads(args.jobs, || {
        runner.planners.prepare(&to_be_planned, &runner.progress);
        parallel::map_in_parallel(&scenarios, |selected| runner.run_or_skip(selected))
    })?;
    runner.progress.finish();
    if let Some(error) = runner.fatal.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let summary = RunSummary::from(finished);
    // The table first: it must not depend on a disk that is full by now.
    finish::report(&summary, &args.report)?;
    finish::write_reports(&summary.outcomes, &args.report.out.of_all())?;
    Ok(summary.exit)
}

/// The folder of a scenario's results.
fn folder_of(loaded: &LoadedScenario, args: &RunArgs) -> PathBuf {
    args.report.out.of_one(&Values::of(&loaded.scenario, None))
}

/// State shared by the scenarios of a run.
struct Runner<'a> {
    args: &'a RunArgs,
    planners: Planners,
    progress: Arc<Progress>,
    /// True after an expectation was not met.
    failed: AtomicBool,
    /// The first error that affects all scenarios, such as a full disk.
    fatal: Mutex<Option<CliError>>,
}

impl Runner<'_> {
    /// Runs or skips a scenario.
    fn run_or_skip(&self, selected: &Selected) -> FinishedRun {
        let name = &selected.loaded.scenario.name;
        if let Some(reason) = self.reason_to_skip(selected) {
            return FinishedRun::skipped(name, reason);
        }
        self.progress.begins(name);
        let start = Instant::now();
        let mut finished = match FinishedRun::catch(name, || self.run(&selected.loaded)) {
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
            None => match self.planners.timed_plan(scenario, &loaded.robot, &*self.progress)? {
                planner::Outcome::Found(plan) => plan,
                planner::Outcome::Infeasible(why) => {
                    let verdict = verdict_without_simulation(scenario, VerdictKind::Infeasible, why.to_string());
                    return Ok(Run { verdict, posture: None, plan: None, simulated: None });
                }
            },
        };
        self.progress.simulates();
        Ok(pipeline::run_plan(scenario, &loaded.robot, plan, &loaded.filled_in, &*self.progress)?)
    }

    fn reason_to_skip(&self, selected: &Selected) -> Option<SkipReason> {
        let fatal = || self.fatal.lock().unwrap_or_else(PoisonError::into_inner).is_some();
        if !selected.wanted {
            Some(SkipReason::Filtered)
        } else if interrupt::requested() {
            Some(SkipReason::Interrupted)
        } else if fatal() || self.args.fail_fast && self.failed.load(Ordering::SeqCst) {
            Some(SkipReason::AfterFailure)
        } else {
            None
        }
    }
}
