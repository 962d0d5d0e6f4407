//! Reads scenario and plan files, checks them and fills in defaults.
//!
//! All errors of input files are found here, before anything is planned or written. Each error names the file, the line,
//! the key, the value found and the value expected. This module does not plan or simulate.

mod arrays;
mod check;
mod crossings;
mod draft;
pub mod error;
pub mod file;
mod fill_in;
mod foreign;
pub mod import;
pub mod load_section;
mod locate;
pub mod material;
mod object_section;
pub mod plan_file;
pub mod plan_input;
mod plan_reader;
pub mod replan_request;
mod resolve;
mod robot_file;
mod staged_file;
mod sweep_section;
mod task_path;
mod task_section;
mod uncertainty_section;

use std::path::{Path, PathBuf};

use draft::{Draft, TomlDocument};
pub use error::{InputError, InputErrorKind};
use file::ScenarioFile;
use plan_file::ReadPlan;
pub use plan_file::read_plan;
pub use plan_reader::{AnyPlan, LoadedPlan, PlanReader, load_any_plan, load_plan, load_plan_text};
pub use replan_request::{ReplanRequest, read_replan_request};
use robot_file::Robots;
pub use robot_file::robot_parameters;
pub use staged_file::LoadedStagedPlan;
pub use sweep_section::usual_sweep;

use crate::{
    input::{MOST_DOCUMENT, MOST_TOML},
    model::{plan::Plan, scenario::Scenario, task::Task},
    robot::Robot,
};
use resolve::Resolved;

/// A resolved scenario with its robot and, if the file names one, its plan.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedScenario {
    /// The file that it was read from.
    pub path: PathBuf,
    /// The resolved scenario.
    pub scenario: Scenario,
    /// The robot.
    pub robot: Robot,
    /// The task of a task file; the scenario's operation is then that of its first piece.
    pub task: Option<Task>,
    /// The plan that `planner.plan` names.
    pub plan: Option<Plan>,
    /// For each value that the plan's file leaves out, what it follows from.
    pub filled_in: Vec<String>,
    /// All files that were read.
    pub inputs: Vec<PathBuf>,
}

impl LoadedScenario {
    /// The path of the plan that `planner.plan` names.
    pub fn plan_path(&self) -> Option<PathBuf> {
        self.scenario.planner.plan.as_ref().map(|plan| folder_of(&self.path).join(plan))
    }
}

/// Reads, checks and completes a scenario file.
///
/// # Errors
/// If the file, or a robot or plan that it names, cannot be read or contains an invalid value.
pub fn load(path: &Path) -> Result<LoadedScenario, InputError> {
    load_text(path, &scenario_text(path)?)
}

/// The text of a scenario or task file.
///
/// # Errors
/// If it cannot be read, or is no text.
pub fn scenario_text(path: &Path) -> Result<String, InputError> {
    error::read_text(path, MOST_TOML)
}

/// The text of a plan file.
///
/// # Errors
/// If it cannot be read, or is no text.
pub fn plan_text(path: &Path) -> Result<String, InputError> {
    error::read_text(path, MOST_DOCUMENT)
}

/// True if a text is that of a JSON object, such as a plan, and not of a scenario.
#[must_use]
pub fn is_json(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

/// True if the text of a file is TOML with the section `[task]`.
#[must_use]
pub fn is_task(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|file| file.contains_key("task"))
}

/// Reads, checks and completes a task file.
///
/// # Errors
/// As for [`load`], and if the file has no `[task]`.
pub fn load_task(path: &Path) -> Result<(LoadedScenario, Task), InputError> {
    load_task_text(path, &scenario_text(path)?)
}

/// As [`load_task`], of the text of a file.
///
/// # Errors
/// As for [`load_task`].
pub fn load_task_text(path: &Path, text: &str) -> Result<(LoadedScenario, Task), InputError> {
    let loaded = load_any(path, text)?;
    match loaded.task.clone() {
        Some(task) => Ok((loaded, task)),
        None => {
            let expected = "[task] with a path that is cut or drilled; a scenario of one hold is run by `benchdog run`";
            Err(check::Checker::toml(path, text).value("operation", "[operation]", expected))
        }
    }
}

/// Checks and completes the text of a scenario file. Files that it names are relative to the folder of `path`.
///
/// # Errors
/// As for [`load`].
pub fn load_text(path: &Path, text: &str) -> Result<LoadedScenario, InputError> {
    let loaded = load_any(path, text)?;
    if loaded.task.is_some() {
        let expected = "[operation] with one operation; a task is run by `benchdog task`";
        return Err(check::Checker::toml(path, text).value("task", "[task]", expected));
    }
    Ok(loaded)
}

fn load_any(path: &Path, text: &str) -> Result<LoadedScenario, InputError> {
    if let Ok(probe) = toml::from_str::<check::FormatProbe>(text) {
        check::Checker::toml(path, text).format(probe.format)?;
    }
    let (file, Resolved { scenario, task, robot }) = read_and_resolve(path, text)?;
    let folder = folder_of(path);
    let mut inputs = vec![path.to_owned()];
    inputs.extend(robot.files.iter().cloned());
    inputs.extend(file.load.file.as_ref().map(|forces| folder.join(forces)));
    let of_path = file.task.as_ref().and_then(|task| task.file.as_ref());
    inputs.extend(of_path.map(|path| folder.join(path)));
    inputs.extend(file.sweep.iter().flat_map(|sweep| sweep.files()).map(|values| folder.join(values)));
    let (plan, filled_in) = match &scenario.planner.plan {
        Some(plan) => {
            let plan_path = folder.join(plan);
            let plan_text = check::Checker::toml(path, text).named_file("planner.plan", &plan_path, MOST_DOCUMENT)?;
            let ReadPlan { plan, filled_in, .. } =
                plan_file::from_text(&plan_path, &plan_text, &mut Robots::with(&robot), Some(&scenario))?;
            resolve::check_plan_matches(path, text, &scenario, &plan)?;
            inputs.push(plan_path);
            (Some(plan), filled_in)
        }
        None => (None, Vec::new()),
    };
    Ok(LoadedScenario { path: path.to_owned(), scenario, robot, task, plan, filled_in, inputs })
}

/// The values of a scenario file, and what they resolve to.
///
/// # Errors
/// All faults that do not follow from others.
fn read_and_resolve(path: &Path, text: &str) -> Result<(ScenarioFile, Resolved), InputError> {
    let document = TomlDocument::parse(path, text).map_err(|error| match foreign::not_toml(path, text) {
        Some(hint) => InputError::file(path, InputErrorKind::Syntax(hint)),
        None => error,
    })?;
    let mut draft = Draft::new(path, document);
    let mut robots = Robots::default();
    while let Some(file) = draft.read::<ScenarioFile>() {
        match resolve::resolve(path, text, &file, &mut robots) {
            Ok(resolved) if draft.is_whole() => {
                let Resolved { scenario, robot, .. } = &resolved;
                tracing::debug!(scenario = scenario.name, robot = robot.description, "checked a scenario");
                return Ok((file, resolved));
            }
            Ok(_) => break,
            Err(error) => {
                if !draft.refuse(error) {
                    break;
                }
            }
        }
    }
    Err(draft.into_error())
}

/// The folder that the paths in a file are relative to.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// The text of a file, and the path that messages name and to whose folder the files in it are relative.
#[derive(Clone, Copy, Debug)]
pub struct FileText<'a> {
    /// The path; it need not exist.
    pub path: &'a Path,
    /// The text.
    pub text: &'a str,
}

/// Checks the values of a scenario that a program has changed after it was read. An error names `path` and the key.
///
/// # Errors
/// If a value is not valid.
pub fn check_changed(path: &Path, scenario: &Scenario, robot: &Robot) -> Result<(), InputError> {
    let check = check::Checker::toml(path, "");
    let evaluations = scenario.planner.evaluations;
    check.that(evaluations != Some(0), "planner.evaluations", "0", "a positive number of candidates")?;
    resolve::check_values(&check, scenario, robot)
}

/// A scenario for a plan that contains none: the plan's own values, and defaults for its kind of operation.
#[must_use]
pub fn default_for_plan(plan: &Plan, robot: &Robot) -> Scenario {
    resolve::default_for_plan(plan, robot)
}
