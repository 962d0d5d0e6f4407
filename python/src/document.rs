//! Values as Python has them after `json.load` of the file that Benchdog writes.

use pyo3::prelude::*;
use pythonize::Pythonizer;
use serde::Serialize;

use crate::errors;

/// A value as dicts and lists with the keys, their order and the numbers of its file. It goes by way of JSON, which has no tuples.
pub fn document<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(errors::other)?;
    let mut json = serde_json::Deserializer::from_str(&text);
    Ok(serde_transcode::transcode(&mut json, Pythonizer::new(py))?)
}
