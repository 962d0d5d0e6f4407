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
    let (plan, robot) = scenario::read_plan(&args.plan, None)?;
    let mut scenario = match (&args.scenario, &plan.scenario) {
        (Some(path), _) => scenario::load_for(path, &plan)?,
        (None, Some(scenario)) => scenario.clone(),
        (None, None) => scenario::for_plan(&plan, &robot),
    };
    scenario.name.clone_from(&plan.name);
    let ended = Ended::catch(&plan.name.clone(), || {
        let run = pipeline::run_plan(&scenario, &robot, plan)?;
        finish(run, &scenario, &robot, &args.report)
    });
    report(vec![ended], &args.report)
}
