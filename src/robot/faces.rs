//! Faces of fingers: where the shapes of a link are on either side of a gripper's middle plane.

use nalgebra::Vector3;

use super::tree::Robot;
use crate::model::frames::Pose;

/// Mean y_G of the centres of a link's shapes, m.
pub(super) fn mean_y(robot: &Robot, link: usize, x_gl: &Pose) -> f64 {
    let shapes = &robot.links[link].shapes;
    let sum: f64 = shapes.iter().map(|placed| (x_gl * placed.x_ls).translation.y).sum();
    sum / shapes.len() as f64
}

/// Distance of a link's innermost face from the plane y_G = 0, positive on the given side, m.
pub(super) fn nearest_face(robot: &Robot, link: usize, x_gl: &Pose, side: f64) -> f64 {
    let inner = robot.links[link].shapes.iter().map(|placed| {
        let x_gs = x_gl * placed.x_ls;
        let inward_s = x_gs.rotation.inverse() * Vector3::new(0.0, -side, 0.0);
        side * x_gs.translation.y - placed.shape.support_m(&inward_s)
    });
    inner.fold(f64::INFINITY, f64::min)
}
