//! Grasps in the files of grasp planners: `isaac_grasp` and `moveit_msgs/Grasp` in YAML, and bare 4x4 matrices.
//!
//! A file states poses of a gripper in a frame of its own; which frame of the board and of the robot that is, the user says.
//! The opening of the gripper is not read: our fingers close on the board's thickness.

mod grasp;
mod isaac;
mod matrices;
mod moveit;
mod yaml;

use std::path::{Path, PathBuf};

use super::{InputError, InputErrorKind, error::read_text};
use crate::input::MOST_DOCUMENT;
pub use grasp::ForeignGrasp;

/// The grasps of a file.
#[derive(Clone, Debug)]
pub struct ForeignGrasps {
    /// The file.
    pub path: PathBuf,
    /// Its grasps, in the order of the file; at least one, with different names.
    pub grasps: Vec<ForeignGrasp>,
}

impl ForeignGrasps {
    /// The grasp of this name.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&ForeignGrasp> {
        self.grasps.iter().find(|grasp| grasp.name == name)
    }

    /// An error of one grasp, "found ..., expected ...".
    #[must_use]
    pub fn error(&self, grasp: &ForeignGrasp, found: String, expected: String) -> InputError {
        InputError {
            file: self.path.clone(),
            line: Some(grasp.line),
            key: Some(grasp.key.clone()),
            kind: InputErrorKind::Value { found, expected },
        }
    }
}

/// Reads the grasps of a file in one of the known formats.
///
/// # Errors
/// If the file cannot be read, is of no known format, or has a pose that is not rigid or a name twice.
pub fn read_grasps(path: &Path) -> Result<ForeignGrasps, InputError> {
    let found = ForeignGrasps { path: path.to_owned(), grasps: grasps_of(path, &read_text(path, MOST_DOCUMENT)?)? };
    let Some(_) = found.grasps.first() else {
        let (found, expected) = ("no grasp".to_owned(), "at least one".to_owned());
        return Err(InputError::file(path, InputErrorKind::Value { found, expected }));
    };
    for (number, grasp) in found.grasps.iter().enumerate() {
        if found.grasps[..number].iter().any(|other| other.name == grasp.name) {
            return Err(found.error(grasp, format!("the name {} again", grasp.name), "every name once".into()));
        }
    }
    Ok(found)
}

fn grasps_of(path: &Path, text: &str) -> Result<Vec<ForeignGrasp>, InputError> {
    if matrices::is_matrices(text) {
        return matrices::grasps(path, text);
    }
    let keys = yaml::top_keys(path, text)?;
    let has = |key: &str| keys.iter().any(|found| found == key);
    if has("grasps") {
        return isaac::grasps(path, text);
    }
    if has("grasp_pose") {
        return moveit::grasps(path, text);
    }
    let found = if keys.is_empty() { "no keys".to_owned() } else { format!("the keys {}", keys.join(", ")) };
    let expected =
        "`format: isaac_grasp` with `grasps`, messages of moveit_msgs/Grasp with `grasp_pose`, or 4x4 matrices";
    Err(InputError::file(path, InputErrorKind::Value { found, expected: expected.into() }))
}

#[cfg(test)]
mod tests;
