//! Meshes: STL, COLLADA and OBJ files, their convex hulls and convex decompositions.
//!
//! As in ROS, the unit of a COLLADA file counts and its up axis does not.

use std::{collections::BTreeSet, sync::Arc};

use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use parry3d_f64::{
    glamx::DVec3,
    transformation::{
        try_convex_hull,
        vhacd::{VHACD, VHACDParameters},
    },
};

use super::{
    geometry::{MeshFile, PlacedShape, Shape, TriangleMesh, Visual, VisualGeometry},
    mesh_file,
    tree::{Link, Robot},
};
use crate::model::frames::Pose;

/// The largest distance by which a point of a mesh's hull may stick out of the shape, m: a fifth of the usual clearance.
const HULL_TOLERANCE_M: f64 = 1e-3;

/// The most corners of a shape. A distance of two shapes costs in proportion to their corners.
const MOST_CORNERS: usize = 96;

/// Least thickness of the box that replaces the hull of a flat mesh, m.
const LEAST_THICKNESS_M: f64 = 1e-3;

/// The finest voxels of a convex decomposition, along the longest side.
const VOXELS: u32 = 64;

/// How a collision mesh becomes convex shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Convexity {
    /// Its convex hull.
    Hull,
    /// Several convex parts.
    Parts,
}

/// A part of a mesh with a colour of its own.
#[derive(Clone, Debug)]
pub struct MeshPart {
    /// The triangles, in the frame of the mesh.
    pub surface: TriangleMesh,
    /// Colour that the file gives, red green blue alpha, 0 to 1.
    pub rgba: Option<[f64; 4]>,
}

impl MeshFile {
    /// The parts of the mesh, scaled.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(&self) -> Result<Vec<MeshPart>, String> {
        let at = |problem: String| format!("mesh {}: {problem}", self.path.display());
        let scene = mesh_file::read(&self.path).map_err(at)?;
        let scale = Vector3::from(self.scale);
        let parts = scene.meshes.iter().enumerate().map(|(number, mesh)| {
            let corner = |p: &[f32; 3]| Point3::from(Vector3::from(p.map(f64::from)).component_mul(&scale));
            let diffuse = scene.materials.get(number).and_then(|material| material.color.diffuse);
            let mut triangles = mesh.faces.clone();
            if self.scale.iter().product::<f64>() < 0.0 {
                triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            }
            let surface = TriangleMesh { points_m: mesh.vertices.iter().map(corner).collect(), triangles };
            MeshPart { surface, rgba: diffuse.map(|rgba| rgba.map(f64::from)) }
        });
        let parts: Vec<MeshPart> = parts.filter(|part| !part.surface.triangles.is_empty()).collect();
        let points = || parts.iter().flat_map(|part| &part.surface.points_m);
        if parts.is_empty() {
            return Err(at("found no triangles".into()));
        }
        if !points().all(|p| p.iter().all(|v| v.is_finite())) {
            return Err(at("found a point that is not finite".into()));
        }
        let in_range = |part: &MeshPart| {
            let count = part.surface.points_m.len();
            part.surface.triangles.iter().flatten().all(|&corner| (corner as usize) < count)
        };
        if !parts.iter().all(in_range) {
            return Err(at("found a triangle with a corner that the file does not have".into()));
        }
        Ok(parts)
    }

    /// Convex shapes that enclose the mesh, each with its pose in the mesh's frame.
    ///
    /// # Errors
    /// As for [`MeshFile::read`].
    pub(super) fn convex_shapes(&self, convexity: Convexity) -> Result<Vec<(Pose, Shape)>, String> {
        let surface = joined(&self.read()?);
        let pieces = match convexity {
            Convexity::Hull => vec![surface.points_m],
            Convexity::Parts => decomposed(&surface),
        };
        Ok(pieces.iter().map(|points| hull_shape(points)).collect())
    }
}

/// All parts as one surface.
fn joined(parts: &[MeshPart]) -> TriangleMesh {
    let mut all = TriangleMesh::default();
    for part in parts {
        let first = all.points_m.len() as u32;
        all.points_m.extend(&part.surface.points_m);
        all.triangles.extend(part.surface.triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
    }
    all
}

/// The points of each part of an approximate convex decomposition.
fn decomposed(surface: &TriangleMesh) -> Vec<Vec<Point3<f64>>> {
    let points: Vec<DVec3> = surface.points_m.iter().map(to_parry).collect();
    let parameters = VHACDParameters { resolution: VOXELS, ..VHACDParameters::default() };
    let decomposition = VHACD::decompose(&parameters, &points, &surface.triangles, true);
    let parts = decomposition.compute_exact_convex_hulls(&points, &surface.triangles);
    let parts: Vec<Vec<_>> = parts.iter().map(|(points, _)| points.iter().map(from_parry).collect()).collect();
    let parts: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { vec![surface.points_m.clone()] } else { parts }
}

/// The convex hull of points, with few corners, and the pose of its centre; a thin box if the points lie in a plane.
fn hull_shape(points_m: &[Point3<f64>]) -> (Pose, Shape) {
    let mut distinct: Vec<DVec3> = points_m.iter().map(to_parry).collect();
    distinct.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    distinct.dedup();
    let (low, high) = bounds(&distinct);
    let centre = (low + high) / 2.0;
    let centred: Vec<DVec3> = distinct.iter().map(|p| *p - centre).collect();
    let x_ms = Isometry3::from(Translation3::new(centre.x, centre.y, centre.z));
    let shape = match few_corners(&centred) {
        Some((points, triangles)) => {
            Shape::Hull(Arc::new(TriangleMesh { points_m: points.iter().map(from_parry).collect(), triangles }))
        }
        None => {
            let half = (high - low) / 2.0;
            Shape::Box { half_m: [half.x, half.y, half.z].map(|side| side.max(LEAST_THICKNESS_M / 2.0)) }
        }
    };
    (x_ms, shape)
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let infinite = DVec3::splat(f64::INFINITY);
    points.iter().fold((infinite, -infinite), |(low, high), p| (low.min(*p), high.max(*p)))
}

type Hull = (Vec<DVec3>, Vec<[u32; 3]>);

/// The hull of a subset of the points: first the outermost in 26 directions, then always the point that sticks out most,
/// until none does by more than [`HULL_TOLERANCE_M`] or there are [`MOST_CORNERS`]. `None` if the hull has no volume.
fn few_corners(points: &[DVec3]) -> Option<Hull> {
    let (corners, _) = try_convex_hull(points).ok()?;
    let mut chosen: BTreeSet<usize> = directions().filter_map(|direction| outermost(&corners, direction)).collect();
    loop {
        let subset: Vec<DVec3> = chosen.iter().map(|&corner| corners[corner]).collect();
        let hull = try_convex_hull(&subset).ok();
        let farthest = match &hull {
            Some(hull) => farthest_outside(&corners, hull),
            None => (0..corners.len()).find(|corner| !chosen.contains(corner)).map(|corner| (corner, f64::INFINITY)),
        };
        match farthest {
            Some((corner, out_m)) if out_m > HULL_TOLERANCE_M && chosen.len() < MOST_CORNERS => {
                if !chosen.insert(corner) {
                    return hull;
                }
            }
            _ => return hull,
        }
    }
}

/// The 26 directions from the centre of a cube to its faces, edges and corners.
fn directions() -> impl Iterator<Item = DVec3> {
    let sides = [-1.0, 0.0, 1.0];
    let all = sides.into_iter().flat_map(move |x| sides.into_iter().map(move |y| (x, y)));
    let all = all.flat_map(move |(x, y)| sides.into_iter().map(move |z| DVec3::new(x, y, z)));
    all.filter(|direction| *direction != DVec3::ZERO)
}

fn outermost(points: &[DVec3], direction: DVec3) -> Option<usize> {
    let along = |point: &usize| points[*point].dot(direction);
    (0..points.len()).max_by(|a, b| along(a).total_cmp(&along(b)))
}

/// The point that is farthest outside a hull, and how far its planes are from it, m.
fn farthest_outside(points: &[DVec3], (corners, triangles): &Hull) -> Option<(usize, f64)> {
    let planes: Vec<(DVec3, f64)> = triangles
        .iter()
        .map(|triangle| triangle.map(|corner| corners[corner as usize]))
        .map(|[a, b, c]| ((b - a).cross(c - a).normalize_or_zero(), a))
        .map(|(normal, a)| (normal, normal.dot(a)))
        .collect();
    let out_m = |point: &DVec3| planes.iter().map(|(normal, at)| normal.dot(*point) - at).fold(0.0, f64::max);
    points.iter().map(out_m).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

fn to_parry(p: &Point3<f64>) -> DVec3 {
    DVec3::new(p.x, p.y, p.z)
}

fn from_parry(p: &DVec3) -> Point3<f64> {
    Point3::new(p.x, p.y, p.z)
}

/// A part of a link as it is drawn.
#[derive(Clone, Debug)]
pub struct DrawnPart {
    /// Pose in the link's frame.
    pub x_lp: Pose,
    /// What is drawn.
    pub form: DrawnForm,
    /// Colour, red green blue alpha, 0 to 1; `None` if neither the URDF nor the mesh has one.
    pub rgba: Option<[f64; 4]>,
}

/// The form of a [`DrawnPart`].
#[derive(Clone, Debug)]
pub enum DrawnForm {
    /// A convex shape.
    Shape(Shape),
    /// A surface.
    Surface(TriangleMesh),
}

impl Robot {
    /// What is drawn of a link: its visuals if they have meshes that can be read, else its collision shapes. Of a robot with
    /// visual meshes, links without visuals are not drawn: vendors use them for safety zones.
    #[must_use]
    pub fn drawn(&self, link: usize) -> Vec<DrawnPart> {
        let has_mesh = |link: &Link| link.visuals.iter().any(|v| matches!(v.geometry, VisualGeometry::Mesh(_)));
        let link = &self.links[link];
        if link.visuals.is_empty() && self.links.iter().any(has_mesh) {
            return Vec::new();
        }
        let visuals = has_mesh(link).then(|| link.visuals.iter().map(drawn_visual));
        let visuals = visuals.and_then(|visuals| visuals.collect::<Result<Vec<_>, _>>().ok());
        visuals.map_or_else(
            || {
                let shape = |placed: &PlacedShape| DrawnPart {
                    x_lp: placed.x_ls,
                    form: DrawnForm::Shape(placed.shape.clone()),
                    rgba: Some(placed.rgba),
                };
                link.shapes.iter().map(shape).collect()
            },
            |visuals| visuals.into_iter().flatten().collect(),
        )
    }
}

fn drawn_visual(visual: &Visual) -> Result<Vec<DrawnPart>, String> {
    let part = |form, rgba| DrawnPart { x_lp: visual.x_lv, form, rgba };
    match &visual.geometry {
        VisualGeometry::Primitive(shape) => Ok(vec![part(DrawnForm::Shape(shape.clone()), visual.rgba)]),
        VisualGeometry::Mesh(mesh) => {
            let parts = mesh.read()?.into_iter();
            Ok(parts.map(|found| part(DrawnForm::Surface(found.surface), visual.rgba.or(found.rgba))).collect())
        }
    }
}
