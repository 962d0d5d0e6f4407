//! Reads plan files and checks them against the robot that they name.

use std::path::Path;

use nalgebra::Vector3;

use super::{
    InputError, InputErrorKind,
    check::{Checker, FormatProbe},
    error::read_text,
    load_robot, resolve,
};
use crate::{
    human::{Human, default_tool},
    model::plan::{ArmHold, Plan},
    robot::{Arm, Chain, Robot},
};

/// Largest excess of a joint angle over its limit, rad: rounding of written numbers.
const LIMIT_TOLERANCE_RAD: f64 = 1e-6;

/// Largest deviation of a hand's pose from `x_wo x_og`, m and rad: 1 mm and 0.1 degrees.
const HAND_TOLERANCE: (f64, f64) = (1e-3, 0.1 * std::f64::consts::PI / 180.0);

/// Reads and checks a plan file. The robot that it names is loaded, unless it is `robot`.
///
/// # Errors
/// If the file cannot be read, is not a plan of the supported format, or does not fit the robot.
pub fn read_plan(path: &Path, robot: Option<&Robot>) -> Result<(Plan, Robot), InputError> {
    let text = read_text(path)?;
    let check = Checker::json(path, &text);
    if let Ok(probe) = serde_json::from_str::<FormatProbe>(&text) {
        check.format(probe.format)?;
    }
    let mut plan = parse(path, &text)?;
    let robot = match robot {
        Some(robot) if robot.description == plan.robot => robot.clone(),
        _ => {
            let folder = path.parent().unwrap_or(Path::new(""));
            load_robot(&plan.robot, folder).map_err(|e| check.robot("robot", e))?
        }
    };
    plan.robot.clone_from(&robot.description);
    check.name(&plan.name)?;
    check_object(&check, &plan)?;
    check_arms(&check, &plan, &robot)?;
    check_human(&check, &plan)?;
    if let Some(scenario) = &plan.scenario {
        let check = check.under("scenario.");
        check.format(scenario.format)?;
        resolve::check_values(&check, scenario, &robot)?;
    }
    Ok((plan, robot))
}

fn parse(path: &Path, text: &str) -> Result<Plan, InputError> {
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

fn check_object(check: &Checker<'_>, plan: &Plan) -> Result<(), InputError> {
    check.board_size("object.size_m", plan.object.size_m, std::iter::empty())?;
    check.positive("object.mass_kg", plan.object.mass_kg, "kg")?;
    check.on_board("operation.x_ot", &plan.operation.x_ot, plan.object.size_m)
}

/// Requires a valid person whose joint angles are within their limits.
fn check_human(check: &Checker<'_>, plan: &Plan) -> Result<(), InputError> {
    let Some(posture) = &plan.human else { return Ok(()) };
    let person = posture.person();
    resolve::check_person(check, &person)?;
    let tool = plan.scenario.as_ref().map_or_else(|| default_tool(plan.operation.kind), |scenario| scenario.tool);
    let human = Human::new(&person, &tool).map_err(|error| check.syntax("human", error.to_string()))?;
    for (i, (&q, [lower, upper])) in posture.q_rad.iter().zip(human.arm().limits_rad).enumerate() {
        let inside = q >= lower - LIMIT_TOLERANCE_RAD && q <= upper + LIMIT_TOLERANCE_RAD;
        let expected = format!("{lower} to {upper} rad, the limits of the person's joint q{}", i + 1);
        check.that(inside, &format!("human.q_rad[{i}]"), q.to_string(), &expected)?;
    }
    Ok(())
}

fn check_arms(check: &Checker<'_>, plan: &Plan, robot: &Robot) -> Result<(), InputError> {
    check.that(!plan.arms.is_empty(), "arms", "no arm", "at least one")?;
    for (index, hold) in plan.arms.iter().enumerate() {
        let key = |rest: &str| format!("arms[{index}].{rest}");
        let known: Vec<_> = robot.arms.iter().map(|arm| arm.name.as_str()).collect();
        let arm_index = robot.arm_index(&hold.name).ok_or_else(|| {
            check.value(
                &key("name"),
                format!("\"{}\"", hold.name),
                format!("an arm of the robot: {}", known.join(", ")),
            )
        })?;
        let twice = plan.arms[..index].iter().any(|other| other.name == hold.name);
        check.that(!twice, &key("name"), format!("\"{}\" again", hold.name), "every arm once")?;
        let arm = &robot.arms[arm_index];
        check_joints(check, index, hold, arm, robot)?;
        check.grip_force(&key("grip_force_n"), hold.grip_force_n, std::iter::once(arm))?;
        check.board_size("object.size_m", plan.object.size_m, std::iter::once(arm))?;
        check_straddle(check, &key("x_og"), hold)?;
        check_hand(check, &key("x_og"), hold, plan, &Chain::new(robot, arm_index, 0.0))?;
    }
    Ok(())
}

fn check_joints(check: &Checker<'_>, index: usize, hold: &ArmHold, arm: &Arm, robot: &Robot) -> Result<(), InputError> {
    let names: Vec<_> = arm.joints.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
    let same = hold.joints.iter().map(String::as_str).eq(names.iter().copied());
    let expected = format!("the joints of the {} arm: {}", arm.name, names.join(", "));
    check.that(same, &format!("arms[{index}].joints"), hold.joints.join(", "), &expected)?;
    let expected = format!("{} angles in rad", names.len());
    let count = hold.q_rad.len();
    check.that(count == names.len(), &format!("arms[{index}].q_rad"), count.to_string(), &expected)?;
    for (i, (&joint, &q)) in arm.joints.iter().zip(&hold.q_rad).enumerate() {
        let (lower, upper) = (robot.joints[joint].lower, robot.joints[joint].upper);
        let inside = q >= lower - LIMIT_TOLERANCE_RAD && q <= upper + LIMIT_TOLERANCE_RAD;
        let expected = format!("{lower} to {upper} rad, the limits of {}", names[i]);
        check.that(inside, &format!("arms[{index}].q_rad[{i}]"), q.to_string(), &expected)?;
    }
    Ok(())
}

/// Requires fingers that close across the board's thickness, centred on it.
fn check_straddle(check: &Checker<'_>, key: &str, hold: &ArmHold) -> Result<(), InputError> {
    let off_m = hold.x_og.translation.vector.z.abs();
    let off_rad = (hold.x_og.rotation * Vector3::y()).z.abs().min(1.0).acos();
    let found =
        format!("fingers {:.2} mm off the board's middle and {:.2} degrees askew", off_m * 1e3, off_rad.to_degrees());
    let astride = off_m <= HAND_TOLERANCE.0 && off_rad <= HAND_TOLERANCE.1;
    check.that(astride, key, found, "fingers that close across the thickness, within 1 mm and 0.1 degrees")
}

/// Requires joint angles whose forward kinematics agree with `x_wo x_og`.
fn check_hand(check: &Checker<'_>, key: &str, hold: &ArmHold, plan: &Plan, chain: &Chain) -> Result<(), InputError> {
    let reached = chain.gripper_pose(&hold.q_rad);
    let meant = plan.object.x_wo * hold.x_og;
    let apart_m = (reached.translation.vector - meant.translation.vector).norm();
    let apart_rad = reached.rotation.angle_to(&meant.rotation);
    let found =
        format!("the hand {:.2} mm and {:.2} degrees from where q_rad puts it", apart_m * 1e3, apart_rad.to_degrees());
    let close = apart_m <= HAND_TOLERANCE.0 && apart_rad <= HAND_TOLERANCE.1;
    check.that(close, key, found, "x_wo x_og to equal the arm's forward kinematics within 1 mm and 0.1 degrees")
}
