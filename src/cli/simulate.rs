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
    let (plan, robot, scenario) = scenario::plan_and_scenario(&args.plan, args.scenario.as_deref())?;
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
