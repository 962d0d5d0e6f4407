//! `benchdog plan`: a scenario's hold, written to a file or to standard output.

use super::{
    args::PlanArgs,
    exit::{CliError, Exit},
    maps::Maps,
    output, pipeline,
};
use crate::{model::verdict::VerdictKind, planner::PlanOutcome, report, scenario};

/// Plans a scenario.
pub fn plan(args: &PlanArgs) -> Result<Exit, CliError> {
    let mut loaded = scenario::load(&args.scenario)?;
    if loaded.plan.is_some() {
        let path = args.scenario.display();
        return Err(CliError::Usage(format!(
            "{path}: planner.plan: the scenario has its plan, there is nothing to plan"
        )));
    }
    if let Some(seed) = args.seed {
        loaded.scenario.planner.seed = seed;
    }
    let infeasible_expected = loaded.scenario.expect.verdict == VerdictKind::Infeasible;
    match pipeline::timed_plan(&loaded.scenario, &loaded.robot, &Maps::default())? {
        PlanOutcome::Found(plan) => {
            let text = report::json::plan(&plan);
            match &args.output {
                Some(path) => report::file::write_whole(path, text.as_bytes())?,
                None => output::print(&text)?,
            }
            Ok(if infeasible_expected { Exit::NotMet } else { Exit::Met })
        }
        PlanOutcome::Infeasible(why) => {
            output::complain(&format!("{}: no feasible plan: {why}", loaded.scenario.name));
            Ok(if infeasible_expected { Exit::Met } else { Exit::Infeasible })
        }
    }
}
