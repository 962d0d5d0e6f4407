//! `benchdog front`: the Pareto front of the two comforts as CSV, SVG and plans.

use super::{
    args::FrontArgs,
    exit::{CliError, Exit},
    interrupt, output,
    plan::{infeasible, load_for_planning, stop_on_interrupt},
};
use crate::{
    planner::{Front, FrontPoint, Outcome, Planner},
    report::{self, front::Row},
};

/// Computes and writes the front.
pub fn front(args: &FrontArgs) -> Result<Exit, CliError> {
    let mut loaded = load_for_planning(&args.scenario)?;
    args.search.apply(&mut loaded.scenario.planner);
    report::file::check_folder(&args.out)?;
    interrupt::listen("the front of the plans found so far is written")?;
    let planner = Planner::new(&loaded.robot);
    match planner.search(&loaded.scenario).observer(&mut stop_on_interrupt).front()? {
        Outcome::Found(front) => {
            write(&front, args)?;
            Ok(if interrupt::requested() { Exit::Interrupted } else { Exit::Met })
        }
        Outcome::Infeasible(why) => Ok(infeasible(&loaded, &why)),
    }
}

fn write(front: &Front, args: &FrontArgs) -> Result<(), CliError> {
    let row = |point: &FrontPoint, own| {
        let [muscular, peripersonal_m] = point.comforts();
        Row { share: point.share, muscular, peripersonal_m, own }
    };
    for (index, point) in front.points.iter().enumerate() {
        let path = args.out.join(format!("front-{}.json", index + 1));
        report::file::write_whole(&path, report::json::plan(&point.plan).as_bytes())?;
    }
    let own = args.out.join("own-weights.json");
    report::file::write_whole(&own, report::json::plan(&front.own.plan).as_bytes())?;
    let mut rows: Vec<Row> = front.points.iter().map(|point| row(point, false)).collect();
    rows.push(row(&front.own, true));
    report::file::write_whole(&args.out.join("front.svg"), report::front::svg(&rows, front.optima).as_bytes())?;
    report::file::write_whole(&args.out.join("front.csv"), report::front::csv(&rows, front.optima).as_bytes())?;
    output::print(&report::front::table(&rows, front.optima))
}
