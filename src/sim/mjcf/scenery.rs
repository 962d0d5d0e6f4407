//! What is only seen: the robot's shapes, the floor, a light and a camera.

use std::io;

use nalgebra::{Isometry3, Vector3};

use super::{
    exported_arm::ExportedArm,
    xml::{Xml, empty, geom, numbers},
};
use crate::{
    model::frames::Pose,
    robot::{Link, Robot, Shape},
};

/// The group of geoms that are only seen; a viewer can hide it.
const SEEN_GROUP: u8 = 2;

/// Half sides of the floor, m, and the spacing of its grid.
const FLOOR_M: [f64; 3] = [3.0, 3.0, 0.1];

/// Floor, light, camera, and the links that no arm of the plan moves.
pub(super) fn fixed(
    xml: &mut Xml,
    robot: &Robot,
    arms: &[ExportedArm<'_>],
    board_w_m: &Vector3<f64>,
) -> io::Result<()> {
    empty(xml, "light", &[("pos", "0 0 4".into()), ("dir", "0 0 -1".into()), ("directional", "true".into())])?;
    // From the side where the person stands, above their head, with the board in the centre of the picture.
    let eye_m = Vector3::new(board_w_m.x.signum().mul_add(1.6, board_w_m.x), board_w_m.y - 1.2, board_w_m.z + 0.9);
    let camera = [("name", "board"), ("mode", "targetbody"), ("target", "board")];
    let mut camera: Vec<_> = camera.into_iter().map(|(key, value)| (key, value.to_owned())).collect();
    camera.push(("pos", numbers(eye_m.as_slice())));
    empty(xml, "camera", &camera)?;
    let x_wf = Isometry3::translation(0.0, 0.0, robot.floor_z_m);
    geom(xml, "floor", ("plane", &FLOOR_M), &x_wf, (SEEN_GROUP, [0.8, 0.8, 0.8, 1.0]))?;
    let Some(first) = arms.first() else { return Ok(()) };
    for (index, link) in robot.links.iter().enumerate() {
        if arms.iter().all(|arm| arm.bodies.placements[index].body.is_none()) {
            shapes(xml, link, &first.bodies.placements[index].x_bl)?;
        }
    }
    Ok(())
}

/// The shapes of all links that are fixed to a moving body.
pub(super) fn moving(xml: &mut Xml, robot: &Robot, arm: &ExportedArm<'_>, body: usize) -> io::Result<()> {
    let links = robot.links.iter().zip(&arm.bodies.placements);
    for (link, placement) in links.filter(|(_, placement)| placement.body == Some(body)) {
        shapes(xml, link, &placement.x_bl)?;
    }
    Ok(())
}

/// The shapes of a link whose pose in its body is `x_bl`.
fn shapes(xml: &mut Xml, link: &Link, x_bl: &Pose) -> io::Result<()> {
    for (number, placed) in link.shapes.iter().enumerate() {
        let name = format!("{} shape {}", link.name, number + 1);
        let look = (SEEN_GROUP, placed.rgba);
        let x_bs = x_bl * placed.x_ls;
        match placed.shape {
            Shape::Box { half_m } => geom(xml, &name, ("box", &half_m), &x_bs, look)?,
            Shape::Cylinder { radius_m, half_length_m } => {
                geom(xml, &name, ("cylinder", &[radius_m, half_length_m]), &x_bs, look)?;
            }
            Shape::Sphere { radius_m } => geom(xml, &name, ("sphere", &[radius_m]), &x_bs, look)?,
        }
    }
    Ok(())
}
