//! Scenario and plan files: read, checked, completed with defaults.
//!
//! Whatever a file gets wrong is found here, before anything is planned or written, and said with the file, the line,
//! the key, what was found and what was expected. This module knows files and figures; it never plans or simulates.

mod check;
pub mod error;
pub mod file;
pub mod load_section;
mod locate;
pub mod material;
pub mod paper;
pub mod plan_file;
mod resolve;

use std::path::{Path, PathBuf};

pub use error::{InputError, InputErrorKind};
pub use plan_file::read_plan;

use crate::{
    model::{
        plan::Plan,
        scenario::{ArmParameters, PadParameters, RobotParameters, Scenario},
    },
    robot::{BUILTIN, Robot, RobotError},
};

/// A scenario that can be run: resolved, with its robot and, where the file names one, the plan to judge.
#[derive(Clone, Debug)]
pub struct LoadedScenario {
    /// Where it was read from.
    pub path: PathBuf,
    /// Every figure, defaults filled in.
    pub scenario: Scenario,
    /// The robot.
    pub robot: Robot,
    /// The plan of `planner.plan`.
    pub plan: Option<Plan>,
}

/// Reads, checks and completes a scenario file.
///
/// # Errors
/// When the file, the robot or the plan that it names cannot be read, or any value is not what the format asks for.
pub fn load(path: &Path) -> Result<LoadedScenario, InputError> {
    load_text(path, &error::read_text(path)?)
}

/// Checks and completes the text of a scenario file; files that it names are relative to `path`'s folder.
///
/// # Errors
/// As for [`load`].
pub fn load_text(path: &Path, text: &str) -> Result<LoadedScenario, InputError> {
    if let Ok(probe) = toml::from_str::<check::FormatProbe>(text) {
        check::Checker::toml(path, text).format(probe.format)?;
    }
    let file = file::parse(path, text)?;
    let (scenario, robot) = resolve::resolve(path, text, &file)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let plan = match &scenario.planner.plan {
        Some(plan) => {
            let plan = read_plan(&folder.join(plan), Some(&robot))?.0;
            resolve::check_plan_matches(path, text, &scenario, &plan)?;
            Some(plan)
        }
        None => None,
    };
    Ok(LoadedScenario { path: path.to_owned(), scenario, robot, plan })
}

/// Loads a robot for a file in `folder`. One that comes from a path is named by its whole path from then on, since the
/// plan that names it may be written to another folder.
///
/// # Errors
/// When there is no such robot or its files cannot be used.
fn load_robot(description: &str, folder: &Path) -> Result<Robot, RobotError> {
    let mut robot = Robot::load(description, folder)?;
    if !BUILTIN.contains(&description)
        && let Ok(path) = folder.join(description).canonicalize()
    {
        robot.description = path.display().to_string();
    }
    Ok(robot)
}

/// The figures of a robot that a plan's result depends on.
pub fn robot_parameters(robot: &Robot) -> RobotParameters {
    let arms = robot
        .arms
        .iter()
        .map(|arm| ArmParameters {
            name: arm.name.clone(),
            joints: arm.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
            stiffness_nm_rad: arm.stiffness_nm_rad.clone(),
            damping_nm_s_rad: arm.damping_nm_s_rad.clone(),
            effort_nm: arm.effort_nm.clone(),
            pads: arm
                .gripper
                .fingers
                .iter()
                .map(|finger| PadParameters {
                    name: finger.pad.name.clone(),
                    size_m: finger.pad.size_m,
                    centre_m: finger.pad.centre_m,
                })
                .collect(),
        })
        .collect();
    RobotParameters { description: robot.description.clone(), arms }
}

/// The scenario of a file for a plan that is given, which must be one for its robot, board and operation.
///
/// # Errors
/// As [`load`], and when the plan answers another scenario.
pub fn load_for_plan(path: &Path, plan: &Plan) -> Result<Scenario, InputError> {
    let scenario = load(path)?.scenario;
    resolve::check_plan_matches(path, &error::read_text(path)?, &scenario, plan)?;
    Ok(scenario)
}

/// A plan file, its robot, and what it is to be judged under: the scenario given, the one in the plan, or the defaults
/// for its operation; named after the plan.
///
/// # Errors
/// As [`read_plan`] and [`load_for_plan`].
pub fn load_plan_and_scenario(plan: &Path, scenario: Option<&Path>) -> Result<(Plan, Robot, Scenario), InputError> {
    let (plan, robot) = read_plan(plan, None)?;
    let mut scenario = match (scenario, &plan.scenario) {
        (Some(path), _) => load_for_plan(path, &plan)?,
        (None, Some(scenario)) => scenario.clone(),
        (None, None) => default_for_plan(&plan, &robot),
    };
    scenario.name.clone_from(&plan.name);
    Ok((plan, robot, scenario))
}

/// The scenario of a plan that carries none: its own figures, and the defaults for its kind of operation.
pub fn default_for_plan(plan: &Plan, robot: &Robot) -> Scenario {
    resolve::default_for_plan(plan, robot)
}
