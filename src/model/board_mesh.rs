//! The surface of a plate as triangles, for pictures.

use nalgebra::{Point3, Vector3};

use super::{
    plate::Plate,
    polygon::{Point, sides, triangles},
};

/// The surface of a plate: triangles whose corners turn counter-clockwise seen from outside. Every triangle has corners of its
/// own, so that each has the normal of its face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardMesh {
    /// Three corners of each triangle, in O, m.
    pub triangles_o: Vec<[Point3<f64>; 3]>,
}

impl BoardMesh {
    /// The surface of a plate of this thickness, m: both faces with the holes, and the walls of outline and holes.
    #[must_use]
    pub fn new(plate: &Plate, thickness_m: f64) -> Self {
        let half_m = thickness_m / 2.0;
        let at = |[x, y]: Point, z: f64| Point3::new(x, y, z);
        let face = triangles(plate.outline_m(), plate.holes_m());
        let faces = face.iter().flat_map(|&[a, b, c]| {
            [[a, b, c].map(|corner| at(corner, half_m)), [a, c, b].map(|corner| at(corner, -half_m))]
        });
        // Outward of the outline is to the right of its sides, outward of the material in a hole to the left.
        let outline = sides(plate.outline_m());
        let holes = plate.holes_m().iter().flat_map(|hole| sides(hole)).map(|(a, b)| (b, a));
        let walls = outline.chain(holes).flat_map(|(a, b)| {
            let [low_a, low_b, high_a, high_b] = [at(a, -half_m), at(b, -half_m), at(a, half_m), at(b, half_m)];
            [[low_a, low_b, high_b], [low_a, high_b, high_a]]
        });
        Self { triangles_o: faces.chain(walls).collect() }
    }

    /// The outward unit normal of each triangle.
    pub fn normals_o(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.triangles_o.iter().map(|[a, b, c]| (b - a).cross(&(c - a)).normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::{super::plate::PlateRecord, *};
    use crate::model::polygon::circle;

    /// The divergence theorem: a closed surface with outward normals encloses its volume, and its area vectors add up to zero.
    #[test]
    fn the_surface_is_closed_and_encloses_the_volume() {
        let outline_m = vec![[0.3, -0.1], [0.2, 0.2], [-0.1, 0.25], [-0.3, 0.0], [0.0, -0.25]];
        let holes_m = vec![circle([0.1, 0.05], 0.05, 32), vec![[-0.1, 0.0], [0.0, -0.02], [-0.02, -0.1]]];
        let plate = Plate::from(PlateRecord { outline_m, holes_m });
        assert_eq!(plate.check(), Ok(()));
        let mesh = BoardMesh::new(&plate, 0.02);
        let (mut volume_m3, mut area) = (0.0, Vector3::zeros());
        for [a, b, c] in &mesh.triangles_o {
            volume_m3 += a.coords.dot(&b.coords.cross(&c.coords)) / 6.0;
            area += (b - a).cross(&(c - a)) / 2.0;
        }
        // Rounding of some hundred products of lengths below 1 m.
        assert!((volume_m3 - plate.moments().area_m2 * 0.02).abs() < 1e-14, "{volume_m3}");
        assert!(area.norm() < 1e-14);
        assert!(mesh.normals_o().all(|normal| (normal.norm() - 1.0).abs() < 1e-12));
    }
}
