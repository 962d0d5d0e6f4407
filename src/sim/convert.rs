//! Conversions between nalgebra's types and rapier's, which are glam's. No other file of this module converts.

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::math::{Matrix, Pose as EnginePose, Rotation, Vector};

use crate::model::frames::Pose;

/// A vector for rapier.
pub(super) fn to_engine_vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// A symmetric matrix for rapier.
pub(super) fn to_engine_matrix(m: &Matrix3<f64>) -> Matrix {
    Matrix::from_cols(
        to_engine_vector(&m.column(0).into()),
        to_engine_vector(&m.column(1).into()),
        to_engine_vector(&m.column(2).into()),
    )
}

/// A pose for rapier.
pub(super) fn to_engine_pose(pose: &Pose) -> EnginePose {
    let [x, y, z, w]: [f64; 4] = pose.rotation.quaternion().coords.into();
    EnginePose::from_parts(to_engine_vector(&pose.translation.vector), Rotation::from_xyzw(x, y, z, w))
}

/// A vector from rapier.
pub(super) fn from_engine_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// A pose from rapier. Rounding lets its quaternion drift from unit length, so it is normalised.
pub(super) fn from_engine_pose(pose: &EnginePose) -> Pose {
    let r = pose.rotation;
    Isometry3::from_parts(
        Translation3::from(from_engine_vector(pose.translation)),
        UnitQuaternion::new_normalize(Quaternion::new(r.w, r.x, r.y, r.z)),
    )
}
