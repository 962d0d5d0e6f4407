//! `benchdog plan`: a scenario's hold, written to a file or to standard output; with `--top` several that differ.

use std::{ops::ControlFlow, path::Path};

use super::{
    args::PlanArgs,
    exit::{CliError, Exit},
    interrupt, output,
    planners::Planners,
};
use crate::{
    model::verdict::VerdictKind,
    planner::{Infeasible, Outcome, Planner, Progress},
    report,
    scenario::{self, LoadedScenario},
};

/// Plans a scenario. Ctrl-C ends the search with the best hold so far.
pub fn plan(args: &PlanArgs) -> Result<Exit, CliError> {
    let mut loaded = to_be_planned(&args.scenario)?;
    args.planner.apply(&mut loaded.scenario.planner);
    interrupt::listen("the best plan so far is checked and written")?;
    match (args.top, &args.output) {
        (Some(wanted), Some(folder)) => top(&loaded, wanted.get(), folder),
        _ => one(&loaded, args.output.as_deref()),
    }
}

/// Reads a scenario that does not bring its plan.
pub fn to_be_planned(path: &Path) -> Result<LoadedScenario, CliError> {
    let loaded = scenario::load(path)?;
    if loaded.plan.is_some() {
        let path = path.display();
        return Err(CliError::Usage(format!(
            "{path}: planner.plan: the scenario has its plan, there is nothing to plan"
        )));
    }
    Ok(loaded)
}

/// Ends a search once the user has asked for it.
pub fn until_interrupted(_: &Progress<'_>) -> ControlFlow<()> {
    if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn one(loaded: &LoadedScenario, output: Option<&Path>) -> Result<Exit, CliError> {
    let outcome = Planners::default().timed_plan(&loaded.scenario, &loaded.robot, Some(&mut until_interrupted))?;
    match outcome {
        Outcome::Found(plan) => {
            let text = report::json::plan(&plan);
            match output {
                Some(path) => report::file::write_whole(path, text.as_bytes())?,
                None => output::print(&text)?,
            }
            Ok(found(loaded))
        }
        Outcome::Infeasible(why) => Ok(infeasible(loaded, &why)),
    }
}

fn top(loaded: &LoadedScenario, wanted: usize, folder: &Path) -> Result<Exit, CliError> {
    report::file::check_folder(folder)?;
    let planner = Planner::new(&loaded.robot);
    match planner.search(&loaded.scenario).observer(&mut until_interrupted).top(wanted)? {
        Outcome::Found(plans) => {
            for (index, plan) in plans.iter().enumerate() {
                let path = folder.join(format!("plan-{}.json", index + 1));
                report::file::write_whole(&path, report::json::plan(plan).as_bytes())?;
            }
            output::print(&report::plans::table(&plans))?;
            Ok(found(loaded))
        }
        Outcome::Infeasible(why) => Ok(infeasible(loaded, &why)),
    }
}

fn found(loaded: &LoadedScenario) -> Exit {
    if interrupt::requested() {
        Exit::Interrupted
    } else if loaded.scenario.expect.verdict == VerdictKind::Infeasible {
        Exit::NotMet
    } else {
        Exit::Met
    }
}

/// Says that a scenario has no plan, and why.
pub fn infeasible(loaded: &LoadedScenario, why: &Infeasible) -> Exit {
    output::complain(&format!("{}: no feasible plan: {why}", loaded.scenario.name));
    if interrupt::requested() {
        Exit::Interrupted
    } else if loaded.scenario.expect.verdict == VerdictKind::Infeasible {
        Exit::Met
    } else {
        Exit::Infeasible
    }
}
