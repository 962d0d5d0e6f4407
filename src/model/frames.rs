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

use nalgebra::Isometry3;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

pub use super::pose_form::{
    MatrixRecord, PoseForm, PoseRecord, RpyRecord, rotation_from_rows, rotation_from_rpy, rotation_from_xyzw,
};

/// A rigid transform; `x_ab * p_b = p_a`.
pub type Pose = Isometry3<f64>;

/// For `#[serde(with = "frames::pose")]`: writes a [`Pose`] as a [`PoseRecord`] and reads any
/// [`PoseForm`].
pub mod pose {
    use serde::Serializer;

    use super::*;

    /// Writes a pose as a [`PoseRecord`].
    pub fn serialize<S: Serializer>(pose: &Pose, serializer: S) -> Result<S::Ok, S::Error> {
        PoseRecord::from(pose).serialize(serializer)
    }

    /// Reads a pose from one of its forms.
    ///
    /// # Errors
    /// If the form is malformed or the pose is not rigid.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pose, D::Error> {
        Pose::try_from(PoseForm::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// For `#[serde(deserialize_with = "frames::optional_pose")]`: reads a pose from one of its forms, or none from `null`.
///
/// # Errors
/// If the form is malformed or the pose is not rigid.
pub fn optional_pose<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Pose>, D::Error> {
    let form = Option::<PoseForm>::deserialize(deserializer)?;
    form.map(Pose::try_from).transpose().map_err(D::Error::custom)
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
