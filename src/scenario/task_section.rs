//! The section `[task]` of a task file.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    InputError,
    check::Checker,
    task_path::{Source, check_crossings, check_on_board, check_points, read_file},
};
use crate::{
    check::bounds,
    input::MOST_CSV,
    model::{
        operation::OperationKind,
        scenario::Board,
        task::{MotionSettings, Task},
        tool_path::Stroke,
    },
};

/// `[task]`, in place of `[operation]`: a path that is cut or drilled while the robot holds, moves and regrasps the board. Exactly
/// one of `circle`, `lines_m`, `holes_m` and `file` is the path.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskSection {
    /// `cut` or `drill`.
    pub kind: OperationKind,
    /// The tool's force, N: along the path, or into the board.
    pub force_n: f64,
    /// For `cut`: speed of the knife, m/s; 0.03 by default.
    pub speed_m_s: Option<f64>,
    /// For `cut`: a whole circle.
    pub circle: Option<CircleSection>,
    /// For `cut`: lines of at least two points on the worked face, m along x_O and y_O from its centre; the knife is lifted
    /// between them.
    pub lines_m: Option<Vec<Vec<[f64; 2]>>>,
    /// For `drill`: holes in their order.
    pub holes_m: Option<Vec<[f64; 2]>>,
    /// A CSV file with the columns `stroke`, `x_m` and `y_m`, relative to the folder of the task file: points of lines, or holes.
    pub file: Option<String>,
    /// True if lines and circles may cross themselves and one another.
    #[serde(default)]
    pub may_cross: bool,
    /// Longest piece of the path for which posture and stability are computed once, m; 0.05 by default.
    pub piece_m: Option<f64>,
    /// The least objective at a piece, as a share of that of the best hold for this piece alone; 0.5 by default.
    pub least_comfort: Option<f64>,
    /// What a change of one hand's grasp costs: as much as this many pieces that lose all of their comfort; 1 by default.
    pub regrasp_cost: Option<f64>,
    /// The same for a motion of the board; 0.1 by default.
    pub move_cost: Option<f64>,
    /// Limits of the arms' motions.
    #[serde(default)]
    pub motion: MotionSettings,
}

/// `circle` of `[task]`: a whole circle, counter-clockwise seen from the worker's side.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleSection {
    /// Its centre on the worked face, m; the board's centre by default.
    #[serde(default)]
    pub centre_m: [f64; 2],
    /// Its radius, m.
    pub radius_m: f64,
    /// Direction from the centre to where the cut begins, degrees from x_O towards y_O; 0 by default.
    #[serde(default)]
    pub start_deg: f64,
}

/// The task of a section on a board.
///
/// # Errors
/// If a value is out of range or does not belong to the kind, or the path is not one: off the board, crossing itself, without
/// points.
pub fn task(check: &Checker<'_>, section: &TaskSection, board: &Board, folder: &Path) -> Result<Task, InputError> {
    let kind = section.kind;
    let known = matches!(kind, OperationKind::Cut | OperationKind::Drill);
    check.that(known, "task.kind", format!("\"{kind}\""), "\"cut\" or \"drill\"")?;
    check.positive("task.force_n", section.force_n, bounds::MOST_FORCE_N, "N")?;
    if kind == OperationKind::Drill {
        check.absent("task.speed_m_s", section.speed_m_s.is_some(), "kind = \"cut\"")?;
    }
    let (source, path) = read_path(check, section, folder)?;
    let task = Task {
        kind,
        force_n: section.force_n,
        path,
        speed_m_s: section.speed_m_s.unwrap_or(Task::SPEED_M_S),
        piece_m: section.piece_m.unwrap_or(Task::PIECE_M),
        least_comfort: section.least_comfort.unwrap_or(Task::LEAST_COMFORT),
        regrasp_cost: section.regrasp_cost.unwrap_or(Task::REGRASP_COST),
        move_cost: section.move_cost.unwrap_or(Task::MOVE_COST),
        motion: section.motion,
    };
    check_values(check, &task)?;
    check_on_board(check, &source, &task, &board.shape())?;
    if !section.may_cross {
        check_crossings(check, &source, &task.path)?;
    }
    Ok(task)
}

/// Checks the figures of a task.
fn check_values(check: &Checker<'_>, task: &Task) -> Result<(), InputError> {
    check.within("task.speed_m_s", task.speed_m_s, 1e-4, 1.0, "m/s")?;
    check.within("task.piece_m", task.piece_m, 0.005, 0.5, "m")?;
    check.within("task.least_comfort", task.least_comfort, 0.0, 1.0, "a share of the best comfort")?;
    check.within("task.regrasp_cost", task.regrasp_cost, 0.0, 100.0, "pieces of the path")?;
    check.within("task.move_cost", task.move_cost, 0.0, 100.0, "pieces of the path")?;
    check.within("task.motion.speed_share", task.motion.speed_share, 0.001, 1.0, "a share of the robot's speed")?;
    check.within("task.motion.acceleration_rad_s2", task.motion.acceleration_rad_s2, 0.01, 100.0, "rad/s^2")
}

/// The path of a section, and where it is given.
fn read_path(check: &Checker<'_>, section: &TaskSection, folder: &Path) -> Result<(Source, Vec<Stroke>), InputError> {
    let mut source = Source { key: key_of_path(check, section)?, csv: None };
    let path = if let Some(CircleSection { centre_m, radius_m, start_deg }) = section.circle {
        check.place("task.circle.centre_m", &centre_m)?;
        check.within("task.circle.radius_m", radius_m, 0.005, 10.0, "m")?;
        check.within("task.circle.start_deg", start_deg, -360.0, 360.0, "degrees")?;
        vec![Stroke::Circle { centre_m, radius_m, start_deg }]
    } else if let Some(lines) = &section.lines_m {
        lines.iter().map(|points_m| Stroke::Line { points_m: points_m.clone() }).collect()
    } else if let Some(holes) = &section.holes_m {
        holes.iter().map(|&point_m| Stroke::Hole { point_m }).collect()
    } else {
        let file = check.present("task.file", section.file.as_ref(), "the path of a CSV file")?;
        let csv = folder.join(file);
        let text = check.named_file("task.file", &csv, MOST_CSV)?;
        let (path, rows) = read_file(&csv, &text, section.kind == OperationKind::Cut)?;
        source.csv = Some(rows);
        path
    };
    check_points(check, &source, &path)?;
    Ok((source, path))
}

/// The key that gives the path: exactly one, and one that belongs to the kind.
fn key_of_path(check: &Checker<'_>, section: &TaskSection) -> Result<&'static str, InputError> {
    let given: Vec<_> = [
        ("task.circle", section.circle.is_some()),
        ("task.lines_m", section.lines_m.is_some()),
        ("task.holes_m", section.holes_m.is_some()),
        ("task.file", section.file.is_some()),
    ]
    .into_iter()
    .filter_map(|(key, is_given)| is_given.then_some(key))
    .collect();
    let [key] = given[..] else {
        let key = given.get(1).copied().unwrap_or("task");
        return Err(check.value(key, format!("{} paths", given.len()), "one of circle, lines_m, holes_m and file"));
    };
    let is_cut = section.kind == OperationKind::Cut;
    check.absent("task.circle", !is_cut && section.circle.is_some(), "kind = \"cut\"")?;
    check.absent("task.lines_m", !is_cut && section.lines_m.is_some(), "kind = \"cut\"")?;
    check.absent("task.holes_m", is_cut && section.holes_m.is_some(), "kind = \"drill\"")?;
    Ok(key)
}
