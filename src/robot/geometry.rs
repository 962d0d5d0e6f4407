//! The geometry of a link: shapes for collisions, visuals for pictures.

use std::{path::PathBuf, sync::Arc};

use nalgebra::{Point3, Vector3};

use crate::model::frames::Pose;

/// A shape in its link.
#[derive(Clone, Debug)]
pub struct PlacedShape {
    /// Pose of the shape's centre in the link's frame.
    pub x_ls: Pose,
    /// The shape.
    pub shape: Shape,
    /// Colour, red green blue alpha, 0 to 1.
    pub rgba: [f64; 4],
}

/// A convex shape, centred at its own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A box.
    Box {
        /// Half sides along x, y, z, m.
        half_m: [f64; 3],
    },
    /// A cylinder about z.
    Cylinder {
        /// Radius, m.
        radius_m: f64,
        /// Half its length, m.
        half_length_m: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius_m: f64,
    },
    /// The convex hull of a mesh or of a part of it.
    Hull(Arc<TriangleMesh>),
}

impl Shape {
    /// Support of the shape along a unit direction in its frame: the largest `direction . p` of its points, m.
    pub fn support_m(&self, direction_s: &Vector3<f64>) -> f64 {
        match self {
            Self::Box { half_m } => Vector3::from(*half_m).dot(&direction_s.abs()),
            Self::Cylinder { radius_m, half_length_m } => {
                radius_m * direction_s.xy().norm() + half_length_m * direction_s.z.abs()
            }
            Self::Sphere { radius_m } => *radius_m,
            Self::Hull(hull) => {
                hull.points_m.iter().map(|p_s| direction_s.dot(&p_s.coords)).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Points on the surface whose convex hull is close to the shape: corners, and 20 points a circle.
    #[must_use]
    pub fn surface_points(&self) -> Vec<Point3<f64>> {
        const ROUND: u32 = 20;
        let circle = |k: u32| libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(ROUND));
        match *self {
            Self::Hull(ref hull) => hull.points_m.clone(),
            Self::Box { half_m: [x, y, z] } => {
                let signs = [-1.0, 1.0];
                signs
                    .iter()
                    .flat_map(|i| signs.iter().flat_map(move |j| signs.map(|k| Point3::new(i * x, j * y, k * z))))
                    .collect()
            }
            Self::Cylinder { radius_m, half_length_m } => (0..ROUND)
                .flat_map(|k| {
                    let (sin, cos) = circle(k);
                    [-half_length_m, half_length_m].map(|z| Point3::new(radius_m * cos, radius_m * sin, z))
                })
                .collect(),
            // Circles about the three axes of the shape. In any direction of view their hull is close to the outline.
            Self::Sphere { radius_m } => (0..3)
                .flat_map(|axis| (0..ROUND).map(move |k| (axis, k)))
                .map(|(axis, k)| {
                    let (sin, cos) = circle(k);
                    let mut point = Point3::origin();
                    point[axis] = radius_m * cos;
                    point[(axis + 1) % 3] = radius_m * sin;
                    point
                })
                .collect(),
        }
    }
}

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// The corners, m.
    pub points_m: Vec<Point3<f64>>,
    /// Indices of the corners of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Geometry that is only seen.
#[derive(Clone, Debug)]
pub struct Visual {
    /// Pose in the link's frame.
    pub x_lv: Pose,
    /// The geometry.
    pub geometry: VisualGeometry,
    /// Colour that the URDF gives, red green blue alpha, 0 to 1.
    pub rgba: Option<[f64; 4]>,
}

/// The geometry of a [`Visual`].
#[derive(Clone, Debug, PartialEq)]
pub enum VisualGeometry {
    /// A primitive.
    Primitive(Shape),
    /// A mesh, which is read when it is drawn.
    Mesh(MeshFile),
}

/// A mesh that a URDF names.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// The file.
    pub path: PathBuf,
    /// Factors along x, y, z of the file's coordinates.
    pub scale: [f64; 3],
}
