//! `benchdog import`: makes a plan of grasps that another planner wrote.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    args::{ArmChoice, ImportArgs},
    exit::{CliError, Exit},
    inputs, interrupt, output,
    plan::load_for_planning,
    progress::Progress,
    streams,
};
use crate::{
    check::{CheckedPlan, fingers_across},
    complete::{ArmTask, Completer, Effort, Reached, Target},
    model::{
        FORMAT,
        file_name::MOST_BYTES,
        frames::Pose,
        plan::{ArmHold, Plan},
    },
    planner::{BOARD_DRAWS, place_board},
    report,
    scenario::{
        LoadedScenario,
        import::{ForeignGrasp, ForeignGrasps, read_grasps},
    },
};

/// An arm with its grasp.
struct Hold<'a> {
    /// Index into the robot's arms.
    arm: usize,
    grasp: &'a ForeignGrasp,
    x_og: Pose,
}

/// The board's pose, the arms' angles, and where they come from in words.
struct Placement {
    x_wo: Pose,
    q_rad: Vec<Vec<f64>>,
    origin: String,
}

/// A plan, and what a user should know about it.
struct Imported {
    plan: Plan,
    notes: Vec<String>,
}

/// Makes a plan of a scenario's task and a file's grasps, or one of each grasp.
pub fn import(args: &ImportArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the scenario", "")?;
    let loaded = load_for_planning(&args.scenario)?;
    let file = read_grasps(&args.grasps)?;
    progress.does("looking for a pose of the board that the arms reach");
    let read: Vec<_> = loaded.inputs.iter().chain([&args.grasps]).cloned().collect();
    let output = args.output.as_deref().and_then(streams::file);
    match (&args.all, output) {
        (Some(arm), Some(folder)) => return all(args, &loaded, &file, &read, (arm, folder), &progress),
        (Some(_), None) => {
            return Err(CliError::Usage("-o -: found standard output, expected a folder beside --all".into()));
        }
        (None, _) => inputs::protect(&read, output.map(Path::to_owned))?,
    }
    let found = imported(args, &loaded, &file, &args.arm)?;
    progress.finish();
    let _writing = interrupt::writing();
    let Some(Imported { plan, notes }) = found else {
        output::message(&format!("{}: no feasible plan: {}", loaded.scenario.name, no_pose()));
        return Ok(Exit::Infeasible);
    };
    let text = report::json::plan(&plan);
    match output {
        Some(path) => {
            report::file::write_whole(path, text.as_bytes())?;
            output::print(&format!("{}\n", notes.join("\n")))?;
        }
        // The plan alone is on the standard output.
        None => {
            output::print(&text)?;
            output::message(&notes.join("\n"));
        }
    }
    Ok(Exit::Met)
}

fn no_pose() -> String {
    format!("none of {BOARD_DRAWS} poses of the board lets the arms reach these grasps without a contact")
}

/// Makes a plan of each grasp of a file that `--arm` does not name, with the arm of `--all`, in a folder.
fn all(
    args: &ImportArgs,
    loaded: &LoadedScenario,
    file: &ForeignGrasps,
    read: &[PathBuf],
    (arm, folder): (&str, &Path),
    progress: &Progress,
) -> Result<Exit, CliError> {
    let is_free = |grasp: &&ForeignGrasp| args.arm.iter().all(|choice| choice.grasp != grasp.name);
    let mut grasps: Vec<&ForeignGrasp> = file.grasps.iter().filter(is_free).collect();
    grasps.sort_by(|a, b| a.name.cmp(&b.name));
    let mut paths = BTreeMap::new();
    for grasp in &grasps {
        let stem = output::file_stem(&grasp.name);
        if let Some(other) = paths.insert(stem.clone(), &grasp.name) {
            let found = format!("a name whose plan is {stem}.json, as that of {other}");
            return Err(file
                .error(grasp, found, "names that differ in letters, digits, `-`, `_` or `.`".into())
                .into());
        }
        let length = plan_name(loaded, grasp).len();
        if length > MOST_BYTES {
            let found = format!("a name whose plan has a name of {length} characters");
            return Err(file
                .error(grasp, found, format!("at most {MOST_BYTES}, since files are named after it"))
                .into());
        }
    }
    let path_of = |grasp: &ForeignGrasp| folder.join(format!("{}.json", output::file_stem(&grasp.name)));
    inputs::protect(read, grasps.iter().map(|grasp| path_of(grasp)))?;
    report::file::check_folder(folder)?;
    let mut exit = Exit::Infeasible;
    for grasp in grasps {
        progress.begins(&grasp.name);
        let own = ArmChoice { arm: arm.to_owned(), grasp: grasp.name.clone() };
        let choices: Vec<ArmChoice> = args.arm.iter().cloned().chain([own]).collect();
        let left_out = match imported(args, loaded, file, &choices) {
            Ok(Some(Imported { mut plan, notes })) => {
                plan.name = plan_name(loaded, grasp);
                let _writing = interrupt::writing();
                report::file::write_whole(&path_of(grasp), report::json::plan(&plan).as_bytes())?;
                progress.leaves("the plans that were written stay");
                progress.print(&format!("wrote {}: {}\n", path_of(grasp).display(), notes.join("; ")))?;
                exit = Exit::Met;
                continue;
            }
            Ok(None) => no_pose(),
            Err(CliError::Input(error)) => error.to_string(),
            Err(error) => return Err(error),
        };
        progress.print(&format!("left out {}: {left_out}\n", grasp.name))?;
    }
    progress.finish();
    Ok(exit)
}

/// The name of the plan of a grasp beside those of other grasps.
fn plan_name(loaded: &LoadedScenario, grasp: &ForeignGrasp) -> String {
    format!("{}-{}", loaded.scenario.name, output::file_stem(&grasp.name))
}

/// The plan of these grasps; `None` if the board has no pose at which the arms reach them.
fn imported(
    args: &ImportArgs,
    loaded: &LoadedScenario,
    file: &ForeignGrasps,
    choices: &[ArmChoice],
) -> Result<Option<Imported>, CliError> {
    let holds = holds(args, loaded, file, choices)?;
    let Some(Placement { x_wo, q_rad, origin }) = placement(args, loaded, file, &holds)? else { return Ok(None) };
    let plan = plan_of(loaded, &holds, x_wo, q_rad);
    let checked = CheckedPlan::new(&loaded.robot, &plan, &loaded.scenario.human, &loaded.scenario.tool)?;
    let mut notes: Vec<_> = holds.iter().map(|hold| described(loaded, hold)).collect();
    notes.push(origin);
    notes.extend(checked.first_contact(0.0).map(|contact| format!("the plan {}: {}", contact.verdict, contact.reason)));
    Ok(Some(Imported { plan, notes }))
}

/// The arms with their grasps in our frames.
fn holds<'a>(
    args: &ImportArgs,
    LoadedScenario { robot, scenario, .. }: &LoadedScenario,
    file: &'a ForeignGrasps,
    choices: &[ArmChoice],
) -> Result<Vec<Hold<'a>>, CliError> {
    let mut holds: Vec<Hold<'a>> = Vec::with_capacity(choices.len());
    for choice in choices {
        let usage = |found: &str, expected: String| {
            CliError::Usage(format!("--arm {}={}: found {found}, expected {expected}", choice.arm, choice.grasp))
        };
        let arm = robot.arm_index(&choice.arm).ok_or_else(|| {
            let names: Vec<_> = robot.arms.iter().map(|arm| arm.name.as_str()).collect();
            usage("another arm", format!("an arm of the robot: {}", names.join(", ")))
        })?;
        if holds.iter().any(|hold| hold.arm == arm) {
            return Err(usage("the arm again", "every arm once".into()));
        }
        let grasp = file.named(&choice.grasp).ok_or_else(|| {
            let names: Vec<_> = file.grasps.iter().map(|grasp| grasp.name.as_str()).collect();
            usage("another grasp", format!("a grasp of {}: {}", file.path.display(), names.join(", ")))
        })?;
        let x_og = grasp_in_board(args, file, grasp)?;
        if let Some(flaw) = fingers_across(holds.len(), &x_og) {
            let expected = format!("{}; see --gripper-frame and --object-frame", flaw.expected());
            return Err(file.error(grasp, flaw.found(), expected).into());
        }
        let grip_force_n = scenario.grip.force_n;
        if let Some(most_n) = grasp.max_force_n.filter(|most_n| *most_n < grip_force_n) {
            let expected = format!("at least {grip_force_n} N, the scenario's grip.force_n");
            return Err(file.error(grasp, format!("a largest force of {most_n} N"), expected).into());
        }
        holds.push(Hold { arm, grasp, x_og });
    }
    Ok(holds)
}

/// X_OG of a grasp.
fn grasp_in_board(args: &ImportArgs, file: &ForeignGrasps, grasp: &ForeignGrasp) -> Result<Pose, CliError> {
    let x_fg = grasp.x_fh * args.gripper_frame;
    if args.world_frame.as_ref() != Some(&grasp.frame) {
        return Ok(args.object_frame * x_fg);
    }
    match &args.board_pose {
        Some(x_wo) => Ok(x_wo.inverse() * x_fg),
        None => {
            let found = format!("a pose in the frame {}, which is the world's", grasp.frame);
            Err(file.error(grasp, found, "the board's pose, --board-pose".into()).into())
        }
    }
}

/// The board's pose as given or found, with the arms' angles; `None` if none is found.
fn placement(
    args: &ImportArgs,
    LoadedScenario { robot, scenario, .. }: &LoadedScenario,
    file: &ForeignGrasps,
    holds: &[Hold<'_>],
) -> Result<Option<Placement>, CliError> {
    let (board, clearance_m) = (scenario.object.shape(), scenario.limits.clearance_mm * 1e-3);
    let Some(x_wo) = args.board_pose else {
        let grasps: Vec<_> = holds.iter().map(|hold| (hold.arm, hold.x_og)).collect();
        let seed = scenario.planner.seed;
        let placed = place_board(robot, &board, &grasps, clearance_m, seed);
        return Ok(placed.map(|placed| Placement {
            x_wo: placed.x_wo,
            q_rad: placed.q_rad,
            origin: format!(
                "the board's pose: the first of the search domain that the arms reach without a contact, number {} with \
                 the seed {seed}; --board-pose sets another",
                placed.draw
            ),
        }));
    };
    let task =
        |hold: &Hold<'_>| ArmTask { arm: hold.arm, target: Target::Gripper { x_wg: x_wo * hold.x_og, seed_rad: None } };
    let tasks: Vec<_> = holds.iter().map(task).collect();
    let completer = Completer::new(robot, &board);
    let completion = completer.complete_with_clearance(&tasks, &x_wo, &[], clearance_m, Effort::THOROUGH);
    let Reached { q_rad, .. } = completion.reached().map_err(|(task, found)| {
        let Hold { arm, grasp, .. } = &holds[task];
        let expected = format!("a pose that the {} arm reaches within its joint limits", robot.arms[*arm].name);
        file.error(grasp, found, expected)
    })?;
    Ok(Some(Placement { x_wo, q_rad, origin: "the board's pose: --board-pose".into() }))
}

/// The plan of a scenario's task with these holds.
fn plan_of(
    LoadedScenario { robot, scenario, .. }: &LoadedScenario,
    holds: &[Hold<'_>],
    x_wo: Pose,
    q_rad: Vec<Vec<f64>>,
) -> Plan {
    let arm = |(hold, q_rad): (&Hold<'_>, Vec<f64>)| {
        let arm = &scenario.robot.arms[hold.arm];
        ArmHold {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            q_rad,
            x_og: hold.x_og,
            grip_force_n: robot.arms[hold.arm].gripper.grip_force_n(scenario.grip.force_n),
        }
    };
    Plan {
        format: FORMAT,
        name: scenario.name.clone(),
        robot: robot.description.clone(),
        operation: scenario.operation,
        object: scenario.object.placed(x_wo),
        arms: holds.iter().zip(q_rad).map(arm).collect(),
        human: None,
        comfort: None,
        muscles: None,
        stability: None,
        clearance: None,
        planner: None,
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    }
}

/// `left: grasp_0, a pose in the frame board, confidence 0.9`.
fn described(loaded: &LoadedScenario, hold: &Hold<'_>) -> String {
    let ForeignGrasp { name, frame, confidence, .. } = hold.grasp;
    let confidence = confidence.map_or(String::new(), |confidence| format!(", confidence {confidence}"));
    format!("{}: {name}, a pose in the frame {frame}{confidence}", loaded.robot.arms[hold.arm].name)
}
