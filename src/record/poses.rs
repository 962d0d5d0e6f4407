//! Poses of entities.

use rerun::{EntityPath, Transform3D};

use super::{
    error::RecordError,
    frames::{quaternion, vec3},
    messages::Messages,
};
use crate::model::frames::Pose;

/// Logs the poses of an entity over time.
pub(super) fn log_poses(
    messages: &mut Messages,
    path: &EntityPath,
    times_s: &[f64],
    poses: impl Iterator<Item = Pose>,
) -> Result<(), RecordError> {
    let (translations, rotations): (Vec<_>, Vec<_>) =
        poses.map(|pose| (vec3(&pose.translation.vector), quaternion(&pose.rotation))).unzip();
    let transforms = Transform3D::new().with_many_translation(translations).with_many_quaternion(rotations);
    messages.log_columns(path, times_s, transforms.columns_of_unit_batches().map_err(RecordError::encode)?)
}

/// A pose as a transform.
pub(super) fn transform(pose: &Pose) -> Transform3D {
    Transform3D::new().with_translation(vec3(&pose.translation.vector)).with_quaternion(quaternion(&pose.rotation))
}
