//! Reads staged plan files, format 2, and checks them against the robot that they name.

use std::path::{Path, PathBuf};

use super::{
    InputError, InputErrorKind,
    check::{Checker, FormatProbe},
    error::read_text,
    resolve,
    robot_file::{load_robot, options_of},
};
use crate::{
    check::{Flaws, StagedStates, check_plate},
    human::default_tool,
    model::{
        scenario::{Person, Scenario},
        staged_plan::{STAGED_FORMAT, StagedPlan},
    },
    robot::Robot,
};

/// A staged plan with its robot and the scenario to judge it by.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadedStagedPlan {
    /// The file that it was read from.
    pub path: PathBuf,
    /// The plan.
    pub plan: StagedPlan,
    /// What follows from it by kinematics.
    pub states: StagedStates,
    /// The robot.
    pub robot: Robot,
    /// The scenario: that of the plan, or the defaults for its operation.
    pub scenario: Scenario,
    /// All files that were read.
    pub inputs: Vec<PathBuf>,
}

/// True if a file is a staged plan by its `format`. False of a file that cannot be read.
#[must_use]
pub fn is_staged_plan(path: &Path) -> bool {
    let probe = std::fs::read_to_string(path).ok().and_then(|text| serde_json::from_str::<FormatProbe>(&text).ok());
    probe.is_some_and(|probe| probe.format == STAGED_FORMAT)
}

/// Reads and checks a staged plan.
///
/// # Errors
/// If the file cannot be read, is not a staged plan, or does not fit the robot.
pub fn load_staged(path: &Path) -> Result<LoadedStagedPlan, InputError> {
    let text = read_text(path)?;
    let check = Checker::json(path, &text);
    let mut json = serde_json::Deserializer::from_str(&text);
    let mut plan: StagedPlan = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let key = error.path().to_string();
        let inner = error.into_inner();
        let message = inner.to_string();
        let message = message.split(" at line ").next().unwrap_or(&message).to_owned();
        let kind = InputErrorKind::Syntax(message);
        InputError { file: path.to_owned(), line: Some(inner.line()), key: (key != ".").then_some(key), kind }
    })?;
    check.that(plan.format == STAGED_FORMAT, "format", plan.format.to_string(), "2")?;
    check.name(&plan.name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let options = plan.scenario.as_ref().map(|scenario| options_of(&scenario.robot)).unwrap_or_default();
    let robot = load_robot(&plan.robot, folder, &options, plan.object.size_m[2])
        .map_err(|error| check.robot("robot", error))?;
    plan.robot.clone_from(&robot.description);
    if let Some(scenario) = &plan.scenario {
        let check = check.under("scenario.");
        check.format(scenario.format)?;
        if let Some(flaw) = check_plate(scenario.object.plate.as_ref()) {
            return Err(check.value(&flaw.key(), flaw.found(), flaw.expected()));
        }
        resolve::check_values(&check, scenario, &robot)?;
    }
    let states = StagedStates::new(&robot, &plan)
        .map_err(|flaw| check.value(&flaw.key, flaw.found.clone(), flaw.expected.clone()))?;
    let first = states.pieces.first().map(|piece| &piece.plan);
    let first = check.present("stages", first, "a stage with a piece of the path")?;
    let scenario = plan.scenario.clone().unwrap_or_else(|| resolve::default_for_plan(first, &robot));
    let scenario = Scenario { name: plan.name.clone(), ..scenario };
    check_pieces(&check, &plan, &states, &robot, &scenario)?;
    let mut inputs = vec![path.to_owned()];
    inputs.extend(robot.files.iter().cloned());
    Ok(LoadedStagedPlan { path: path.to_owned(), plan, states, robot, scenario, inputs })
}

/// Requires that every piece is a plan that fits the robot and the person.
fn check_pieces(
    check: &Checker<'_>,
    plan: &StagedPlan,
    states: &StagedStates,
    robot: &Robot,
    scenario: &Scenario,
) -> Result<(), InputError> {
    let tool = plan.scenario.as_ref().map_or_else(|| default_tool(plan.task.kind), |scenario| scenario.tool);
    for piece in &states.pieces {
        let key = format!("stages[{}].hold.pieces[{}]", piece.stage, piece.number);
        if let Some(posture) = &piece.plan.human {
            resolve::check_person(&check.under("stages.human."), &posture.person(&Person::default()))?;
        }
        let refused = |flaws: Flaws| {
            let flaw = flaws.first();
            check.value(&format!("{key}: {}", flaw.key()), flaw.found(), flaw.expected())
        };
        StagedStates::checked(robot, piece, &scenario.human, &tool).map_err(refused)?;
    }
    Ok(())
}
