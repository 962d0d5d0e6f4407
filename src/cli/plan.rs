//! `benchdog plan`: writes a scenario's plan or, with `--top`, the best plans that differ.

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    args::{CacheArgs, PlanArgs},
    cache,
    exit::{CliError, Exit},
    inputs, interrupt, output,
    planners::Planners,
};
use crate::{
    model::verdict::VerdictKind,
    planner::{Infeasible, Outcome, Progress},
    report,
    scenario::{self, LoadedScenario},
};

/// Plans a scenario. Ctrl-C ends the search with the best plan so far.
pub fn plan(args: &PlanArgs) -> Result<Exit, CliError> {
    let mut loaded = load_for_planning(&args.scenario)?;
    args.planner.apply(&mut loaded.scenario.planner);
    let outputs: Vec<_> = match (&args.output, args.top) {
        (Some(folder), Some(wanted)) => (1..=wanted.get()).map(|number| numbered(folder, number)).collect(),
        (output, _) => output.iter().cloned().collect(),
    };
    inputs::protect(&loaded.inputs, outputs)?;
    interrupt::listen("the best plan so far is checked and written")?;
    match (args.top, &args.output) {
        (Some(wanted), Some(folder)) => top(&loaded, wanted.get(), folder, args.cache),
        _ => one(&loaded, args.output.as_deref(), args.cache),
    }
}

/// Reads a scenario that does not name a plan.
///
/// # Errors
/// If it is invalid or names a plan.
pub fn load_for_planning(path: &Path) -> Result<LoadedScenario, CliError> {
    let loaded = scenario::load(path)?;
    if loaded.plan.is_some() {
        let path = path.display();
        return Err(CliError::Usage(format!("{path}: planner.plan: found a plan, expected a scenario without one")));
    }
    Ok(loaded)
}

/// Ends a search after Ctrl-C.
pub fn stop_on_interrupt(_: &Progress<'_>) -> ControlFlow<()> {
    if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn one(loaded: &LoadedScenario, output: Option<&Path>, cache: CacheArgs) -> Result<Exit, CliError> {
    let planners = Planners::new(cache);
    let outcome = planners.timed_plan(&loaded.scenario, &loaded.robot, Some(&mut stop_on_interrupt))?;
    match outcome {
        Outcome::Found(plan) => {
            let text = report::json::plan(&plan);
            let posture = plan.human.and_then(|human| human.posture);
            let mut table = posture.map(|figures| report::posture::table(&figures)).unwrap_or_default();
            if let Some(clearance) = &plan.clearance {
                table.push_str(&format!("clearance of the robot: {clearance}\n"));
            }
            if let Some(work) = &plan.muscles {
                table.push_str(&report::muscles::table(work));
            }
            if let Some(push) = plan.stability.as_ref().and_then(|stability| stability.lateral.as_ref()) {
                table.push_str(&format!("sideways push: {push}, the worst direction\n"));
            }
            match output {
                Some(path) => {
                    report::file::write_whole(path, text.as_bytes())?;
                    output::print(&table)?;
                }
                // The plan alone is on the standard output.
                None => {
                    output::print(&text)?;
                    output::message(table.trim_end());
                }
            }
            Ok(found(loaded))
        }
        Outcome::Infeasible(why) => Ok(infeasible(loaded, &why)),
    }
}

fn top(loaded: &LoadedScenario, wanted: usize, folder: &Path, cache: CacheArgs) -> Result<Exit, CliError> {
    report::file::check_folder(folder)?;
    let planner = cache::planner(&loaded.robot, cache);
    match planner.search(&loaded.scenario).observer(&mut stop_on_interrupt).top(wanted)? {
        Outcome::Found(plans) => {
            for (index, plan) in plans.iter().enumerate() {
                report::file::write_whole(&numbered(folder, index + 1), report::json::plan(plan).as_bytes())?;
            }
            output::print(&report::plans::table(&plans))?;
            Ok(found(loaded))
        }
        Outcome::Infeasible(why) => Ok(infeasible(loaded, &why)),
    }
}

/// The file of one of the best plans, from 1.
fn numbered(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("plan-{number}.json"))
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

/// Prints why no plan was found; returns the command's result.
pub fn infeasible(loaded: &LoadedScenario, why: &Infeasible) -> Exit {
    output::message(&format!("{}: no feasible plan: {why}", loaded.scenario.name));
    if interrupt::requested() {
        Exit::Interrupted
    } else if loaded.scenario.expect.verdict == VerdictKind::Infeasible {
        Exit::Met
    } else {
        Exit::Infeasible
    }
}
