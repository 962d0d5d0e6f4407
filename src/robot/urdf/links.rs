//! Links: mass properties, collision shapes, visuals.

use std::{collections::BTreeMap, path::PathBuf};

use nalgebra::{Isometry3, Matrix3, Vector3};
use urdf_rs::Geometry;

use super::pose::read_pose;
use crate::robot::{
    geometry::{MeshFile, PlacedShape, Shape, Visual, VisualGeometry},
    mesh::Convexity,
    packages::Packages,
    tree::Link,
};

/// Colour of geometry without a colour in its visual.
const DEFAULT_RGBA: [f64; 4] = [0.6, 0.6, 0.6, 1.0];

/// Tolerance of negative eigenvalues of an inertia, relative to the largest, since published values are rounded.
const INERTIA_TOLERANCE: f64 = 1e-6;

/// Rounding of inertias that are zero, kg m^2.
const ROUNDING_KG_M2: f64 = 1e-12;

/// Negative eigenvalues up to this share of the largest are taken for errors of a vendor's fit and set to zero: such an
/// inertia is that of a thin body. More would be another body.
const MENDED_INERTIA: f64 = 0.1;

/// Eigenvalues below this are those of a part of some grams, which no result depends on, kg m^2.
const NEGLIGIBLE_INERTIA_KG_M2: f64 = 1e-6;

/// A collision mesh this far from where the same mesh is drawn is displaced by mistake, m.
const DISPLACED_M: f64 = 0.3;

/// A shape with its pose in a frame.
type PosedShape = (Isometry3<f64>, Shape);

/// What reads links.
pub(super) struct Reader<'a> {
    pub packages: &'a Packages,
    /// Links whose meshes are decomposed.
    pub decomposed: &'a [String],
    /// Colours of the URDF by name.
    pub colours: &'a BTreeMap<&'a str, [f64; 4]>,
}

/// A link, and what was found on reading it.
pub(super) struct ReadLink {
    pub link: Link,
    pub problems: Vec<String>,
    pub notes: Vec<String>,
    pub files: Vec<PathBuf>,
}

pub(super) fn global_colours(materials: &[urdf_rs::Material]) -> BTreeMap<&str, [f64; 4]> {
    materials.iter().filter_map(|m| m.color.as_ref().map(|c| (m.name.as_str(), c.rgba.0))).collect()
}

impl Reader<'_> {
    /// Reads a link. After a problem the link lacks the part that has it.
    pub fn read(&self, link: &urdf_rs::Link, parent_joint: Option<usize>) -> ReadLink {
        let mut read = ReadLink {
            link: Link::empty(&link.name, parent_joint),
            problems: Vec::new(),
            notes: Vec::new(),
            files: Vec::new(),
        };
        let at = |problem: String| format!("link {}: {problem}", link.name);
        match read_inertial(&link.inertial) {
            Ok((mass_kg, com_l, inertia, note)) => {
                (read.link.mass_kg, read.link.com_l, read.link.inertia_l) = (mass_kg, com_l, inertia);
                read.notes.extend(note.map(at));
            }
            Err(problem) => read.problems.push(at(problem)),
        }
        for (number, collision) in link.collision.iter().enumerate() {
            // Pictures of links without visuals show the collision shapes, with the colours of the visuals.
            let visual =
                if link.visual.len() == link.collision.len() { link.visual.get(number) } else { link.visual.first() };
            let rgba = visual.and_then(|visual| self.colour(visual)).unwrap_or(DEFAULT_RGBA);
            match self.shapes(&link.name, collision) {
                Ok((shapes, file)) => {
                    read.link.shapes.extend(shapes.into_iter().map(|(x_ls, shape)| PlacedShape { x_ls, shape, rgba }));
                    read.files.extend(file);
                }
                Err(problem) => read.problems.push(at(problem)),
            }
        }
        read.notes.extend(link.collision.iter().find_map(|collision| displaced(collision, &link.visual)).map(at));
        for visual in &link.visual {
            match self.visual(visual) {
                Ok(visuals) => read.link.visuals.extend(visuals),
                Err(problem) => read.notes.push(at(format!("a visual is not drawn: {problem}"))),
            }
        }
        read
    }

    fn colour(&self, visual: &urdf_rs::Visual) -> Option<[f64; 4]> {
        let material = visual.material.as_ref()?;
        material.color.as_ref().map(|c| c.rgba.0).or_else(|| self.colours.get(material.name.as_str()).copied())
    }

    /// The convex shapes of a collision geometry, and the mesh file that has them.
    fn shapes(&self, link: &str, collision: &urdf_rs::Collision) -> Result<(Vec<PosedShape>, Option<PathBuf>), String> {
        let x_lg = read_pose(&collision.origin)?;
        let Geometry::Mesh { filename, scale } = &collision.geometry else {
            let placed = primitives(&collision.geometry)?.into_iter().map(|(x_gs, shape)| (x_lg * x_gs, shape));
            return Ok((placed.collect(), None));
        };
        let mesh = self.mesh(filename, scale.as_ref())?;
        let is_decomposed = self.decomposed.iter().any(|name| name == link);
        let shapes = mesh.convex_shapes(if is_decomposed { Convexity::Parts } else { Convexity::Hull })?;
        Ok((shapes.into_iter().map(|(x_ms, shape)| (x_lg * x_ms, shape)).collect(), Some(mesh.path)))
    }

    fn visual(&self, visual: &urdf_rs::Visual) -> Result<Vec<Visual>, String> {
        let (x_lv, rgba) = (read_pose(&visual.origin)?, self.colour(visual));
        if let Geometry::Mesh { filename, scale } = &visual.geometry {
            let geometry = VisualGeometry::Mesh(self.mesh(filename, scale.as_ref())?);
            return Ok(vec![Visual { x_lv, geometry, rgba }]);
        }
        let placed = |(x_vs, shape)| Visual { x_lv: x_lv * x_vs, geometry: VisualGeometry::Primitive(shape), rgba };
        Ok(primitives(&visual.geometry)?.into_iter().map(placed).collect())
    }

    fn mesh(&self, filename: &str, scale: Option<&urdf_rs::Vec3>) -> Result<MeshFile, String> {
        let scale = scale.map_or([1.0; 3], |scale| scale.0);
        if !scale.iter().all(|factor| factor.is_finite() && *factor != 0.0) {
            return Err(format!(
                "found the mesh {filename} with scale {scale:?}, expected finite factors other than 0"
            ));
        }
        let path = self.packages.resolve(filename).map_err(|problem| format!("mesh: {problem}"))?;
        Ok(MeshFile { path, scale })
    }
}

/// A note on a collision that has the mesh of a visual far from it: an origin with a wrong number.
fn displaced(collision: &urdf_rs::Collision, visuals: &[urdf_rs::Visual]) -> Option<String> {
    let Geometry::Mesh { filename, .. } = &collision.geometry else { return None };
    let same = |visual: &&urdf_rs::Visual| matches!(&visual.geometry, Geometry::Mesh { filename: other, .. } if other == filename);
    let away_m =
        |visual: &urdf_rs::Visual| (Vector3::from(collision.origin.xyz.0) - Vector3::from(visual.origin.xyz.0)).norm();
    let least_m = visuals.iter().filter(same).map(away_m).min_by(f64::total_cmp)?;
    (least_m > DISPLACED_M).then(|| {
        format!("its collision mesh {filename} is {least_m:.2} m from where the same mesh is drawn; look at its origin")
    })
}

/// The convex primitives of a geometry that is no mesh, each with its pose. A capsule is a cylinder with a sphere at either end.
fn primitives(geometry: &Geometry) -> Result<Vec<PosedShape>, String> {
    let centred = |shape| vec![(Isometry3::identity(), shape)];
    let (shapes, sizes) = match geometry {
        Geometry::Box { size } => (centred(Shape::Box { half_m: size.map(|side| side / 2.0) }), size.to_vec()),
        Geometry::Cylinder { radius, length } => {
            (centred(Shape::Cylinder { radius_m: *radius, half_length_m: length / 2.0 }), vec![*radius, *length])
        }
        Geometry::Sphere { radius } => (centred(Shape::Sphere { radius_m: *radius }), vec![*radius]),
        Geometry::Capsule { radius, length } => {
            let end = |side: f64| {
                (Isometry3::translation(0.0, 0.0, side * length / 2.0), Shape::Sphere { radius_m: *radius })
            };
            let middle = Shape::Cylinder { radius_m: *radius, half_length_m: length / 2.0 };
            (vec![(Isometry3::identity(), middle), end(1.0), end(-1.0)], vec![*radius, *length])
        }
        Geometry::Mesh { .. } => (Vec::new(), Vec::new()),
    };
    match sizes.iter().find(|size| !(size.is_finite() && **size > 0.0)) {
        Some(size) => Err(format!("found geometry with a size of {size} m, expected sizes above 0")),
        None => Ok(shapes),
    }
}

/// Mass, centre of mass in the link, inertia about the centre of mass in axes of the link, and a note if it was mended.
type Inertial = (f64, Vector3<f64>, Matrix3<f64>, Option<String>);

fn read_inertial(inertial: &urdf_rs::Inertial) -> Result<Inertial, String> {
    let mass_kg = inertial.mass.value;
    if !(mass_kg.is_finite() && mass_kg >= 0.0) {
        return Err(format!("found a mass of {mass_kg} kg, expected a finite number, at least 0"));
    }
    let i = &inertial.inertia;
    let inertia = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    if !inertia.iter().all(|v| v.is_finite()) {
        return Err("found an inertia that is not finite, expected kg m^2".into());
    }
    let eigen = inertia.symmetric_eigen();
    let (least, largest) = (eigen.eigenvalues.min(), eigen.eigenvalues.amax());
    if least < -(MENDED_INERTIA * largest).max(NEGLIGIBLE_INERTIA_KG_M2) {
        return Err(format!("found an inertia with eigenvalue {least}, expected none below 0"));
    }
    let x_lc = read_pose(&inertial.origin)?;
    let r = x_lc.rotation.to_rotation_matrix();
    let about = |inertia: Matrix3<f64>| r.matrix() * inertia * r.matrix().transpose();
    if least >= -(INERTIA_TOLERANCE * largest).max(ROUNDING_KG_M2) {
        return Ok((mass_kg, x_lc.translation.vector, about(inertia), None));
    }
    let mut mended = eigen;
    mended.eigenvalues.apply(|value| *value = value.max(0.0));
    let note = format!("its inertia has the eigenvalue {least:.3e} kg m^2, which is set to 0");
    Ok((mass_kg, x_lc.translation.vector, about(mended.recompose()), Some(note)))
}
