//! Reads plan files and checks them against the robot that they name.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::{
    InputError, InputErrorKind,
    arrays::too_long,
    check::{Checker, FormatProbe},
    draft::{Draft, JsonDocument},
    error::read_text,
    fill_in::{FilledPlan, fill_in, refused},
    foreign::other_format,
    plan_input::PlanFile,
    resolve,
    robot_file::{Robots, options_of},
};
use crate::{
    check::{CheckedPlan, Flaw, check_plate},
    human::default_tool,
    input::MOST_DOCUMENT,
    model::{
        plan::Plan,
        scenario::{Person, Scenario, ShoulderKind},
    },
    robot::Robot,
};

/// A plan with its robot and what was filled in.
pub struct ReadPlan {
    /// The plan.
    pub plan: Plan,
    /// The robot that it names.
    pub robot: Robot,
    /// For each value that the file leaves out, what it follows from.
    pub filled_in: Vec<String>,
}

/// Reads and checks a plan file. The robot that it names is loaded, unless it is `robot`. Values that the file leaves out are
/// filled in.
///
/// # Errors
/// If the file cannot be read, is not a plan of the supported format, does not determine a plan, or does not fit the robot.
pub fn read_plan(path: &Path, robot: Option<&Robot>) -> Result<(Plan, Robot), InputError> {
    let mut robots = robot.map_or_else(Robots::default, Robots::with);
    let ReadPlan { plan, robot, .. } = from_text(path, &read_text(path, MOST_DOCUMENT)?, &mut robots, None)?;
    Ok((plan, robot))
}

/// As [`read_plan`], from the text of the file and for a plan that is judged by `scenario`; by default by its own.
pub fn from_text(
    path: &Path,
    text: &str,
    robots: &mut Robots<'_>,
    scenario: Option<&Scenario>,
) -> Result<ReadPlan, InputError> {
    let check = Checker::json(path, text);
    if let Some(format) = format_of(text) {
        check.format(format)?;
    }
    let file = match parse::<PlanFile>(path, text) {
        Ok(file) => file,
        Err(error) => {
            if let Some(hint) = other_format(path, text) {
                return Err(InputError::file(path, InputErrorKind::Syntax(hint.into())));
            }
            let too_long = serde_json::from_str(text).ok().and_then(|values| too_long::<PlanFile>(&values));
            return Err(too_long.map_or(error, |array| check.value(&array.key, array.found, array.expected)));
        }
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let options = scenario.or(file.scenario.as_ref()).map(|scenario| options_of(&scenario.robot)).unwrap_or_default();
    let robot = robots
        .get(&file.robot, folder, &options, file.object.size_m[2])
        .map_err(|error| check.robot("robot", error))?;
    check.name(&file.name)?;
    let FilledPlan { mut plan, notes, angle_keys } = fill_in(&check, file, &robot, scenario)?;
    plan.robot.clone_from(&robot.description);
    check_plan(&check, &plan, &robot, &angle_keys)?;
    check_scenario(&check, plan.scenario.as_ref(), &robot)?;
    Ok(ReadPlan { plan, robot, filled_in: notes })
}

/// The format of a plan, whatever its other keys are; `None` if it states none.
pub fn format_of(text: &str) -> Option<u32> {
    serde_json::from_str::<FormatProbe>(text).ok().map(|probe| probe.format)
}

/// Checks the scenario in a plan.
pub fn check_scenario(check: &Checker<'_>, scenario: Option<&Scenario>, robot: &Robot) -> Result<(), InputError> {
    let Some(scenario) = scenario else { return Ok(()) };
    let check = check.under("scenario.");
    check.format(scenario.format)?;
    if let Some(flaw) = check_plate(scenario.object.plate.as_ref()) {
        return Err(check.value(&flaw.key(), flaw.found(), flaw.expected()));
    }
    resolve::check_values(&check, scenario, robot)
}

/// The values of a JSON file; an error has the line and the key, and all unknown keys and wrong types.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, InputError> {
    let first = match parse_to_first_fault(path, text) {
        Ok(values) => return Ok(values),
        Err(first) => first,
    };
    let Some(document) = JsonDocument::parse(path, text) else { return Err(first) };
    let mut draft = Draft::new(path, document);
    let _: Option<T> = draft.read();
    let all = draft.into_error();
    Err(if all.faults().len() > 1 { all } else { first })
}

fn parse_to_first_fault<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, InputError> {
    let mut json = serde_json::Deserializer::from_str(text);
    serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let key = error.path().to_string();
        let inner = error.into_inner();
        InputError {
            file: path.to_owned(),
            line: Some(inner.line()),
            key: (key != ".").then_some(key),
            kind: InputErrorKind::Syntax(without_position(&inner.to_string())),
        }
    })
}

/// Removes the line and column at the end of a message of serde_json: the error states the line itself.
fn without_position(message: &str) -> String {
    message.split(" at line ").next().unwrap_or(message).to_owned()
}

/// Checks the plan against the robot and the person; the first flaw is the error.
fn check_plan(check: &Checker<'_>, plan: &Plan, robot: &Robot, angle_keys: &[Vec<String>]) -> Result<(), InputError> {
    let default = Person::default();
    let (rules, tool) = match &plan.scenario {
        Some(scenario) => (&scenario.human, scenario.tool),
        None => (&default, default_tool(plan.operation.kind)),
    };
    if let Some(posture) = &plan.human {
        // The rules are checked with the scenario that they are part of.
        resolve::check_person(check, &posture.person(&default))?;
    }
    let Err(flaws) = CheckedPlan::new(robot, plan, rules, &tool) else { return Ok(()) };
    // Without a scenario the shoulder may be of either kind; whoever uses the plan knows which.
    let of_a_box = Person { shoulder: ShoulderKind::Box, ..default };
    if plan.scenario.is_none() && CheckedPlan::new(robot, plan, &of_a_box, &tool).is_ok() {
        return Ok(());
    }
    let flaw = flaws.first();
    Err(match flaw {
        Flaw::Person(error) => check.syntax(&flaw.key(), error.to_string()),
        Flaw::Angle { arm, joint, .. } => check.value(&angle_keys[*arm][*joint], flaw.found(), flaw.expected()),
        _ => refused(check, flaw),
    })
}
