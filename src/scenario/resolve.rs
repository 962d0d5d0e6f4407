//! Resolves a scenario file: fills in defaults and checks every value.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use super::{
    InputError,
    check::Checker,
    file::{GripSection, HumanSection, LimitsSection, OperationSection, PlaceKind, ScenarioFile, ToolSection},
    load_section::{self, LoadSection, check_load},
    object_section,
    robot_file::{Robots, robot_parameters},
    sweep_section::{self, check_expectation, check_sweep},
    task_section,
    uncertainty_section::check_uncertainty,
};
use crate::{
    check::bounds,
    human::{
        Human,
        body::MAX_LEAN_DEG,
        tools::{TOOL_NAMES, default_tool, named_tool},
    },
    model::{
        FORMAT,
        frames::{Pose, rotation_from_xyzw},
        load::Load,
        operation::{Operation, OperationKind},
        plan::{PlacedObject, Plan},
        plate::Plate,
        scenario::{
            Board, ComfortSettings, Expectation, Grip, Limits, Person, PlannerSettings, PostureLimits, Scenario, Sex,
            SimulationSettings, StandingPlace, Tool,
        },
        task::Task,
        uncertainty::Uncertainty,
        wrench::Wrench,
    },
    robot::{PadGrip, Robot, RobotOptions},
};

/// What a scenario file resolves to.
pub struct Resolved {
    /// The scenario.
    pub scenario: Scenario,
    /// The task of a task file.
    pub task: Option<Task>,
    /// The robot.
    pub robot: Robot,
}

/// The resolved scenario of a file, and its robot.
///
/// # Errors
/// If the robot cannot be loaded or a value is invalid.
pub fn resolve(path: &Path, text: &str, file: &ScenarioFile, robots: &mut Robots<'_>) -> Result<Resolved, InputError> {
    let check = Checker::toml(path, text);
    check.name(&file.name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let robot = robot(&check, file, folder, robots)?;
    grip_keys(&check, &file.grip, &robot)?;
    if let Some(arm) = robot.arms.iter().find(|arm| arm.gripper.cup.is_some()) {
        let expected = "the path of a plan: planners know grasps of edges alone";
        let found = format!("none for a robot whose {} arm has a suction cup", arm.name);
        check.that(file.planner.plan.is_some(), "planner.plan", found, expected)?;
    }
    let object = object_section::board(&check, &file.object, &robot)?;
    let (operation, task) = operation_or_task(&check, file, &object, folder)?;
    let mut scenario = Scenario {
        format: FORMAT,
        name: file.name.clone(),
        robot: robot_parameters(&robot),
        human: person(&check, &file.human)?,
        tool: tool(&check, file.tool.as_ref(), operation.kind)?,
        limits: limits_with_defaults(&file.limits, operation.kind),
        object,
        operation,
        comfort: file.comfort,
        planner: file.planner.clone(),
        grip: grip_with_defaults(&file.grip, &robot),
        simulation: file.simulation,
        load: load_section::load(&check, &file.load, folder)?,
        uncertainty: file.uncertainty.clone(),
        sweep: None,
        expect: file.expect,
    };
    if let Some(section) = &file.sweep {
        scenario.sweep = Some(sweep_section::sweep(&check, section, &scenario, &robot, folder)?);
    }
    check_values(&check, &scenario, &robot)?;
    Ok(Resolved { scenario, task, robot })
}

/// The robot of a file, at the gap of its board.
fn robot(
    check: &Checker<'_>,
    file: &ScenarioFile,
    folder: &Path,
    robots: &mut Robots<'_>,
) -> Result<Robot, InputError> {
    let options = RobotOptions {
        packages: file.robot.packages.iter().map(PathBuf::from).collect(),
        posture: file.robot.posture.clone(),
    };
    robots
        .get(&file.robot.description, folder, &options, file.object.thickness_m())
        .map_err(|error| check.robot("robot.description", error))
}

/// The operation of a file or, of a task file, that of the first piece, with the task.
fn operation_or_task(
    check: &Checker<'_>,
    file: &ScenarioFile,
    object: &Board,
    folder: &Path,
) -> Result<(Operation, Option<Task>), InputError> {
    let section = match (&file.operation, &file.task) {
        (Some(section), None) => return Ok((operation(check, section, object)?, None)),
        (None, Some(section)) => section,
        (None, None) => return Err(check.value("operation", "nothing", "[operation], or [task] of a task file")),
        (Some(_), Some(_)) => return Err(check.value("task", "[task] beside [operation]", "one of them")),
    };
    let of_holds = "a scenario of one hold, with [operation]";
    check.absent("sweep", file.sweep.is_some(), of_holds)?;
    check.absent("planner.plan", file.planner.plan.is_some(), of_holds)?;
    check.absent("load", file.load != LoadSection::default(), of_holds)?;
    check.absent("uncertainty", file.uncertainty != Uncertainty::default(), of_holds)?;
    let task = task_section::task(check, section, object, folder)?;
    let first = task.pieces().first().and_then(|piece| task.operation_of(piece, object.size_m[2]));
    let operation = check.present("task", first, "a path of some length")?;
    Ok((operation, Some(task)))
}

/// Checks all values of a resolved scenario but those of board and operation, which depend on the form of the file.
pub fn check_values(check: &Checker<'_>, scenario: &Scenario, robot: &Robot) -> Result<(), InputError> {
    check_person(check, &scenario.human)?;
    check_tool(check, &scenario.tool)?;
    Human::new(&scenario.human, &scenario.tool).map_err(|error| check.syntax("human", error.to_string()))?;
    grip(check, &scenario.grip, robot)?;
    comfort(check, &scenario.comfort)?;
    simulation(check, &scenario.simulation)?;
    check_load(check, scenario)?;
    check_uncertainty(check, &scenario.uncertainty, robot, scenario.object.shape().thickness_m())?;
    check_sweep(check, scenario, robot)?;
    check_expectation(check, scenario)?;
    check_limits(check, &scenario.limits)
}

/// The person of a file, with the place checked.
fn person(check: &Checker<'_>, section: &HumanSection) -> Result<Person, InputError> {
    Ok(Person { place: place(check, section)?, ..person_with_defaults(section) })
}

/// Where the person of a file stands.
pub fn place(check: &Checker<'_>, section: &HumanSection) -> Result<StandingPlace, InputError> {
    let given = [
        ("human.x_m", section.x_m),
        ("human.y_m", section.y_m),
        ("human.heading_deg", section.heading_deg),
        ("human.place_tolerance_m", section.place_tolerance_m),
        ("human.heading_tolerance_deg", section.heading_tolerance_deg),
    ];
    let place = match section.place {
        PlaceKind::Free => {
            for (key, value) in given {
                check.absent(key, value.is_some(), "human.place = \"given\"")?;
            }
            StandingPlace::Free
        }
        PlaceKind::Given => StandingPlace::Given {
            p_wb_m: [
                check.present("human.x_m", section.x_m, "a position in m, since human.place = \"given\"")?,
                check.present("human.y_m", section.y_m, "a position in m, since human.place = \"given\"")?,
            ],
            heading_deg: check.present(
                "human.heading_deg",
                section.heading_deg,
                "a direction in degrees, since human.place = \"given\"",
            )?,
            tolerance_m: section.place_tolerance_m.unwrap_or(PLACE_TOLERANCE_M),
            tolerance_deg: section.heading_tolerance_deg.unwrap_or(HEADING_TOLERANCE_DEG),
        },
    };
    for (key, value) in given {
        if let Some(value) = value {
            check.finite(key, &[value])?;
        }
    }
    Ok(place)
}

/// Default tolerance of a given place, m: half a foot's length either way.
const PLACE_TOLERANCE_M: f64 = 0.05;
/// Default tolerance of a given heading, degrees.
const HEADING_TOLERANCE_DEG: f64 = 5.0;

/// The person of a file. The default height and mass are those of typical adults (`docs/method.md#43-body-dimensions`).
fn person_with_defaults(section: &HumanSection) -> Person {
    let (default_height_m, default_mass_kg) = match section.sex {
        Sex::Male => (1.75, 75.0),
        Sex::Female => (1.62, 62.0),
    };
    Person {
        height_m: section.height_m.unwrap_or(default_height_m),
        mass_kg: section.mass_kg.unwrap_or(default_mass_kg),
        sex: section.sex,
        hand: section.hand,
        percentile: section.percentile,
        lean_deg: section.lean_deg,
        shoulder: section.shoulder,
        posture: section.posture_limits(),
        place: StandingPlace::Free,
    }
}

/// Checks a person's values.
pub fn check_person(check: &Checker<'_>, person: &Person) -> Result<(), InputError> {
    check.within("human.height_m", person.height_m, 1.2, 2.3, "m")?;
    check.within("human.mass_kg", person.mass_kg, 30.0, 250.0, "kg")?;
    // Outside this range the normal distribution of strength could reach zero torque.
    check.within("human.percentile", person.percentile, 0.1, 99.9, "%")?;
    check.within("human.lean_deg", person.lean_deg, 0.0, MAX_LEAN_DEG, "degrees")?;
    check_posture_limits(check, &person.posture)?;
    let StandingPlace::Given { p_wb_m, heading_deg, tolerance_m, tolerance_deg } = person.place else { return Ok(()) };
    // In the scenario of a plan the place is an object of its own.
    let keys = if check.is_nested() {
        ["place.p_wb_m[0]", "place.p_wb_m[1]", "place.heading_deg", "place.tolerance_m", "place.tolerance_deg"]
    } else {
        ["x_m", "y_m", "heading_deg", "place_tolerance_m", "heading_tolerance_deg"]
    };
    let [x, y, heading, tolerance, of_heading] = keys.map(|key| format!("human.{key}"));
    check.place(&x, &p_wb_m[..1])?;
    check.place(&y, &p_wb_m[1..])?;
    check.within(&heading, heading_deg, -360.0, 360.0, "degrees")?;
    check.within(&tolerance, tolerance_m, 0.001, 10.0, "m")?;
    check.within(&of_heading, tolerance_deg, 0.1, 180.0, "degrees")
}

fn check_posture_limits(check: &Checker<'_>, limits: &PostureLimits) -> Result<(), InputError> {
    // In the scenario of a plan the limits are in an object of their own.
    let key = |name: &str| if check.is_nested() { format!("human.posture.{name}") } else { format!("human.{name}") };
    let within = |name: &str, found: f64, [least, most]: [f64; 2], unit: &str| {
        check.within(&key(name), found, least, most, unit)
    };
    let range = |name: &str, [low, high]: [f64; 2], [least, most]: [f64; 2], unit: &str| {
        within(&format!("{name}[0]"), low, [least, most], unit)?;
        within(&format!("{name}[1]"), high, [low, most], unit)
    };
    within("facing_deg", limits.facing_deg, [0.0, 180.0], "degrees")?;
    within("view_deg", limits.view_deg, [0.0, 180.0], "degrees")?;
    within("gaze_yaw_deg", limits.gaze_yaw_deg, [0.0, 180.0], "degrees")?;
    range("gaze_pitch_deg", limits.gaze_pitch_deg, [-90.0, 90.0], "degrees")?;
    range("eye_distance_m", limits.eye_distance_m, [0.0, 5.0], "m")?;
    within("face_elevation_deg", limits.face_elevation_deg, [-90.0, 90.0], "degrees")?;
    within("upper_arm_deg", limits.upper_arm_deg, [1.0, 180.0], "degrees")?;
    within("reach", limits.reach, [0.2, 1.0], "a share of the straight arm")?;
    range("elbow_deg", limits.elbow_deg, [0.0, 180.0], "degrees")?;
    within("limit_margin_deg", limits.limit_margin_deg, [0.0, 60.0], "degrees")?;
    within("deviation_margin_deg", limits.deviation_margin_deg, [0.0, 25.0], "degrees")
}

/// The tool of a file: a shipped one by its name, one with figures, or that of the operation.
fn tool(check: &Checker<'_>, section: Option<&ToolSection>, kind: OperationKind) -> Result<Tool, InputError> {
    let Some(section) = section else { return Ok(default_tool(kind)) };
    let ToolSection { name, mass_kg, tip_h_m, rotation_xyzw } = section;
    let Some(name) = name else {
        return Ok(Tool {
            mass_kg: check.present("tool.mass_kg", *mass_kg, "a mass in kg, or tool.name")?,
            tip_h_m: check.present("tool.tip_h_m", *tip_h_m, "a position [x, y, z] in m, or tool.name")?,
            rotation_xyzw: check.present("tool.rotation_xyzw", *rotation_xyzw, "a unit quaternion, or tool.name")?,
        });
    };
    check.absent("tool.mass_kg", mass_kg.is_some(), "a tool without a name")?;
    check.absent("tool.tip_h_m", tip_h_m.is_some(), "a tool without a name")?;
    check.absent("tool.rotation_xyzw", rotation_xyzw.is_some(), "a tool without a name")?;
    let expected = || TOOL_NAMES.map(|name| format!("\"{name}\"")).join(", ");
    named_tool(name).ok_or_else(|| check.value("tool.name", format!("\"{name}\""), expected()))
}

fn check_tool(check: &Checker<'_>, tool: &Tool) -> Result<(), InputError> {
    check.within("tool.mass_kg", tool.mass_kg, 0.0, 50.0, "kg")?;
    for (index, &value) in tool.tip_h_m.iter().enumerate() {
        check.within(&format!("tool.tip_h_m[{index}]"), value, -2.0, 2.0, "m")?;
    }
    rotation_from_xyzw(tool.rotation_xyzw).map_err(|problem| check.syntax("tool.rotation_xyzw", problem))?;
    Ok(())
}

/// The operation of a file on a board.
pub fn operation(check: &Checker<'_>, section: &OperationSection, board: &Board) -> Result<Operation, InputError> {
    let operation = match section.kind {
        OperationKind::Drill | OperationKind::Cut => face_operation(check, section, board)?,
        OperationKind::Wrench => free_operation(check, section)?,
    };
    let key = if section.kind == OperationKind::Wrench { "operation.x_ot" } else { "operation.point_m" };
    check.on_board(key, &operation.x_ot, &board.shape())?;
    Ok(operation)
}

fn face_operation(check: &Checker<'_>, section: &OperationSection, board: &Board) -> Result<Operation, InputError> {
    check.absent("operation.wrench_o", section.wrench_o.is_some(), "kind = \"wrench\"")?;
    check.absent("operation.x_ot", section.x_ot.is_some(), "kind = \"wrench\"")?;
    let point_m = check.present("operation.point_m", section.point_m, "a point [x, y] in m")?;
    let force_n = check.present("operation.force_n", section.force_n, "a force in N")?;
    check.place("operation.point_m", &point_m)?;
    check.positive("operation.force_n", force_n, bounds::MOST_FORCE_N, "N")?;
    let thickness_m = board.size_m[2];
    if section.kind == OperationKind::Drill {
        check.absent("operation.direction_o", section.direction_o.is_some(), "kind = \"cut\"")?;
        return Ok(Operation::drill(point_m, force_n, thickness_m));
    }
    let given = check.present("operation.direction_o", section.direction_o, "a direction [x, y, 0]")?;
    check.finite("operation.direction_o", &given)?;
    let direction_o = Vector3::from(given);
    let in_plane = direction_o.z == 0.0 && direction_o.norm() > 1e-6;
    check.that(in_plane, "operation.direction_o", format!("{given:?}"), "a direction [x, y, 0] along the face")?;
    Ok(Operation::cut(point_m, direction_o.normalize(), force_n, thickness_m))
}

fn free_operation(check: &Checker<'_>, section: &OperationSection) -> Result<Operation, InputError> {
    check.absent("operation.point_m", section.point_m.is_some(), "kind = \"drill\" or \"cut\"")?;
    check.absent("operation.force_n", section.force_n.is_some(), "kind = \"drill\" or \"cut\"")?;
    check.absent("operation.direction_o", section.direction_o.is_some(), "kind = \"cut\"")?;
    let wrench = check.present("operation.wrench_o", section.wrench_o, "six components in N and N m")?;
    let record = check.present("operation.x_ot", section.x_ot, "a pose")?;
    check.wrench("operation.wrench_o", &wrench)?;
    let some_load = wrench.iter().any(|&component| component != 0.0);
    check.that(some_load, "operation.wrench_o", "zero", "a wrench that loads the board")?;
    let x_ot = Pose::try_from(record).map_err(|problem| check.syntax("operation.x_ot", problem))?;
    Ok(Operation { kind: OperationKind::Wrench, wrench_o: Wrench::from(wrench), x_ot })
}

/// Grip force and friction of a file, else of the robot's grippers.
fn grip_with_defaults(section: &GripSection, robot: &Robot) -> Grip {
    let usual = Grip::default();
    let least = |of: fn(&PadGrip) -> Option<f64>, usual: f64| {
        let given = robot.arms.iter().filter_map(|arm| arm.gripper.holding.pads().and_then(of));
        given.min_by(f64::total_cmp).unwrap_or(usual)
    };
    Grip {
        force_n: section.force_n.unwrap_or_else(|| least(|pads| pads.grip_force_n, usual.force_n)),
        friction: section.friction.unwrap_or_else(|| least(|pads| pads.friction, usual.friction)),
    }
}

/// Requires that some gripper has pads if the file has figures of them.
fn grip_keys(check: &Checker<'_>, section: &GripSection, robot: &Robot) -> Result<(), InputError> {
    if robot.arms.iter().any(|arm| arm.gripper.holding.pads().is_some()) {
        return Ok(());
    }
    let belongs_to = "pads, and every gripper of this robot has measured wrench limits";
    check.absent("grip.force_n", section.force_n.is_some(), belongs_to)?;
    check.absent("grip.friction", section.friction.is_some(), belongs_to)
}

fn grip(check: &Checker<'_>, grip: &Grip, robot: &Robot) -> Result<(), InputError> {
    check.grip_force("grip.force_n", grip.force_n, robot.arms.iter())?;
    check.positive("grip.friction", grip.friction, 2.0, "a Coulomb coefficient")
}

fn comfort(check: &Checker<'_>, comfort: &ComfortSettings) -> Result<(), InputError> {
    if let Some(saturation_m) = comfort.saturation_m {
        check.positive("comfort.saturation_m", saturation_m, bounds::MOST_PLACE_M, "m")?;
    }
    check.not_negative("comfort.weight_muscular", comfort.weight_muscular, bounds::MOST_WEIGHT, "a weight")?;
    let peripersonal = comfort.weight_peripersonal;
    check.not_negative("comfort.weight_peripersonal", peripersonal, bounds::MOST_WEIGHT, "a weight in 1/m")?;
    let Some(share) = comfort.peripersonal_share else {
        return check.absent("comfort.optima", comfort.optima.is_some(), "comfort.peripersonal_share");
    };
    check.within("comfort.peripersonal_share", share, 0.0, 1.0, "a share")?;
    let defaults = ComfortSettings::default();
    for (key, weight, unchanged) in [
        ("comfort.weight_muscular", comfort.weight_muscular, defaults.weight_muscular),
        ("comfort.weight_peripersonal", comfort.weight_peripersonal, defaults.weight_peripersonal),
    ] {
        check.that(weight == unchanged, key, "a weight beside comfort.peripersonal_share", "one or the other")?;
    }
    let Some(optima) = comfort.optima else { return Ok(()) };
    let muscular = optima.muscular_regularised;
    check.positive("comfort.optima.muscular_regularised", muscular, bounds::MOST_LIMIT, "a comfort")?;
    check.positive("comfort.optima.peripersonal_m", optima.peripersonal_m, bounds::MOST_PLACE_M, "m")
}

fn simulation(check: &Checker<'_>, settings: &SimulationSettings) -> Result<(), InputError> {
    let SimulationSettings { settle_s, ramp_s, hold_s, release_s, timestep_s } = *settings;
    check.positive("simulation.settle_s", settle_s, bounds::MOST_TIME_S, "s")?;
    check.positive("simulation.ramp_s", ramp_s, bounds::MOST_TIME_S, "s")?;
    check.positive("simulation.hold_s", hold_s, bounds::MOST_TIME_S, "s")?;
    check.not_negative("simulation.release_s", release_s, bounds::MOST_TIME_S, "s")?;
    check.within("simulation.timestep_s", timestep_s, 1e-5, SimulationSettings::MAX_TIMESTEP_S, "s")?;
    let steps = (settle_s + ramp_s + hold_s + release_s) / timestep_s;
    let most = SimulationSettings::MAX_STEPS as f64;
    let expected = format!("at most {most} steps in all phases together");
    check.that(steps <= most, "simulation", format!("{steps:.0} steps"), &expected)?;
    let least_s = SimulationSettings::MIN_HOLD_STEPS as f64 * timestep_s;
    let expected = format!("at least {} time steps, to measure creep", SimulationSettings::MIN_HOLD_STEPS);
    check.that(hold_s >= least_s, "simulation.hold_s", hold_s.to_string(), &expected)
}

/// The limits of a file. The default deflection depends on the kind of operation
/// (`docs/method.md#810-default-limits`).
fn limits_with_defaults(section: &LimitsSection, kind: OperationKind) -> Limits {
    Limits {
        slip_mm: section.slip_mm,
        slip_deg: section.slip_deg,
        deflection_mm: section.deflection_mm.unwrap_or(Limits::of(kind).deflection_mm),
        sag_mm: section.sag_mm,
        creep_mm_s: section.creep_mm_s,
        torque_ratio: section.torque_ratio,
        load_factor: section.load_factor,
        clearance_mm: section.clearance_mm,
        rula: section.rula,
        rula_arm: section.rula_arm,
        reba: section.reba,
    }
}

fn check_limits(check: &Checker<'_>, limits: &Limits) -> Result<(), InputError> {
    check.positive("limits.slip_mm", limits.slip_mm, bounds::MOST_LIMIT, "mm")?;
    check.positive("limits.slip_deg", limits.slip_deg, bounds::MOST_LIMIT, "degrees")?;
    check.positive("limits.deflection_mm", limits.deflection_mm, bounds::MOST_LIMIT, "mm")?;
    check.positive("limits.sag_mm", limits.sag_mm, bounds::MOST_LIMIT, "mm")?;
    check.positive("limits.creep_mm_s", limits.creep_mm_s, bounds::MOST_LIMIT, "mm/s")?;
    check.positive("limits.torque_ratio", limits.torque_ratio, bounds::MOST_LIMIT, "a ratio")?;
    // The solvers stop at 100, and the planner applies a safety factor.
    check.within("limits.load_factor", limits.load_factor, 0.0, 50.0, "a multiple of the load")?;
    check.not_negative("limits.clearance_mm", limits.clearance_mm, bounds::MOST_LIMIT, "mm")?;
    for (key, score, most) in [
        ("limits.rula", limits.rula, 7.0),
        ("limits.rula_arm", limits.rula_arm, 12.0),
        ("limits.reba", limits.reba, 12.0),
    ] {
        if let Some(score) = score {
            check.within(key, f64::from(score), 1.0, most, "a score")?;
        }
    }
    Ok(())
}

/// Largest deviation of a plan's board, operation and grip force from the scenario's, m, kg, N and N m: rounding of
/// written numbers.
const SAME_TOLERANCE: f64 = 1e-6;

/// Checks that a plan has a scenario's robot, board, operation and grip force. The roll of a drill may differ.
///
/// # Errors
/// If one of them differs.
pub fn check_plan_matches(path: &Path, text: &str, scenario: &Scenario, plan: &Plan) -> Result<(), InputError> {
    let check = Checker::toml(path, text);
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME_TOLERANCE);
    let same_robot = plan.robot == scenario.robot.description;
    let found = format!("a plan for the robot \"{}\"", plan.robot);
    check.that(same_robot, "planner.plan", found, &format!("one for \"{}\"", scenario.robot.description))?;
    let (found, expected) = (&plan.object, &scenario.object);
    let same_mass = close(&[found.mass_kg], &[expected.mass_kg()]);
    let described = format!("{:?} m and {} kg", expected.size_m, expected.mass_kg());
    let same_board = close(&found.size_m, &expected.size_m) && same_mass;
    let size = format!("a plan for a board of {:?} m and {} kg", found.size_m, found.mass_kg);
    check.that(same_board, "planner.plan", size, &described)?;
    let outlines = [found.shape().outline_m(), expected.shape().outline_m()].map(|corners| corners.concat());
    let holes = [&found.plate, &expected.plate].map(holes_of);
    let coms = [found.com_o(), expected.placed(found.x_wo).com_o()];
    let same_shape = same_corners(&outlines) && same_corners(&holes) && close(coms[0].as_slice(), coms[1].as_slice());
    let found = "a plan for a board of another outline, other holes or another centre of mass";
    check.that(same_shape, "planner.plan", found, "the scenario's object")?;
    let (found, expected) = (&plan.operation, &scenario.operation);
    let (tip, meant) = (found.x_ot.translation.vector, expected.x_ot.translation.vector);
    let (turned, unrolled) = (found.x_ot.rotation, expected.x_ot.rotation);
    let same_axis = (turned * Vector3::z() - unrolled * Vector3::z()).norm() <= SAME_TOLERANCE;
    let same_turn = same_axis && (found.kind.roll_is_free() || turned.angle_to(&unrolled) <= SAME_TOLERANCE);
    let same_operation = found.kind == expected.kind
        && same_turn
        && close(tip.as_slice(), meant.as_slice())
        && close(found.wrench_o.to_vector().as_slice(), expected.wrench_o.to_vector().as_slice());
    let describe = |operation: &Operation, tip: &[f64]| {
        let wrench: [f64; 6] = operation.wrench_o.into();
        let turn = operation.x_ot.rotation.coords;
        format!("{} with {wrench:?} at {tip:?}, turned by {:?}", operation.kind, turn.as_slice())
    };
    let found = format!("a plan for {}", describe(found, tip.as_slice()));
    check.that(same_operation, "planner.plan", found, &describe(expected, meant.as_slice()))?;
    let force_n = scenario.grip.force_n;
    // A measured gripper has no grip force, which the check of the plan sees to.
    let other =
        plan.arms.iter().find(|hold| hold.grip_force_n != 0.0 && (hold.grip_force_n - force_n).abs() > SAME_TOLERANCE);
    let found = other.map_or(force_n, |hold| hold.grip_force_n);
    let expected = format!("{force_n} N, the scenario's grip.force_n");
    check.that(other.is_none(), "planner.plan", format!("a plan that grips with {found} N"), &expected)
}

/// The coordinates of the corners of all holes, m.
fn holes_of(plate: &Option<Plate>) -> Vec<f64> {
    plate.iter().flat_map(|plate| plate.holes_m().iter().map(|hole| hole.concat())).flatten().collect()
}

/// True if two lists of coordinates are the same but for rounding.
fn same_corners([found, expected]: &[Vec<f64>; 2]) -> bool {
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME_TOLERANCE;
    found.len() == expected.len() && found.iter().zip(expected).all(same)
}

/// A scenario for a plan that contains none: the plan's own values, and defaults for its kind of operation.
pub fn default_for_plan(plan: &Plan, robot: &Robot) -> Scenario {
    let kind = plan.operation.kind;
    let PlacedObject { size_m, ref plate, mass_kg, com_m, .. } = plan.object;
    Scenario {
        format: FORMAT,
        name: plan.name.clone(),
        robot: robot_parameters(robot),
        human: plan.human.map_or_else(
            || person_with_defaults(&HumanSection::default()),
            |posture| posture.person(&Person::default()),
        ),
        tool: default_tool(kind),
        object: Board {
            size_m,
            density_kg_m3: mass_kg / plan.object.shape().volume_m3(),
            plate: plate.clone(),
            mass_kg: plate.as_ref().map(|_| mass_kg),
            com_m,
            material: "unknown".into(),
        },
        operation: plan.operation,
        comfort: ComfortSettings::default(),
        planner: PlannerSettings::default(),
        grip: grip_with_defaults(&GripSection::default(), robot),
        simulation: SimulationSettings::default(),
        load: Load::default(),
        uncertainty: Uncertainty::default(),
        sweep: None,
        limits: limits_with_defaults(&LimitsSection::default(), kind),
        expect: Expectation::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{plate::PlateRecord, polygon::circle},
        scenario::read_plan,
    };

    #[test]
    fn a_plan_for_another_plate_does_not_match() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
        let (mut plan, robot) = read_plan(&path, None).unwrap();
        let pierced = |plan: &mut Plan, centre_m: [f64; 2]| {
            let outline_m = plan.object.shape().outline_m();
            plan.object.plate = Some(PlateRecord { outline_m, holes_m: vec![circle(centre_m, 0.02, 8)] }.into());
        };
        pierced(&mut plan, [0.0, 0.1]);
        let scenario = default_for_plan(&plan, &robot);
        assert_eq!(scenario.object.mass_kg(), plan.object.mass_kg);
        let matches = |plan: &Plan| check_plan_matches(&path, "", &scenario, plan);
        assert!(matches(&plan).is_ok());
        let of_rounded_corners = |plan: &mut Plan| pierced(plan, [1e-9, 0.1]);
        let others: [fn(&mut Plan); 3] = [
            |plan| plan.object.plate = None,
            |plan| plan.object.com_m = Some([0.01, 0.0, 0.0]),
            |plan| plan.object.mass_kg += 0.01,
        ];
        for change in others {
            let mut other = plan.clone();
            change(&mut other);
            let message = matches(&other).unwrap_err().to_string();
            assert!(message.contains("a plan for a board of"), "{message}");
        }
        let mut moved = plan.clone();
        pierced(&mut moved, [0.001, 0.1]);
        assert!(matches(&moved).is_err());
        of_rounded_corners(&mut moved);
        assert!(matches(&moved).is_ok());
    }
}
