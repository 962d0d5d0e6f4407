//! `benchdog front`: the Pareto front of the two comforts as CSV, SVG and plans.

use std::path::{Path, PathBuf};

use super::{
    args::FrontArgs,
    cache,
    exit::{CliError, Exit},
    inputs, interrupt, output,
    plan::{infeasible, load_for_planning},
    progress::Progress,
};
use crate::{
    model::scenario::MuscularMetric,
    planner::{Front, FrontPoint, Outcome},
    report::{self, front::Row},
};

/// The files beside the plans `front-1.json` and so on.
const OTHER_FILES: [&str; 3] = ["own-weights.json", "front.svg", "front.csv"];

/// Computes and writes the front.
pub fn front(args: &FrontArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "the front of the plans found so far is written")?;
    let mut loaded = load_for_planning(&args.scenario)?;
    args.search.apply(&mut loaded.scenario.planner);
    inputs::protect(&loaded.inputs, outputs(&args.out))?;
    report::file::check_folder(&args.out)?;
    let planner = cache::planner(&loaded.robot, args.cache);
    let outcome = planner.search(&loaded.scenario).watch(&*progress).front()?;
    progress.finish();
    match outcome {
        Outcome::Found(front) => {
            write(&front, loaded.scenario.comfort.muscular, args)?;
            Ok(if interrupt::requested() { Exit::Interrupted } else { Exit::Met })
        }
        Outcome::Infeasible(why) => Ok(infeasible(&loaded, &why)),
    }
}

/// The files that may be written into a folder. How many plans there will be is not known yet, but only files that exist can
/// be inputs.
fn outputs(folder: &Path) -> Vec<PathBuf> {
    let existing = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_output = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        OTHER_FILES.contains(&&*name) || name.starts_with("front-") && name.ends_with(".json")
    };
    existing.filter(is_output).collect()
}

fn write(front: &Front, metric: MuscularMetric, args: &FrontArgs) -> Result<(), CliError> {
    let row = |point: &FrontPoint, own| {
        let [muscular, peripersonal_m] = point.comforts();
        Row { share: point.share, muscular, peripersonal_m, own }
    };
    for (index, point) in front.points.iter().enumerate() {
        let path = args.out.join(format!("front-{}.json", index + 1));
        report::file::write_whole(&path, report::json::plan(&point.plan).as_bytes())?;
    }
    let [own, svg, csv] = OTHER_FILES.map(|name| args.out.join(name));
    report::file::write_whole(&own, report::json::plan(&front.own.plan).as_bytes())?;
    let mut rows: Vec<Row> = front.points.iter().map(|point| row(point, false)).collect();
    rows.push(row(&front.own, true));
    report::file::write_whole(&svg, report::front::svg(&rows, front.optima, metric).as_bytes())?;
    report::file::write_whole(&csv, report::front::csv(&rows, front.optima).as_bytes())?;
    output::print(&report::front::table(&rows, front.optima))
}
