//! The parameters of a gripper's grasp on an edge of the board.

use nalgebra::{Isometry3, Point3, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    board::{BoardShape, Edge, EdgeLine},
    frames::Pose,
    polygon::Point,
};

/// Of the edges of a board the one that a gripper at `x_og` grasps: of those whose outward normal is within about 68 degrees of
/// -z_G, the one that G is least deep inside. The angle of a planned grasp is at most 45 degrees, so its edge always qualifies.
/// `None` if no edge does.
#[must_use]
pub fn grasped_edge(x_og: &Pose, board: &BoardShape) -> Option<Edge> {
    let backward_o = x_og.rotation * -Vector3::z();
    let depth_m = |edge: &EdgeLine| edge.reach_m - edge.outward_o.dot(&x_og.translation.vector);
    let edges = board.edges().map(|edge| (edge, board.edge(edge)));
    let behind = edges.filter(|(_, line)| line.outward_o.dot(&backward_o) > 0.375);
    behind.min_by(|(_, a), (_, b)| depth_m(a).total_cmp(&depth_m(b))).map(|(edge, _)| edge)
}

/// A gripper's grasp on an edge: z_G lies in the board's plane and points inward, y_G along +z_O or -z_O, and G is
/// centred in the thickness (`docs/method.md#25-edge-grasps`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeGrasp {
    /// The grasped edge.
    pub edge: Edge,
    /// Position along the edge from the foot of the perpendicular from O, for a box its middle, m; positive counter-clockwise
    /// seen from +z_O.
    pub along_m: f64,
    /// Distance of G from the edge into the board, along the edge's normal, m.
    pub depth_m: f64,
    /// Rotation about z_O of z_G against the edge's inward normal, rad.
    pub angle_rad: f64,
    /// True if y_G, the axis along which the fingers open, points along -z_O, not +z_O.
    pub flipped: bool,
}

impl EdgeGrasp {
    /// The grasp of a gripper at `x_og`, the inverse of [`EdgeGrasp::x_og`]; `None` if no edge is grasped, see [`grasped_edge`].
    /// What an edge grasp does not express, such as an offset along the board's normal, is lost.
    #[must_use]
    pub fn of(x_og: &Pose, board: &BoardShape) -> Option<Self> {
        let edge = grasped_edge(x_og, board)?;
        let EdgeLine { outward_o, reach_m, .. } = board.edge(edge);
        let p_o = x_og.translation.vector;
        let z_g = x_og.rotation * Vector3::z();
        Some(Self {
            edge,
            along_m: Vector3::z().cross(&outward_o).dot(&p_o),
            depth_m: reach_m - outward_o.dot(&p_o),
            angle_rad: libm::atan2(Vector3::z().dot(&-outward_o.cross(&z_g)), -outward_o.dot(&z_g)),
            flipped: (x_og.rotation * Vector3::y()).z < 0.0,
        })
    }

    /// The gripper's pose `x_og` on a board.
    #[must_use]
    pub fn x_og(&self, board: &BoardShape) -> Pose {
        let EdgeLine { outward_o: outward, reach_m, .. } = board.edge(self.edge);
        let along = Vector3::z().cross(&outward);
        let position = outward * (reach_m - self.depth_m) + along * self.along_m;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.angle_rad);
        let z_g = turn * -outward;
        let y_g = if self.flipped { -Vector3::z() } else { Vector3::z() };
        let rotation = Rotation3::from_basis_unchecked(&[y_g.cross(&z_g), y_g, z_g]);
        Isometry3::from_parts(position.into(), UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

/// The corners of a pad with these sides and this centre along x_G and z_G, in the plane of the board, counter-clockwise seen from
/// +z_O, m.
#[must_use]
pub fn pad_corners_m(x_og: &Pose, size_m: [f64; 2], centre_m: [f64; 2]) -> [Point; 4] {
    let corner = |[side_x, side_z]: [f64; 2]| {
        let x_g = centre_m[0] + side_x * size_m[0] / 2.0;
        let z_g = centre_m[1] + side_z * size_m[1] / 2.0;
        let p_o = x_og * Point3::new(x_g, 0.0, z_g);
        [p_o.x, p_o.y]
    };
    // About y_G the way from z_G to x_G is counter-clockwise.
    let mut corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(corner);
    if (x_og.rotation * Vector3::y()).z < 0.0 {
        corners.reverse();
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::{
        super::{plate::PlateRecord, polygon::AreaMoments},
        *,
    };

    /// A box, a triangle and a hexagon.
    fn boards() -> [BoardShape; 3] {
        let plate =
            |outline_m: Vec<[f64; 2]>| BoardShape::plate(PlateRecord { outline_m, holes_m: Vec::new() }.into(), 0.03);
        let hexagon = (0..6).map(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 6.0);
            [0.3 * cos, 0.3 * sin]
        });
        [
            BoardShape::cuboid([0.5, 0.4, 0.03]),
            plate(vec![[0.4, -0.2], [0.1, 0.3], [-0.3, -0.2]]),
            plate(hexagon.collect()),
        ]
    }

    #[test]
    fn fingers_point_inward_and_straddle_the_thickness() {
        for board in boards() {
            for edge in board.edges() {
                for flipped in [false, true] {
                    let grasp = EdgeGrasp { edge, along_m: 0.05, depth_m: 0.035, angle_rad: 0.3, flipped };
                    let x_og = grasp.x_og(&board);
                    let z_g = x_og.rotation * Vector3::z();
                    let y_g = x_og.rotation * Vector3::y();
                    let read = EdgeGrasp::of(&x_og, &board).unwrap();
                    let pairs = [(read.along_m, 0.05), (read.depth_m, 0.035), (read.angle_rad, 0.3)];
                    assert!(pairs.iter().all(|(found, meant)| (found - meant).abs() < 1e-14), "{read:?}");
                    assert_eq!((read.edge, read.flipped), (edge, flipped));
                    // cos(0.3): the grasp's angle; rounding only.
                    assert!((z_g.dot(&-board.edge(edge).outward_o) - 0.3_f64.cos()).abs() < 1e-14);
                    assert!((y_g.z.abs() - 1.0).abs() < 1e-14);
                    assert_eq!(x_og.translation.vector.z, 0.0);
                }
            }
        }
    }

    #[test]
    fn a_grasp_tells_its_edge() {
        for board in boards() {
            for edge in board.edges() {
                let [low_m, high_m] = board.edge(edge).along_m;
                let middle_m = (low_m + high_m) / 2.0;
                for (angle_rad, aside_m) in [(0.0, 0.0), (0.7, 0.08), (-0.7, 0.08), (0.7, -0.08)] {
                    let along_m = middle_m + aside_m;
                    let grasp = EdgeGrasp { edge, along_m, depth_m: 0.04, angle_rad, flipped: false };
                    assert_eq!(grasped_edge(&grasp.x_og(&board), &board), Some(edge));
                }
            }
        }
    }

    #[test]
    fn a_pad_is_a_rectangle_about_its_centre() {
        let board = BoardShape::cuboid([0.5, 0.4, 0.03]);
        for (edge, flipped) in board.edges().flat_map(|edge| [(edge, false), (edge, true)]) {
            let x_og = EdgeGrasp { edge, along_m: 0.1, depth_m: 0.03, angle_rad: 0.4, flipped }.x_og(&board);
            let moments = AreaMoments::of(&pad_corners_m(&x_og, [0.04, 0.03], [0.001, -0.01]));
            assert!((moments.area_m2 - 0.04 * 0.03).abs() < 1e-15);
            let centre = x_og * Point3::new(0.001, 0.0, -0.01);
            let [x, y] = moments.centroid_m();
            assert!((x - centre.x).abs() < 1e-12 && (y - centre.y).abs() < 1e-12);
        }
    }

    #[test]
    fn depth_is_measured_from_the_edge() {
        let grasp = EdgeGrasp { edge: Edge::PLUS_Y, along_m: 0.0, depth_m: 0.035, angle_rad: 0.0, flipped: false };
        let x_og = grasp.x_og(&BoardShape::cuboid([0.5, 0.4, 0.03]));
        assert!((x_og.translation.vector - Vector3::new(0.0, 0.165, 0.0)).norm() < 1e-15);
    }
}
