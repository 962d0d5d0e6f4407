//! `benchdog robot new`: writes the description of a robot from its URDF.

use std::path::{Path, PathBuf};

use super::{
    args::RobotNewArgs,
    exit::{CliError, Exit},
    inputs, interrupt, output,
    progress::Progress,
};
use crate::{
    report::file,
    setup::{Reason, Setup, SetupInput, setup},
};

/// Board and load of the scenario that is written: light, and thin enough for most grippers.
const BOARD_M: [f64; 3] = [0.40, 0.30, 0.020];
const DRILL_N: f64 = 10.0;

/// The share of a gripper's opening that the board's thickness may be.
const OPENING_SHARE: f64 = 0.8;

/// Writes a description, and a scenario if one is asked for.
pub fn new(args: &RobotNewArgs) -> Result<Exit, CliError> {
    let input = SetupInput { urdf: args.urdf.clone(), srdf: args.srdf.clone(), packages: args.packages.clone() };
    let outputs = || std::iter::once(args.output.clone()).chain(args.scenario.clone());
    if let Some(path) = outputs().find(|path| path.exists() && !args.force) {
        return Err(CliError::Machine(format!("failed to write {}: it exists; --force replaces it", path.display())));
    }
    inputs::protect(&[vec![input.urdf.clone()], input.srdf.iter().cloned().collect()].concat(), outputs())?;
    let folder = args.output.parent().unwrap_or(Path::new(""));
    let progress = Progress::begin("reading the URDF and sampling postures", "")?;
    let made = setup(&input, folder)?;
    progress.finish();
    let _writing = interrupt::writing();
    inputs::protect(&made.robot.files, outputs())?;
    file::write_whole(&args.output, made.text.as_bytes())?;
    if let Some(path) = &args.scenario {
        file::write_whole(path, scenario(&made, &args.output, path).as_bytes())?;
    }
    output::print(&summary(&made, args))?;
    Ok(Exit::Met)
}

/// What was found, and what a person must do.
fn summary(made: &Setup, args: &RobotNewArgs) -> String {
    let robot = &made.robot;
    let mut lines = vec![format!("wrote {}", args.output.display())];
    for arm in &robot.arms {
        let gripper = &arm.gripper;
        let hand = made.clamps.iter().find(|(name, _)| *name == arm.name).map_or_else(
            || {
                let kind = if gripper.linkage.is_some() { "linkage gripper" } else { "gripper" };
                let [low, high] = gripper.opening_m.map(|m| m * 1e3);
                format!("{kind} opening {low:.1} to {high:.1} mm")
            },
            |(_, why)| format!("a clamp is assumed: {why}"),
        );
        lines.push(format!("  arm {}: {} joints, {hand}", arm.name, arm.joints.len()));
    }
    let count = |reason: Reason| made.allowed.iter().filter(|pair| pair.reason == reason).count();
    lines.push(format!(
        "  {} pairs of links may overlap: {} adjacent, {} always, {} often, {} in the middle posture, {} by the SRDF",
        made.allowed.len(),
        count(Reason::Adjacent),
        count(Reason::Always),
        count(Reason::Often),
        count(Reason::Middle),
        count(Reason::Srdf)
    ));
    lines.push(format!("  {} points on the surface, floor at {} m", robot.body_points.len(), robot.floor_z_m));
    lines.extend(robot.notes.iter().map(|note| format!("  note: {note}")));
    lines.push("  measure: stiffness of the joints, grip force, friction, pads (lines with ASSUMED)".into());
    lines.push(format!("next: benchdog doctor {}", args.output.display()));
    if let Some(path) = &args.scenario {
        lines.push(format!("then: benchdog run {}", path.display()));
    }
    lines.join("\n") + "\n"
}

/// A scenario for the robot: a board that all grippers can hold, drilled in the middle.
fn scenario(made: &Setup, description: &Path, scenario: &Path) -> String {
    let widest_m = made.robot.arms.iter().map(|arm| arm.gripper.opening_m[1]).fold(f64::INFINITY, f64::min);
    let narrowest_m = made.robot.arms.iter().map(|arm| arm.gripper.opening_m[0]).fold(0.0, f64::max);
    let thickness_m = (BOARD_M[2].min(OPENING_SHARE * widest_m).max(narrowest_m + 1e-3) * 1e3).round() / 1e3;
    let [width_m, height_m, _] = BOARD_M;
    let name = scenario.file_stem().map_or_else(|| "drill".into(), |stem| stem.to_string_lossy().into_owned());
    let here = path_from(scenario, description).display().to_string();
    format!(
        "# Written by `benchdog robot new`: a person drills a board that the robot holds.\n\n\
         format = 1\nname = {}\n\n[robot]\ndescription = {}\n\n\
         [object]\nsize_m = [{width_m:?}, {height_m:?}, {thickness_m:?}]\nmaterial = \"foam\"\n\n\
         [operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = {DRILL_N:?}\n",
        toml::Value::from(output::file_stem(&name)),
        toml::Value::from(here)
    )
}

/// The description as the scenario names it: relative if both are in one folder.
fn path_from(scenario: &Path, description: &Path) -> PathBuf {
    let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let same = folder(scenario) == folder(description);
    match description.file_name() {
        Some(name) if same => PathBuf::from(name),
        _ => description.canonicalize().unwrap_or_else(|_| description.to_owned()),
    }
}
