//! Loading of robots: built-in ones by name, others by the path of their description.
//!
//! The table of built-in robots is the only place in the sources that names one.

use std::path::{Path, PathBuf};

use super::{
    assemble::{assemble, bare_robot},
    description::Description,
    faults::{Collector, RobotError, Source},
    packages::Packages,
    tree::{Robot, RobotOptions},
    urdf::{self, UrdfSource},
};
use crate::input::{self, MOST_TOML, MOST_URDF};

/// Names of the built-in robots.
pub const BUILTIN: &[&str] = &["baxter", "dual-panda", "dual-ur5"];

/// Files of the built-in robots, in the order of [`BUILTIN`]: description, then URDF.
const BUILTIN_FILES: [[&str; 2]; BUILTIN.len()] = [
    [include_str!("../../assets/baxter.toml"), include_str!("../../assets/baxter.urdf")],
    [include_str!("../../assets/dual-panda.toml"), include_str!("../../assets/dual-panda.urdf")],
    [include_str!("../../assets/dual-ur5.toml"), include_str!("../../assets/dual-ur5.urdf")],
];

impl Robot {
    /// Loads a built-in robot by its name, or a robot by the path of its description file. A relative path starts at
    /// `relative_to`; the URDF's path is relative to the description file.
    ///
    /// # Errors
    /// If a file cannot be read, the name is unknown, or the description or the URDF is malformed. The message has all faults,
    /// each with the file, the line if there is one, the key, the value found and the value expected.
    pub fn load(description: &str, relative_to: &Path) -> Result<Self, RobotError> {
        Self::load_with(description, relative_to, &RobotOptions::default())
    }

    /// As [`Robot::load`], with what a scenario adds.
    ///
    /// # Errors
    /// As for [`Robot::load`].
    pub fn load_with(description: &str, relative_to: &Path, options: &RobotOptions) -> Result<Self, RobotError> {
        if let Some(number) = BUILTIN.iter().position(|name| *name == description) {
            let [toml_text, urdf_text] = BUILTIN_FILES[number];
            let file = format!("built-in {description}.toml");
            return build(description, &Source { file: &file, text: toml_text }, options, |urdf| {
                Ok((format!("built-in {}", urdf.display()), urdf_text.into(), Path::new("")))
            });
        }
        if !description.ends_with(".toml") {
            return Err(RobotError::Unknown { found: description.into(), builtin: BUILTIN.join(", ") });
        }
        let path = relative_to.join(description);
        let text = read_file(&path, MOST_TOML)?;
        let folder = path.parent().unwrap_or(relative_to);
        let source = Source { file: &path.display().to_string(), text: &text };
        let mut urdf_path = None;
        let mut robot = build(description, &source, options, |urdf| {
            let path = urdf_path.insert(folder.join(urdf));
            Ok((path.display().to_string(), read_file(path, MOST_URDF)?, folder))
        })?;
        robot.files.splice(0..0, std::iter::once(path.clone()).chain(urdf_path));
        Ok(robot)
    }
}

impl Robot {
    /// The robot of a description that is not in a file, as if it were in `folder`.
    ///
    /// # Errors
    /// As for [`Robot::load`].
    pub fn from_text(name: &str, text: &str, folder: &Path) -> Result<Self, RobotError> {
        build(name, &Source { file: name, text }, &RobotOptions::default(), |urdf| {
            let path = folder.join(urdf);
            Ok((path.display().to_string(), read_file(&path, MOST_URDF)?, folder))
        })
    }

    /// The robot of a URDF alone, without arms, and the effort limit of each joint, N m or N, 0 where the URDF has no limit.
    ///
    /// # Errors
    /// As for [`Robot::load`].
    pub fn bare(urdf: &Path, packages: &[PathBuf]) -> Result<(Self, Vec<f64>), RobotError> {
        let (file, text) = (urdf.display().to_string(), read_file(urdf, MOST_URDF)?);
        let packages = Packages::new(packages.to_vec(), urdf.parent().unwrap_or(Path::new("")));
        let mut faults = Collector::default();
        let source = UrdfSource { file: &file, text: &text, packages: &packages, decomposed: &[] };
        let tree = urdf::read(&source, &mut faults).ok_or_else(|| faults.into_error())?;
        let effort = tree.effort.clone();
        Ok((bare_robot(&file, tree, 0.0, &RobotOptions::default()), effort))
    }
}

fn read_file(path: &Path, most_bytes: u64) -> Result<String, RobotError> {
    input::text(path, most_bytes).map_err(|source| RobotError::Read { path: path.display().to_string(), source })
}

/// Name and text of a URDF, and the folder of the description.
type UrdfText<'a> = (String, String, &'a Path);

/// Combines the two files; `urdf` reads the URDF at a path.
fn build<'a>(
    name: &str,
    source: &Source<'_>,
    options: &RobotOptions,
    urdf: impl FnOnce(&Path) -> Result<UrdfText<'a>, RobotError>,
) -> Result<Robot, RobotError> {
    let mut faults = Collector::default();
    let description = match Description::read(source) {
        Ok(description) => description,
        Err(fault) => {
            faults.add(fault);
            return Err(faults.into_error());
        }
    };
    let urdf_path = Path::new(description.urdf.get_ref());
    let (file, text, folder) = match urdf(urdf_path) {
        Ok(read) => read,
        Err(error) => {
            faults.add(source.fault(description.urdf.span(), format!("urdf: {error}")));
            return Err(faults.into_error());
        }
    };
    let given = options.packages.iter().cloned().chain(description.packages.iter().map(|given| folder.join(given)));
    let urdf_folder = folder.join(urdf_path);
    let packages = Packages::new(given.collect(), urdf_folder.parent().unwrap_or(folder));
    let decomposed: Vec<String> = description.decompose.iter().map(|name| name.get_ref().clone()).collect();
    let source_of_urdf = UrdfSource { file: &file, text: &text, packages: &packages, decomposed: &decomposed };
    let tree = urdf::read(&source_of_urdf, &mut faults);
    let robot = tree.and_then(|tree| assemble(name, source, &description, options, tree, &mut faults));
    let robot = robot.ok_or_else(|| faults.into_error())?;
    tracing::debug!(robot = name, links = robot.links.len(), arms = robot.arms.len(), "loaded a robot");
    Ok(robot)
}
