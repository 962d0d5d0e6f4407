//! Poses and their form in files.
//!
//! Monogram notation: `x_wo` is the pose of frame O in frame W, `p_aq` the position of point Q in frame A.
//!
//! | frame | origin and axes |
//! |---|---|
//! | W | world: the robot's base, x forward, y left, z up |
//! | O | board: its centre, z out of the worked face |
//! | T | tool: its tip, z into the material |
//! | G | gripper: the frame in the robot's URDF, z forward along the fingers, which open along y |
//! | P | pad: its centre, z into the board |
//! | B | person: on the floor between the feet |
//! | S | shoulder centre, axes of B |
//! | H | hand: the wrist centre |
//!
//! See `docs/method.md#11-frames`.

use std::borrow::Cow;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize, de::Error as _};

/// A rigid transform; `x_ab * p_b = p_a`.
pub type Pose = Isometry3<f64>;

/// Largest deviation of a quaternion's length from 1 in a file. Six written digits stay within it.
const UNIT_TOLERANCE: f64 = 1e-5;

/// A quaternion whose length deviates less than this is kept bit by bit: a plan read from a file then gives the same
/// simulation as the plan that was written.
const NORMALISED: f64 = 1e-12;

/// A [`Pose`] in a file: `{"translation_m": [x, y, z], "rotation_xyzw": [x, y, z, w]}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseRecord {
    /// Position of the frame's origin, m.
    pub translation_m: [f64; 3],
    /// Unit quaternion, scalar last.
    pub rotation_xyzw: [f64; 4],
}

impl From<&Pose> for PoseRecord {
    fn from(pose: &Pose) -> Self {
        Self { translation_m: pose.translation.vector.into(), rotation_xyzw: pose.rotation.quaternion().coords.into() }
    }
}

/// The rotation of a quaternion, scalar last.
///
/// # Errors
/// If the quaternion is not finite or its length differs from 1 by more than 1e-5.
pub fn rotation_from_xyzw(xyzw: [f64; 4]) -> Result<UnitQuaternion<f64>, String> {
    let [x, y, z, w] = xyzw;
    let quaternion = Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    let deviation = (length - 1.0).abs();
    if deviation.is_nan() || deviation > UNIT_TOLERANCE {
        return Err(format!("found a quaternion of length {length}, expected unit length"));
    }
    Ok(if deviation <= NORMALISED {
        UnitQuaternion::new_unchecked(quaternion)
    } else {
        UnitQuaternion::new_normalize(quaternion)
    })
}

impl TryFrom<PoseRecord> for Pose {
    type Error = String;

    fn try_from(record: PoseRecord) -> Result<Self, String> {
        if !record.translation_m.iter().all(|v| v.is_finite()) {
            return Err("found a translation that is not finite, expected metres".into());
        }
        Ok(Isometry3::from_parts(Translation3::from(record.translation_m), rotation_from_xyzw(record.rotation_xyzw)?))
    }
}

/// For `#[serde(with = "frames::pose")]`: serialises a [`Pose`] as a [`PoseRecord`].
pub mod pose {
    use serde::{Deserializer, Serializer};

    use super::*;

    /// Writes a pose as a [`PoseRecord`].
    pub fn serialize<S: Serializer>(pose: &Pose, serializer: S) -> Result<S::Ok, S::Error> {
        PoseRecord::from(pose).serialize(serializer)
    }

    /// Reads a pose from a [`PoseRecord`].
    ///
    /// # Errors
    /// If the record is malformed or its quaternion is not of unit length.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pose, D::Error> {
        Pose::try_from(PoseRecord::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// The JSON Schema of a wrench: an array of six numbers.
#[derive(Clone, Copy, Debug)]
pub struct WrenchSchema;

impl JsonSchema for WrenchSchema {
    fn schema_name() -> Cow<'static, str> {
        "Wrench".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        <[f64; 6]>::json_schema(generator)
    }
}
