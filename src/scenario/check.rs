//! Checks of values in scenario and plan files. An error names the key and its line.

use std::path::Path;

use super::{InputError, InputErrorKind, locate};
use crate::{
    check::{BOARD_SIDE_M, ON_BOARD_M, ON_MATERIAL, bounds, off_material},
    input,
    model::{
        FORMAT,
        board::BoardShape,
        file_name::{MOST_BYTES, REPORTS},
        frames::Pose,
    },
    robot::{Arm, RobotError},
};

/// Reads `format` before the other keys: a file of another format may have other keys.
#[derive(serde::Deserialize)]
pub struct FormatProbe {
    /// The file's format.
    pub format: u32,
}

/// Checks the values of one file.
pub struct Checker<'a> {
    path: &'a Path,
    text: &'a str,
    line_of: fn(&str, &str) -> Option<usize>,
    /// Prefix of every key.
    prefix: &'static str,
}

impl<'a> Checker<'a> {
    /// A checker for a TOML file.
    pub fn toml(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, line_of: locate::toml_line, prefix: "" }
    }

    /// A checker for a JSON file.
    pub fn json(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, line_of: locate::json_line, prefix: "" }
    }

    /// A checker for the values below a key; `prefix` ends in a dot.
    pub fn under(&self, prefix: &'static str) -> Self {
        Self { prefix, ..*self }
    }

    /// True for the values below a key.
    pub fn is_nested(&self) -> bool {
        !self.prefix.is_empty()
    }

    fn error(&self, key: &str, kind: InputErrorKind) -> InputError {
        let key = format!("{}{key}", self.prefix);
        InputError { file: self.path.to_owned(), line: (self.line_of)(self.text, &key), key: Some(key), kind }
    }

    /// An error "found ..., expected ...".
    pub fn value(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> InputError {
        self.error(key, InputErrorKind::Value { found: found.into(), expected: expected.into() })
    }

    /// An error with a complete message.
    pub fn syntax(&self, key: &str, problem: String) -> InputError {
        self.error(key, InputErrorKind::Syntax(problem))
    }

    /// An error of a robot that cannot be loaded.
    pub fn robot(&self, key: &str, error: RobotError) -> InputError {
        self.error(key, InputErrorKind::Robot(error))
    }

    /// The text of a file that a key names, of at most this many bytes.
    pub fn named_file(&self, key: &str, path: &Path, most_bytes: u64) -> Result<String, InputError> {
        input::text(path, most_bytes)
            .map_err(|source| self.error(key, InputErrorKind::Named { path: path.to_owned(), source }))
    }

    /// The bytes of a file that a key names, at most this many.
    pub fn named_bytes(&self, key: &str, path: &Path, most_bytes: u64) -> Result<Vec<u8>, InputError> {
        input::bytes(path, most_bytes)
            .map_err(|source| self.error(key, InputErrorKind::Named { path: path.to_owned(), source }))
    }

    /// An error of a part that is checked by itself, at the part's key.
    pub fn moved(&self, error: InputError, part: &str) -> InputError {
        let key = error.key.map_or_else(|| part.to_owned(), |key| format!("{part}.{key}"));
        self.error(&key, error.kind)
    }

    /// Requires `ok`.
    pub fn that(&self, ok: bool, key: &str, found: impl Into<String>, expected: &str) -> Result<(), InputError> {
        if ok { Ok(()) } else { Err(self.value(key, found, expected)) }
    }

    /// Requires a name that is valid in file names.
    pub fn name(&self, name: &str) -> Result<(), InputError> {
        let fits = !name.is_empty()
            && !name.starts_with('.')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
        let expected = "letters, digits, `-`, `_` and `.`, since files are named after it";
        self.that(fits, "name", format!("\"{name}\""), expected)?;
        let expected = format!("at most {MOST_BYTES}, since files are named after it");
        self.that(name.len() <= MOST_BYTES, "name", format!("a name of {} characters", name.len()), &expected)?;
        let is_report = REPORTS.iter().any(|report| report.eq_ignore_ascii_case(name));
        let expected = format!("a name other than {}, which a run writes beside its folder", REPORTS.join(", "));
        self.that(!is_report, "name", format!("\"{name}\""), &expected)
    }

    /// Requires the supported format.
    pub fn format(&self, found: u32) -> Result<(), InputError> {
        let expected = format!("{FORMAT}, the only format that benchdog {} reads", env!("CARGO_PKG_VERSION"));
        self.that(found == FORMAT, "format", found.to_string(), &expected)
    }

    /// Requires a number in `low..=high`.
    pub fn within(&self, key: &str, found: f64, low: f64, high: f64, unit: &str) -> Result<(), InputError> {
        let expected = format!("a number from {low} to {high} ({unit})");
        self.that((low..=high).contains(&found), key, number(found), &expected)
    }

    /// Requires a number greater than zero and at most `most`.
    pub fn positive(&self, key: &str, found: f64, most: f64, unit: &str) -> Result<(), InputError> {
        self.that(found <= most || found.is_nan(), key, number(found), &format!("at most {most} ({unit})"))?;
        self.that(found > 0.0, key, number(found), &format!("a positive number ({unit})"))
    }

    /// Requires a number that is not negative and at most `most`.
    pub fn not_negative(&self, key: &str, found: f64, most: f64, unit: &str) -> Result<(), InputError> {
        self.that(found <= most || found.is_nan(), key, number(found), &format!("at most {most} ({unit})"))?;
        self.that(found >= 0.0, key, number(found), &format!("zero or a positive number ({unit})"))
    }

    /// Requires forces and moments within their bounds.
    pub fn wrench(&self, key: &str, found: &[f64; 6]) -> Result<(), InputError> {
        let is_within = bounds::wrench_is_within(found);
        self.that(is_within, key, format!("{found:?}"), &bounds::wrench_in_words())
    }

    /// Requires coordinates within the bounds of places.
    pub fn place(&self, key: &str, found: &[f64]) -> Result<(), InputError> {
        let most_m = bounds::MOST_PLACE_M;
        let is_within = found.iter().all(|coordinate| coordinate.abs() <= most_m);
        self.that(is_within, key, format!("{found:?}"), &format!("numbers from -{most_m} to {most_m} (m)"))
    }

    /// Requires finite numbers.
    pub fn finite(&self, key: &str, found: &[f64]) -> Result<(), InputError> {
        let ok = found.iter().all(|value| value.is_finite());
        self.that(ok, key, format!("{found:?}"), "finite numbers")
    }

    /// Requires a key.
    pub fn present<T>(&self, key: &str, found: Option<T>, expected: &str) -> Result<T, InputError> {
        found.ok_or_else(|| self.value(key, "nothing", expected))
    }

    /// Rejects a key that is not allowed here.
    pub fn absent(&self, key: &str, found: bool, belongs_to: &str) -> Result<(), InputError> {
        self.that(!found, key, "a value", &format!("none: it belongs to {belongs_to}"))
    }

    /// Requires a board whose thickness is within the opening of all grippers.
    pub fn board_size<'r>(
        &self,
        key: &str,
        size_m: [f64; 3],
        arms: impl Iterator<Item = &'r Arm>,
    ) -> Result<(), InputError> {
        for (index, &side) in size_m.iter().enumerate() {
            self.within(&format!("{key}[{index}]"), side, BOARD_SIDE_M[0], BOARD_SIDE_M[1], "m")?;
        }
        self.thickness(&format!("{key}[2]"), size_m[2], arms)
    }

    /// Requires a thickness within the opening of all grippers.
    pub fn thickness<'r>(
        &self,
        key: &str,
        thickness_m: f64,
        mut arms: impl Iterator<Item = &'r Arm>,
    ) -> Result<(), InputError> {
        arms.try_for_each(|arm| {
            let [closed, open] = arm.gripper.opening_m;
            let expected = format!("a thickness that the {} gripper closes on: {closed} to {open} m", arm.name);
            self.that((closed..=open).contains(&thickness_m), key, thickness_m.to_string(), &expected)
        })
    }

    /// Requires a grip force that all grippers can exert.
    pub fn grip_force<'r>(
        &self,
        key: &str,
        force_n: f64,
        arms: impl Iterator<Item = &'r Arm>,
    ) -> Result<(), InputError> {
        self.positive(key, force_n, bounds::MOST_FORCE_N, "N")?;
        for arm in arms {
            let Some(most_n) = arm.gripper.holding.pads().map(|pads| pads.max_force_n) else { continue };
            let expected = format!("at most {most_n} N, what the {} gripper gives", arm.name);
            self.that(force_n <= most_n, key, force_n.to_string(), &expected)?;
        }
        Ok(())
    }

    /// Requires a tool point inside or on the board, and not in one of its holes.
    pub fn on_board(&self, key: &str, x_ot: &Pose, board: &BoardShape) -> Result<(), InputError> {
        let p_ot = x_ot.translation.vector;
        let [x, y, z] = board.size_m.map(|side| side / 2.0);
        let half_m = nalgebra::Vector3::new(x, y, z);
        let inside = (p_ot.abs() - half_m).max() <= ON_BOARD_M;
        if p_ot.z.abs() > z + ON_BOARD_M {
            return Err(self.value(key, format!("z = {}", p_ot.z), format!("a point on the board: |z| <= {z} m")));
        }
        if let Some(plate) = &board.plate {
            let depth_m = plate.depth_m([p_ot.x, p_ot.y]);
            let found = off_material(p_ot.x, p_ot.y, depth_m);
            return self.that(depth_m >= -ON_BOARD_M, key, found, ON_MATERIAL);
        }
        let expected = format!("a point on the board: |x| <= {x} m, |y| <= {y} m");
        self.that(inside, key, format!("[{}, {}]", p_ot.x, p_ot.y), &expected)
    }
}

/// A number in a message: without the zeros of a huge one.
fn number(found: f64) -> String {
    if found.is_finite() && found.abs() >= 1e9 { format!("{found:e}") } else { found.to_string() }
}
