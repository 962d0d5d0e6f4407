//! The description file of a robot: arms, grippers and other data that a URDF does not have, in TOML.
//!
//! This file defines the format; [`super::assemble`] checks the entries against the URDF.

use std::{collections::BTreeMap, fmt, marker::PhantomData};

use serde::{
    Deserialize, Deserializer,
    de::{Error as _, IgnoredAny, SeqAccess, Visitor},
};
use toml::Spanned;

use super::faults::{Fault, Source};
use crate::{input::meant_by, model::FORMAT};

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
    /// Folders that contain packages.
    #[serde(default)]
    pub packages: Vec<String>,
    /// Links whose collision meshes are decomposed into convex parts.
    #[serde(default)]
    pub decompose: Vec<Spanned<String>>,
    /// Pose of the root link in W.
    pub base: Option<BaseEntry>,
    /// Positions of joints that are not part of an arm or a gripper, rad or m.
    #[serde(default)]
    pub posture: BTreeMap<Spanned<String>, Spanned<f64>>,
    pub search_box: Option<SearchBoxEntry>,
    pub arms: Spanned<Vec<ArmEntry>>,
    #[serde(default)]
    pub allowed_collisions: Vec<Spanned<Exactly<String, 2>>>,
    pub body_points: Spanned<Vec<PointEntry>>,
}

/// Where the robot stands or hangs.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BaseEntry {
    pub xyz_m: Option<Spanned<Exactly<f64, 3>>>,
    /// Turns about x, then y, then z of W, as in a URDF.
    pub rpy_deg: Option<Spanned<Exactly<f64, 3>>>,
}

/// Where the planner looks for positions of the board.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SearchBoxEntry {
    pub x_m: Spanned<Exactly<f64, 2>>,
    pub y_m: Spanned<Exactly<f64, 2>>,
    pub z_m: Spanned<Exactly<f64, 2>>,
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
    #[serde(default)]
    pub kind: GripperKind,
    pub frame_link: Spanned<String>,
    /// Pose of G in the frame link, whose frame is G without it.
    pub frame_xyz_m: Option<Spanned<Exactly<f64, 3>>>,
    pub frame_rpy_deg: Option<Spanned<Exactly<f64, 3>>>,
    pub palm_link: Option<Spanned<String>>,
    /// Of two jaws.
    pub opening_m: Option<Spanned<Exactly<f64, 2>>>,
    /// Of pads: the force of each finger, N.
    pub max_force_n: Option<Spanned<f64>>,
    pub grip_force_n: Option<Spanned<f64>>,
    pub friction: Option<Spanned<f64>>,
    /// Of two jaws.
    pub pad_size_m: Option<Spanned<Exactly<f64, 2>>>,
    pub pad_centre_m: Option<Spanned<Exactly<f64, 2>>>,
    /// Of a suction cup.
    pub cup_diameter_m: Option<Spanned<f64>>,
    pub cup_height_m: Option<Spanned<f64>>,
    pub pad_stiffness_n_m: Option<Spanned<f64>>,
    /// What the gripper holds as a whole, in place of friction and force of its pads.
    pub wrench_limits: Option<Spanned<LimitsEntry>>,
    /// Stiffness along and about the axes of G through the grasp point.
    pub hold_stiffness_n_m: Option<Spanned<Exactly<f64, 3>>>,
    pub hold_stiffness_nm_rad: Option<Spanned<Exactly<f64, 3>>>,
    pub fingers: Option<Spanned<Exactly<FingerEntry, 2>>>,
}

/// What holds the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum GripperKind {
    /// Two fingers of the URDF.
    #[default]
    Fingers,
    /// Two jaws that the URDF does not have.
    Clamp,
    /// A suction cup.
    Suction,
}

/// Measured limits of the wrench on the board about the grasp point in G axes.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LimitsEntry {
    pub shape: ShapeEntry,
    pub force_n: Spanned<Exactly<LimitEntry, 3>>,
    pub moment_nm: Spanned<Exactly<LimitEntry, 3>>,
}

/// How the limits act together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ShapeEntry {
    Box,
    Ellipsoid,
}

/// The limits of one component, the lower one first: a number for both directions, or `[low, high]`.
pub(super) struct LimitEntry(pub [f64; 2]);

impl<'de> Deserialize<'de> for LimitEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LimitVisitor)
    }
}

struct LimitVisitor;

impl<'de> Visitor<'de> for LimitVisitor {
    type Value = LimitEntry;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number for both directions, or [low, high]")
    }

    fn visit_f64<E>(self, most: f64) -> Result<LimitEntry, E> {
        Ok(LimitEntry([-most, most]))
    }

    fn visit_i64<E>(self, most: i64) -> Result<LimitEntry, E> {
        Ok(LimitEntry([-most as f64, most as f64]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<LimitEntry, A::Error> {
        ExactlyVisitor(PhantomData).visit_seq(sequence).map(|Exactly(limits)| LimitEntry(limits))
    }
}

/// A finger entry.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FingerEntry {
    pub name: String,
    /// The prismatic joint that moves it; absent for a linkage.
    pub joint: Option<Spanned<String>>,
    pub pad_link: Spanned<String>,
    /// Other links of a linkage that are part of the pad.
    #[serde(default)]
    pub beside: Vec<Spanned<String>>,
}

/// An entry of a point on the robot's surface.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointEntry {
    pub link: Spanned<String>,
    pub p_m: Spanned<Exactly<f64, 3>>,
}

impl Description {
    /// Parses a description.
    ///
    /// # Errors
    /// The first fault of the format.
    pub fn read(source: &Source<'_>) -> Result<Self, Fault> {
        let description: Self = toml::from_str(source.text).map_err(|error| {
            let message = error.message().replace('\n', "; ");
            source.fault(error.span().unwrap_or_default(), format!("{message}{}", meant_by(&message)))
        })?;
        let format = *description.format.get_ref();
        if format != FORMAT {
            return Err(source.fault(description.format.span(), format!("format: found {format}, expected {FORMAT}")));
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
