//! `benchdog simulate`: simulates and judges a plan from any planner.

use std::time::Instant;

use super::{
    args::SimulateArgs,
    exit::{CliError, Exit},
    finish::{self, FinishedRun, RunSummary},
    interrupt, output,
    progress::Progress,
    task,
};
use crate::{
    pipeline,
    report::{self, Outcome},
    scenario::{self, AnyPlan, LoadedPlan},
};

/// Simulates and judges a plan under the given scenario, the one in the plan, or the defaults for its operation.
pub fn simulate(args: &SimulateArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the plan", "")?;
    match scenario::load_any_plan(&args.plan, args.scenario.as_deref())? {
        AnyPlan::OneHold(plan) => one_hold(args, *plan, &progress),
        AnyPlan::Staged(plan) => task::simulate(args, &plan, &progress),
    }
}

fn one_hold(args: &SimulateArgs, plan: LoadedPlan, progress: &Progress) -> Result<Exit, CliError> {
    let LoadedPlan { path, plan, filled_in, robot, scenario, inputs } = plan;
    finish::protect(&args.report, &plan.name, Some(&path), &inputs)?;
    finish::keep_other_plan(&args.report, &plan)?;
    report::file::check_folder(&args.report.out)?;
    let start = Instant::now();
    let mut writing = None;
    let mut finished = FinishedRun::catch(&plan.name.clone(), || {
        progress.simulates();
        let run = pipeline::run_plan(&scenario, &robot, plan, &filled_in, progress)?;
        writing = Some(interrupt::writing());
        finish::write_run(run, &scenario, &robot, Some(&path), &args.report)
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
