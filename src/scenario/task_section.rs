//! The section `[task]` of a task file, and paths from a CSV file.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    InputError,
    check::Checker,
    error::read_text,
    load_section::{at, unreadable},
};
use crate::{
    check::bounds,
    model::{
        board::BoardShape,
        operation::{Operation, OperationKind},
        scenario::Board,
        task::{MotionSettings, Task},
        tool_path::Stroke,
    },
};

/// The header of a file with a path.
const HEADER: [&str; 3] = ["stroke", "x_m", "y_m"];

/// Distance of the points of a path that are compared with the board's outline, m.
const SPACING_M: f64 = 0.005;

/// The most points of a path: files of some hundred kilobytes.
const MOST_POINTS: usize = 20_000;

/// Segments that are nearer than this touch, m.
const TOUCH_M: f64 = 1e-9;

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
    let (key, path) = path(check, section, folder)?;
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
    check_on_board(check, key, &task, &board.shape())?;
    if !section.may_cross {
        check_crossings(check, key, &task.path)?;
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

/// The path of a section, and the key that gives it.
fn path(check: &Checker<'_>, section: &TaskSection, folder: &Path) -> Result<(&'static str, Vec<Stroke>), InputError> {
    let is_cut = section.kind == OperationKind::Cut;
    let given: Vec<_> = [
        ("task.circle", section.circle.is_some()),
        ("task.lines_m", section.lines_m.is_some()),
        ("task.holes_m", section.holes_m.is_some()),
        ("task.file", section.file.is_some()),
    ]
    .into_iter()
    .filter_map(|(key, is_given)| is_given.then_some(key))
    .collect();
    let one = "one of circle, lines_m, holes_m and file";
    let [key] = given[..] else {
        let key = given.get(1).copied().unwrap_or("task");
        return Err(check.value(key, format!("{} paths", given.len()), one));
    };
    check.absent("task.circle", !is_cut && section.circle.is_some(), "kind = \"cut\"")?;
    check.absent("task.lines_m", !is_cut && section.lines_m.is_some(), "kind = \"cut\"")?;
    check.absent("task.holes_m", is_cut && section.holes_m.is_some(), "kind = \"drill\"")?;
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
        read_path(&folder.join(file), is_cut)?
    };
    check.that(!path.is_empty(), key, "an empty path", "at least one hole or line")?;
    for (number, stroke) in path.iter().enumerate() {
        check_points(check, &format!("{key}[{number}]"), stroke)?;
    }
    check_holes(check, key, &path)?;
    Ok((key, path))
}

/// Requires finite points, and of a line at least two that differ from one another.
fn check_points(check: &Checker<'_>, key: &str, stroke: &Stroke) -> Result<(), InputError> {
    match stroke {
        Stroke::Circle { .. } => Ok(()),
        Stroke::Hole { point_m } => check.place(key, point_m),
        Stroke::Line { points_m } => {
            let few = format!("{} points", points_m.len());
            check.that(points_m.len() >= 2, key, few, "a line of at least two points")?;
            for (number, point_m) in points_m.iter().enumerate() {
                check.place(&format!("{key}[{number}]"), point_m)?;
            }
            let twice = points_m.windows(2).position(|pair| pair[0] == pair[1]);
            let at_number = twice.map_or(0, |number| number + 1);
            let expected = "a point that differs from the one before";
            check.that(twice.is_none(), &format!("{key}[{at_number}]"), "the point before", expected)
        }
    }
}

/// Requires that no two holes are at the same point.
fn check_holes(check: &Checker<'_>, key: &str, path: &[Stroke]) -> Result<(), InputError> {
    for (number, stroke) in path.iter().enumerate() {
        let Stroke::Hole { point_m } = stroke else { continue };
        if let Some(other) = path[..number].iter().position(|other| other == stroke) {
            let found = format!("{point_m:?}, hole {} again", other + 1);
            return Err(check.value(&format!("{key}[{number}]"), found, "holes at different points"));
        }
    }
    Ok(())
}

/// Requires that all of the path is on the worked face.
fn check_on_board(check: &Checker<'_>, key: &str, task: &Task, board: &BoardShape) -> Result<(), InputError> {
    for (number, stroke) in task.path.iter().enumerate() {
        let key = if matches!(stroke, Stroke::Circle { .. }) { key.to_owned() } else { format!("{key}[{number}]") };
        let length_m = stroke.length_m();
        let steps = (length_m / SPACING_M).ceil() as usize;
        for step in 0..=steps {
            let along_m = if steps == 0 { 0.0 } else { length_m * step as f64 / steps as f64 };
            let point_m = stroke.at(along_m).point_m;
            let operation = Operation::drill(point_m, task.force_n, board.thickness_m());
            check.on_board(&key, &operation.x_ot, board)?;
        }
    }
    Ok(())
}

/// A straight part of a path: its stroke, its number in the stroke, and its ends.
type Segment = (usize, usize, [[f64; 2]; 2]);

/// Requires that lines and circles neither cross themselves nor one another. A closed line ends where it begins.
fn check_crossings(check: &Checker<'_>, key: &str, path: &[Stroke]) -> Result<(), InputError> {
    let of_stroke = |(number, stroke): (usize, &Stroke)| {
        let points = stroke.outline_m(SPACING_M);
        let segments = points.windows(2).enumerate().map(|(part, pair)| (number, part, [pair[0], pair[1]]));
        segments.collect::<Vec<Segment>>()
    };
    let segments: Vec<Segment> = path.iter().enumerate().flat_map(of_stroke).collect();
    let last_of = |stroke: usize| segments.iter().filter(|segment| segment.0 == stroke).count().saturating_sub(1);
    for (number, a) in segments.iter().enumerate() {
        for b in &segments[number + 1..] {
            let is_closing = a.0 == b.0 && a.1 == 0 && b.1 == last_of(b.0) && a.2[0] == b.2[1];
            let is_next = a.0 == b.0 && b.1 == a.1 + 1;
            if is_next || is_closing {
                continue;
            }
            if let Some([x_m, y_m]) = crossing(&a.2, &b.2) {
                let found = format!("strokes {} and {} that meet at [{x_m:.4}, {y_m:.4}]", a.0 + 1, b.0 + 1);
                return Err(check.value(key, found, "strokes that do not cross, or task.may_cross = true"));
            }
        }
    }
    Ok(())
}

/// A point where two segments meet.
fn crossing([a, b]: &[[f64; 2]; 2], [c, d]: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
    let apart = |one: f64, other: f64, far: f64, end: f64| one.max(other) < far.min(end) - TOUCH_M;
    if (0..2).any(|axis| apart(a[axis], b[axis], c[axis], d[axis]) || apart(c[axis], d[axis], a[axis], b[axis])) {
        return None;
    }
    let minus = |p: &[f64; 2], q: &[f64; 2]| [p[0] - q[0], p[1] - q[1]];
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let (ab, cd, ac) = (minus(b, a), minus(d, c), minus(c, a));
    let determinant = cross(ab, cd);
    let scale = libm::hypot(ab[0], ab[1]) * libm::hypot(cd[0], cd[1]);
    if determinant.abs() <= 1e-12 * scale {
        // Parallel: they meet if they are on one line, since their boxes do.
        return (cross(ab, ac).abs() <= TOUCH_M * libm::hypot(ab[0], ab[1])).then_some(*c);
    }
    let [s, t] = [cross(ac, cd) / determinant, cross(ac, ab) / determinant];
    let within = |share: f64| (-1e-9..=1.0 + 1e-9).contains(&share);
    (within(s) && within(t)).then(|| [a[0] + s * ab[0], a[1] + s * ab[1]])
}

/// Reads a file with a path: lines of the points with one number, or a hole for each row.
///
/// # Errors
/// If the file cannot be read or has other columns or a cell that is not a number; the error names the file and the line.
fn read_path(path: &Path, is_cut: bool) -> Result<Vec<Stroke>, InputError> {
    let text = read_text(path)?;
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut records = reader.records();
    let first = records.next().transpose().map_err(|error| unreadable(path, &error))?;
    let found = first.map(|record| record.iter().collect::<Vec<_>>().join(", ")).unwrap_or_default();
    if found != HEADER.join(", ") {
        return Err(at(path, Some(1), None, format!("\"{found}\""), &format!("the columns {}", HEADER.join(", "))));
    }
    let mut lines: Vec<(f64, Vec<[f64; 2]>)> = Vec::new();
    for (number, record) in records.enumerate() {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let line = record.position().map(|position| position.line() as usize);
        if record.len() != HEADER.len() {
            return Err(at(path, line, None, format!("{} cells", record.len()), "3, one a column"));
        }
        if number >= MOST_POINTS {
            return Err(at(path, line, None, format!("more than {MOST_POINTS} points"), "at most as many"));
        }
        let mut row = [0.0; 3];
        for ((value, cell), column) in row.iter_mut().zip(&record).zip(HEADER) {
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            *value = number.ok_or_else(|| at(path, line, Some(column), format!("\"{cell}\""), "a finite number"))?;
        }
        let [stroke, x_m, y_m] = row;
        match lines.last_mut().filter(|(last, _)| is_cut && *last == stroke) {
            Some((_, points_m)) => points_m.push([x_m, y_m]),
            None => lines.push((stroke, vec![[x_m, y_m]])),
        }
    }
    let stroke = |(_, points_m): (f64, Vec<[f64; 2]>)| match points_m[..] {
        [point_m] if !is_cut => Stroke::Hole { point_m },
        _ => Stroke::Line { points_m },
    };
    Ok(lines.into_iter().map(stroke).collect())
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64;

    use super::*;

    fn meets(path: &[Stroke]) -> bool {
        let check = Checker::toml(Path::new("task.toml"), "");
        check_crossings(&check, "task.lines_m", path).is_err()
    }

    fn line(points_m: &[[f64; 2]]) -> Stroke {
        Stroke::Line { points_m: points_m.to_vec() }
    }

    #[test]
    fn a_figure_of_eight_crosses_itself_and_a_closed_square_does_not() {
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]])]));
        assert!(!meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, 0.0]])]));
        // A line that goes back on itself.
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.05, 0.05], [0.05, 0.0], [0.02, 0.0]])]));
        let circle = Stroke::Circle { centre_m: [0.0; 2], radius_m: 0.1, start_deg: 20.0 };
        assert!(!meets(std::slice::from_ref(&circle)));
        assert!(meets(&[circle.clone(), line(&[[0.0, 0.0], [0.2, 0.0]])]));
        assert!(!meets(&[circle, line(&[[0.0, 0.0], [0.05, 0.0]])]));
    }

    /// Points in the order of their angles about a point between them make a star-shaped line, which never meets itself.
    #[test]
    fn drawn_star_shaped_lines_never_cross() {
        let mut random = Pcg64::new(3, 0);
        for case in 0..300 {
            let mut angles: Vec<f64> = (0..8).map(|_| random.random::<f64>() * 6.0).collect();
            angles.sort_by(f64::total_cmp);
            let mut points_m = vec![[0.0, 0.0]];
            for angle in angles {
                let [x, y] = points_m[points_m.len() - 1];
                let length_m = 0.01 + 0.1 * random.random::<f64>();
                points_m.push([x + length_m * angle.cos(), y + length_m * angle.sin()]);
            }
            let star = in_order_of_angle(&points_m);
            assert!(!meets(&[line(&star)]), "{case}: {star:?}");
        }
    }

    /// The points in the order of their angles about their mean, closed.
    fn in_order_of_angle(points_m: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mean = [0, 1].map(|axis| points_m.iter().map(|point| point[axis]).sum::<f64>() / points_m.len() as f64);
        let mut ordered = points_m.to_vec();
        let angle = |point: &[f64; 2]| (point[1] - mean[1]).atan2(point[0] - mean[0]);
        ordered.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        ordered.push(ordered[0]);
        ordered
    }
}
