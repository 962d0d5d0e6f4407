//! `benchdog doctor`: can Benchdog work here, and does it compute what it must.

use super::{
    exit::{CliError, Exit},
    output,
    versions::LONG,
};
use crate::{
    human::{BODY_POINTS, Human, default_tool},
    judge::fingerprint,
    model::{
        GRAVITY_W,
        plan::Plan,
        scenario::SimulationSettings,
        trace::{Phase, Sample, Trace},
        wrench::Wrench,
    },
    robot::{BUILTIN, Robot},
    scenario, sim,
    statics::{ContactModel, StabilityWorkspace},
};

/// The hold that both tests use: Baxter, both hands at a foam board.
const PLAN: &str = include_str!("../../scenarios/plans/cut-rim.json");

/// Friction between its pads and board.
const FRICTION: f64 = 0.6;

/// How far the solver may be from a closed form, relative: a hundred times its tolerance.
const SOLVER_TOLERANCE: f64 = 1e-5;

/// How far the forces on the board may be from balance at the end of the hold, N: the board still trembles after a ramp
/// of 0.3 s, by some 1e-4 N when this was measured.
const BALANCE_N: f64 = 0.01;

/// What a look at one thing found: what is well, or what is wrong.
type Finding = Result<String, String>;

/// What is looked at, and how.
type Look = (&'static str, fn() -> Finding);

/// Looks at everything and prints a line each.
///
/// # Errors
/// When standard output cannot be written, or something is wrong.
pub fn doctor() -> Result<Exit, CliError> {
    let findings: [Look; 5] =
        [("versions", versions), ("robot", robot), ("person", person), ("solver", solver), ("physics", physics)];
    let mut wrong = Vec::new();
    for (what, look) in findings {
        let (mark, told) = match look() {
            Ok(told) => ("ok", told),
            Err(told) => {
                wrong.push(what);
                ("WRONG", told)
            }
        };
        output::print(&format!("{mark:<5}  {what:<9} {told}\n"))?;
    }
    let (mark, told) = viewer();
    output::print(&format!("{mark:<5}  {:<9} {told}\n", "viewer"))?;
    if wrong.is_empty() { Ok(Exit::Met) } else { Err(CliError::Machine(format!("wrong: {}", wrong.join(", ")))) }
}

fn versions() -> Finding {
    Ok(format!("benchdog {}", LONG.replace('\n', ", ")))
}

fn robot() -> Finding {
    let mut told = Vec::new();
    for name in BUILTIN {
        let robot = Robot::load(name, std::path::Path::new("")).map_err(|error| error.to_string())?;
        let joints: usize = robot.arms.iter().map(|arm| arm.joints.len()).sum();
        let (arms, points) = (robot.arms.len(), robot.body_points.len());
        told.push(format!("{name}: {arms} arms of {joints} joints, {points} points"));
    }
    Ok(told.join("; "))
}

fn person() -> Finding {
    let plan = plan()?;
    let person = scenario::for_plan(&plan, &loaded(&plan)?).human;
    let human = Human::new(&person, &default_tool(plan.operation.kind)).map_err(|error| error.to_string())?;
    Ok(format!("{} m, {} kg, reach {:.2} m, {BODY_POINTS} points", person.height_m, person.mass_kg, human.reach_m()))
}

fn plan() -> Result<Plan, String> {
    serde_json::from_str(PLAN).map_err(|error| error.to_string())
}

fn loaded(plan: &Plan) -> Result<Robot, String> {
    Robot::load(&plan.robot, std::path::Path::new("")).map_err(|error| error.to_string())
}

/// The cone program against a closed form: both hands under a force in the board's plane, through the middle between them
/// and without the board's weight, hold `4 mu F`.
fn solver() -> Finding {
    let plan = plan()?;
    let robot = loaded(&plan)?;
    let mut hold = ContactModel::from_plan(&robot, &plan.arms, &plan.object, &plan.operation, FRICTION)
        .map_err(|error| error.to_string())?;
    let middle = hold.hands.iter().map(|hand| hand.grasp_point_o).sum::<nalgebra::Vector3<f64>>() / 2.0;
    hold.weight = Wrench::default();
    hold.load = Wrench::from_force(nalgebra::Vector3::y()).about(&middle);
    let expected_n: f64 = plan.arms.iter().map(|arm| 2.0 * FRICTION * arm.grip_force_n).sum();
    let outcome = StabilityWorkspace::new().friction_load_factor(&hold).map_err(|error| error.to_string())?;
    let found_n = outcome.load_factor().ok_or("found no load factor where there is one")?;
    let told = format!("four pads hold {found_n:.4} N, closed form {expected_n:.4} N");
    if (found_n / expected_n - 1.0).abs() < SOLVER_TOLERANCE { Ok(told) } else { Err(told) }
}

/// A second of simulation, twice: bit by bit the same, and the forces on the board in balance under the whole load.
fn physics() -> Finding {
    let plan = plan()?;
    let robot = loaded(&plan)?;
    let settings = SimulationSettings { settle_s: 0.3, ramp_s: 0.3, hold_s: 0.3, release_s: 0.1, ..Default::default() };
    let simulate =
        || sim::simulate(&robot, &plan, &sim::Conditions::new(FRICTION, settings)).map_err(|error| error.to_string());
    let (trace, again) = (simulate()?, simulate()?);
    if let Some(reason) = trace.broke_down {
        return Err(reason);
    }
    if fingerprint(&trace) != fingerprint(&again) {
        return Err("found two traces of one hold, expected the same bits".to_owned());
    }
    let last = last_loaded(&trace).ok_or("found no sample under the whole load")?;
    let off_n = imbalance_n(last, plan.object.mass_kg);
    let told = format!("1 s simulated twice, bit by bit the same; forces on the board off balance by {off_n:.4} N");
    if off_n < BALANCE_N { Ok(told) } else { Err(format!("{told}, expected less than {BALANCE_N} N")) }
}

fn last_loaded(trace: &Trace) -> Option<&Sample> {
    trace.samples.iter().rfind(|sample| sample.phase == Phase::Hold)
}

/// The sum of what pads, tool and gravity do to the board, N.
fn imbalance_n(sample: &Sample, mass_kg: f64) -> f64 {
    let pads = sample.arms.iter().flat_map(|arm| &arm.pads).map(|pad| pad.wrench_w.force_n);
    (pads.sum::<nalgebra::Vector3<f64>>() + sample.tool_wrench_w.force_n + GRAVITY_W * mass_kg).norm()
}

#[cfg(feature = "recording")]
fn viewer() -> (&'static str, String) {
    use super::{versions::RERUN, view};
    match view::viewer_version() {
        Ok(Some(version)) if view::is_matching(&version) => ("ok", version),
        Ok(Some(version)) => ("note", format!("found {version}, expected {RERUN}; {}", view::how_to_install())),
        Ok(None) => ("note", format!("not found; {}", view::how_to_install())),
        Err(error) => ("note", error.to_string()),
    }
}

#[cfg(not(feature = "recording"))]
fn viewer() -> (&'static str, String) {
    ("note", "this benchdog was built without recordings".to_owned())
}
