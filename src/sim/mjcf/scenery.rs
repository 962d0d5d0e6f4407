//! What is only seen: the robot's meshes and shapes, the floor, a light and a camera.

use std::io;

use nalgebra::{Isometry3, Vector3};

use super::{
    exported_arm::ExportedArm,
    xml::{Xml, empty, geom, mesh_geom, numbers},
};
use crate::{
    model::frames::Pose,
    robot::{DrawnForm, DrawnPart, Link, Robot, Shape, TriangleMesh},
};

/// The group of geoms that are only seen; a viewer can hide it.
const SEEN_GROUP: u8 = 2;

/// Colour of what has none.
const PLAIN_RGBA: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Half sides of the floor, m, and the spacing of its grid.
const FLOOR_M: [f64; 3] = [3.0, 3.0, 0.1];

/// A robot and what is drawn of each of its links, whose meshes are read once.
pub(super) struct DrawnRobot<'a> {
    pub robot: &'a Robot,
    parts: Vec<Vec<DrawnPart>>,
}

impl<'a> DrawnRobot<'a> {
    /// Reads the meshes.
    pub fn new(robot: &'a Robot) -> Self {
        Self { robot, parts: (0..robot.links.len()).map(|link| robot.drawn(link)).collect() }
    }

    /// All links and what is drawn of them.
    fn links(&self) -> impl Iterator<Item = (&Link, &[DrawnPart])> {
        self.robot.links.iter().zip(self.parts.iter().map(Vec::as_slice))
    }
}

/// Floor, light, camera, and the links that no arm of the plan moves.
pub(super) fn fixed(
    xml: &mut Xml,
    robot: &DrawnRobot<'_>,
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
    let x_wf = Isometry3::translation(0.0, 0.0, robot.robot.floor_z_m);
    geom(xml, "floor", ("plane", &FLOOR_M), &x_wf, (SEEN_GROUP, [0.8, 0.8, 0.8, 1.0]))?;
    let Some(first) = arms.first() else { return Ok(()) };
    for (index, (link, parts)) in robot.links().enumerate() {
        if arms.iter().all(|arm| arm.bodies.placements[index].body.is_none()) {
            drawn(xml, link, parts, &first.bodies.placements[index].x_bl)?;
        }
    }
    Ok(())
}

/// What is drawn of all links that are fixed to a moving body.
pub(super) fn moving(xml: &mut Xml, robot: &DrawnRobot<'_>, arm: &ExportedArm<'_>, body: usize) -> io::Result<()> {
    let links = robot.links().zip(&arm.bodies.placements);
    for ((link, parts), placement) in links.filter(|(_, placement)| placement.body == Some(body)) {
        drawn(xml, link, parts, &placement.x_bl)?;
    }
    Ok(())
}

/// The meshes that the geoms of the robot name. MuJoCo needs no volume of what has no mass.
pub(super) fn assets(xml: &mut Xml, robot: &DrawnRobot<'_>) -> io::Result<()> {
    let meshes = robot.links().flat_map(|(link, parts)| {
        let parts = parts.iter().enumerate();
        parts.filter_map(|(number, part)| surface(&part.form).map(|surface| (part_name(link, number), surface)))
    });
    let meshes: Vec<(String, &TriangleMesh)> = meshes.collect();
    if meshes.is_empty() {
        return Ok(());
    }
    xml.create_element("asset").write_inner_content(|xml| {
        meshes.iter().try_for_each(|(name, surface)| {
            let points: Vec<f64> = surface.points_m.iter().flat_map(|point| [point.x, point.y, point.z]).collect();
            let corners: Vec<String> = surface.triangles.iter().flatten().map(u32::to_string).collect();
            let attributes = [
                ("name", name.clone()),
                ("inertia", "shell".into()),
                ("vertex", numbers(&points)),
                ("face", corners.join(" ")),
            ];
            empty(xml, "mesh", &attributes)
        })
    })?;
    Ok(())
}

fn part_name(link: &Link, number: usize) -> String {
    format!("{} shape {}", link.name, number + 1)
}

/// The surface of a part that is no primitive.
fn surface(form: &DrawnForm) -> Option<&TriangleMesh> {
    match form {
        DrawnForm::Surface(surface) => Some(surface),
        DrawnForm::Shape(Shape::Hull(hull)) => Some(hull),
        DrawnForm::Shape(_) => None,
    }
}

/// What is drawn of a link whose pose in its body is `x_bl`.
fn drawn(xml: &mut Xml, link: &Link, parts: &[DrawnPart], x_bl: &Pose) -> io::Result<()> {
    for (number, part) in parts.iter().enumerate() {
        let name = part_name(link, number);
        let look = (SEEN_GROUP, part.rgba.unwrap_or(PLAIN_RGBA));
        let x_bp = x_bl * part.x_lp;
        match &part.form {
            DrawnForm::Shape(Shape::Box { half_m }) => geom(xml, &name, ("box", half_m), &x_bp, look)?,
            DrawnForm::Shape(Shape::Cylinder { radius_m, half_length_m }) => {
                geom(xml, &name, ("cylinder", &[*radius_m, *half_length_m]), &x_bp, look)?;
            }
            DrawnForm::Shape(Shape::Sphere { radius_m }) => geom(xml, &name, ("sphere", &[*radius_m]), &x_bp, look)?,
            DrawnForm::Surface(_) | DrawnForm::Shape(Shape::Hull(_)) => mesh_geom(xml, &name, &x_bp, look)?,
        }
    }
    Ok(())
}
