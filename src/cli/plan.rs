//! `benchdog plan`: writes a scenario's plan or, with `--top`, the best plans that differ.

use std::path::{Path, PathBuf};

use super::{
    args::PlanArgs,
    cache::{self, CacheArgs},
    exit::{CliError, Exit},
    inputs, interrupt, output,
    planners::Planners,
    progress::Progress,
    streams,
};
use crate::{
    model::{plan::Plan, verdict::VerdictKind},
    planner::{Infeasible, Outcome},
    report,
    scenario::{self, LoadedScenario},
};

/// Plans a scenario. Ctrl-C ends the search with the best plan so far.
pub fn plan(args: &PlanArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "the best plan so far is checked and written")?;
    let mut loaded = load_for_planning(&args.scenario)?;
    args.planner.apply(&mut loaded.scenario.planner);
    let output = args.output.as_deref().and_then(streams::file);
    let outputs: Vec<_> = match (output, args.top) {
        (Some(folder), Some(wanted)) => (1..=wanted.get()).map(|number| numbered(folder, number)).collect(),
        (None, Some(_)) => {
            return Err(CliError::Usage("-o -: found standard output, expected a folder beside --top".into()));
        }
        (output, None) => output.map(Path::to_owned).into_iter().collect(),
    };
    inputs::protect(&loaded.inputs, outputs)?;
    match (args.top, output) {
        (Some(wanted), Some(folder)) => top(&loaded, wanted.get(), folder, args.cache, &progress),
        _ => one(&loaded, output, Planners::new(args.cache).robust(args.planner.robust), &progress),
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

fn one(
    loaded: &LoadedScenario,
    output: Option<&Path>,
    planners: Planners,
    progress: &Progress,
) -> Result<Exit, CliError> {
    let outcome = planners.timed_plan(&loaded.scenario, &loaded.robot, progress)?;
    progress.finish();
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
            output::message(&result_line(&plan));
            Ok(found(loaded))
        }
        Outcome::Infeasible(why) => Ok(infeasible(loaded, &why)),
    }
}

/// What a user wants to know of a plan, such as `quickstart: planned in 0.08 s (maps 6.1 s): objective 95.5, load factor 1.42`.
fn result_line(plan: &Plan) -> String {
    let seconds = |ms: Option<f64>| ms.unwrap_or_default() / 1e3;
    let [wall_s, map_s] = plan.planner.map_or([0.0; 2], |record| [record.wall_ms, record.map_ms].map(seconds));
    let so_far = if interrupt::requested() { ", the best so far" } else { "" };
    let mut line = format!("{}: planned in {wall_s:.2} s (maps {map_s:.1} s){so_far}", plan.name);
    if let Some(comfort) = &plan.comfort {
        let (objective, muscular, peripersonal_m) =
            (comfort.objective, comfort.muscular_regularised, comfort.peripersonal_m);
        line.push_str(&format!(
            ": objective {objective:.2} (muscular {muscular:.2}, peripersonal {peripersonal_m:.3} m)"
        ));
    }
    if let Some(stability) = &plan.stability {
        line.push_str(&format!(", load factor {:.2}", stability.compliant_load_factor));
    }
    if let Some(robust) = plan.planner.and_then(|record| record.robust) {
        line.push_str(&format!(", holds with probability {:.3} in {} runs", robust.probability, robust.runs));
    }
    line
}

fn top(
    loaded: &LoadedScenario,
    wanted: usize,
    folder: &Path,
    cache: CacheArgs,
    progress: &Progress,
) -> Result<Exit, CliError> {
    report::file::check_folder(folder)?;
    let planner = cache::planner(&loaded.robot, cache);
    let outcome = planner.search(&loaded.scenario).watch(progress).top(wanted)?;
    progress.finish();
    match outcome {
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
