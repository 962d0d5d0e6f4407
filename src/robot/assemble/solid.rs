//! Bodies of grippers that the URDF does not have: one shape with its mass.

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};

use crate::robot::{
    geometry::{PlacedShape, Shape, Visual, VisualGeometry},
    tree::Link,
};

/// A jaw or a cup.
pub(super) struct Solid {
    pub shape: Shape,
    pub mass_kg: f64,
    /// Moments of inertia about the centre along the axes of the link, kg m^2.
    pub inertia: [f64; 3],
    pub rgba: [f64; 4],
}

impl Solid {
    /// Makes this the body of an empty link, with its centre there, m.
    pub fn add_to(self, link: &mut Link, centre_l: Vector3<f64>) {
        let Self { shape, mass_kg, inertia, rgba } = self;
        let x_ls = Isometry3::from(Translation3::from(centre_l));
        (link.mass_kg, link.com_l) = (mass_kg, centre_l);
        link.inertia_l = Matrix3::from_diagonal(&inertia.into());
        let geometry = VisualGeometry::Primitive(shape.clone());
        link.visuals.push(Visual { x_lv: x_ls, geometry, rgba: Some(rgba) });
        link.shapes.push(PlacedShape { x_ls, shape, rgba });
    }
}
