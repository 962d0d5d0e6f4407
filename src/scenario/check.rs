//! The checks that scenario and plan files share; each names the key and finds its line when it fails.

use std::path::Path;

use super::{InputError, InputErrorKind, locate};
use crate::{
    model::{FORMAT, frames::Pose},
    robot::{Arm, RobotError},
};

/// How far from the face's rectangle an operation point may be, m: rounding of written figures.
const ON_BOARD_TOLERANCE_M: f64 = 1e-9;

/// The one key that is read before the rest: a file of another format has other keys.
#[derive(serde::Deserialize)]
pub struct FormatProbe {
    /// The number that the file gives.
    pub format: u32,
}

/// Checks values of one file.
pub struct Checker<'a> {
    path: &'a Path,
    text: &'a str,
    line_of: fn(&str, &str) -> Option<usize>,
}

impl<'a> Checker<'a> {
    /// Checks of a TOML file.
    pub fn toml(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, line_of: locate::toml_line }
    }

    /// Checks of a JSON file.
    pub fn json(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, line_of: locate::json_line }
    }

    fn error(&self, key: &str, kind: InputErrorKind) -> InputError {
        InputError { file: self.path.to_owned(), line: (self.line_of)(self.text, key), key: Some(key.to_owned()), kind }
    }

    /// An error that says what was found and what was expected.
    pub fn value(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> InputError {
        self.error(key, InputErrorKind::Value { found: found.into(), expected: expected.into() })
    }

    /// An error whose message already says both.
    pub fn syntax(&self, key: &str, problem: String) -> InputError {
        self.error(key, InputErrorKind::Syntax(problem))
    }

    /// A robot that cannot be loaded.
    pub fn robot(&self, key: &str, error: RobotError) -> InputError {
        self.error(key, InputErrorKind::Robot(error))
    }

    /// `ok`, or an error about this key.
    pub fn that(&self, ok: bool, key: &str, found: impl Into<String>, expected: &str) -> Result<(), InputError> {
        if ok { Ok(()) } else { Err(self.value(key, found, expected)) }
    }

    /// The format number that this build reads.
    pub fn format(&self, found: u32) -> Result<(), InputError> {
        let expected = format!("{FORMAT}, the only format that benchdog {} reads", env!("CARGO_PKG_VERSION"));
        self.that(found == FORMAT, "format", found.to_string(), &expected)
    }

    /// A number between two others, both included.
    pub fn within(&self, key: &str, found: f64, low: f64, high: f64, unit: &str) -> Result<(), InputError> {
        let expected = format!("a number from {low} to {high} ({unit})");
        self.that((low..=high).contains(&found), key, found.to_string(), &expected)
    }

    /// A finite number above zero.
    pub fn positive(&self, key: &str, found: f64, unit: &str) -> Result<(), InputError> {
        let expected = format!("a positive number ({unit})");
        self.that(found.is_finite() && found > 0.0, key, found.to_string(), &expected)
    }

    /// A finite number of at least zero.
    pub fn not_negative(&self, key: &str, found: f64, unit: &str) -> Result<(), InputError> {
        let expected = format!("zero or a positive number ({unit})");
        self.that(found.is_finite() && found >= 0.0, key, found.to_string(), &expected)
    }

    /// Finite numbers.
    pub fn finite(&self, key: &str, found: &[f64]) -> Result<(), InputError> {
        let ok = found.iter().all(|value| value.is_finite());
        self.that(ok, key, format!("{found:?}"), "finite numbers")
    }

    /// A key that must be given.
    pub fn present<T>(&self, key: &str, found: Option<T>, expected: &str) -> Result<T, InputError> {
        found.ok_or_else(|| self.value(key, "nothing", expected))
    }

    /// A key that has no meaning here.
    pub fn absent(&self, key: &str, found: bool, belongs_to: &str) -> Result<(), InputError> {
        self.that(!found, key, "a value", &format!("none: it belongs to {belongs_to}"))
    }

    /// A board that every one of these grippers can close on.
    pub fn board_size<'r>(
        &self,
        key: &str,
        size_m: [f64; 3],
        arms: impl Iterator<Item = &'r Arm>,
    ) -> Result<(), InputError> {
        for (index, &side) in size_m.iter().enumerate() {
            self.within(&format!("{key}[{index}]"), side, 0.001, 5.0, "m")?;
        }
        let thickness_key = format!("{key}[2]");
        for arm in arms {
            let [closed, open] = arm.gripper.opening_m;
            let expected = format!("a thickness that the {} gripper closes on: {closed} to {open} m", arm.name);
            let fits = (closed..=open).contains(&size_m[2]);
            self.that(fits, &thickness_key, size_m[2].to_string(), &expected)?;
        }
        Ok(())
    }

    /// A grip force that every one of these grippers can give.
    pub fn grip_force<'r>(
        &self,
        key: &str,
        force_n: f64,
        arms: impl Iterator<Item = &'r Arm>,
    ) -> Result<(), InputError> {
        self.positive(key, force_n, "N")?;
        for arm in arms {
            let most_n = arm.gripper.max_force_n;
            let expected = format!("at most {most_n} N, what the {} gripper gives", arm.name);
            self.that(force_n <= most_n, key, force_n.to_string(), &expected)?;
        }
        Ok(())
    }

    /// A tool point on the board: within the outline of the face and the thickness.
    pub fn on_board(&self, key: &str, x_ot: &Pose, size_m: [f64; 3]) -> Result<(), InputError> {
        let p_ot = x_ot.translation.vector;
        let [x, y, z] = size_m.map(|side| side / 2.0);
        let half_m = nalgebra::Vector3::new(x, y, z);
        let inside = (p_ot.abs() - half_m).max() <= ON_BOARD_TOLERANCE_M;
        if p_ot.z.abs() > z + ON_BOARD_TOLERANCE_M {
            return Err(self.value(key, format!("z = {}", p_ot.z), format!("a point on the board: |z| <= {z} m")));
        }
        let expected = format!("a point on the board: |x| <= {x} m, |y| <= {y} m");
        self.that(inside, key, format!("[{}, {}]", p_ot.x, p_ot.y), &expected)
    }
}
