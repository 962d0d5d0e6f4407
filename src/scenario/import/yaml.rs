//! YAML text with errors that name file and line.

use std::path::Path;

use serde::{Deserialize, de::DeserializeOwned};
use serde_saphyr::{Error, Spanned};

use super::super::{InputError, InputErrorKind};
use crate::model::frames::{Pose, PoseRecord};

/// All documents of a text that are not empty: ROS ends every message with `---`.
pub fn documents<T: DeserializeOwned>(path: &Path, text: &str) -> Result<Vec<T>, InputError> {
    serde_saphyr::from_multiple(text).map_err(|error| syntax(path, &error))
}

fn syntax(path: &Path, error: &Error) -> InputError {
    let error = error.without_snippet();
    InputError {
        file: path.to_owned(),
        line: error.location().and_then(|location| usize::try_from(location.line()).ok()),
        key: None,
        kind: InputErrorKind::Syntax(first_sentence(&error.to_string())),
    }
}

/// A message without the place, which the error states itself, and without the crate's own options.
fn first_sentence(message: &str) -> String {
    let message = message.lines().next().unwrap_or(message);
    let message = message.split(", set DuplicateKeyPolicy").next().unwrap_or(message);
    message.split(" at line ").next().unwrap_or(message).trim_start_matches("error: ").to_owned()
}

/// The keys of the first document or, if it is a list, of its first element.
pub fn top_keys(path: &Path, text: &str) -> Result<Vec<String>, InputError> {
    let documents: Vec<serde_json::Value> = documents(path, text)?;
    let first = documents.first().map(|first| first.get(0).unwrap_or(first));
    let keys = first.and_then(serde_json::Value::as_object).map(|object| object.keys().cloned().collect());
    Ok(keys.unwrap_or_default())
}

/// The pose of a position and a quaternion.
///
/// # Errors
/// If it is not rigid; the error names the key and the line of `place`.
pub fn pose<T>(path: &Path, key: &str, place: &Spanned<T>, record: PoseRecord) -> Result<Pose, InputError> {
    Pose::try_from(record).map_err(|problem| InputError {
        file: path.to_owned(),
        line: Some(line(place)),
        key: Some(key.to_owned()),
        kind: InputErrorKind::Syntax(problem),
    })
}

/// The line of a value.
pub fn line<T>(place: &Spanned<T>) -> usize {
    usize::try_from(place.referenced.line()).unwrap_or(usize::MAX)
}

/// Three numbers under their names.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Xyz {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// A quaternion under its names.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Xyzw {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}
