//! A recording of a robot alone, in one posture: its links, pads and points, to look at before it is used.

use nalgebra::{Isometry3, Translation3};
use rerun::{Boxes3D, EntityPath, FillMode, Points3D, StoreId, StoreKind, ViewCoordinates};

use super::{
    entity::entity,
    error::RecordError,
    frames::{quaternion, vec3},
    messages::Messages,
    palette, robot, rrd,
};
use crate::{model::frames::Pose, robot::Robot};

/// The name under which the viewer groups such recordings: not that of runs, whose layout it keeps.
const APPLICATION: &str = "benchdog-robot";

/// Thickness of the plates that show pads, m; chosen for visibility.
const PAD_PLATE_M: f64 = 0.004;

/// The bytes of a recording (`.rrd`) of a robot whose joints are at `positions`. Equal inputs give equal bytes.
///
/// # Errors
/// If it cannot be encoded.
pub fn encode_posture(of: &Robot, positions: &[f64]) -> Result<Vec<u8>, RecordError> {
    let mut recording = Messages::new(StoreId::new(StoreKind::Recording, APPLICATION, "robot"));
    recording.log_static(&EntityPath::properties(), &rerun::RecordingInfo::new().with_name("robot"))?;
    recording.log_static(&entity(&["scene"]), &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    let x_wl = of.link_poses(positions);
    robot::log_posture(&mut recording, of, &x_wl)?;
    for (number, arm) in of.arms.iter().enumerate() {
        let gripper = &arm.gripper;
        for (finger, side) in gripper.fingers.iter().zip([1.0, -1.0]) {
            let [x_m, z_m] = finger.pad.centre_m;
            let travel_m = finger.opening_sign * (positions[finger.joint] - finger.closed_m);
            let y_m = side * (finger.pad.offset_m + travel_m - PAD_PLATE_M / 2.0);
            let x_wp: Pose = x_wl[gripper.frame_link] * Isometry3::from(Translation3::new(x_m, y_m, z_m));
            let [width_m, height_m] = finger.pad.size_m;
            let plate = Boxes3D::from_sizes([[width_m as f32, PAD_PLATE_M as f32, height_m as f32]])
                .with_centers([vec3(&x_wp.translation.vector)])
                .with_quaternions([quaternion(&x_wp.rotation)])
                .with_colors([palette::hand(number)])
                .with_fill_mode(FillMode::Solid);
            recording.log_static(&entity(&["scene", "pads", &arm.name, &finger.pad.name]), &plate)?;
        }
    }
    let points = of.body_points.iter().map(|point| vec3(&(x_wl[point.link] * point.p_l).coords));
    let points = Points3D::new(points).with_radii([0.008]).with_colors([palette::points()]);
    recording.log_static(&entity(&["scene", "points", "robot"]), &points)?;
    rrd::bytes(recording.into_messages())
}
