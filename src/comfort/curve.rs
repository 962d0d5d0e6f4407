//! Muscular comfort along a circle that is cut: the best and the worst posture at each of 16 points
//! (docs/method.md#411-muscular-comfort-along-a-circle; the paper shows it as a figure).
//!
//! The board's pose is fixed, there is no robot, and the person keeps clear of the board. The paper states neither the pose
//! of its board nor whether its person could move. So each point has two spans: over all standing poses of the grid of
//! [`responses::Response`] (`free`), and from one standing pose for all points (`fixed`). That pose is the one from which the
//! most points can be cut and, among those, the one with the largest sum of best comforts.
//!
//! As in the paper's figure, the result (`benchdog curve`) is a band from worst to best, lower and narrower next to the points
//! that the wrist cannot reach, and periodic. In the paper two neighbouring points have no solution; here three have none
//! standing anywhere (1, 15 and 16), and eight have none from one pose. The knife's angle in the hand and the wrist's range
//! (docs/method.md#44-tools-in-the-hand, docs/method.md#41-arm-kinematics) are assumptions, since the paper states neither;
//! they turn the gap around the circle.

use std::{collections::BTreeMap, f64::consts::TAU};

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};

use super::{
    query::ResponseQuery,
    responses::{self, GridPlace},
};
use crate::{
    collision::{BoardBody, CollisionModel, Scene},
    human::{Human, Muscular},
    model::{
        board::BoardShape,
        frames::Pose,
        operation::Operation,
        scenario::{ComfortSettings, MuscularMetric},
        stop::Never,
    },
};

/// Number of points of the circle (docs/method.md#23-cutting).
pub const POINTS: usize = 16;

/// The board's centre in W, m: in the middle of the workspace of two-armed robots, 1.1 m above Baxter's floor, between elbow
/// and shoulder.
const BOARD_P_WO_M: [f64; 3] = [0.60, 0.0, 0.20];

/// A circle to cut, and the person who cuts it.
#[derive(Clone, Copy)]
pub struct Cut<'a> {
    /// The person and the tool.
    pub human: &'a Human,
    /// The collision model of the robot; only the board is tested.
    pub collision: &'a CollisionModel,
    /// Metrics and weights.
    pub settings: ComfortSettings,
    /// The board.
    pub board: &'a BoardShape,
    /// Radius of the circle about the board's centre, m.
    pub radius_m: f64,
    /// Force along the cut, N.
    pub force_n: f64,
    /// Height of the floor in W, m.
    pub floor_z_m: f64,
}

/// The muscular comfort of the worst and of the best posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The posture with the least comfort.
    pub worst: Muscular,
    /// The posture with the most comfort.
    pub best: Muscular,
}

impl Span {
    fn with(self, other: &Muscular) -> Self {
        Self {
            worst: if other.regularised < self.worst.regularised { *other } else { self.worst },
            best: if other.regularised > self.best.regularised { *other } else { self.best },
        }
    }
}

/// One point of the circle. A span is `None` if the person has no solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Direction from the board's centre, rad from x_O towards y_O.
    pub angle_rad: f64,
    /// Over all standing poses.
    pub free: Option<Span>,
    /// From the one standing pose of the curve.
    pub fixed: Option<Span>,
}

/// Best and worst muscular comfort along a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The metric of the comforts.
    pub metric: MuscularMetric,
    /// The board's pose: upright, its front face towards the person.
    pub x_wo: Pose,
    /// The one standing pose; `None` if no point can be reached.
    pub x_wb_fixed: Option<Pose>,
    /// The points, counter-clockwise as the person sees them.
    pub points: [CurvePoint; POINTS],
}

/// The span of each point, from one standing pose or all.
type Spans = [Option<Span>; POINTS];

/// The best and the worst muscular comfort at each point of the circle.
#[must_use]
pub fn muscular_curve(cut: &Cut<'_>) -> Curve {
    let x_wo = board_pose();
    let board = BoardBody::new(cut.board);
    let mut free: Spans = [None; POINTS];
    let mut by_place = BTreeMap::<GridPlace, (Pose, Spans)>::new();
    for point in 0..POINTS {
        let query = ResponseQuery {
            human: cut.human,
            collision: cut.collision,
            settings: cut.settings,
            operation: Operation::cut_on_circle(cut.radius_m, angle_rad(point), cut.force_n, board.thickness_m()),
            floor_z_m: cut.floor_z_m,
            robot_points_w: &[],
            scene: Scene { link_poses: &[], holding: &[], board: &board, x_wo, person: &[], clearance_m: 0.0 },
            stop: &Never,
        };
        responses::visit(&query, |place, response| {
            let (_, spans) = by_place.entry(place).or_insert((response.x_wb, [None; POINTS]));
            for span in [&mut free[point], &mut spans[point]] {
                let alone = Span { worst: response.muscular, best: response.muscular };
                *span = Some(span.map_or(alone, |span| span.with(&response.muscular)));
            }
        });
    }
    let fixed = by_place.into_values().max_by(|(_, a), (_, b)| score(a).partial_cmp(&score(b)).unwrap_or(EQUAL));
    let (x_wb_fixed, fixed) = fixed.map_or((None, [None; POINTS]), |(x_wb, spans)| (Some(x_wb), spans));
    let points = std::array::from_fn(|i| CurvePoint { angle_rad: angle_rad(i), free: free[i], fixed: fixed[i] });
    Curve { metric: cut.settings.muscular, x_wo, x_wb_fixed, points }
}

/// Sums of comforts are never NaN, so they always compare.
const EQUAL: std::cmp::Ordering = std::cmp::Ordering::Equal;

/// The rank of a standing pose: number of points reached, then the sum of their best comforts.
fn score(spans: &Spans) -> (usize, f64) {
    let reached = || spans.iter().flatten();
    (reached().count(), reached().map(|span| span.best.regularised).sum())
}

/// Direction of a point (counted from 0) from the board's centre, rad from x_O towards y_O.
#[must_use]
pub fn angle_rad(point: usize) -> f64 {
    TAU * point as f64 / POINTS as f64
}

/// The front face towards +x_W, y_O up.
fn board_pose() -> Pose {
    let rotation = Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    Isometry3::from_parts(Vector3::from(BOARD_P_WO_M).into(), UnitQuaternion::from_rotation_matrix(&rotation))
}
