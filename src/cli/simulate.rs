//! `benchdog simulate`: any plan, ours or not.

use std::time::Instant;

use super::{
    args::SimulateArgs,
    exit::{CliError, Exit},
    finish::{self, Ended, Ending},
    output, pipeline,
};
use crate::{
    report::{self, Outcome},
    scenario,
};

/// Simulates and judges a plan under the scenario given, the one in the plan, or the defaults for its operation.
pub fn simulate(args: &SimulateArgs) -> Result<Exit, CliError> {
    let (plan, robot) = scenario::read_plan(&args.plan, None)?;
    let mut scenario = match (&args.scenario, &plan.scenario) {
        (Some(path), _) => scenario::load_for(path, &plan)?,
        (None, Some(scenario)) => scenario.clone(),
        (None, None) => scenario::for_plan(&plan, &robot),
    };
    scenario.name.clone_from(&plan.name);
    report::file::check_folder(&args.report.out)?;
    let start = Instant::now();
    let mut ended = Ended::catch(&plan.name.clone(), || {
        let run = pipeline::run_plan(&scenario, &robot, plan)?;
        finish::finish(run, &scenario, &robot, &args.report)
    })?;
    ended.wall_s = Some(start.elapsed().as_secs_f64());
    if let Outcome::Crashed { name, message } = &ended.outcome {
        output::complain(&format!("error: {name}: {message}"));
    }
    let ending = Ending::from(vec![ended]);
    finish::report(&ending, &args.report)?;
    Ok(ending.exit)
}
