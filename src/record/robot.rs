//! The robot in the scene: its visual meshes, or its collision shapes where it has none.

use nalgebra::{Point3, Vector3};
use rerun::{Boxes3D, Color, Cylinders3D, Ellipsoids3D, EntityPath, FillMode, Mesh3D};

use super::{
    entity::entity,
    error::RecordError,
    frames::{Frames, quaternion, vec3},
    messages::Messages,
    palette,
    poses::{log_poses, transform},
};
use crate::{
    model::frames::Pose,
    robot::{DrawnForm, DrawnPart, Link, Robot, Shape, TriangleMesh},
};

/// Logs all links.
pub(super) fn log(messages: &mut Messages, robot: &Robot, frames: &Frames) -> Result<(), RecordError> {
    let carriers = robot.carriers();
    for (index, link) in robot.links.iter().enumerate() {
        let parts = robot.drawn(index);
        if parts.is_empty() {
            continue;
        }
        let path = entity(&["scene", "robot", &link.name]);
        log_link(messages, &path, link, &parts)?;
        match carriers[index] {
            Some(_) => {
                let poses = frames.x_wl.iter().map(|x_wl| x_wl[index]);
                log_poses(messages, &path, &frames.times_s, poses)?;
            }
            None => {
                let x_wl = frames.x_wl.first().map_or_else(Pose::identity, |x_wl| x_wl[index]);
                messages.log_static(&path, &transform(&x_wl))?;
            }
        }
    }
    Ok(())
}

/// Logs all links at fixed poses.
pub(super) fn log_posture(messages: &mut Messages, robot: &Robot, x_wl: &[Pose]) -> Result<(), RecordError> {
    for (index, (link, x_wl)) in robot.links.iter().zip(x_wl).enumerate() {
        let path = entity(&["scene", "robot", &link.name]);
        log_link(messages, &path, link, &robot.drawn(index))?;
        messages.log_static(&path, &transform(x_wl))?;
    }
    Ok(())
}

/// Logs the parts of a link: shapes on the link's entity, each mesh on one of its own.
fn log_link(messages: &mut Messages, path: &EntityPath, link: &Link, parts: &[DrawnPart]) -> Result<(), RecordError> {
    let shapes = parts.iter().filter_map(|part| match &part.form {
        DrawnForm::Shape(shape) => Some((part.x_lp, shape)),
        DrawnForm::Surface(_) => None,
    });
    log_shapes(messages, path, &shapes.collect::<Vec<_>>())?;
    for (number, part) in parts.iter().enumerate() {
        let surface = match &part.form {
            DrawnForm::Surface(surface) => surface,
            DrawnForm::Shape(Shape::Hull(hull)) => &**hull,
            DrawnForm::Shape(_) => continue,
        };
        let colour = part.rgba.filter(|_| !link.visuals.is_empty()).map_or_else(palette::robot, colour);
        let path = entity(&["scene", "robot", &link.name, &format!("mesh {}", number + 1)]);
        messages.log_static(&path, &mesh(surface, &part.x_lp, colour))?;
    }
    Ok(())
}

fn colour(rgba: [f64; 4]) -> Color {
    let [r, g, b, a] = rgba.map(|channel| (255.0 * channel.clamp(0.0, 1.0)) as u8);
    Color::from_unmultiplied_rgba(r, g, b, a)
}

/// A surface in the frame of its link.
fn mesh(surface: &TriangleMesh, x_lp: &Pose, colour: Color) -> Mesh3D {
    let points_l: Vec<Point3<f64>> = surface.points_m.iter().map(|point| x_lp * point).collect();
    let normals = normals(&points_l, &surface.triangles);
    Mesh3D::new(points_l.iter().map(|point| vec3(&point.coords)))
        .with_triangle_indices(surface.triangles.iter().copied())
        .with_vertex_normals(normals.iter().map(vec3))
        .with_albedo_factor(colour.to_u32())
}

/// The normal of each corner: the mean of its triangles' normals, weighted with their areas.
fn normals(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| points[corner as usize]);
        let weighted = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&corner| sums[corner as usize] += weighted);
    }
    sums.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_else(Vector3::z)).collect()
}

/// Logs the shapes of a link, grouped by kind.
fn log_shapes(messages: &mut Messages, path: &EntityPath, shapes: &[(Pose, &Shape)]) -> Result<(), RecordError> {
    let (mut boxes, mut cylinders, mut spheres) = (Vec::new(), Vec::new(), Vec::new());
    for (x_ls, shape) in shapes {
        let (centre, rotation) = (vec3(&x_ls.translation.vector), quaternion(&x_ls.rotation));
        match **shape {
            Shape::Hull(_) => {}
            Shape::Box { half_m } => boxes.push((half_m.map(|v| v as f32), centre, rotation)),
            Shape::Cylinder { radius_m, half_length_m } => {
                cylinders.push((2.0 * half_length_m as f32, radius_m as f32, centre, rotation));
            }
            Shape::Sphere { radius_m } => spheres.push(([radius_m as f32; 3], centre)),
        }
    }
    if !boxes.is_empty() {
        let archetype = Boxes3D::from_half_sizes(boxes.iter().map(|b| b.0))
            .with_centers(boxes.iter().map(|b| b.1))
            .with_quaternions(boxes.iter().map(|b| b.2))
            .with_colors([palette::robot()])
            .with_fill_mode(FillMode::Solid);
        messages.log_static(path, &archetype)?;
    }
    if !cylinders.is_empty() {
        let archetype =
            Cylinders3D::from_lengths_and_radii(cylinders.iter().map(|c| c.0), cylinders.iter().map(|c| c.1))
                .with_centers(cylinders.iter().map(|c| c.2))
                .with_quaternions(cylinders.iter().map(|c| c.3))
                .with_colors([palette::robot()])
                .with_fill_mode(FillMode::Solid);
        messages.log_static(path, &archetype)?;
    }
    if !spheres.is_empty() {
        let archetype = Ellipsoids3D::from_half_sizes(spheres.iter().map(|s| s.0))
            .with_centers(spheres.iter().map(|s| s.1))
            .with_colors([palette::robot()])
            .with_fill_mode(FillMode::Solid);
        messages.log_static(path, &archetype)?;
    }
    Ok(())
}
