//! Poses and their form in files. Monogram notation: `x_wo` is the pose of frame O in frame W, `p_aq` the position of
//! Q in A.
//!
//! Frames: W world = robot base (x forward, y left, z up); O board, at its centre, z out of the worked face; T tool tip,
//! z into the material; G gripper, z out of the fingers, which open along y; P pad, at its centre, z into the object;
//! B person, on the floor between the feet; S shoulder centre, axes of B; H hand, at the wrist centre.

use std::borrow::Cow;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize, de::Error as _};

/// A rigid transform; `x_ab * p_b = p_a`.
pub type Pose = Isometry3<f64>;

/// How far from 1 the length of a quaternion in a file may be: six written digits keep it within this.
const UNIT_TOLERANCE: f64 = 1e-5;

/// Below this a quaternion counts as normalised already and is kept bit by bit, so that a plan that went through a file
/// gives the same simulation as one that did not.
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

/// The rotation that a file's quaternion (scalar last) stands for.
///
/// # Errors
/// When the quaternion is not finite or its length is not 1 within 1e-5.
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

/// `#[serde(with = "frames::pose")]`: a [`Pose`] as a [`PoseRecord`].
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
    /// When the record is malformed or its quaternion is not of unit length.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pose, D::Error> {
        Pose::try_from(PoseRecord::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// The schema of a six-component wrench array, shared by every field that holds one.
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
