//! Where boards and grasps are sampled (docs/method.md#36-search-domain, docs/method.md#25-edge-grasps).

use std::f64::consts::FRAC_PI_4;

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

use super::params::library::{OPPOSITE_EDGE, PAD_TO_HOLE_M};
use crate::{
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::{EdgeGrasp, pad_corners_m},
    },
    robot::{Chain, Finger, Gripper, SearchBox},
};

/// Depth of the gripper's origin inside the edge, m, of a gripper whose palm allows it (docs/method.md#25-edge-grasps).
pub const DEPTH_M: [f64; 2] = [0.020, 0.060];
/// Angle of the gripper in the board's plane, rad (docs/method.md#25-edge-grasps).
pub const ANGLE_RAD: [f64; 2] = [-FRAC_PI_4, FRAC_PI_4];

/// Distance of the board's centre in front of the shoulders, as a share of the arms' reach: nearer, the forearms do not fit
/// between board and torso; farther, few orientations of the board are reached.
const AHEAD: [f64; 2] = [0.20, 0.55];
/// Distance of the board's centre to the side of the shoulders' middle, as a share of the arms' reach: both arms reach there.
const ASIDE: f64 = 0.18;
/// Height of the board's centre above or below the shoulders, as a share of the arms' reach.
const ABOVE: f64 = 0.55;
/// Height of the board's centre above the floor that the person stands on, m: from the hip of a short person (0.4 x 1.55 m) to
/// the eyes of a person of 1.62 m.
const WORK_HEIGHT_M: [f64; 2] = [0.62, 1.52];
/// The domain's bounds are multiples of 1 / `PER_M` m, so that they are independent of rounding.
const PER_M: f64 = 20.0;
/// The worked face may turn this far from the person's side, +x_W: beyond a right angle, so that a person beside the robot can
/// work on it, rad.
const FACING_RAD: f64 = 100.0 * std::f64::consts::PI / 180.0;

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
    /// The domain of a robot with these arms: a box in front of the shoulders and at the person's working height. The arms'
    /// reach is the shortest one's, from its first joint to the gripper.
    ///
    /// A box of the robot's description comes first.
    pub fn of<'c>(arms: impl Iterator<Item = &'c Chain> + Clone, floor_z_m: f64, given: Option<SearchBox>) -> Self {
        if let Some(SearchBox { x_m, y_m, z_m }) = given {
            return Self { x_m, y_m, z_m, facing_rad: FACING_RAD };
        }
        let count = arms.clone().count().max(1) as f64;
        let shoulders_m = arms.clone().map(Chain::shoulder_w).sum::<Vector3<f64>>() / count;
        let reach_m = arms.map(Chain::reach_m).fold(f64::INFINITY, f64::min);
        let reach_m = if reach_m.is_finite() { reach_m } else { 0.0 };
        let rounded = |bounds: [f64; 2]| bounds.map(|v: f64| (v * PER_M).round() / PER_M);
        let [low_m, high_m] = WORK_HEIGHT_M.map(|height_m| floor_z_m + height_m);
        Self {
            x_m: rounded(AHEAD.map(|share| shoulders_m.x + share * reach_m)),
            y_m: rounded([-ASIDE, ASIDE].map(|share| shoulders_m.y + share * reach_m)),
            z_m: rounded([low_m.max(shoulders_m.z - ABOVE * reach_m), high_m.min(shoulders_m.z + ABOVE * reach_m)]),
            facing_rad: FACING_RAD,
        }
    }

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

/// The edges of a board that the search grasps: all four of a box, of a plate those at least as long as the narrowest pad of the
/// grippers is wide.
pub fn graspable_edges<'g>(board: &BoardShape, grippers: impl Iterator<Item = &'g Gripper>) -> Vec<Edge> {
    let fingers = grippers.filter_map(|gripper| gripper.fingers.first());
    let narrowest_m = fingers.map(|finger| finger.pad.size_m[0]).fold(f64::INFINITY, f64::min);
    let is_long = |edge: &Edge| {
        let [low_m, high_m] = board.edge(*edge).along_m;
        board.plate.is_none() || high_m - low_m >= narrowest_m
    };
    board.edges().filter(is_long).collect()
}

/// A uniformly distributed one of these edges; `None` if there is no edge.
pub fn draw_edge(edges: &[Edge], random: &mut Pcg64) -> Option<Edge> {
    (!edges.is_empty()).then(|| edges[random.random_range(0..edges.len())])
}

/// The edge of a further gripper: opposite to the first one's, or the same (docs/method.md#25-edge-grasps).
pub fn draw_other_edge(edge: Edge, opposite: Edge, random: &mut Pcg64) -> Edge {
    if random.random_bool(OPPOSITE_EDGE) { opposite } else { edge }
}

/// A uniformly distributed grasp on an edge with a depth in this range, m; its pads may lie partly off the board.
pub fn draw_grasp(edge: Edge, board: &BoardShape, depth_m: [f64; 2], random: &mut Pcg64) -> EdgeGrasp {
    let [low_m, high_m] = board.edge(edge).along_m;
    EdgeGrasp {
        edge,
        along_m: uniform(random, low_m, high_m),
        depth_m: uniform(random, depth_m[0], depth_m[1]),
        angle_rad: uniform(random, ANGLE_RAD[0], ANGLE_RAD[1]),
        flipped: random.random_bool(0.5),
    }
}

/// True if the gripper's pads lie on the material of the board's face.
pub fn pads_on_board(gripper: &Gripper, grasp: &EdgeGrasp, board: &BoardShape) -> bool {
    pad_margins_m(gripper, grasp, board).iter().all(|&margin_m| margin_m >= 0.0)
}

/// Distance of the pads' outermost corner inside each edge of the board, m, negative outside: of a box +x_O, -x_O, +y_O, -y_O;
/// of a plate its edges in order, then what the pads keep from the convex hull of each hole beyond [`PAD_TO_HOLE_M`].
pub fn pad_margins_m(gripper: &Gripper, grasp: &EdgeGrasp, board: &BoardShape) -> Vec<f64> {
    // A suction cup has no pads, and so no margin.
    let Some(Finger { pad, .. }) = gripper.fingers.first() else { return vec![f64::NEG_INFINITY] };
    let corners_m = pad_corners_m(&grasp.x_og(board), pad.size_m, pad.centre_m);
    if let Some(plate) = &board.plate {
        let mut margins_m = plate.patch_margins_m(&corners_m);
        margins_m.iter_mut().skip(plate.sides().len()).for_each(|margin_m| *margin_m -= PAD_TO_HOLE_M);
        return margins_m;
    }
    let [half_x_m, half_y_m, _] = board.size_m.map(|side_m| side_m / 2.0);
    let margins_m = corners_m.iter().fold([f64::INFINITY; 4], |margins_m, [x_m, y_m]| {
        let corner_m = [half_x_m - x_m, half_x_m + x_m, half_y_m - y_m, half_y_m + y_m];
        std::array::from_fn(|side| margins_m[side].min(corner_m[side]))
    });
    margins_m.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{
            plate::{Plate, PlateRecord, ROUND_SIDES},
            polygon::circle,
        },
        reproduce::paper,
        robot::Robot,
    };

    fn domain(robot: &Robot) -> SearchDomain {
        let chains: Vec<_> = (0..robot.arms.len()).map(|arm| Chain::new(robot, arm, 0.0)).collect();
        SearchDomain::of(chains.iter(), robot.floor_z_m, robot.search_box)
    }

    /// The box that was chosen for Baxter by hand, from where boards can be held: x 0.35 to 0.85, y -0.25 to 0.25, z -0.3 to
    /// 0.6 m. The shares of the reach reproduce it to 1 cm before rounding, and exactly after it.
    #[test]
    fn the_domain_of_baxter_is_the_one_chosen_by_hand() {
        let baxter = domain(&paper::printed_operations()[0].load().unwrap().robot);
        assert_eq!((baxter.x_m, baxter.y_m, baxter.z_m), ([0.35, 0.85], [-0.25, 0.25], [-0.3, 0.6]));
    }

    #[test]
    fn the_working_height_follows_the_floor() {
        let robot = paper::printed_operations()[0].load().unwrap().robot;
        let mut moved = robot.clone();
        moved.floor_z_m -= 0.1;
        let [here, there] = [&robot, &moved].map(domain);
        assert_eq!((here.x_m, here.y_m), (there.x_m, there.y_m));
        assert_eq!(there.z_m, [-0.4, 0.5]);
    }

    /// A convex polygon about O: a regular one with displaced corners, stretched; up to ten corners.
    fn drawn_outline(random: &mut Pcg64) -> Vec<[f64; 2]> {
        let count = random.random_range(3..=10);
        let [width_m, height_m] = [0.0; 2].map(|_| uniform(random, 0.15, 0.5));
        let corner = |k: usize| {
            let turn_rad = std::f64::consts::TAU * (k as f64 + uniform(random, -0.3, 0.3)) / count as f64;
            let (sin, cos) = libm::sincos(turn_rad);
            [width_m * cos, height_m * sin]
        };
        (0..count).map(corner).collect()
    }

    /// On hundreds of convex plates with a hole: a grasp whose margins are not negative has its whole pads on the material, at
    /// points that are tested one by one, and one with a negative margin is near to something.
    #[test]
    fn drawn_grasps_have_their_pads_on_the_material() {
        let robot = paper::printed_operations()[0].load().unwrap().robot;
        let gripper = &robot.arms[0].gripper;
        let pad = &gripper.fingers[0].pad;
        let mut random = Pcg64::new(18, 0);
        let (mut plates, mut on, mut off) = (0, 0, 0);
        while plates < 300 {
            let outline_m = drawn_outline(&mut random);
            let hole =
                circle([uniform(&mut random, -0.05, 0.05), uniform(&mut random, -0.05, 0.05)], 0.03, ROUND_SIDES);
            let plate = Plate::from(PlateRecord { outline_m, holes_m: vec![hole] });
            if plate.check().is_err() {
                continue;
            }
            plates += 1;
            let board = BoardShape::plate(plate.clone(), 0.02);
            let edges = graspable_edges(&board, std::iter::once(gripper));
            for _ in 0..20 {
                let Some(edge) = draw_edge(&edges, &mut random) else { continue };
                let grasp = draw_grasp(edge, &board, DEPTH_M, &mut random);
                let margins_m = pad_margins_m(gripper, &grasp, &board);
                assert_eq!(margins_m.len(), plate.sides().len() + 1);
                let x_og = grasp.x_og(&board);
                let depths_m = (0..=8).flat_map(|i| (0..=8).map(move |j| [i, j])).map(|[i, j]| {
                    let along =
                        |side: usize, step: i32| pad.centre_m[side] + pad.size_m[side] * (f64::from(step) / 8.0 - 0.5);
                    let p_o = x_og * nalgebra::Point3::new(along(0, i), 0.0, along(1, j));
                    plate.depth_m([p_o.x, p_o.y])
                });
                let least_m = depths_m.fold(f64::INFINITY, f64::min);
                if pads_on_board(gripper, &grasp, &board) {
                    assert!(least_m > -1e-12, "{least_m}");
                    on += 1;
                } else {
                    // A grid of 5 mm and the distance that pads keep from a hole.
                    assert!(least_m < 0.005 + PAD_TO_HOLE_M, "{least_m}");
                    off += 1;
                }
            }
        }
        assert!(on > 300 && off > 300, "{on} {off}");
    }

    #[test]
    fn edges_that_are_shorter_than_a_pad_are_left_out() {
        let robot = paper::printed_operations()[0].load().unwrap().robot;
        let edges_of = |board: &BoardShape| graspable_edges(board, robot.arms.iter().map(|arm| &arm.gripper));
        let outline_m = vec![[0.2, -0.2], [0.2, 0.18], [0.18, 0.2], [-0.2, 0.2], [-0.2, -0.2]];
        let plate = BoardShape::plate(PlateRecord { outline_m, holes_m: Vec::new() }.into(), 0.02);
        // The side between corners 1 and 2 is 28 mm long, a pad is 40.4 mm wide.
        assert_eq!(edges_of(&plate), [0, 2, 3, 4].map(Edge));
        // All edges of a box count, however short: their grasps are drawn in vain.
        assert_eq!(edges_of(&BoardShape::cuboid([0.03, 0.02, 0.01])).len(), 4);
        assert_eq!(draw_edge(&[], &mut Pcg64::new(1, 0)), None);
    }

    #[test]
    fn drawn_boards_are_in_the_domain() {
        let domain = domain(&paper::printed_operations()[0].load().unwrap().robot);
        let mut random = Pcg64::new(1, 0);
        for _ in 0..500 {
            assert!(domain.contains(&domain.draw_board(&mut random)));
        }
    }
}
