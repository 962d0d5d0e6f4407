//! Checks of a task's path, and paths from CSV files.

use std::path::{Path, PathBuf};

use super::{
    InputError,
    check::Checker,
    crossings::{Crossing, first_crossing},
    load_section::{at, unreadable},
};
use crate::model::{board::BoardShape, operation::Operation, task::Task, tool_path::Stroke};

/// The header of a file with a path.
const HEADER: [&str; 3] = ["stroke", "x_m", "y_m"];

/// Distance of the points of a path that are compared with the board's outline, m.
const SPACING_M: f64 = 0.005;

/// The most strokes of a path.
const MOST_STROKES: usize = 1_000;

/// The most points of a path: files of some hundred kilobytes.
const MOST_POINTS: usize = 20_000;

/// Where a path is given: the key of the task file and, of a path from a CSV file, its rows.
pub struct Source {
    /// The key.
    pub key: &'static str,
    /// The rows; `None` of a path in the task file.
    pub csv: Option<CsvRows>,
}

/// The CSV file of a path, and for each stroke the lines of its points, from 1.
pub struct CsvRows {
    path: PathBuf,
    lines: Vec<Vec<usize>>,
}

impl Source {
    /// The key of a stroke, and of one of its points if it has several.
    fn key_of(&self, number: usize, stroke: &Stroke, point: Option<usize>) -> String {
        match (stroke, point) {
            (Stroke::Circle { .. }, _) => self.key.to_owned(),
            (Stroke::Line { .. }, Some(point)) => format!("{}[{number}][{point}]", self.key),
            _ => format!("{}[{number}]", self.key),
        }
    }

    /// An error at a stroke or a point of it; of a path from a CSV file with that file, its line and its columns,
    /// which are what has to be changed.
    fn located(&self, error: InputError, stroke: usize, point: Option<usize>) -> InputError {
        let Some(CsvRows { path, lines }) = &self.csv else { return error };
        let line = lines.get(stroke).and_then(|lines| lines.get(point.unwrap_or(0))).copied();
        let columns = if point.is_some() { "x_m, y_m" } else { "stroke" };
        InputError { file: path.clone(), line, key: Some(columns.to_owned()), kind: error.kind }
    }
}

/// Requires strokes of finite points that differ from the one before, and holes at different points.
///
/// # Errors
/// The first flaw.
pub fn check_points(check: &Checker<'_>, source: &Source, path: &[Stroke]) -> Result<(), InputError> {
    check_size(check, source, path)?;
    for (number, stroke) in path.iter().enumerate() {
        check_stroke(check, source, number, stroke)?;
    }
    check_holes(check, source, path)
}

/// Requires strokes, and no more strokes and points than the checks of crossings compare in seconds.
fn check_size(check: &Checker<'_>, source: &Source, path: &[Stroke]) -> Result<(), InputError> {
    let key = source.key;
    check.that(!path.is_empty(), key, "an empty path", "at least one hole or line")?;
    if path.len() > MOST_STROKES {
        let error = check.value(key, format!("{} strokes", path.len()), format!("at most {MOST_STROKES} strokes"));
        return Err(source.located(error, MOST_STROKES, None));
    }
    let points_of = |stroke: &Stroke| match stroke {
        Stroke::Line { points_m } => points_m.len(),
        Stroke::Hole { .. } | Stroke::Circle { .. } => 1,
    };
    let count: usize = path.iter().map(points_of).sum();
    check.that(count <= MOST_POINTS, key, format!("{count} points"), &format!("at most {MOST_POINTS} points"))
}

/// Requires finite points, and of a line at least two that differ from one another.
fn check_stroke(check: &Checker<'_>, source: &Source, number: usize, stroke: &Stroke) -> Result<(), InputError> {
    let key = |point: Option<usize>| source.key_of(number, stroke, point);
    let points_m = match stroke {
        Stroke::Circle { .. } => return Ok(()),
        Stroke::Hole { point_m } => std::slice::from_ref(point_m),
        Stroke::Line { points_m } => {
            let few = format!("{} points", points_m.len());
            let enough = check.that(points_m.len() >= 2, &key(None), few, "a line of at least two points");
            enough.map_err(|error| source.located(error, number, None))?;
            points_m
        }
    };
    for (point, point_m) in points_m.iter().enumerate() {
        let place = check.place(&key(Some(point)), point_m);
        place.map_err(|error| source.located(error, number, Some(point)))?;
    }
    let Some(before) = points_m.windows(2).position(|pair| pair[0] == pair[1]) else { return Ok(()) };
    let point = Some(before + 1);
    let error = check.value(&key(point), "the point before", "a point that differs from the one before");
    Err(source.located(error, number, point))
}

/// Requires that no two holes are at the same point.
fn check_holes(check: &Checker<'_>, source: &Source, path: &[Stroke]) -> Result<(), InputError> {
    for (number, stroke) in path.iter().enumerate() {
        let Stroke::Hole { point_m } = stroke else { continue };
        if let Some(other) = path[..number].iter().position(|other| other == stroke) {
            let found = format!("{point_m:?}, hole {} again", other + 1);
            let error = check.value(&source.key_of(number, stroke, None), found, "holes at different points");
            return Err(source.located(error, number, Some(0)));
        }
    }
    Ok(())
}

/// Requires that all of the path is on the worked face: the points that are given, and points between them.
///
/// # Errors
/// The first point beside the board.
pub fn check_on_board(check: &Checker<'_>, source: &Source, task: &Task, board: &BoardShape) -> Result<(), InputError> {
    let is_on_board = |number: usize, stroke: &Stroke, point: usize, point_m: [f64; 2]| {
        let x_ot = Operation::drill(point_m, task.force_n, board.thickness_m()).x_ot;
        let fits = check.on_board(&source.key_of(number, stroke, None), &x_ot, board);
        fits.map_err(|error| source.located(error, number, Some(point)))
    };
    for (number, stroke) in task.path.iter().enumerate() {
        let points = stroke.outline_m(SPACING_M);
        for (point, &point_m) in points.iter().enumerate() {
            is_on_board(number, stroke, point, point_m)?;
        }
        // The outline of a line is its given points alone; it may leave a plate, over a hole, between two of them.
        for (point, pair) in points.windows(2).enumerate() {
            let step_m = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
            let parts = (libm::hypot(step_m[0], step_m[1]) / SPACING_M).ceil() as usize;
            for part in 1..parts {
                let share = part as f64 / parts as f64;
                is_on_board(number, stroke, point + 1, [0, 1].map(|axis| pair[0][axis] + share * step_m[axis]))?;
            }
        }
    }
    Ok(())
}

/// Requires that lines and circles neither cross themselves nor one another. A closed line ends where it begins.
///
/// # Errors
/// Where they cross.
pub fn check_crossings(check: &Checker<'_>, source: &Source, path: &[Stroke]) -> Result<(), InputError> {
    let Some(Crossing { strokes: [first, second], part, point_m: [x_m, y_m] }) = first_crossing(path, SPACING_M) else {
        return Ok(());
    };
    let found = format!("strokes {} and {} that meet at [{x_m:.4}, {y_m:.4}]", first + 1, second + 1);
    let error = check.value(source.key, found, "strokes that do not cross, or task.may_cross = true");
    Err(source.located(error, second, Some(part + 1)))
}

/// The path of a file with this text: lines of the points with one number, or a hole for each row.
///
/// # Errors
/// If the file has other columns, no row, a cell that is not a number or, with holes, a stroke of
/// two rows; the error names the file and the line.
pub fn read_file(path: &Path, text: &str, is_cut: bool) -> Result<(Vec<Stroke>, CsvRows), InputError> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut records = reader.records();
    let first = records.next().transpose().map_err(|error| unreadable(path, &error))?;
    let found = first.map(|record| record.iter().collect::<Vec<_>>().join(", ")).unwrap_or_default();
    if found != HEADER.join(", ") {
        return Err(at(path, Some(1), None, format!("\"{found}\""), &format!("the columns {}", HEADER.join(", "))));
    }
    let mut strokes: Vec<CsvStroke> = Vec::new();
    for (count, record) in records.enumerate() {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let line = record.position().map_or(count + 2, |position| position.line() as usize);
        if count >= MOST_POINTS {
            let found = format!("more than {MOST_POINTS} points");
            return Err(at(path, Some(line), None, found, "at most as many"));
        }
        let [number, x_m, y_m] = row(path, line, &record)?;
        let last = strokes.last_mut().filter(|last| last.number == number);
        if last.is_some() && !is_cut {
            let found = format!("stroke {number} again");
            return Err(at(path, Some(line), Some(HEADER[0]), found, "a stroke of its own for each hole"));
        }
        match last {
            Some(last) => {
                last.points_m.push([x_m, y_m]);
                last.lines.push(line);
            }
            None => strokes.push(CsvStroke { number, points_m: vec![[x_m, y_m]], lines: vec![line] }),
        }
    }
    if strokes.is_empty() {
        return Err(at(path, Some(1), None, "no row below the header".to_owned(), "at least one hole or line"));
    }
    let lines = strokes.iter_mut().map(|stroke| std::mem::take(&mut stroke.lines)).collect();
    let stroke = |CsvStroke { points_m, .. }: CsvStroke| match points_m[..] {
        [point_m] if !is_cut => Stroke::Hole { point_m },
        _ => Stroke::Line { points_m },
    };
    Ok((strokes.into_iter().map(stroke).collect(), CsvRows { path: path.to_owned(), lines }))
}

/// The rows with one stroke's number that follow one another.
struct CsvStroke {
    number: f64,
    points_m: Vec<[f64; 2]>,
    lines: Vec<usize>,
}

/// The numbers of a row.
fn row(path: &Path, line: usize, record: &csv::StringRecord) -> Result<[f64; 3], InputError> {
    if record.len() != HEADER.len() {
        return Err(at(path, Some(line), None, format!("{} cells", record.len()), "3, one a column"));
    }
    let mut row = [0.0; 3];
    for ((value, cell), column) in row.iter_mut().zip(record).zip(HEADER) {
        let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
        *value = number.ok_or_else(|| at(path, Some(line), Some(column), format!("\"{cell}\""), "a finite number"))?;
    }
    Ok(row)
}
