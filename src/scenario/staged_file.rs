//! Reads staged plan files, format 2, and checks them against the robot that they name.

use std::path::{Path, PathBuf};

use super::{
    InputError,
    check::Checker,
    plan_file::{check_scenario, parse},
    resolve,
    robot_file::{load_robot, options_of},
};
use crate::{
    check::{CheckedPlan, Flaws, StagedStates, initial_plan},
    human::default_tool,
    model::{
        scenario::{Person, Scenario, Tool},
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

/// Checks the text of a staged plan.
///
/// # Errors
/// If it is not a staged plan, or does not fit the robot.
pub fn from_text(path: &Path, text: &str) -> Result<LoadedStagedPlan, InputError> {
    let check = Checker::json(path, text);
    let mut plan: StagedPlan = parse(path, text)?;
    check.that(plan.format == STAGED_FORMAT, "format", plan.format.to_string(), "2")?;
    check.name(&plan.name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let options = plan.scenario.as_ref().map(|scenario| options_of(&scenario.robot)).unwrap_or_default();
    let robot = load_robot(&plan.robot, folder, &options, plan.object.size_m[2])
        .map_err(|error| check.robot("robot", error))?;
    plan.robot.clone_from(&robot.description);
    check_scenario(&check, plan.scenario.as_ref(), &robot)?;
    let initial = check.present("task.path", initial_plan(&plan), "at least one stroke")?;
    let tool = plan.scenario.as_ref().map_or_else(|| default_tool(plan.task.kind), |scenario| scenario.tool);
    let judged_by = plan.scenario.clone().unwrap_or_else(|| resolve::default_for_plan(&initial, &robot));
    let scenario = Scenario { name: plan.name.clone(), ..judged_by };
    CheckedPlan::new(&robot, &initial, &scenario.human, &tool).map_err(|flaws| {
        let flaw = flaws.first();
        check.value(&flaw.key(), flaw.found(), flaw.expected())
    })?;
    let states = StagedStates::new(&robot, &plan)
        .map_err(|flaw| check.value(&flaw.key, flaw.found.clone(), flaw.expected.clone()))?;
    check_pieces(&check, &states, &robot, &scenario, &tool)?;
    let mut inputs = vec![path.to_owned()];
    inputs.extend(robot.files.iter().cloned());
    Ok(LoadedStagedPlan { path: path.to_owned(), plan, states, robot, scenario, inputs })
}

/// Requires that every piece is a plan that fits the robot and the person.
fn check_pieces(
    check: &Checker<'_>,
    states: &StagedStates,
    robot: &Robot,
    scenario: &Scenario,
    tool: &Tool,
) -> Result<(), InputError> {
    for piece in &states.pieces {
        let key = format!("stages[{}].hold.pieces[{}]", piece.stage, piece.number);
        if let Some(posture) = &piece.plan.human {
            resolve::check_person(check, &posture.person(&Person::default()))
                .map_err(|error| check.moved(error, &key))?;
        }
        let refused = |flaws: Flaws| {
            let (flaw, of_plan) = (flaws.first(), flaws.first().key());
            match of_plan.starts_with("human") {
                true => check.value(&format!("{key}.{of_plan}"), flaw.found(), flaw.expected()),
                // Arms and board are not values of the piece: they follow from the stages before.
                false => check.value(&key, format!("{of_plan}: {}", flaw.found()), flaw.expected()),
            }
        };
        CheckedPlan::new(robot, &piece.plan, &scenario.human, tool).map_err(refused)?;
    }
    Ok(())
}
