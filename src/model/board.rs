//! The shape of a board: a box, or a plate with a convex outline and holes; the board with its mass at a pose.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseForm, pose},
    plate::{OutlineSide, Plate},
    polygon::Point,
};

/// An edge of a board by its number, counter-clockwise. Of a box: 0 is at +x_O, 1 at +y_O, 2 at -x_O, 3 at -y_O; of a plate: the
/// side from that corner of the outline to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Edge(pub usize);

impl Edge {
    /// The edge of a box at +x_O.
    pub const PLUS_X: Self = Self(0);
    /// The edge of a box at +y_O.
    pub const PLUS_Y: Self = Self(1);
    /// The edge of a box at -x_O.
    pub const MINUS_X: Self = Self(2);
    /// The edge of a box at -y_O.
    pub const MINUS_Y: Self = Self(3);
}

/// Where an edge of a board is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLine {
    /// Outward unit normal, in O.
    pub outward_o: Vector3<f64>,
    /// Distance of its line from O, m.
    pub reach_m: f64,
    /// Its ends in the direction `z_O x outward_o`, from the foot of the perpendicular from O, m.
    pub along_m: [f64; 2],
}

/// The shape of a board.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardShape {
    /// Sides of the box, or of the plate's bounding box, m: width, height, thickness.
    pub size_m: [f64; 3],
    /// The outline and the holes; `None` for a box about O.
    pub plate: Option<Plate>,
}

/// A rectangle in the plane of a board that contains it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardRectangle {
    /// Its axes and centre in O: x along the outward normal of an edge.
    pub x_or: Pose,
    /// Half of its sides, m.
    pub half_m: [f64; 2],
}

/// Numbers of quarter turns that differ.
pub const QUARTERS: usize = 4;

impl BoardShape {
    /// A box about O with these sides, m.
    #[must_use]
    pub fn cuboid(size_m: [f64; 3]) -> Self {
        Self { size_m, plate: None }
    }

    /// A plate with this thickness, m.
    #[must_use]
    pub fn plate(plate: Plate, thickness_m: f64) -> Self {
        let [low_m, high_m] = plate.bounds_m();
        Self { size_m: [high_m[0] - low_m[0], high_m[1] - low_m[1], thickness_m], plate: Some(plate) }
    }

    /// Thickness, m.
    #[must_use]
    pub fn thickness_m(&self) -> f64 {
        self.size_m[2]
    }

    /// Volume, m^3.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        match &self.plate {
            None => self.size_m.iter().product::<f64>(),
            Some(plate) => plate.moments().area_m2 * self.size_m[2],
        }
    }

    /// The centroid in O, m: the centre of mass if the density is uniform.
    #[must_use]
    pub fn centroid_o(&self) -> Vector3<f64> {
        self.plate.as_ref().map_or_else(Vector3::zeros, |plate| {
            let [x, y] = plate.moments().centroid_m();
            Vector3::new(x, y, 0.0)
        })
    }

    /// The inertia about the centroid in O axes for a uniform density of this mass, kg m^2.
    #[must_use]
    pub fn inertia_o(&self, mass_kg: f64) -> Matrix3<f64> {
        let Some(plate) = &self.plate else {
            let [x, y, z] = self.size_m.map(|side| side * side * mass_kg / 12.0);
            return Matrix3::from_diagonal(&Vector3::new(y + z, x + z, x + y));
        };
        let [xx, yy, xy] = plate.moments().central_m2().map(|moment_m2| moment_m2 * mass_kg);
        let zz = self.size_m[2] * self.size_m[2] * mass_kg / 12.0;
        Matrix3::new(yy + zz, -xy, 0.0, -xy, xx + zz, 0.0, 0.0, 0.0, xx + yy)
    }

    /// True if a point is within the outline, holes included, and the thickness.
    #[must_use]
    pub fn surrounds(&self, p_o: &Vector3<f64>) -> bool {
        let line_m = |line: EdgeLine| line.reach_m - line.outward_o.dot(p_o);
        self.edges().all(|edge| line_m(self.edge(edge)) >= 0.0) && p_o.z.abs() <= self.size_m[2] / 2.0
    }

    /// All edges, counter-clockwise.
    pub fn edges(&self) -> impl Iterator<Item = Edge> + use<> {
        (0..self.plate.as_ref().map_or(QUARTERS, |plate| plate.sides().len())).map(Edge)
    }

    /// Where an edge is.
    #[must_use]
    pub fn edge(&self, edge: Edge) -> EdgeLine {
        if let Some(plate) = &self.plate {
            let OutlineSide { outward: [x, y], reach_m, along_m } = plate.sides()[edge.0 % plate.sides().len()];
            return EdgeLine { outward_o: Vector3::new(x, y, 0.0), reach_m, along_m };
        }
        let outward_o = match edge.0 % QUARTERS {
            0 => Vector3::x(),
            1 => Vector3::y(),
            2 => -Vector3::x(),
            _ => -Vector3::y(),
        };
        let axis = edge.0 % 2;
        let half_m = self.size_m[1 - axis] / 2.0;
        EdgeLine { outward_o, reach_m: self.size_m[axis] / 2.0, along_m: [-half_m, half_m] }
    }

    /// The name of an edge: `+x` of a box, `edge 2` of a plate.
    #[must_use]
    pub fn edge_name(&self, edge: Edge) -> String {
        match (&self.plate, edge.0 % QUARTERS) {
            (Some(_), _) => format!("edge {}", edge.0),
            (None, 0) => "+x".into(),
            (None, 1) => "+y".into(),
            (None, 2) => "-x".into(),
            (None, _) => "-y".into(),
        }
    }

    /// The edge that is where `edge` was after the board has turned by quarters about z_O, counter-clockwise; `None` if the
    /// outline is another one then. A box counts as the same after any quarter, though its sides are exchanged.
    #[must_use]
    pub fn turned(&self, edge: Edge, quarters: usize) -> Option<Edge> {
        match &self.plate {
            None => Some(Edge((edge.0 + quarters) % QUARTERS)),
            Some(plate) => plate.shift_by_quarters(quarters).map(|shift| Edge((edge.0 + shift) % plate.sides().len())),
        }
    }

    /// True if the board counts as the same after it has turned by quarters, see [`BoardShape::turned`].
    #[must_use]
    pub fn turns(&self, quarters: usize) -> bool {
        self.turned(Edge(0), quarters).is_some()
    }

    /// The centre of the bounding rectangle in O, m.
    #[must_use]
    pub fn centre_m(&self) -> Point {
        self.plate.as_ref().map_or([0.0; 2], |plate| {
            let [low_m, high_m] = plate.bounds_m();
            [0, 1].map(|axis| (low_m[axis] + high_m[axis]) / 2.0)
        })
    }

    /// Of these edges the one whose outward normal is most opposite to that of `edge`; `edge` itself if there is no other.
    #[must_use]
    pub fn most_opposite(&self, edge: Edge, among: &[Edge]) -> Edge {
        let outward_o = self.edge(edge).outward_o;
        let along = |other: &Edge| self.edge(*other).outward_o.dot(&outward_o);
        among
            .iter()
            .copied()
            .filter(|other| *other != edge)
            .min_by(|a, b| along(a).total_cmp(&along(b)))
            .unwrap_or(edge)
    }

    /// Corners of the outline on both faces, in O, m.
    #[must_use]
    pub fn corners_o(&self) -> Vec<Point3<f64>> {
        let half_m = self.size_m[2] / 2.0;
        let outline = self.outline_m();
        outline.iter().flat_map(|[x, y]| [-half_m, half_m].map(|z| Point3::new(*x, *y, z))).collect()
    }

    /// The corners of the outline, counter-clockwise, m.
    #[must_use]
    pub fn outline_m(&self) -> Vec<Point> {
        let [x, y, _] = self.size_m.map(|side| side / 2.0);
        self.plate.as_ref().map_or_else(|| vec![[x, -y], [x, y], [-x, y], [-x, -y]], |plate| plate.outline_m().to_vec())
    }

    /// The smallest rectangle along an edge that contains the outline. The edge is part of one of its sides.
    #[must_use]
    pub fn rectangle_at(&self, edge: Edge) -> BoardRectangle {
        let EdgeLine { outward_o, reach_m, .. } = self.edge(edge);
        let along_o = Vector3::z().cross(&outward_o);
        let corners = self.outline_m();
        let extent = |axis: &Vector3<f64>| {
            let along = corners.iter().map(|[x, y]| axis.x * x + axis.y * y);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], m| [low.min(m), high.max(m)])
        };
        let ([deepest_m, _], [low_m, high_m]) = (extent(&outward_o), extent(&along_o));
        let centre_o = outward_o * ((reach_m + deepest_m) / 2.0) + along_o * ((low_m + high_m) / 2.0);
        let rotation = Rotation3::from_basis_unchecked(&[outward_o, along_o, Vector3::z()]);
        BoardRectangle {
            x_or: Isometry3::from_parts(centre_o.into(), UnitQuaternion::from_rotation_matrix(&rotation)),
            half_m: [(reach_m - deepest_m) / 2.0, (high_m - low_m) / 2.0],
        }
    }
}

/// The board and its pose.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacedObject {
    /// Width, height and thickness along x_O, y_O, z_O, m; of a plate those of its bounding box.
    pub size_m: [f64; 3],
    /// Outline and holes of a plate; without them the board is a box about O.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plate: Option<Plate>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in O, m; by default the centroid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub com_m: Option<[f64; 3]>,
    /// Pose of the board in W.
    #[serde(with = "pose")]
    #[schemars(with = "PoseForm")]
    pub x_wo: Pose,
}

impl PlacedObject {
    /// A box about O of uniform density.
    #[must_use]
    pub fn cuboid(size_m: [f64; 3], mass_kg: f64, x_wo: Pose) -> Self {
        Self { size_m, plate: None, mass_kg, com_m: None, x_wo }
    }

    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> BoardShape {
        BoardShape { size_m: self.size_m, plate: self.plate.clone() }
    }

    /// True for a box whose centre of mass is at O.
    #[must_use]
    pub fn is_uniform_box(&self) -> bool {
        self.plate.is_none() && self.com_m.is_none()
    }

    /// The centre of mass in O, m.
    #[must_use]
    pub fn com_o(&self) -> Vector3<f64> {
        self.com_m.map_or_else(|| self.shape().centroid_o(), Vector3::from)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::plate::PlateRecord, *};

    const SIZE_M: [f64; 3] = [0.5, 0.4, 0.03];

    fn as_plate(outline_m: Vec<Point>) -> BoardShape {
        BoardShape::plate(PlateRecord { outline_m, holes_m: Vec::new() }.into(), SIZE_M[2])
    }

    #[test]
    fn a_box_and_its_outline_are_the_same_board() {
        let cuboid = BoardShape::cuboid(SIZE_M);
        let plate = as_plate(cuboid.outline_m());
        assert_eq!(plate.size_m, SIZE_M);
        // Rounding of products of lengths below 1 m and masses of 1 kg.
        assert!((plate.volume_m3() - cuboid.volume_m3()).abs() < 1e-15);
        assert!((plate.inertia_o(2.0) - cuboid.inertia_o(2.0)).norm() < 1e-14);
        assert!((plate.centroid_o() - cuboid.centroid_o()).norm() < 1e-15);
        assert_eq!(plate.corners_o(), cuboid.corners_o());
        for (one, other) in plate.edges().zip(cuboid.edges()) {
            assert_eq!(plate.edge(one), cuboid.edge(other));
            assert_eq!(plate.turned(one, 2), cuboid.turned(other, 2));
            let rectangle = plate.rectangle_at(one);
            assert!((rectangle.half_m[0] * rectangle.half_m[1] - 0.05).abs() < 1e-15);
        }
        assert_eq!((plate.turned(Edge(0), 1), cuboid.turned(Edge(0), 1)), (None, Some(Edge(1))));
    }

    #[test]
    fn an_edge_of_a_box_turns_as_its_outward_normal_does() {
        let board = BoardShape::cuboid(SIZE_M);
        let quarter = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        for edge in board.edges() {
            let next = board.turned(edge, 1).unwrap();
            assert!((quarter * board.edge(edge).outward_o - board.edge(next).outward_o).norm() < 1e-15);
            assert_eq!(board.turned(next, 3), Some(edge));
            let all: Vec<_> = board.edges().collect();
            assert_eq!(Some(board.most_opposite(edge, &all)), board.turned(edge, 2));
        }
    }

    #[test]
    fn the_most_opposite_edge_of_a_triangle_is_one_of_the_others() {
        let triangle = as_plate(vec![[0.2, -0.1], [0.0, 0.3], [-0.2, -0.1]]);
        let all: Vec<_> = triangle.edges().collect();
        for edge in triangle.edges() {
            let opposite = triangle.most_opposite(edge, &all);
            assert_ne!(opposite, edge);
            assert!(triangle.edge(edge).outward_o.dot(&triangle.edge(opposite).outward_o) < 0.0);
            assert_eq!(triangle.most_opposite(edge, &[edge]), edge);
        }
    }

    /// The inertia of a prism is that of its triangles.
    #[test]
    fn the_inertia_is_that_of_boxes_cut_along_the_thickness() {
        // Two halves of a rectangle along its diagonal have together the inertia of the whole.
        let [x, y, _] = SIZE_M.map(|side| side / 2.0);
        let halves = [vec![[x, -y], [x, y], [-x, -y]], vec![[x, y], [-x, y], [-x, -y]]].map(as_plate);
        let about_o = |half: &BoardShape| {
            let com = half.centroid_o();
            half.inertia_o(1.0) + (Matrix3::identity() * com.norm_squared() - com * com.transpose())
        };
        let sum = about_o(&halves[0]) + about_o(&halves[1]);
        assert!((sum - BoardShape::cuboid(SIZE_M).inertia_o(2.0)).norm() < 1e-15);
    }

    #[test]
    fn a_rectangle_at_an_edge_contains_the_outline() {
        let hexagon: Vec<Point> = (0..6)
            .map(|k| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * (f64::from(k) + 0.3) / 6.0);
                [0.25 * cos + 0.02, 0.2 * sin - 0.01]
            })
            .collect();
        let board = as_plate(hexagon);
        for edge in board.edges() {
            let BoardRectangle { x_or, half_m } = board.rectangle_at(edge);
            let corners_r: Vec<_> = board.corners_o().iter().map(|corner| x_or.inverse() * corner).collect();
            assert!(corners_r.iter().all(|p| p.x.abs() < half_m[0] + 1e-12 && p.y.abs() < half_m[1] + 1e-12));
            // Two corners of each face are on the edge.
            assert_eq!(corners_r.iter().filter(|p| (p.x - half_m[0]).abs() < 1e-12).count(), 4);
        }
    }
}
