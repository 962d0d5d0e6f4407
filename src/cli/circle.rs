//! `benchdog circle`: the three ways to hold a board for a whole circle that is cut, side by side.

use super::{
    args::CircleArgs,
    curve::circle_radius_m,
    exit::{CliError, Exit},
    interrupt, output,
    plan::{infeasible, to_be_planned, until_interrupted},
};
use crate::{
    model::{plan::Plan, scenario::PersonAnswer},
    planner::{
        Outcome, Planner,
        path::{CirclePlans, Continuous, MotionStep},
    },
    report,
};

/// Writes plans and tables of the three ways.
pub fn circle(args: &CircleArgs) -> Result<Exit, CliError> {
    let mut loaded = to_be_planned(&args.scenario)?;
    circle_radius_m(&loaded)?;
    args.search.apply(&mut loaded.scenario.planner);
    // Of three ways to hold the best answers are compared; the mean of all would take minutes for each.
    loaded.scenario.comfort.person = PersonAnswer::Most;
    report::file::check_folder(&args.out)?;
    interrupt::listen("what was found of the circle is written")?;
    let planner = Planner::new(&loaded.robot);
    let found = match planner.search(&loaded.scenario).observer(&mut until_interrupted).circle()? {
        Outcome::Found(found) => found,
        Outcome::Infeasible(why) => return Ok(infeasible(&loaded, &why)),
    };
    let CirclePlans { continuous: Continuous { hold, sequence, motions }, separate } = found;
    let ways = [("hold", hold), ("sequence", sequence), ("separate", separate)];
    for (name, plans) in &ways {
        for (index, plan) in plans.iter().enumerate() {
            let path = args.out.join(format!("{name}-{}.json", index + 1));
            match plan {
                Some(plan) => report::file::write_whole(&path, report::json::plan(plan).as_bytes())?,
                None => report::file::remove(&path)?,
            }
        }
    }
    let joints = ways.iter().flat_map(|(_, plans)| plans).flatten().next().map_or_else(Vec::new, joints);
    let step = |step: &MotionStep| report::circle::Step { x_wo: step.x_wo, q_rad: step.q_rad.concat() };
    let motions: Vec<Vec<_>> = motions.iter().map(|motion| motion.iter().map(step).collect()).collect();
    report::file::write_whole(&args.out.join("motion.csv"), report::circle::motion_csv(&joints, &motions).as_bytes())?;
    let ways: Vec<_> = ways.iter().map(|(name, plans)| (*name, plans.as_slice())).collect();
    report::file::write_whole(&args.out.join("circle.csv"), report::circle::csv(&ways).as_bytes())?;
    output::print(&report::circle::table(&ways))?;
    Ok(if interrupt::requested() {
        Exit::Interrupted
    } else if ways.iter().any(|(_, plans)| plans.iter().any(Option::is_some)) {
        Exit::Met
    } else {
        Exit::Infeasible
    })
}

/// The names of all joints of a plan's arms, arm after arm.
fn joints(plan: &Plan) -> Vec<String> {
    plan.arms.iter().flat_map(|arm| arm.joints.clone()).collect()
}
