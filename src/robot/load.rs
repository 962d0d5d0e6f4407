//! Loading of robots: built-in ones by name, others by the path of their description.
//!
//! The table of built-in robots is the only place in the sources that names one.

use std::path::{Path, PathBuf};

use super::{
    assemble::assemble,
    description::{Description, Source},
    tree::{Robot, RobotError},
    urdf,
};

/// Names of the built-in robots.
pub const BUILTIN: &[&str] = &["baxter"];

/// Files of the built-in robots, in the order of [`BUILTIN`]: description, then URDF.
const BUILTIN_FILES: [[&str; 2]; BUILTIN.len()] =
    [[include_str!("../../assets/baxter.toml"), include_str!("../../assets/baxter.urdf")]];

impl Robot {
    /// Loads a built-in robot by its name, or a robot by the path of its description file. A relative path starts at
    /// `relative_to`; the URDF's path is relative to the description file.
    ///
    /// # Errors
    /// If a file cannot be read, the name is unknown, or the description or the URDF is malformed. The message names the file,
    /// the line if there is one, the key, the value found and the value expected.
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

/// Combines the two files; `urdf` returns the name and the text of the URDF at a path.
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
