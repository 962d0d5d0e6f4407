//! Faces of fingers: where the shapes of a pad are on either side of a gripper's middle plane.

use nalgebra::Vector3;

use super::tree::{Face, Robot};
use crate::model::frames::Pose;

/// A rectangle in the plane of a pad: ranges along x_G and z_G, m.
pub(super) type Rectangle = [[f64; 2]; 2];

impl Face {
    /// All shapes of links.
    pub fn of_links(robot: &Robot, links: &[usize]) -> Self {
        let of_link = |&link: &usize| (0..robot.links[link].shapes.len()).map(move |shape| [link, shape]);
        Self { shapes: links.iter().flat_map(of_link).collect() }
    }

    /// Of these shapes those that a line along y_G through a rectangle meets; all if it meets none. `x_gw` is the pose of W in G.
    #[must_use]
    pub(super) fn across(&self, robot: &Robot, x_wl: &[Pose], x_gw: &Pose, rectangle: &Rectangle) -> Self {
        self.or_all(self.met(robot, x_wl, x_gw, rectangle))
    }

    /// Of the shapes of two faces those that a line along y_G meets together with one of the other; all of a face with none.
    #[must_use]
    pub fn facing(faces: &[Self; 2], robot: &Robot, x_wl: &[Pose], x_gw: &Pose) -> [Self; 2] {
        [0, 1].map(|own| {
            let others = faces[1 - own].shapes.iter().map(|&shape| bounds_g(robot, x_wl, x_gw, shape));
            let mut met: Vec<_> = others.flat_map(|bounds| faces[own].met(robot, x_wl, x_gw, &bounds)).collect();
            met.sort_unstable();
            met.dedup();
            faces[own].or_all(met)
        })
    }

    fn met(&self, robot: &Robot, x_wl: &[Pose], x_gw: &Pose, rectangle: &Rectangle) -> Vec<[usize; 2]> {
        let overlaps = |shape: &&[usize; 2]| {
            let bounds = bounds_g(robot, x_wl, x_gw, **shape);
            bounds.iter().zip(rectangle).all(|(own, wanted)| own[0] < wanted[1] && wanted[0] < own[1])
        };
        self.shapes.iter().filter(overlaps).copied().collect()
    }

    fn or_all(&self, shapes: Vec<[usize; 2]>) -> Self {
        if shapes.is_empty() { self.clone() } else { Self { shapes } }
    }

    /// The shapes.
    pub fn shapes(&self) -> &[[usize; 2]] {
        &self.shapes
    }

    /// Mean y_G of the centres of the shapes, m.
    pub(super) fn mean_y(&self, robot: &Robot, x_wl: &[Pose], x_gw: &Pose) -> f64 {
        let centre_y =
            |&[link, shape]: &[usize; 2]| ((x_gw * x_wl[link]) * robot.links[link].shapes[shape].x_ls).translation.y;
        self.shapes.iter().map(centre_y).sum::<f64>() / self.shapes.len() as f64
    }

    /// Distance of the innermost face from the plane y_G = 0, positive on the given side, m.
    pub(super) fn nearest_m(&self, robot: &Robot, x_wl: &[Pose], x_gw: &Pose, side: f64) -> f64 {
        let inner = self.shapes.iter().map(|&[link, shape]| {
            let placed = &robot.links[link].shapes[shape];
            let x_gs = (x_gw * x_wl[link]) * placed.x_ls;
            let inward_s = x_gs.rotation.inverse() * Vector3::new(0.0, -side, 0.0);
            side * x_gs.translation.y - placed.shape.support_m(&inward_s)
        });
        inner.fold(f64::INFINITY, f64::min)
    }
}

/// Ranges of a shape along x_G and z_G, m.
fn bounds_g(robot: &Robot, x_wl: &[Pose], x_gw: &Pose, [link, shape]: [usize; 2]) -> Rectangle {
    let placed = &robot.links[link].shapes[shape];
    let x_gs = (x_gw * x_wl[link]) * placed.x_ls;
    let to_s = x_gs.rotation.inverse();
    [Vector3::x(), Vector3::z()].map(|axis| {
        let at_m = x_gs.translation.vector.dot(&axis);
        let along_s = to_s * axis;
        [at_m - placed.shape.support_m(&-along_s), at_m + placed.shape.support_m(&along_s)]
    })
}
