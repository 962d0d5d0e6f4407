//! `benchdog doctor`: checks that Benchdog works on this machine.

use super::{
    args::DoctorArgs,
    cache,
    exit::{CliError, Exit},
    output, robot_check,
};
use crate::{
    check::CheckedPlan,
    human::{BODY_POINTS, Human, default_tool},
    judge::fingerprint,
    model::{
        GRAVITY_W,
        plan::Plan,
        scenario::{Person, SimulationSettings},
        trace::{Phase, Sample, Trace},
        wrench::Wrench,
    },
    pipeline::versions::LONG,
    report::file,
    robot::{BUILTIN, Robot},
    scenario, sim,
    statics::{ContactModel, StabilityWorkspace},
};

/// The plan of the solver and physics checks: Baxter holds a foam board with both hands.
const PLAN: &str = include_str!("../../scenarios/plans/cut-rim.json");

/// Friction coefficient of pads and board.
const FRICTION: f64 = 0.6;

/// Largest relative error of the solver against the closed form: a hundred times its tolerance.
const SOLVER_TOLERANCE: f64 = 1e-5;

/// Largest residual of the forces on the board at the end of the hold, N. The board still oscillates 0.6 s after a ramp of 0.3 s,
/// by less than a thousandth of the load.
const BALANCE_N: f64 = 0.01;

/// A description of what works, or of the failure.
type CheckResult = Result<String, String>;

/// The name and the function of a check.
type Check = (&'static str, fn() -> CheckResult);

/// Runs all checks and prints a line for each.
///
/// # Errors
/// If standard output cannot be written or a check fails.
pub fn doctor(args: &DoctorArgs) -> Result<Exit, CliError> {
    if let Some(description) = &args.description {
        return robot_check::check(description, args);
    }
    let checks: [Check; 5] =
        [("versions", versions), ("robot", robot), ("person", person), ("solver", solver), ("physics", physics)];
    let mut wrong = Vec::new();
    for (what, check) in checks {
        let (mark, message) = match check() {
            Ok(message) => ("ok", message),
            Err(message) => {
                wrong.push(what);
                ("WRONG", message)
            }
        };
        output::report(&format!("{mark:<5}  {what:<9} {message}\n"))?;
    }
    for (what, (mark, message)) in [("maps", maps()), ("viewer", viewer())] {
        output::report(&format!("{mark:<5}  {what:<9} {message}\n"))?;
    }
    if wrong.is_empty() { Ok(Exit::Met) } else { Err(CliError::Machine(format!("wrong: {}", wrong.join(", ")))) }
}

fn versions() -> CheckResult {
    Ok(format!("benchdog {}", LONG.replace('\n', ", ")))
}

fn robot() -> CheckResult {
    let mut message = Vec::new();
    for name in BUILTIN {
        let robot = Robot::load(name, std::path::Path::new("")).map_err(|error| error.to_string())?;
        let joints: usize = robot.arms.iter().map(|arm| arm.joints.len()).sum();
        let (arms, points) = (robot.arms.len(), robot.body_points.len());
        message.push(format!("{name}: {arms} arms of {joints} joints, {points} points"));
    }
    Ok(message.join("; "))
}

fn person() -> CheckResult {
    let plan = plan()?;
    let person = scenario::default_for_plan(&plan, &loaded(&plan)?).human;
    let human = Human::new(&person, &default_tool(plan.operation.kind)).map_err(|error| error.to_string())?;
    Ok(format!("{} m, {} kg, reach {:.2} m, {BODY_POINTS} points", person.height_m, person.mass_kg, human.reach_m()))
}

fn plan() -> Result<Plan, String> {
    serde_json::from_str(PLAN).map_err(|error| error.to_string())
}

fn loaded(plan: &Plan) -> Result<Robot, String> {
    Robot::load(&plan.robot, std::path::Path::new("")).map_err(|error| error.to_string())
}

fn checked<'a>(plan: &'a Plan, robot: &'a Robot) -> Result<CheckedPlan<'a>, String> {
    CheckedPlan::new(robot, plan, &Person::default(), &default_tool(plan.operation.kind))
        .map_err(|flaws| flaws.to_string())
}

/// Compares the load factor with a closed form: two hands with four pads of grip force `F` and friction `mu` resist `4 mu F`
/// in the board's plane through the point between the hands, without the board's weight.
fn solver() -> CheckResult {
    let plan = plan()?;
    let robot = loaded(&plan)?;
    let checked = checked(&plan, &robot)?;
    let mut hold = ContactModel::of_plan(&checked, FRICTION).map_err(|error| error.to_string())?;
    let middle = hold.hands.iter().map(|hand| hand.grasp_point_o).sum::<nalgebra::Vector3<f64>>() / 2.0;
    hold.weight = Wrench::default();
    hold.load = Wrench::from_force(nalgebra::Vector3::y()).about(&middle);
    let expected_n: f64 = plan.arms.iter().map(|arm| 2.0 * FRICTION * arm.grip_force_n).sum();
    let outcome = StabilityWorkspace::new().friction_load_factor(&hold).map_err(|error| error.to_string())?;
    let found_n = outcome.load_factor().ok_or("found no load factor, expected one")?;
    let message = format!("four pads hold {found_n:.4} N, closed form {expected_n:.4} N");
    if (found_n / expected_n - 1.0).abs() < SOLVER_TOLERANCE { Ok(message) } else { Err(message) }
}

/// Simulates a second twice: the traces must be equal bit by bit, and the forces on the board must balance under the full
/// load.
fn physics() -> CheckResult {
    let plan = plan()?;
    let robot = loaded(&plan)?;
    let settings = SimulationSettings { settle_s: 0.3, ramp_s: 0.3, hold_s: 0.6, release_s: 0.1, ..Default::default() };
    let checked = checked(&plan, &robot)?;
    let simulate =
        || sim::simulate(&checked, &sim::Conditions::new(FRICTION, settings)).map_err(|error| error.to_string());
    let (trace, again) = (simulate()?, simulate()?);
    if let Some(reason) = trace.broke_down {
        return Err(reason);
    }
    if fingerprint(&trace) != fingerprint(&again) {
        return Err("found two different traces of one plan, expected equal ones".to_owned());
    }
    let last = last_loaded(&trace).ok_or("found no sample under the full load")?;
    let off_n = imbalance_n(last, plan.object.mass_kg);
    let message = format!("1.3 s simulated twice with equal results; residual of the forces on the board {off_n:.4} N");
    if off_n < BALANCE_N { Ok(message) } else { Err(format!("{message}, expected less than {BALANCE_N} N")) }
}

fn last_loaded(trace: &Trace) -> Option<&Sample> {
    trace.samples.iter().rfind(|sample| sample.phase == Phase::Hold)
}

/// The sum of the forces of pads, tool and gravity on the board, N.
fn imbalance_n(sample: &Sample, mass_kg: f64) -> f64 {
    let pads = sample.arms.iter().flat_map(|arm| &arm.pads).map(|pad| pad.wrench_w.force_n);
    (pads.sum::<nalgebra::Vector3<f64>>() + sample.tool_wrench_w.force_n + GRAVITY_W * mass_kg).norm()
}

/// Where maps are kept between commands. Without a folder everything works, only later.
fn maps() -> (&'static str, String) {
    let Some(folder) = cache::folder() else {
        return ("note", format!("are not kept between commands; {} names a folder for them", cache::VARIABLE));
    };
    let path = folder.path().display();
    match file::check_folder(folder.path()) {
        Ok(()) => ("ok", format!("are kept in {path}")),
        Err(error) => ("note", format!("are not kept between commands: {error}")),
    }
}

#[cfg(feature = "recording")]
fn viewer() -> (&'static str, String) {
    use super::view;
    use crate::pipeline::versions::RERUN;
    match view::viewer_version() {
        Ok(Some(version)) if view::is_new_enough(&version) => ("ok", version),
        Ok(Some(version)) => {
            ("note", format!("found {version}, expected {RERUN} or newer; {}", view::how_to_install()))
        }
        Ok(None) => ("note", format!("not found; {}", view::how_to_install())),
        Err(error) => ("note", error.to_string()),
    }
}

#[cfg(not(feature = "recording"))]
fn viewer() -> (&'static str, String) {
    ("note", "this benchdog was built without recordings".to_owned())
}
