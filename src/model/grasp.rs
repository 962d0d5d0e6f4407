//! The parameters of a gripper's grasp on an edge of the board.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};

use super::frames::Pose;

/// An edge of the board's rectangle, named by the outward axis of O.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Edge {
    /// The edge at +x_O.
    PlusX,
    /// The edge at -x_O.
    MinusX,
    /// The edge at +y_O.
    PlusY,
    /// The edge at -y_O.
    MinusY,
}

impl Edge {
    /// All four edges, counter-clockwise from +x_O.
    pub const ALL: [Self; 4] = [Self::PlusX, Self::PlusY, Self::MinusX, Self::MinusY];

    /// The edge after `quarters` quarter turns about z_O, counter-clockwise seen from +z_O.
    #[must_use]
    pub fn turned(self, quarters: usize) -> Self {
        let place = match self {
            Self::PlusX => 0,
            Self::PlusY => 1,
            Self::MinusX => 2,
            Self::MinusY => 3,
        };
        Self::ALL[(place + quarters) % Self::ALL.len()]
    }

    /// The edge's outward unit normal, in O.
    #[must_use]
    pub fn outward_o(self) -> Vector3<f64> {
        match self {
            Self::PlusX => Vector3::x(),
            Self::MinusX => -Vector3::x(),
            Self::PlusY => Vector3::y(),
            Self::MinusY => -Vector3::y(),
        }
    }

    /// The edge that a gripper at `x_og` grasps: of the edges whose outward normal is within about 68 degrees of -z_G, the
    /// one that G is least deep inside. The angle of a planned grasp is at most 45 degrees, so its edge always
    /// qualifies. `None` if no edge does.
    #[must_use]
    pub fn of(x_og: &Pose, size_m: [f64; 3]) -> Option<Self> {
        let backward_o = x_og.rotation * -Vector3::z();
        let depth_m =
            |edge: &Self| edge.reach_and_half_length_m(size_m).0 - edge.outward_o().dot(&x_og.translation.vector);
        let behind = Self::ALL.into_iter().filter(|edge| edge.outward_o().dot(&backward_o) > 0.375);
        behind.min_by(|a, b| depth_m(a).total_cmp(&depth_m(b)))
    }

    /// Distance from the board's centre to the edge and half the edge's length, m.
    #[must_use]
    pub fn reach_and_half_length_m(self, size_m: [f64; 3]) -> (f64, f64) {
        match self {
            Self::PlusX | Self::MinusX => (size_m[0] / 2.0, size_m[1] / 2.0),
            Self::PlusY | Self::MinusY => (size_m[1] / 2.0, size_m[0] / 2.0),
        }
    }
}

impl std::fmt::Display for Edge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
        })
    }
}

/// A gripper's grasp on an edge: z_G lies in the board's plane and points inward, y_G along +z_O or -z_O, and G is
/// centred in the thickness (`docs/method.md#25-edge-grasps`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeGrasp {
    /// The grasped edge.
    pub edge: Edge,
    /// Position along the edge from its middle, m; positive counter-clockwise seen from +z_O.
    pub along_m: f64,
    /// Distance of G from the edge into the board, along the edge's normal, m.
    pub depth_m: f64,
    /// Rotation about z_O of z_G against the edge's inward normal, rad.
    pub angle_rad: f64,
    /// True if y_G, the axis along which the fingers open, points along -z_O, not +z_O.
    pub flipped: bool,
}

impl EdgeGrasp {
    /// The gripper's pose `x_og` on a board of `size_m`.
    #[must_use]
    pub fn x_og(&self, size_m: [f64; 3]) -> Pose {
        let outward = self.edge.outward_o();
        let along = Vector3::z().cross(&outward);
        let (reach_m, _) = self.edge.reach_and_half_length_m(size_m);
        let position = outward * (reach_m - self.depth_m) + along * self.along_m;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.angle_rad);
        let z_g = turn * -outward;
        let y_g = if self.flipped { -Vector3::z() } else { Vector3::z() };
        let rotation = Rotation3::from_basis_unchecked(&[y_g.cross(&z_g), y_g, z_g]);
        Isometry3::from_parts(position.into(), UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingers_point_inward_and_straddle_the_thickness() {
        for edge in Edge::ALL {
            for flipped in [false, true] {
                let grasp = EdgeGrasp { edge, along_m: 0.05, depth_m: 0.035, angle_rad: 0.3, flipped };
                let x_og = grasp.x_og([0.5, 0.4, 0.03]);
                let z_g = x_og.rotation * Vector3::z();
                let y_g = x_og.rotation * Vector3::y();
                // cos(0.3): the grasp's angle; rounding only.
                assert!((z_g.dot(&-edge.outward_o()) - 0.3_f64.cos()).abs() < 1e-14);
                assert!((y_g.z.abs() - 1.0).abs() < 1e-14);
                assert_eq!(x_og.translation.vector.z, 0.0);
            }
        }
    }

    #[test]
    fn an_edge_turns_as_its_outward_normal_does() {
        let quarter = Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        for edge in Edge::ALL {
            assert!((quarter * edge.outward_o() - edge.turned(1).outward_o()).norm() < 1e-15);
            assert_eq!(edge.turned(1).turned(3), edge);
            assert_eq!(edge.turned(2).outward_o(), -edge.outward_o());
        }
    }

    #[test]
    fn a_grasp_tells_its_edge() {
        for edge in Edge::ALL {
            for (angle_rad, along_m) in [(0.0, 0.0), (0.7, 0.1), (-0.7, 0.1), (0.7, -0.1)] {
                let grasp = EdgeGrasp { edge, along_m, depth_m: 0.04, angle_rad, flipped: false };
                assert_eq!(Edge::of(&grasp.x_og([0.5, 0.4, 0.03]), [0.5, 0.4, 0.03]), Some(edge));
            }
        }
    }

    #[test]
    fn depth_is_measured_from_the_edge() {
        let grasp = EdgeGrasp { edge: Edge::PlusY, along_m: 0.0, depth_m: 0.035, angle_rad: 0.0, flipped: false };
        assert!((grasp.x_og([0.5, 0.4, 0.03]).translation.vector - Vector3::new(0.0, 0.165, 0.0)).norm() < 1e-15);
    }
}
