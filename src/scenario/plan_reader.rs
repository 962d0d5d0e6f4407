//! Reads plans with the scenarios to judge them by.

use std::path::{Path, PathBuf};

use super::{
    FileText, InputError, LoadedScenario, LoadedStagedPlan,
    check::Checker,
    default_for_plan, load_text,
    plan_file::{self, ReadPlan},
    plan_text, resolve,
    robot_file::Robots,
    scenario_text, staged_file,
};
use crate::{
    model::{plan::Plan, scenario::Scenario, staged_plan::STAGED_FORMAT},
    robot::Robot,
};

/// A plan with its robot and the scenario to judge it by.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedPlan {
    /// The file that the plan was read from.
    pub path: PathBuf,
    /// The plan.
    pub plan: Plan,
    /// For each value that the file leaves out, what it follows from.
    pub filled_in: Vec<String>,
    /// The robot.
    pub robot: Robot,
    /// The scenario.
    pub scenario: Scenario,
    /// All files that were read.
    pub inputs: Vec<PathBuf>,
}

/// A plan of one hold or of a task.
#[derive(Clone, Debug)]
pub enum AnyPlan {
    /// Format 1.
    OneHold(Box<LoadedPlan>),
    /// Format 2.
    Staged(Box<LoadedStagedPlan>),
}

/// Reads a plan file and the scenario to judge the plan by: that of the file `scenario`, which must have the plan's robot,
/// board, operation and grip force; or the one in the plan; or the defaults for its operation. The scenario gets the
/// plan's name.
///
/// # Errors
/// As [`super::read_plan`] and [`super::load`], and if the scenario is for another robot, board, operation or grip force.
pub fn load_plan(path: &Path, scenario: Option<&Path>) -> Result<LoadedPlan, InputError> {
    let text = plan_text(path)?;
    // A scenario from a pipe can be read once.
    let of_scenario = scenario.map(scenario_text).transpose()?.unwrap_or_default();
    load_plan_text(FileText { path, text: &text }, scenario.map(|path| FileText { path, text: &of_scenario }))
}

/// Checks and completes the text of a plan file, as [`load_plan`].
///
/// # Errors
/// As [`load_plan`].
pub fn load_plan_text(plan: FileText<'_>, scenario: Option<FileText<'_>>) -> Result<LoadedPlan, InputError> {
    PlanReader::new(scenario)?.one_hold(plan)
}

/// Reads a plan file of any format. A staged plan is judged by its own scenario.
///
/// # Errors
/// As [`load_plan`]; if a staged plan is not one or does not fit the robot; and for a `scenario` beside a staged plan.
pub fn load_any_plan(path: &Path, scenario: Option<&Path>) -> Result<AnyPlan, InputError> {
    let text = plan_text(path)?;
    let of_scenario = scenario.map(scenario_text).transpose()?.unwrap_or_default();
    PlanReader::new(scenario.map(|path| FileText { path, text: &of_scenario }))?.any(FileText { path, text: &text })
}

/// Reads several plans that are judged by one scenario, or each by its own. The robot of the last plan is not loaded again.
pub struct PlanReader<'a> {
    scenario: Option<(LoadedScenario, FileText<'a>)>,
    robots: Robots<'static>,
}

impl<'a> PlanReader<'a> {
    /// A reader of plans that are judged by a scenario.
    ///
    /// # Errors
    /// As [`super::load`].
    pub fn new(scenario: Option<FileText<'a>>) -> Result<Self, InputError> {
        let loaded = |file: FileText<'a>| Ok((load_text(file.path, file.text)?, file));
        Ok(Self { scenario: scenario.map(loaded).transpose()?, robots: Robots::default() })
    }

    /// Reads a plan of any format, as [`load_any_plan`].
    ///
    /// # Errors
    /// As [`load_any_plan`].
    pub fn any(&mut self, plan: FileText<'_>) -> Result<AnyPlan, InputError> {
        let FileText { path, text } = plan;
        if plan_file::format_of(text) != Some(STAGED_FORMAT) {
            return self.one_hold(plan).map(|plan| AnyPlan::OneHold(Box::new(plan)));
        }
        if self.scenario.is_some() {
            let expected =
                "1, a plan of one hold, beside a scenario file: a staged plan is judged by the scenario in it";
            return Err(Checker::json(path, text).value("format", STAGED_FORMAT.to_string(), expected));
        }
        staged_file::from_text(path, text).map(|plan| AnyPlan::Staged(Box::new(plan)))
    }

    /// Reads a plan of one hold, as [`load_plan`].
    ///
    /// # Errors
    /// As [`load_plan`].
    pub fn one_hold(&mut self, plan: FileText<'_>) -> Result<LoadedPlan, InputError> {
        let FileText { path, text } = plan;
        let of_file = self.scenario.as_ref().map(|(loaded, _)| &loaded.scenario);
        let ReadPlan { plan, robot, filled_in } = plan_file::from_text(path, text, &mut self.robots, of_file)?;
        let mut inputs = vec![path.to_owned()];
        inputs.extend(robot.files.iter().cloned());
        let mut scenario = match (&self.scenario, &plan.scenario) {
            (Some((LoadedScenario { scenario, inputs: others, .. }, file)), _) => {
                resolve::check_plan_matches(file.path, file.text, scenario, &plan)?;
                inputs.extend(others.iter().cloned());
                scenario.clone()
            }
            (None, Some(scenario)) => scenario.clone(),
            (None, None) => default_for_plan(&plan, &robot),
        };
        scenario.name.clone_from(&plan.name);
        Ok(LoadedPlan { path: path.to_owned(), plan, filled_in, robot, scenario, inputs })
    }
}
