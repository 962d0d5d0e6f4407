//! Where boards and grasps are sampled (docs/method.md#36-search-domain, docs/method.md#25-edge-grasps).

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

use super::params::library::OPPOSITE_EDGE;
use crate::{
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
    },
    robot::Gripper,
};

/// Depth of the gripper's origin inside the edge, m (docs/method.md#25-edge-grasps).
pub const DEPTH_M: [f64; 2] = [0.020, 0.060];
/// Angle of the gripper in the board's plane, rad (docs/method.md#25-edge-grasps).
pub const ANGLE_RAD: [f64; 2] = [-FRAC_PI_4, FRAC_PI_4];

/// The poses of the board that the search considers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchDomain {
    /// Range of the board's centre along x_W, m.
    pub x_m: [f64; 2],
    /// Range along y_W, m.
    pub y_m: [f64; 2],
    /// Range along z_W, m.
    pub z_m: [f64; 2],
    /// Largest angle between the worked face's normal and the person's side, +x_W, rad.
    pub facing_rad: f64,
}

impl SearchDomain {
    /// The domain of Baxter (docs/method.md#36-search-domain).
    pub const BAXTER: Self = Self {
        x_m: [0.35, 0.85],
        y_m: [-0.25, 0.25],
        z_m: [-0.3, 0.6],
        facing_rad: 100.0 * std::f64::consts::PI / 180.0,
    };

    /// True if the board's centre and worked face are in the domain.
    pub fn contains(&self, x_wo: &Pose) -> bool {
        let p_wo = x_wo.translation.vector;
        let within = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
        within(p_wo.x, self.x_m)
            && within(p_wo.y, self.y_m)
            && within(p_wo.z, self.z_m)
            && self.facing_margin(x_wo) >= 0.0
    }

    /// Margin of the worked face's normal in the cone about the person's side, as a difference of cosines; negative outside.
    pub fn facing_margin(&self, x_wo: &Pose) -> f64 {
        (x_wo.rotation * Vector3::z()).x - self.facing_rad.cos()
    }

    /// A pose of the board, uniformly distributed in the domain.
    pub fn draw_board(&self, random: &mut Pcg64) -> Pose {
        let p_wo = [self.x_m, self.y_m, self.z_m].map(|[low, high]| uniform(random, low, high));
        loop {
            // A uniform point of the unit ball in four dimensions gives a uniform rotation.
            let [x, y, z, w] = std::array::from_fn(|_| uniform(random, -1.0, 1.0));
            let quaternion = Quaternion::new(w, x, y, z);
            if !(0.01..=1.0).contains(&quaternion.norm_squared()) {
                continue;
            }
            let x_wo = Isometry3::from_parts(p_wo.into(), UnitQuaternion::from_quaternion(quaternion));
            if self.facing_margin(&x_wo) >= 0.0 {
                return x_wo;
            }
        }
    }
}

/// A uniformly distributed number between two others.
pub fn uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// A uniformly distributed edge.
pub fn draw_edge(random: &mut Pcg64) -> Edge {
    Edge::ALL[random.random_range(0..Edge::ALL.len())]
}

/// The edge of a further gripper: opposite to the first one's, or the same (docs/method.md#25-edge-grasps).
pub fn draw_other_edge(edge: Edge, random: &mut Pcg64) -> Edge {
    if random.random_bool(OPPOSITE_EDGE) { edge.turned(2) } else { edge }
}

/// A uniformly distributed grasp on an edge; its pads may lie partly off the board.
pub fn draw_grasp(edge: Edge, size_m: [f64; 3], random: &mut Pcg64) -> EdgeGrasp {
    let (_, half_length_m) = edge.reach_and_half_length_m(size_m);
    EdgeGrasp {
        edge,
        along_m: uniform(random, -half_length_m, half_length_m),
        depth_m: uniform(random, DEPTH_M[0], DEPTH_M[1]),
        angle_rad: uniform(random, ANGLE_RAD[0], ANGLE_RAD[1]),
        flipped: random.random_bool(0.5),
    }
}

/// True if every corner of the gripper's pads lies on the board's face.
pub fn pads_on_board(gripper: &Gripper, grasp: &EdgeGrasp, size_m: [f64; 3]) -> bool {
    pad_margins_m(gripper, grasp, size_m).iter().all(|&margin_m| margin_m >= 0.0)
}

/// Distance of the pads' outermost corner inside each edge of the board, m: +x_O, -x_O, +y_O, -y_O; negative outside.
pub fn pad_margins_m(gripper: &Gripper, grasp: &EdgeGrasp, size_m: [f64; 3]) -> [f64; 4] {
    let x_og = grasp.x_og(size_m);
    let pad = &gripper.fingers[0].pad;
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    corners.iter().fold([f64::INFINITY; 4], |margins_m, [side_x, side_z]| {
        let x_g = pad.centre_m[0] + side_x * pad.size_m[0] / 2.0;
        let z_g = pad.centre_m[1] + side_z * pad.size_m[1] / 2.0;
        let p_o = x_og * Point3::new(x_g, 0.0, z_g);
        let [half_x_m, half_y_m, _] = size_m.map(|side_m| side_m / 2.0);
        let corner_m = [half_x_m - p_o.x, half_x_m + p_o.x, half_y_m - p_o.y, half_y_m + p_o.y];
        std::array::from_fn(|side| margins_m[side].min(corner_m[side]))
    })
}
