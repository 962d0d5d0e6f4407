//! `benchdog doctor my-robot.toml`: checks a robot's description, and records the robot to look at.

use std::path::Path;

use super::{
    args::DoctorArgs,
    exit::{CliError, Exit},
    output,
};
use crate::{
    collision::CollisionModel,
    input::{self, MOST_TOML},
    robot::{Chain, Finger, Gripper, Holding, InverseKinematics, MeasuredGrip, Robot, RobotError},
    setup::{Overlaps, middle, positions},
};

/// The share of random postures from which on a pair is told, and how many pairs are.
const OFTEN: f64 = 0.05;
const MOST_PAIRS: usize = 10;

/// Checks a description: all faults, all links that overlap in the middle posture, what is assumed.
pub fn check(description: &Path, args: &DoctorArgs) -> Result<Exit, CliError> {
    let robot = match Robot::load(&description.display().to_string(), Path::new("")) {
        Ok(robot) => robot,
        Err(RobotError::Invalid(faults)) => {
            let lines: Vec<String> = faults.all().iter().map(|fault| format!("WRONG  {fault}\n")).collect();
            output::report(&lines.concat())?;
            return Err(CliError::Machine(format!("found {} faults in the description", lines.len())));
        }
        Err(error) => return Err(CliError::Robot(error)),
    };
    let q_rad = middle(&robot);
    let joint_positions = positions(&robot, &q_rad, 0.5);
    let mut lines: Vec<String> = (0..robot.arms.len()).map(|arm| arm_line(&robot, arm)).collect();
    lines.push(format!(
        "ok     {} links, {} points, {} pairs of links may overlap",
        robot.links.len(),
        robot.body_points.len(),
        robot.allowed_collisions.len()
    ));
    lines.extend(robot.notes.iter().map(|note| format!("note   {note}")));
    lines.extend(assumed(&robot.files).into_iter().map(|line| format!("note   {line}")));
    let overlaps = CollisionModel::new(&robot).overlapping_links(&robot.link_poses(&joint_positions));
    for [a, b] in &overlaps {
        let [a, b] = [*a, *b].map(|link| &robot.links[link].name);
        lines.push(format!(
            "WRONG  {a} and {b} overlap with the arms in the middle of their ranges: if the parts do not touch there, add \
             [\"{a}\", \"{b}\"] to allowed_collisions"
        ));
    }
    lines.extend(often(&robot));
    output::report(&(lines.join("\n") + "\n"))?;
    record(&robot, &joint_positions, description, args)?;
    match overlaps.len() {
        0 => Ok(Exit::Met),
        count => Err(CliError::Machine(format!("found {count} pairs of links that overlap"))),
    }
}

fn arm_line(robot: &Robot, index: usize) -> String {
    let arm = &robot.arms[index];
    let gripper = &arm.gripper;
    let chain = Chain::new(robot, index, 0.0);
    let solver = InverseKinematics::for_chain(&chain).name();
    format!(
        "ok     arm {}: {} joints, reach {:.2} m, {solver} inverse kinematics; {}, {}",
        arm.name,
        arm.joints.len(),
        chain.reach_m(),
        shape_of(gripper),
        holds(gripper),
    )
}

/// What a gripper looks like.
fn shape_of(gripper: &Gripper) -> String {
    let [narrow_mm, wide_mm] = gripper.opening_m.map(|m| m * 1e3);
    match (&gripper.cup, gripper.fingers.first()) {
        (Some(cup), _) => format!("suction cup of {:.1} mm", 2e3 * cup.radius_m),
        (None, Some(Finger { pad, .. })) => {
            let [width_mm, height_mm] = pad.size_m.map(|m| m * 1e3);
            format!("gripper opens {narrow_mm:.1} to {wide_mm:.1} mm, pads {width_mm:.1} x {height_mm:.1} mm")
        }
        (None, None) => "no gripper".to_owned(),
    }
}

/// What a gripper holds.
fn holds(gripper: &Gripper) -> String {
    match &gripper.holding {
        Holding::Pads(pads) => format!("{} N", pads.max_force_n),
        Holding::Measured(MeasuredGrip { limits, stiffness }) => {
            let grip = if stiffness.is_some() { "elastic" } else { "rigid" };
            format!("{grip} within a measured {limits}")
        }
    }
}

/// How often links meet in random postures: shapes that are too large leave no posture to a planner.
fn often(robot: &Robot) -> Vec<String> {
    let overlaps = Overlaps::of(robot);
    let percent = |share: f64| (100.0 * share).round();
    let mut lines = vec![format!("ok     {} % of random postures are free of overlaps", percent(overlaps.free))];
    lines.extend(overlaps.shares.iter().filter(|(_, share)| *share >= OFTEN).take(MOST_PAIRS).map(
        |([a, b], share)| {
            let [a, b] = [*a, *b].map(|link| &robot.links[link].name);
            format!("note   {a} and {b} overlap in {} % of random postures", percent(*share))
        },
    ));
    lines
}

/// The lines of a description that are marked as assumed.
fn assumed(files: &[std::path::PathBuf]) -> Vec<String> {
    let Some(text) = files.first().and_then(|path| input::text(path, MOST_TOML).ok()) else { return Vec::new() };
    let lines = text.lines().enumerate().filter(|(_, line)| line.contains("# ASSUMED"));
    lines.map(|(number, line)| format!("line {}: {}", number + 1, line.trim())).collect()
}

/// Writes the recording if one is asked for.
#[cfg(feature = "recording")]
fn record(robot: &Robot, joint_positions: &[f64], description: &Path, args: &DoctorArgs) -> Result<(), CliError> {
    let Some(path) = &args.record else { return Ok(()) };
    super::inputs::protect(&[robot.files.clone(), vec![description.to_owned()]].concat(), [path.clone()])?;
    crate::report::file::write_whole(path, &crate::record::encode_posture(robot, joint_positions)?)?;
    output::print(&format!("wrote {}; look at it with: benchdog view {0}\n", path.display()))
}

#[cfg(not(feature = "recording"))]
fn record(_: &Robot, _: &[f64], _: &Path, args: &DoctorArgs) -> Result<(), CliError> {
    match &args.record {
        Some(_) => Err(CliError::Machine("this benchdog was built without recordings".to_owned())),
        None => Ok(()),
    }
}
