//! Fills in what a plan file leaves out: joint angles by inverse kinematics, grasps and the board's pose by forward kinematics,
//! joints in the robot's order, the grip force.

use super::{
    InputError,
    check::Checker,
    plan_input::{Angles, ArmInput, ObjectInput, PlanFile},
};
use crate::{
    check::{BOARD_SIDE_M, Flaw, check_plate},
    collision::PersonPart,
    complete::{ArmTask, Completer, Completion, Effort, Reached, Target},
    human::{Human, default_tool},
    model::{
        board::BoardShape,
        frames::Pose,
        plan::{ArmHold, HumanPosture, PlacedObject, Plan},
        scenario::{Limits, Person, Scenario},
    },
    robot::{Chain, Robot},
};

/// A complete plan, and what was filled in.
pub struct FilledPlan {
    /// The plan.
    pub plan: Plan,
    /// For each value that was filled in, what it follows from.
    pub notes: Vec<String>,
    /// For each arm, in the plan's order, the file's key of the angle of each joint, in the robot's order.
    pub angle_keys: Vec<Vec<String>>,
}

/// An arm of a plan file with its joints in the robot's order.
struct ArmFacts {
    /// Index into [`Robot::arms`].
    index: usize,
    q_rad: Option<Vec<f64>>,
    seed_rad: Option<Vec<f64>>,
    x_og: Option<Pose>,
    angle_keys: Vec<String>,
}

/// Completes the plan of a file. `scenario` is the one that the plan is judged by; by default that of the plan.
///
/// # Errors
/// If the file does not determine the plan, or an arm does not reach its pose.
pub fn fill_in(
    check: &Checker<'_>,
    file: PlanFile,
    robot: &Robot,
    scenario: Option<&Scenario>,
) -> Result<FilledPlan, InputError> {
    let own = file.scenario.clone();
    let scenario = scenario.or(own.as_ref());
    let mut notes = Vec::new();
    let facts: Vec<_> = (0..file.arms.len()).map(|arm| facts(check, robot, &file, arm)).collect::<Result<_, _>>()?;
    let x_wo = match file.object.x_wo {
        Some(x_wo) => x_wo,
        None => board_pose(check, robot, &file, &facts, &mut notes)?,
    };
    let q_rad = angles(check, robot, &file, &facts, &x_wo, scenario, &mut notes)?;
    let hold = |((input, facts), q_rad): ((&ArmInput, &ArmFacts), Vec<f64>)| ArmHold {
        name: input.name.clone(),
        joints: joint_names(robot, facts.index),
        x_og: facts.x_og.unwrap_or_else(|| x_wo.inverse() * chain(robot, &file, facts.index).gripper_pose(&q_rad)),
        q_rad,
        grip_force_n: input.grip_force_n.unwrap_or_else(|| default_grip_force_n(robot, facts.index, scenario)),
    };
    let arms: Vec<_> = file.arms.iter().zip(&facts).zip(q_rad).map(hold).collect();
    notes.extend(left_out(&file, "x_og", |input| input.x_og.is_none(), "it follows from q_rad"));
    let of_grip = match scenario {
        Some(_) => "the scenario's grip.force_n",
        None => "the most that the gripper gives",
    };
    let has_pads = |arm: &str| robot.arms.iter().any(|of| of.name == arm && of.gripper.holding.pads().is_some());
    let lacks_force = |input: &ArmInput| input.grip_force_n.is_none() && has_pads(&input.name);
    notes.extend(left_out(&file, "grip_force_n", lacks_force, of_grip));
    let PlanFile {
        format, name, robot, operation, object, human, comfort, muscles, stability, clearance, planner, ..
    } = file;
    let ObjectInput { size_m, plate, mass_kg, com_m, .. } = object;
    let object = PlacedObject { size_m, plate, mass_kg, com_m, x_wo };
    let (scenario, benchdog) = (own, file.benchdog);
    let plan = Plan {
        format,
        name,
        robot,
        operation,
        object,
        arms,
        human,
        comfort,
        muscles,
        stability,
        clearance,
        planner,
        scenario,
        benchdog,
    };
    Ok(FilledPlan { plan, notes, angle_keys: facts.into_iter().map(|facts| facts.angle_keys).collect() })
}

/// The error of a flaw.
pub fn refused(check: &Checker<'_>, flaw: &Flaw) -> InputError {
    check.value(&flaw.key(), flaw.found(), flaw.expected())
}

/// What a file states about one arm.
fn facts(check: &Checker<'_>, robot: &Robot, file: &PlanFile, arm: usize) -> Result<ArmFacts, InputError> {
    let input = &file.arms[arm];
    let Some(index) = robot.arm_index(&input.name) else {
        let known = robot.arms.iter().map(|arm| arm.name.clone()).collect();
        return Err(refused(check, &Flaw::UnknownArm { arm, found: input.name.clone(), known }));
    };
    let of_robot = joint_names(robot, index);
    if let Some(found) = &input.joints
        && !is_permutation(found, &of_robot)
    {
        let flaw = Flaw::Joints { arm, name: input.name.clone(), found: found.clone(), expected: of_robot };
        return Err(refused(check, &flaw));
    }
    let key = |name: &str| format!("arms[{arm}].{name}");
    let read = |name: &str, angles: &Option<Angles>| {
        angles.as_ref().map(|angles| in_order(check, &key(name), input, angles, &of_robot)).transpose()
    };
    let (q_rad, seed_rad) = (read("q_rad", &input.q_rad)?, read("seed_rad", &input.seed_rad)?);
    if q_rad.is_none() && input.x_og.is_none() {
        return Err(check.value(&format!("arms[{arm}]"), "neither q_rad nor x_og", "at least one of them"));
    }
    if q_rad.is_some() && seed_rad.is_some() {
        let expected = "none: it belongs to an arm without q_rad";
        return Err(check.value(&key("seed_rad"), "angles", expected));
    }
    let angle_keys = of_robot.iter().map(|joint| angle_key(&key("q_rad"), input, joint)).collect();
    Ok(ArmFacts { index, q_rad, seed_rad, x_og: input.x_og, angle_keys })
}

/// Angles in the robot's order of the joints.
fn in_order(
    check: &Checker<'_>,
    key: &str,
    input: &ArmInput,
    angles: &Angles,
    of_robot: &[String],
) -> Result<Vec<f64>, InputError> {
    let expected = || format!("the joints of the {} arm: {}", input.name, of_robot.join(", "));
    let named: Vec<(&String, f64)> = match (angles, &input.joints) {
        (Angles::Listed(angles_rad), Some(joints)) if angles_rad.len() == joints.len() => {
            joints.iter().zip(angles_rad.iter().copied()).collect()
        }
        (Angles::Listed(angles_rad), Some(joints)) => {
            let expected = format!("{} angles in rad", joints.len());
            return Err(check.value(key, angles_rad.len().to_string(), expected));
        }
        (Angles::Listed(_), None) => {
            let expected = "the key `joints` with their order, or an object of joints with their angles";
            return Err(check.value(key, "a list of angles without joints", expected));
        }
        (Angles::Named(named), _) => named.iter().map(|(name, angle_rad)| (name, *angle_rad)).collect(),
    };
    if let Some((other, _)) = named.iter().find(|(name, _)| !of_robot.contains(name)) {
        return Err(check.value(&format!("{key}.{other}"), format!("\"{other}\""), expected()));
    }
    let angle_rad = |joint: &String| named.iter().find(|(name, _)| *name == joint).map(|(_, angle_rad)| *angle_rad);
    let missing = of_robot.iter().find(|joint| angle_rad(joint).is_none());
    if let Some(joint) = missing {
        return Err(check.value(key, format!("no angle of {joint}"), expected()));
    }
    Ok(of_robot.iter().filter_map(angle_rad).collect())
}

/// The key of a joint's angle in the file.
fn angle_key(key: &str, input: &ArmInput, joint: &str) -> String {
    match (&input.q_rad, &input.joints) {
        (Some(Angles::Listed(_)), Some(joints)) => {
            joints.iter().position(|name| name == joint).map_or(key.to_owned(), |place| format!("{key}[{place}]"))
        }
        (Some(Angles::Named(_)), _) => format!("{key}.{joint}"),
        _ => key.to_owned(),
    }
}

/// True if both lists have the same names, every name once.
fn is_permutation(found: &[String], expected: &[String]) -> bool {
    found.len() == expected.len() && expected.iter().all(|name| found.contains(name))
}

/// Names of an arm's joints, from the base outward.
fn joint_names(robot: &Robot, arm: usize) -> Vec<String> {
    robot.arms[arm].joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect()
}

/// The chain of an arm that holds the file's board.
fn chain(robot: &Robot, file: &PlanFile, arm: usize) -> Chain {
    Chain::new(robot, arm, robot.arms[arm].gripper.travel_for_gap_m(0, file.object.size_m[2]))
}

/// The board's pose from the first arm that has both angles and a grasp.
fn board_pose(
    check: &Checker<'_>,
    robot: &Robot,
    file: &PlanFile,
    facts: &[ArmFacts],
    notes: &mut Vec<String>,
) -> Result<Pose, InputError> {
    for (input, facts) in file.arms.iter().zip(facts) {
        if let (Some(q_rad), Some(x_og)) = (&facts.q_rad, &facts.x_og) {
            notes.push(format!("the plan's file leaves out x_wo: it follows from q_rad and x_og of {}", input.name));
            return Ok(chain(robot, file, facts.index).gripper_pose(q_rad) * x_og.inverse());
        }
    }
    Err(check.value("object.x_wo", "nothing", "a pose, or an arm with both q_rad and x_og"))
}

/// The angles of every arm: those of the file, or those that reach the grasp.
fn angles(
    check: &Checker<'_>,
    robot: &Robot,
    file: &PlanFile,
    facts: &[ArmFacts],
    x_wo: &Pose,
    scenario: Option<&Scenario>,
    notes: &mut Vec<String>,
) -> Result<Vec<Vec<f64>>, InputError> {
    let task = |facts: &ArmFacts| {
        let target = match (&facts.q_rad, &facts.x_og) {
            (None, Some(x_og)) => Target::Gripper { x_wg: x_wo * x_og, seed_rad: facts.seed_rad.clone() },
            // An arm has angles or a grasp.
            (q_rad, _) => Target::Angles(q_rad.clone().unwrap_or_default()),
        };
        ArmTask { arm: facts.index, target }
    };
    let tasks: Vec<_> = facts.iter().map(task).collect();
    if tasks.iter().all(|task| matches!(task.target, Target::Angles(_))) {
        return Ok(facts.iter().filter_map(|facts| facts.q_rad.clone()).collect());
    }
    let size_m = file.object.size_m;
    let range_m = BOARD_SIDE_M;
    for (axis, &found_m) in size_m.iter().enumerate() {
        if !(range_m[0]..=range_m[1]).contains(&found_m) {
            return Err(refused(check, &Flaw::BoardSide { axis, found_m, range_m }));
        }
    }
    if let Some(flaw) = check_plate(file.object.plate.as_ref()) {
        return Err(refused(check, &flaw));
    }
    let board = BoardShape { size_m, plate: file.object.plate.clone() };
    let Reached { q_rad, contact } = completed(&Completer::new(robot, &board), &tasks, file, x_wo, scenario)
        .reached()
        .map_err(|(task, found)| {
            let expected = format!("a pose that the {} arm reaches within its joint limits", file.arms[task].name);
            check.value(&format!("arms[{task}].x_og"), found, expected)
        })?;
    notes.extend(angles_note(file, contact.is_none()));
    Ok(q_rad)
}

/// The angles with the clearance that a planner would keep, else without a contact; without regard to the person if they cannot
/// be avoided.
fn completed(
    completer: &Completer<'_>,
    tasks: &[ArmTask],
    file: &PlanFile,
    x_wo: &Pose,
    scenario: Option<&Scenario>,
) -> Completion {
    let kind = file.operation.kind;
    let clearance_mm = scenario.map_or(Limits::of(kind).clearance_mm, |scenario| scenario.limits.clearance_mm);
    let person = file.human.as_ref().map(|posture| person_parts(posture, file, scenario)).unwrap_or_default();
    let attempt = |person: &[PersonPart]| {
        completer.complete_with_clearance(tasks, x_wo, person, clearance_mm * 1e-3, Effort::THOROUGH)
    };
    match attempt(&person) {
        Completion::Found(Reached { contact: Some(_), .. }) if !person.is_empty() => attempt(&[]),
        completion => completion,
    }
}

/// The capsules of a plan's person; empty if the person is invalid, which the check of the plan says.
fn person_parts(posture: &HumanPosture, file: &PlanFile, scenario: Option<&Scenario>) -> Vec<PersonPart> {
    let default = Person::default();
    let (rules, tool) = match scenario {
        Some(scenario) => (&scenario.human, scenario.tool),
        None => (&default, default_tool(file.operation.kind)),
    };
    let Ok(human) = Human::new(&posture.person(rules), &tool) else { return Vec::new() };
    human.capsules_w(&posture.x_wb, &posture.q_rad).map(PersonPart::from).to_vec()
}

fn angles_note(file: &PlanFile, is_free: bool) -> Option<String> {
    let seeded = file.arms.iter().filter(|input| input.q_rad.is_none()).map(|input| input.seed_rad.is_some());
    let near = match seeded.clone().all(|seeded| seeded) {
        true => "seed_rad",
        false if seeded.clone().any(|seeded| seeded) => "seed_rad or the middle of the joint ranges",
        false => "the middle of the joint ranges",
    };
    let of = if is_free { "of the answers without a contact" } else { "all answers have a contact; of them" };
    let origin = format!("filled in by inverse kinematics, {of} the nearest to {near}");
    left_out(file, "q_rad", |input| input.q_rad.is_none(), &origin)
}

/// A note about a key that some arms leave out; `None` if all have it.
fn left_out(file: &PlanFile, key: &str, lacks: impl Fn(&ArmInput) -> bool, origin: &str) -> Option<String> {
    let names: Vec<_> = file.arms.iter().filter(|input| lacks(input)).map(|input| input.name.as_str()).collect();
    (!names.is_empty()).then(|| format!("the plan's file leaves out {key} of {}: {origin}", names.join(" and ")))
}

/// The grip force of an arm whose file has none, N.
fn default_grip_force_n(robot: &Robot, arm: usize, scenario: Option<&Scenario>) -> f64 {
    let pads = robot.arms[arm].gripper.holding.pads();
    pads.map_or(0.0, |pads| scenario.map_or(pads.max_force_n, |scenario| scenario.grip.force_n))
}
