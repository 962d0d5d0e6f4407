//! The person in the scene: body, eyes, line of sight, the sector in front of them, and the tool in the hand.

use nalgebra::{Point3, Vector3};
use rerun::{Capsules3D, Color, Ellipsoids3D, FillMode, LineStrips3D, Mesh3D};

use super::{
    entity::entity,
    error::RecordError,
    frames::{from_z, quaternion, vec3},
    input::{Capsule, PersonShape},
    messages::Messages,
    muscles, palette,
};
use crate::model::tool_part::ToolPart;

/// Radius of the spheres that show the eyes, m.
const EYE_RADIUS_M: f64 = 0.014;

/// Radius of the lines of the person's sight and sector, m; chosen for visibility.
const LINE_RADIUS_M: f32 = 0.003;

/// Logs the person and the tool, from a time on, s, or without time.
pub(super) fn log(messages: &mut Messages, person: &PersonShape, from_s: Option<f64>) -> Result<(), RecordError> {
    messages.log(&entity(&["scene", "person"]), from_s, &capsules(&person.capsules))?;
    let eyes = Ellipsoids3D::from_half_sizes([[EYE_RADIUS_M as f32; 3]; 2])
        .with_centers(points(&person.eyes_w))
        .with_colors([palette::eyes()])
        .with_fill_mode(FillMode::Solid);
    messages.log(&entity(&["scene", "person", "eyes"]), from_s, &eyes)?;
    let sight = line(&person.line_of_sight_w, palette::sight());
    messages.log(&entity(&["scene", "person", "line_of_sight"]), from_s, &sight)?;
    if !person.sector_w.is_empty() {
        messages.log(&entity(&["scene", "person", "sector"]), from_s, &line(&person.sector_w, palette::sight()))?;
    }
    muscles::log_bellies(messages, &person.muscles, from_s)?;
    messages.log(&entity(&["scene", "tool"]), from_s, &mesh(&person.tool))
}

fn points(points_w: &[Point3<f64>]) -> Vec<[f32; 3]> {
    points_w.iter().map(|point_w| vec3(&point_w.coords)).collect()
}

fn line(points_w: &[Point3<f64>], colour: Color) -> LineStrips3D {
    LineStrips3D::new([points(points_w)]).with_radii([LINE_RADIUS_M]).with_colors([colour])
}

fn capsules(capsules: &[Capsule]) -> Capsules3D {
    let along = |capsule: &Capsule| capsule.ends_w[1] - capsule.ends_w[0];
    Capsules3D::from_lengths_and_radii(
        capsules.iter().map(|capsule| along(capsule).norm() as f32),
        capsules.iter().map(|capsule| capsule.radius_m as f32),
    )
    .with_translations(capsules.iter().map(|capsule| vec3(&capsule.ends_w[0].coords)))
    .with_quaternions(capsules.iter().map(|capsule| quaternion(&from_z(&along(capsule)))))
    .with_colors([palette::person()])
    .with_fill_mode(FillMode::Solid)
}

/// The tool as flat triangles, each with corners, normal and colours of its own.
fn mesh(parts: &[ToolPart]) -> Mesh3D {
    let (mut corners, mut normals, mut colours) = (Vec::new(), Vec::new(), Vec::new());
    for part in parts {
        for triangle_w in triangles(part) {
            let normal_w = (triangle_w[1] - triangle_w[0]).cross(&(triangle_w[2] - triangle_w[0])).normalize();
            corners.extend(points(&triangle_w));
            normals.extend([vec3(&normal_w); 3]);
            colours.extend([palette::tool(part.material); 3]);
        }
    }
    Mesh3D::new(corners).with_vertex_normals(normals).with_vertex_colors(colours)
}

/// The surface of a part; normals by the right-hand rule point out of it.
fn triangles(part: &ToolPart) -> Vec<[Point3<f64>; 3]> {
    let [first, second] = &part.ends_w;
    let mut triangles = Vec::new();
    for corner in 1..first.len() - 1 {
        triangles.push([first[0], first[corner], first[corner + 1]]);
        triangles.push([second[0], second[corner], second[corner + 1]]);
    }
    for corner in 0..first.len() {
        let next = (corner + 1) % first.len();
        triangles.push([first[corner], first[next], second[next]]);
        triangles.push([first[corner], second[next], second[corner]]);
    }
    let centre =
        first.iter().chain(second).map(|corner| corner.coords).sum::<Vector3<f64>>() / (2 * first.len()) as f64;
    for [a, b, c] in &mut triangles {
        if (*b - *a).cross(&(*c - *a)).dot(&(a.coords - centre)) < 0.0 {
            std::mem::swap(b, c);
        }
    }
    triangles
}
