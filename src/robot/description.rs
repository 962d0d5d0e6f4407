//! The description file of a robot: arms, grippers and other data that a URDF does not have, in TOML.
//!
//! This file defines the format; [`super::assemble`] checks the entries against the URDF.

use std::{fmt, marker::PhantomData, ops::Range};

use serde::{
    Deserialize, Deserializer,
    de::{Error as _, IgnoredAny, SeqAccess, Visitor},
};
use toml::Spanned;

use super::tree::RobotError;
use crate::model::FORMAT;

/// A text with the name of its file, for messages.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// An error at a position of this text.
    pub fn error(&self, span: Range<usize>, problem: &str) -> RobotError {
        let line = 1 + self.text.bytes().take(span.start).filter(|&byte| byte == b'\n').count();
        RobotError::Invalid { file: self.file.into(), problem: format!("line {line}: {problem}") }
    }
}

/// An array of exactly `N` values. The reader of TOML drops what exceeds the length of a Rust array.
pub(super) struct Exactly<T, const N: usize>(pub [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ExactlyVisitor(PhantomData))
    }
}

struct ExactlyVisitor<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for ExactlyVisitor<T, N> {
    type Value = Exactly<T, N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of length {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut values = Vec::with_capacity(N);
        while values.len() < N
            && let Some(value) = sequence.next_element()?
        {
            values.push(value);
        }
        let mut found = values.len();
        while sequence.next_element::<IgnoredAny>()?.is_some() {
            found += 1;
        }
        let of_length = |_| A::Error::invalid_length(found, &self);
        if found > N { Err(of_length(Vec::new())) } else { values.try_into().map(Exactly).map_err(of_length) }
    }
}

/// A description file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    pub format: Spanned<u32>,
    pub urdf: Spanned<String>,
    pub floor_z_m: Spanned<f64>,
    pub arms: Spanned<Vec<ArmEntry>>,
    #[serde(default)]
    pub allowed_collisions: Vec<Spanned<Exactly<String, 2>>>,
    pub body_points: Spanned<Vec<PointEntry>>,
}

/// An arm entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ArmEntry {
    pub name: Spanned<String>,
    pub base_link: Spanned<String>,
    pub joints: Spanned<Vec<Spanned<String>>>,
    pub effort_nm: Option<Spanned<Vec<f64>>>,
    pub stiffness_nm_rad: Spanned<Vec<f64>>,
    pub damping_nm_s_rad: Spanned<Vec<f64>>,
    pub gripper: GripperEntry,
}

/// A gripper entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GripperEntry {
    pub frame_link: Spanned<String>,
    pub palm_link: Spanned<String>,
    pub opening_m: Spanned<Exactly<f64, 2>>,
    pub max_force_n: Spanned<f64>,
    pub pad_size_m: Spanned<Exactly<f64, 2>>,
    pub pad_centre_m: Spanned<Exactly<f64, 2>>,
    pub pad_stiffness_n_m: Option<Spanned<f64>>,
    pub fingers: Spanned<Exactly<FingerEntry, 2>>,
}

/// A finger entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FingerEntry {
    pub name: String,
    pub joint: Spanned<String>,
    pub pad_link: Spanned<String>,
}

/// An entry of a point on the robot's surface.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointEntry {
    pub link: Spanned<String>,
    pub p_m: Spanned<Exactly<f64, 3>>,
}

impl Description {
    pub fn read(source: &Source) -> Result<Self, RobotError> {
        let description: Self = toml::from_str(source.text)
            .map_err(|error| source.error(error.span().unwrap_or_default(), error.message()))?;
        let format = *description.format.get_ref();
        if format != FORMAT {
            let problem = format!("format: found {format}, expected {FORMAT}");
            return Err(source.error(description.format.span(), &problem));
        }
        Ok(description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_has_exactly_the_values_of_its_key() {
        let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/baxter.toml")).unwrap();
        let read = |text: &str| Description::read(&Source { file: "baxter.toml", text });
        assert!(read(&text).is_ok());
        let line = text.lines().find(|line| line.trim_start().starts_with("opening_m")).unwrap();
        let number = 1 + text.lines().position(|other| other == line).unwrap();
        for (values, found) in [("0.0, 0.01, 0.02, 0.03", 4), ("0.01", 1)] {
            let key = line.split('[').next().unwrap();
            let error = read(&text.replacen(line, &format!("{key}[{values}]"), 1)).err().unwrap().to_string();
            let expected = format!("line {number}: invalid length {found}, expected an array of length 2");
            assert!(error.contains(&expected), "{error}");
        }
    }
}
