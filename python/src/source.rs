//! Scenarios and plans as Python has them: a path, a text or a dict.

use std::path::{Path, PathBuf};

use benchdog::{
    input::{self, MOST_DOCUMENT, MOST_TOML},
    scenario::{self, FileText, InputError, InputErrorKind, LoadedPlan, LoadedScenario},
};
use pyo3::{prelude::*, types::PyDict};
use pythonize::Depythonizer;
use serde::de::DeserializeOwned;

use crate::errors::{self, DICT};

/// Stands for the file of a text in messages.
const TEXT: &str = "<text>";

/// A file's text, and the path that messages name.
pub struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// A scenario: a path, TOML in a `str` of several lines, or a dict with a scenario file's tables and keys.
    pub fn scenario(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(dict) = given.cast::<PyDict>() {
            let table: toml::Table = values(dict)?;
            let text = toml::to_string(&table).map_err(errors::other)?;
            return Ok(Self { path: DICT.into(), text });
        }
        Self::of_file_or_text(given, |text| text.contains('\n'), MOST_TOML)
    }

    /// A plan: a path, JSON in a `str`, or a dict as `plan()` gives it.
    pub fn plan(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(dict) = given.cast::<PyDict>() {
            let document: serde_json::Value = values(dict)?;
            return Ok(Self { path: DICT.into(), text: document.to_string() });
        }
        Self::of_file_or_text(given, |text| text.trim_start().starts_with('{'), MOST_DOCUMENT)
    }

    fn of_file_or_text(given: &Bound<'_, PyAny>, is_text: fn(&str) -> bool, most_bytes: u64) -> PyResult<Self> {
        if let Ok(text) = given.extract::<String>()
            && is_text(&text)
        {
            return Ok(Self { path: TEXT.into(), text });
        }
        let path: PathBuf = given.extract()?;
        let text = input::text(&path, most_bytes).map_err(|error| errors::input(InputError::file(&path, error)))?;
        Ok(Self { path, text })
    }

    fn file(&self) -> FileText<'_> {
        FileText { path: &self.path, text: &self.text }
    }

    /// The scenario, without a plan of its own: plans are simulated.
    pub fn load_scenario(&self) -> PyResult<LoadedScenario> {
        let loaded = scenario::load_text(&self.path, &self.text).map_err(errors::input)?;
        if loaded.plan.is_some() {
            return Err(errors::argument("planner.plan", "a plan", "a scenario without one; simulate() takes plans"));
        }
        Ok(loaded)
    }

    /// The plan, with the scenario that it is judged by: the given one, its own, or the usual one for its operation.
    pub fn load_plan(&self, scenario: Option<&Self>) -> PyResult<LoadedPlan> {
        scenario::load_plan_text(self.file(), scenario.map(Self::file)).map_err(errors::input)
    }
}

/// The values of a dict. `None` stands for a key that is left out.
pub fn values<T: DeserializeOwned>(dict: &Bound<'_, PyDict>) -> PyResult<T> {
    let given = without_none(dict)?;
    serde_path_to_error::deserialize(&mut Depythonizer::from_object(&given)).map_err(|error| {
        let key = Some(error.path().to_string()).filter(|key| key != ".");
        let kind = InputErrorKind::Syntax(error.inner().to_string());
        errors::input(InputError { file: Path::new(DICT).to_owned(), line: None, key, kind })
    })
}

fn without_none<'py>(dict: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let kept = PyDict::new(dict.py());
    for (key, value) in dict {
        match value.cast::<PyDict>() {
            Ok(inner) => kept.set_item(key, without_none(inner)?)?,
            Err(_) if value.is_none() => {}
            Err(_) => kept.set_item(key, value)?,
        }
    }
    Ok(kept)
}
