//! The samples that are shown in the scene, with the poses of the robot's links.

use nalgebra::{UnitQuaternion, Vector3};

use super::{error::RecordError, input::RecordingInput};
use crate::{
    model::{frames::Pose, trace::Sample},
    robot::ArmState,
};

/// Time between two frames, s.
const FRAME_S: f64 = 0.02;

/// The samples that are shown, with the poses of the robot's links.
pub(super) struct Frames<'a> {
    /// The samples.
    pub samples: Vec<&'a Sample>,
    /// Their times, s.
    pub times_s: Vec<f64>,
    /// Poses of the links, by frame and link.
    pub x_wl: Vec<Vec<Pose>>,
}

/// The robot's index of each arm of the trace.
pub(super) fn arm_indices(input: &RecordingInput) -> Result<Vec<usize>, RecordError> {
    let names = || input.robot.arms.iter().map(|arm| format!("\"{}\"", arm.name)).collect::<Vec<_>>().join(", ");
    let index = |name: &String| {
        let unknown = || RecordError::UnknownArm { found: name.clone(), expected: names() };
        input.robot.arm_index(name).ok_or_else(unknown)
    };
    input.trace.arms.iter().map(|arm| index(&arm.name)).collect()
}

/// One sample every 20 ms.
pub(super) fn frames<'a>(input: &RecordingInput<'a>, arms: &[usize]) -> Frames<'a> {
    let mut samples: Vec<&Sample> = Vec::new();
    for sample in &input.trace.samples {
        // The tolerance of 0.5 ms allows for rounding in sums of steps.
        if samples.last().is_none_or(|last| sample.time_s - last.time_s > FRAME_S - 5e-4) {
            samples.push(sample);
        }
    }
    let link_poses = |sample: &Sample| {
        let states: Vec<ArmState> = arms
            .iter()
            .zip(&sample.arms)
            .map(|(&arm, state)| ArmState {
                arm,
                q_rad: &state.q_rad,
                finger_travel_m: std::array::from_fn(|finger| state.finger_m.get(finger).copied().unwrap_or(0.0)),
            })
            .collect();
        input.robot.link_poses(&input.robot.positions(&states))
    };
    Frames {
        times_s: samples.iter().map(|sample| sample.time_s).collect(),
        x_wl: samples.iter().map(|sample| link_poses(sample)).collect(),
        samples,
    }
}

/// A vector in rerun's single precision.
pub(super) fn vec3(vector: &Vector3<f64>) -> [f32; 3] {
    vector.map(|v| v as f32).into()
}

pub(super) fn quaternion(rotation: &UnitQuaternion<f64>) -> rerun::Quaternion {
    let [x, y, z, w] = rotation.coords.map(|v| v as f32).into();
    rerun::Quaternion::from_xyzw([x, y, z, w])
}

/// The smallest rotation of the z axis to a direction.
pub(super) fn from_z(direction: &Vector3<f64>) -> UnitQuaternion<f64> {
    // For -z the axis is any that is orthogonal to z.
    UnitQuaternion::rotation_between(&Vector3::z(), direction)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}
