//! The robot that a scenario or plan file names.

use std::path::{Path, PathBuf};

use crate::{
    model::scenario::{ArmParameters, PadParameters, RobotParameters},
    robot::{BUILTIN, Robot, RobotError, RobotOptions},
};

/// Robots for files. Some robots have meshes of many megabytes: one that the next file names, too, is not loaded again.
#[derive(Default)]
pub struct Robots<'a> {
    /// One that is there already.
    given: Option<&'a Robot>,
    last: Option<Loaded>,
}

/// A robot, and for what it was loaded.
struct Loaded {
    description: String,
    /// To which paths are relative; `None` if there are none.
    folder: Option<PathBuf>,
    options: RobotOptions,
    robot: Robot,
}

impl<'a> Robots<'a> {
    /// With a robot that is used for every file that names it.
    pub fn with(given: &'a Robot) -> Self {
        Self { given: Some(given), last: None }
    }

    /// The robot that a file in `folder` names, holding a board of this thickness.
    ///
    /// # Errors
    /// As [`load_robot`].
    pub fn get(
        &mut self,
        description: &str,
        folder: &Path,
        options: &RobotOptions,
        thickness_m: f64,
    ) -> Result<Robot, RobotError> {
        if let Some(robot) = self.given.filter(|robot| robot.description == description) {
            return Ok(robot.at_gap(thickness_m));
        }
        let has_paths = !BUILTIN.contains(&description) || !options.packages.is_empty();
        let of_folder = has_paths.then_some(folder);
        let is_same = |last: &&Loaded| {
            last.description == description && last.folder.as_deref() == of_folder && last.options == *options
        };
        if let Some(Loaded { robot, .. }) = self.last.as_ref().filter(is_same) {
            return Ok(robot.at_gap(thickness_m));
        }
        let robot = load_robot(description, folder, options, thickness_m)?;
        self.last = Some(Loaded {
            description: description.to_owned(),
            folder: of_folder.map(Path::to_owned),
            options: options.clone(),
            robot: robot.clone(),
        });
        Ok(robot)
    }
}

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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// Two folders have a robot of one file name, with floors at different heights.
    #[test]
    fn the_last_robot_is_used_again_for_the_same_file_alone() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(root.join("scenarios/robots/dual-ur5-measured.toml")).unwrap();
        let text = text.replace("../../assets", root.join("assets").to_str().unwrap());
        let [one, two] = [-0.8, -0.7].map(|floor_z_m| {
            let folder = tempfile::tempdir().unwrap();
            let text = text.replace("floor_z_m = -0.8", &format!("floor_z_m = {floor_z_m}"));
            fs::write(folder.path().join("robot.toml"), text).unwrap();
            folder
        });
        let mut robots = Robots::default();
        let mut floor_z_m = |folder: &tempfile::TempDir| {
            robots.get("robot.toml", folder.path(), &RobotOptions::default(), 0.03).unwrap().floor_z_m
        };
        assert_eq!([&one, &one, &two, &one].map(&mut floor_z_m), [-0.8, -0.8, -0.7, -0.8]);
        // It is not read again.
        fs::remove_file(one.path().join("robot.toml")).unwrap();
        assert_eq!(floor_z_m(&one), -0.8);
        let of_other_options =
            RobotOptions { packages: vec![one.path().to_owned()], posture: std::collections::BTreeMap::new() };
        assert!(robots.get("robot.toml", one.path(), &of_other_options, 0.03).is_err());
    }

    #[test]
    fn a_built_in_robot_is_that_of_all_folders() {
        let options = RobotOptions::default();
        let mut robots = Robots::default();
        robots.get("baxter", Path::new("a"), &options, 0.02).unwrap();
        assert_eq!(robots.last.as_ref().unwrap().folder, None);
        let again = robots.get("baxter", Path::new("b"), &options, 0.03).unwrap();
        let loaded = load_robot("baxter", Path::new("b"), &options, 0.03).unwrap();
        assert!(format!("{again:?}") == format!("{loaded:?}"));
    }
}
