//! Selects the scenarios of a run from files, folders and patterns, and reads them.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use glob::Pattern;

use super::{args::PlannerArgs, exit::CliError, output};
use crate::scenario::{self, LoadedScenario};

/// A scenario, and whether it passes `--filter`.
#[derive(Debug)]
pub struct Selected {
    /// The scenario.
    pub loaded: LoadedScenario,
    /// False if the filters exclude it: it is listed, but not run.
    pub wanted: bool,
}

/// Reads and checks the scenarios that the arguments name, in this order; those of a folder or pattern are sorted by name.
///
/// # Errors
/// If an argument names no scenario, a scenario is invalid, two have the same name, or none passes the filters.
pub fn scenarios(arguments: &[PathBuf], filters: &[String], planner: &PlannerArgs) -> Result<Vec<Selected>, CliError> {
    let given = filters.join(", ");
    let filters = filters.iter().map(|text| Filter::new(text)).collect::<Result<Vec<_>, _>>()?;
    let mut names = BTreeMap::<String, PathBuf>::new();
    let mut selected = Vec::new();
    let mut tasks = Vec::new();
    for path in files(arguments, SCENARIOS)? {
        let text = scenario::scenario_text(&path)?;
        if scenario::is_task(&text) {
            tasks.push((path, text));
            continue;
        }
        let mut loaded = scenario::load_text(&path, &text)?;
        planner.apply(&mut loaded.scenario.planner);
        let name = loaded.scenario.name.clone();
        if let Some(other) = names.insert(name.clone(), path.clone()) {
            return Err(one_name_twice(&path, &name, &other));
        }
        let wanted = filters.is_empty() || filters.iter().any(|filter| filter.passes(&name));
        selected.push(Selected { loaded, wanted });
    }
    leave_out(&tasks, selected.is_empty())?;
    if selected.iter().any(|scenario| scenario.wanted) {
        return Ok(selected);
    }
    let known: Vec<_> = names.into_keys().collect();
    Err(CliError::Usage(format!(
        "--filter {given}: found no scenario that passes, expected one of {}",
        known.join(", ")
    )))
}

/// Two files whose results would be written into one folder.
pub fn one_name_twice(path: &Path, name: &str, other: &Path) -> CliError {
    let (path, other) = (path.display(), other.display());
    CliError::Usage(format!("{path}: name: found \"{name}\", which is also the name of {other}"))
}

/// Notes that tasks among scenarios are left out. A task alone is an error.
fn leave_out(tasks: &[(PathBuf, String)], alone: bool) -> Result<(), CliError> {
    for (path, text) in tasks {
        if alone {
            scenario::load_text(path, text)?;
        }
        output::message(&format!("{}: a task, left out: it is run by `benchdog task`", path.display()));
    }
    Ok(())
}

/// What the files of a command are.
#[derive(Clone, Copy)]
struct Kind {
    extension: &'static str,
    name: &'static str,
}

const SCENARIOS: Kind = Kind { extension: "toml", name: "scenarios" };
const PLANS: Kind = Kind { extension: "json", name: "plans" };

/// The plan files that the arguments name, in this order; those of a folder or pattern are sorted by name.
///
/// # Errors
/// If a folder or pattern has none, or cannot be read.
pub fn plans(arguments: &[PathBuf]) -> Result<Vec<PathBuf>, CliError> {
    files(arguments, PLANS)
}

/// The files that the arguments name. An existing path is never a pattern, even if it contains * ? or [.
fn files(arguments: &[PathBuf], kind: Kind) -> Result<Vec<PathBuf>, CliError> {
    let mut files = Vec::new();
    for argument in arguments {
        let text = argument.to_string_lossy();
        if argument.is_dir() {
            files.extend(files_in(argument, kind)?);
        } else if !argument.exists() && is_pattern(&text) {
            files.extend(matches(&text, kind)?);
        } else {
            files.push(argument.clone());
        }
    }
    Ok(files)
}

fn is_pattern(text: &str) -> bool {
    text.contains(['*', '?', '['])
}

/// The files of a kind in a folder, not in its subfolders.
fn files_in(folder: &Path, Kind { extension, name }: Kind) -> Result<Vec<PathBuf>, CliError> {
    let failed = |error| CliError::Usage(format!("failed to read {}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_file() && path.extension().is_some_and(|found| found == extension) {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        return Err(CliError::Usage(format!("{}: found no .{extension} file, expected {name}", folder.display())));
    }
    Ok(files)
}

/// The files that match a pattern.
fn matches(pattern: &str, Kind { name, .. }: Kind) -> Result<Vec<PathBuf>, CliError> {
    let paths = glob::glob(pattern).map_err(|error| CliError::Usage(format!("{pattern}: {error}")))?;
    let mut files = Vec::new();
    for path in paths {
        let path = path.map_err(|error| {
            CliError::Usage(format!("failed to read {}: {}", error.path().display(), error.error()))
        })?;
        if path.is_file() {
            files.push(path);
        }
    }
    if files.is_empty() {
        return Err(CliError::Usage(format!("{pattern}: found no file that matches, expected {name}")));
    }
    Ok(files)
}

/// A filter of names.
pub enum Filter {
    /// The name contains this text.
    Contains(String),
    /// The whole name matches this pattern.
    Matches(Pattern),
}

impl Filter {
    /// Parses the text of a `--filter`.
    ///
    /// # Errors
    /// If the text is an invalid pattern.
    pub fn new(text: &str) -> Result<Self, CliError> {
        match is_pattern(text) {
            false => Ok(Self::Contains(text.to_owned())),
            true => {
                let failed = |error| CliError::Usage(format!("--filter {text}: {error}"));
                Pattern::new(text).map(Self::Matches).map_err(failed)
            }
        }
    }

    /// True if the name passes.
    pub fn passes(&self, name: &str) -> bool {
        match self {
            Self::Contains(text) => name.contains(text.as_str()),
            Self::Matches(pattern) => pattern.matches(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_is_part_of_a_name_or_a_pattern_of_the_whole() {
        let passes = |text: &str, name| Filter::new(text).unwrap().passes(name);
        assert!(passes("cut", "short-cut-3") && !passes("cut", "drill"));
        assert!(passes("cut-*", "cut-3") && !passes("cut-*", "short-cut-3"));
        assert!(passes("cut-0[1-3]", "cut-02") && !passes("cut-0[1-3]", "cut-04"));
        let Err(CliError::Usage(message)) = Filter::new("cut-[") else { panic!("an open bracket is not a pattern") };
        assert!(message.starts_with("--filter cut-[: "), "{message}");
    }
}
