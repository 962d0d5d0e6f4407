//! Bodies of a scene in W as items of a picture; the caller gives the SVG attributes.

use nalgebra::Point3;

use super::projection::Item;
use crate::{
    model::{board::PlacedObject, frames::Pose},
    robot::Robot,
};

/// Number of the colours of arms in pages.
pub const ARM_COLOURS: usize = 3;

/// The board at a pose; through its holes one sees what is behind.
#[must_use]
pub fn board(object: &PlacedObject, x_wo: &Pose, paint: String) -> Item {
    let corners_w = object.shape().corners_o().into_iter().map(|p| x_wo * p).collect();
    let in_plane = |[x, y]: &[f64; 2]| x_wo * Point3::new(*x, *y, 0.0);
    let holes = object.plate.iter().flat_map(|plate| plate.holes_m());
    let holes_w: Vec<_> = holes.map(|hole| hole.iter().map(in_plane).collect()).collect();
    if holes_w.is_empty() { Item::Hull(corners_w, paint) } else { Item::Pierced(corners_w, holes_w, paint) }
}

/// The part of an arm that a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmPart {
    /// Index of the arm in the robot.
    pub arm: usize,
    /// True of the last link and of the fingers.
    pub is_hand: bool,
}

/// For each link the arm that it belongs to; `None` if it stays.
#[must_use]
pub fn arm_parts(robot: &Robot) -> Vec<Option<ArmPart>> {
    robot.nearest_above(|joint| {
        robot.arms.iter().enumerate().find_map(|(number, arm)| {
            let is_finger = arm.gripper.fingers.iter().any(|finger| finger.joint == joint);
            let is_last = arm.joints.last() == Some(&joint);
            let part = ArmPart { arm: number, is_hand: is_finger || is_last };
            (is_finger || arm.joints.contains(&joint)).then_some(part)
        })
    })
}

/// The shapes of the links for which `paint` gives attributes, from the colour of a shape (red, green, blue, opacity from 0 to 1).
pub fn links(robot: &Robot, x_wl: &[Pose], paint: impl Fn(Option<ArmPart>, [f64; 4]) -> Option<String>) -> Vec<Item> {
    let mut items = Vec::new();
    for ((link, x_wl), part) in robot.links.iter().zip(x_wl).zip(arm_parts(robot)) {
        for placed in &link.shapes {
            let Some(paint) = paint(part, placed.rgba) else { continue };
            let points_w = placed.shape.surface_points().into_iter().map(|p| x_wl * placed.x_ls * p).collect();
            items.push(Item::Hull(points_w, paint));
        }
    }
    items
}
