//! `benchdog circle`: plans the cut of a whole circle with three strategies and compares them.

use std::path::{Path, PathBuf};

use super::{
    cache,
    curve::circle_radius_m,
    exit::{CliError, Exit},
    inputs, interrupt, output,
    plan::{infeasible, load_for_planning},
    progress::Progress,
    task_args::CircleArgs,
};
use crate::{
    model::{plan::Plan, scenario::ResponseKind},
    planner::{
        Outcome,
        path::{self, CirclePlans, Continuous, MotionStep},
    },
    report,
};

/// The strategies, in the order of tables.
const STRATEGIES: [&str; 3] = ["hold", "sequence", "separate"];

/// Plans with the three strategies and writes plans and tables.
pub fn circle(args: &CircleArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "what was found is written")?;
    let mut loaded = load_for_planning(&args.scenario)?;
    circle_radius_m(&loaded)?;
    args.search.apply(&mut loaded.scenario.planner);
    // The strategies are compared by the person's best response: the mean response would take minutes per grasp.
    loaded.scenario.comfort.person = ResponseKind::Best;
    let [circle_csv, motion_csv] = ["circle.csv", "motion.csv"].map(|name| args.out.join(name));
    let plans =
        STRATEGIES.iter().flat_map(|strategy| (1..=path::POINTS).map(|point| plan_path(&args.out, strategy, point)));
    inputs::protect(&loaded.inputs, plans.chain([circle_csv.clone(), motion_csv.clone()]))?;
    report::file::check_folder(&args.out)?;
    let planner = cache::planner(&loaded.robot, args.cache);
    let outcome = planner.search(&loaded.scenario).watch(&*progress).circle()?;
    progress.finish();
    let found = match outcome {
        Outcome::Found(found) => found,
        Outcome::Infeasible(why) => return Ok(infeasible(&loaded, &why)),
    };
    let CirclePlans { continuous: Continuous { hold, sequence, motions }, separate } = found;
    let strategies = [("hold", hold), ("sequence", sequence), ("separate", separate)];
    for (name, plans) in &strategies {
        for (index, plan) in plans.iter().enumerate() {
            let path = plan_path(&args.out, name, index + 1);
            match plan {
                Some(plan) => report::file::write_whole(&path, report::json::plan(plan).as_bytes())?,
                None => report::file::remove(&path)?,
            }
        }
    }
    let joints = strategies.iter().flat_map(|(_, plans)| plans).flatten().next().map_or_else(Vec::new, joints);
    let step = |step: &MotionStep| report::circle::Step { x_wo: step.x_wo, q_rad: step.q_rad.concat() };
    let motions: Vec<Vec<_>> = motions.iter().map(|motion| motion.iter().map(step).collect()).collect();
    report::file::write_whole(&motion_csv, report::circle::motion_csv(&joints, &motions).as_bytes())?;
    let strategies: Vec<_> = strategies.iter().map(|(name, plans)| (*name, plans.as_slice())).collect();
    report::file::write_whole(&circle_csv, report::circle::csv(&strategies).as_bytes())?;
    output::print(&report::circle::table(&strategies))?;
    Ok(if interrupt::requested() {
        Exit::Interrupted
    } else if strategies.iter().any(|(_, plans)| plans.iter().any(Option::is_some)) {
        Exit::Met
    } else {
        Exit::Infeasible
    })
}

/// The file of a strategy's plan for a point, from 1.
fn plan_path(folder: &Path, strategy: &str, point: usize) -> PathBuf {
    folder.join(format!("{strategy}-{point}.json"))
}

/// The names of all joints of a plan's arms, arm after arm.
fn joints(plan: &Plan) -> Vec<String> {
    plan.arms.iter().flat_map(|arm| arm.joints.clone()).collect()
}
