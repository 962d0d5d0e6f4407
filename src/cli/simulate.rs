//! `benchdog simulate`: any plan, ours or not.

use super::{
    args::SimulateArgs,
    exit::{CliError, Exit},
    finish::{Ended, finish, report},
    pipeline,
};
use crate::scenario;

/// Simulates and judges a plan under the scenario given, the one in the plan, or the defaults for its operation.
pub fn simulate(args: &SimulateArgs) -> Result<Exit, CliError> {
    let (plan, robot, scenario) = scenario::plan_and_scenario(&args.plan, args.scenario.as_deref())?;
    let ended = Ended::catch(&plan.name.clone(), || {
        let run = pipeline::run_plan(&scenario, &robot, plan)?;
        finish(run, &scenario, &robot, &args.report)
    });
    report(vec![ended], &args.report)
}
