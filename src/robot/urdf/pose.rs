//! Poses of a URDF.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use crate::model::frames::Pose;

/// An origin: position, m, and roll, pitch and yaw about fixed axes, rad.
pub(super) fn read_pose(pose: &urdf_rs::Pose) -> Result<Pose, String> {
    if !pose.xyz.iter().chain(pose.rpy.iter()).all(|v| v.is_finite()) {
        return Err("found an origin that is not finite, expected m and rad".into());
    }
    let [roll, pitch, yaw] = pose.rpy.0;
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Isometry3::from_parts(Translation3::from(pose.xyz.0), rotation))
}
