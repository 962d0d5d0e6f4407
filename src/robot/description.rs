//! The description file of a robot: what no URDF says, in TOML.
//!
//! This module knows the file's form and where files come from; what entries mean together is `assemble`'s business.
//! The table of built-in robots below is the only place in the sources that names one.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use toml::Spanned;

use super::{
    assemble::assemble,
    tree::{Robot, RobotError},
    urdf,
};
use crate::model::FORMAT;

/// The robots that are built in, by name.
pub const BUILTIN: &[&str] = &["baxter"];

/// The files of the built-in robots, in the order of [`BUILTIN`]: description, then URDF.
const BUILTIN_FILES: [[&str; 2]; BUILTIN.len()] =
    [[include_str!("../../assets/baxter.toml"), include_str!("../../assets/baxter.urdf")]];

impl Robot {
    /// Loads a robot: a built-in one by its name, or the one that a description file describes. `relative_to` is the
    /// folder from which a relative path leads to the description file; the URDF's path is relative to that file.
    ///
    /// # Errors
    /// When a file cannot be read, the name is unknown, or the description or the URDF is malformed: then the message
    /// names the file, the line where there is one, the key, what was found and what was expected.
    pub fn load(description: &str, relative_to: &Path) -> Result<Self, RobotError> {
        if let Some(number) = BUILTIN.iter().position(|name| *name == description) {
            let [toml_text, urdf_text] = BUILTIN_FILES[number];
            let file = format!("built-in {description}.toml");
            return build(description, &Source { file: &file, text: toml_text }, |urdf| {
                Ok((format!("built-in {}", urdf.display()), urdf_text.into()))
            });
        }
        if !description.ends_with(".toml") {
            return Err(RobotError::Unknown { found: description.into(), builtin: BUILTIN.join(", ") });
        }
        let path = relative_to.join(description);
        let text = read_file(&path)?;
        let folder = path.parent().unwrap_or(relative_to);
        build(description, &Source { file: &path.display().to_string(), text: &text }, |urdf| {
            let path = folder.join(urdf);
            Ok((path.display().to_string(), read_file(&path)?))
        })
    }
}

/// The files that [`Robot::load`] reads: the description and the URDF that it names; none for a built-in robot. Files that
/// cannot be read are left out.
pub fn source_files(description: &str, relative_to: &Path) -> Vec<PathBuf> {
    if BUILTIN.contains(&description) {
        return Vec::new();
    }
    let path = relative_to.join(description);
    let Ok(text) = read_file(&path) else { return Vec::new() };
    let urdf = Description::read(&Source { file: "", text: &text })
        .map(|description| path.parent().unwrap_or(relative_to).join(description.urdf.get_ref()));
    std::iter::once(path.clone()).chain(urdf.ok()).collect()
}

fn read_file(path: &Path) -> Result<String, RobotError> {
    std::fs::read_to_string(path).map_err(|source| RobotError::Read { path: path.display().to_string(), source })
}

/// Puts the two files together; `urdf` gives the name and the text of the URDF that the description names.
fn build(
    name: &str,
    source: &Source,
    urdf: impl FnOnce(&Path) -> Result<(String, String), RobotError>,
) -> Result<Robot, RobotError> {
    let description = Description::read(source)?;
    let (urdf_file, urdf_text) = urdf(Path::new(description.urdf.get_ref()))?;
    let tree = urdf::read(&urdf_text).map_err(|problem| RobotError::Invalid { file: urdf_file, problem })?;
    assemble(name, source, &description, tree)
}

/// A text with the name of its file, for messages.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// The error at a place of this text.
    pub fn error(&self, span: Range<usize>, problem: &str) -> RobotError {
        let line = 1 + self.text.bytes().take(span.start).filter(|&byte| byte == b'\n').count();
        RobotError::Invalid { file: self.file.into(), problem: format!("line {line}: {problem}") }
    }
}

/// A description file, as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    pub format: Spanned<u32>,
    pub urdf: Spanned<String>,
    pub floor_z_m: Spanned<f64>,
    pub arms: Spanned<Vec<ArmEntry>>,
    #[serde(default)]
    pub allowed_collisions: Vec<Spanned<[String; 2]>>,
    pub body_points: Spanned<Vec<PointEntry>>,
}

/// An arm, as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArmEntry {
    pub name: Spanned<String>,
    pub base_link: Spanned<String>,
    pub joints: Spanned<Vec<Spanned<String>>>,
    pub effort_nm: Option<Spanned<Vec<f64>>>,
    pub stiffness_nm_rad: Spanned<Vec<f64>>,
    pub damping_nm_s_rad: Spanned<Vec<f64>>,
    pub gripper: GripperEntry,
}

/// A gripper, as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GripperEntry {
    pub frame_link: Spanned<String>,
    pub palm_link: Spanned<String>,
    pub opening_m: Spanned<[f64; 2]>,
    pub max_force_n: Spanned<f64>,
    pub pad_size_m: Spanned<[f64; 2]>,
    pub pad_centre_m: Spanned<[f64; 2]>,
    pub fingers: Spanned<[FingerEntry; 2]>,
}

/// A finger, as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FingerEntry {
    pub name: String,
    pub joint: Spanned<String>,
    pub pad_link: Spanned<String>,
}

/// A point on the robot's surface, as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointEntry {
    pub link: Spanned<String>,
    pub p_m: Spanned<[f64; 3]>,
}

impl Description {
    fn read(source: &Source) -> Result<Self, RobotError> {
        let description: Self = toml::from_str(source.text)
            .map_err(|error| source.error(error.span().unwrap_or_default(), error.message()))?;
        let format = *description.format.get_ref();
        if format != FORMAT {
            let problem = format!("format: found {format}, expected {FORMAT}");
            return Err(source.error(description.format.span(), &problem));
        }
        Ok(description)
    }
}
