//! The robot that a scenario or plan file names.

use std::path::{Path, PathBuf};

use crate::{
    model::scenario::{ArmParameters, PadParameters, RobotParameters},
    robot::{BUILTIN, Robot, RobotError, RobotOptions},
};

/// Loads a robot for a file in `folder` that holds a board of this thickness. If the description is a path, the robot's
/// `description` becomes the absolute path, because a plan that names it may be written to another folder.
///
/// # Errors
/// If there is no such robot or its files are invalid.
pub fn load_robot(
    description: &str,
    folder: &Path,
    options: &RobotOptions,
    thickness_m: f64,
) -> Result<Robot, RobotError> {
    let absolute = |given: &PathBuf| folder.join(given).canonicalize().unwrap_or_else(|_| folder.join(given));
    let packages = options.packages.iter().map(absolute).collect();
    let options = RobotOptions { packages, posture: options.posture.clone() };
    let mut robot = Robot::load_with(description, folder, &options)?.at_gap(thickness_m);
    if !BUILTIN.contains(&description)
        && let Ok(path) = folder.join(description).canonicalize()
    {
        robot.description = path.display().to_string();
    }
    Ok(robot)
}

/// With what a robot was loaded.
pub fn options_of(robot: &RobotParameters) -> RobotOptions {
    RobotOptions { packages: robot.packages.iter().map(PathBuf::from).collect(), posture: robot.posture.clone() }
}

/// The parameters of a robot that results depend on.
#[must_use]
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
            wrench_limits: arm.gripper.holding.measured().map(|measured| measured.limits),
        })
        .collect();
    RobotParameters {
        description: robot.description.clone(),
        packages: robot.options.packages.iter().map(|folder| folder.display().to_string()).collect(),
        posture: robot.options.posture.clone(),
        arms,
    }
}
