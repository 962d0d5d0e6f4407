//! `benchdog curve`: best and worst muscular comfort along a circular cut
//! (`docs/method.md#411-muscular-comfort-along-a-circle`).

use std::path::Path;

use super::{
    args::CurveArgs,
    exit::{CliError, Exit},
    inputs, interrupt, output,
    progress::Progress,
};
use crate::{
    collision::CollisionModel,
    comfort::curve::{Curve, Cut, POINTS, muscular_curve},
    human::{Human, muscular::formula_in_words},
    report,
    reproduce::paper,
    scenario::{self, LoadedScenario},
};

/// Writes the curve as CSV and SVG.
pub fn curve(args: &CurveArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "")?;
    let loaded = match &args.scenario {
        Some(path) => scenario::load(path)?,
        None => paper::printed_operations()[0].load()?,
    };
    let files = ["muscular_curve.csv", "muscular_curve.svg"].map(|name| args.out.join(name));
    inputs::protect(&loaded.inputs, files.clone())?;
    progress.does("computing the comfort along the circle");
    let curve = curve_of(&loaded)?;
    progress.finish();
    let _writing = interrupt::writing();
    let [csv, svg] = files;
    report::file::write_whole(&csv, report::curve::csv(&curve).as_bytes())?;
    report::file::write_whole(&svg, report::curve::svg(&curve).as_bytes())?;
    output::print(&summary(&curve, &args.out))?;
    Ok(Exit::Met)
}

/// The curve of the circle of a scenario's cut.
///
/// # Errors
/// If the operation is not a cut or is at the board's centre, or the person or the tool is invalid.
pub fn curve_of(loaded: &LoadedScenario) -> Result<Curve, CliError> {
    let scenario = &loaded.scenario;
    let radius_m = circle_radius_m(loaded)?;
    Ok(muscular_curve(&Cut {
        human: &Human::new(&scenario.human, &scenario.tool)?,
        collision: &CollisionModel::new(&loaded.robot),
        settings: scenario.comfort,
        board: &scenario.object.shape(),
        radius_m,
        force_n: scenario.operation.wrench_o.force_n.norm(),
        floor_z_m: loaded.robot.floor_z_m,
    }))
}

/// The radius of the circle of a scenario's cut, m.
///
/// # Errors
/// If the operation is not a cut or is at the board's centre.
pub fn circle_radius_m(loaded: &LoadedScenario) -> Result<f64, CliError> {
    loaded.scenario.operation.circle_radius_m().ok_or_else(|| {
        let found = format!("{}: found an operation that is not on a circle", loaded.path.display());
        CliError::Usage(format!("{found}, expected a cut away from the board's centre"))
    })
}

fn summary(curve: &Curve, out: &Path) -> String {
    let free = curve.points.iter().filter(|point| point.free.is_some()).count();
    let fixed = curve.points.iter().filter(|point| point.fixed.is_some()).count();
    let place = curve.x_wb_fixed.map_or_else(String::new, |x_wb| {
        let p_wb_m = x_wb.translation.vector;
        let heading_deg = x_wb.rotation.euler_angles().2.to_degrees();
        format!(", at x {:.2} m, y {:.2} m, heading {heading_deg:.0} degrees", p_wb_m.x, p_wb_m.y)
    });
    format!(
        "{free} of {POINTS} points can be cut standing anywhere, {fixed} from one place{place}\n\
         muscular comfort: {1}\n\
         written: {0}/muscular_curve.csv, {0}/muscular_curve.svg\n",
        out.display(),
        formula_in_words(curve.metric)
    )
}
