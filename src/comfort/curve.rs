//! The analysis behind the muscular metric: along a circle that is cut, how comfortable and how uncomfortable the person's
//! solutions are at each of 16 points (METHOD section 9, the paper's figure).
//!
//! The board's pose is fixed and no robot stands in the way; the person keeps clear of the board. The paper does not say
//! where its board was, nor whether its person could step aside. So each point is looked at twice: with every standing
//! place and heading of the grid of [`super::Response`] (`free`), and from one place and heading for all points (`fixed`),
//! the one from which the most points can be cut, and among those the one with the largest sum of best comforts.
//!
//! Like the paper's figure, the result (`benchdog curve`) has a band from worst to best at each point, lower and narrower
//! next to the points that the wrist cannot serve, and closes where the circle does: 16 and 1 are alike. Unlike it, three
//! neighbouring points have no solution, not two (1, 15 and 16, standing anywhere), and eight have none from one place: the
//! knife's angle in the hand and the wrist's range are ours (METHOD section 4), the paper states neither, and a turn of
//! either moves the gap around the circle.

use std::{collections::BTreeMap, f64::consts::TAU};

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};

use super::{
    ResponseQuery,
    responses::{self, GridPlace},
};
use crate::{
    collision::{CollisionModel, Scene},
    human::{Human, Muscular},
    model::{frames::Pose, operation::Operation, scenario::ComfortSettings},
};

/// How many points of the circle are cut (METHOD section 2).
pub const POINTS: usize = 16;

/// Where the board's centre is in W, m: in the middle of where two-armed robots hold boards, 1.1 m over Baxter's floor,
/// between elbow and shoulder.
const BOARD_P_WO_M: [f64; 3] = [0.60, 0.0, 0.20];

/// A circle to cut, and who cuts it.
#[derive(Clone, Copy)]
pub struct Cut<'a> {
    /// The person and the tool.
    pub human: &'a Human,
    /// Who touches whom.
    pub collision: &'a CollisionModel,
    /// How comfort is measured.
    pub settings: ComfortSettings,
    /// Sides of the board, m.
    pub board_size_m: [f64; 3],
    /// Radius of the circle about the middle of the board, m.
    pub radius_m: f64,
    /// Force along the cut, N.
    pub force_n: f64,
    /// Height of the floor in W, m.
    pub floor_z_m: f64,
}

/// The muscular comfort of the worst and of the best posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The posture that needs most.
    pub worst: Muscular,
    /// The posture that needs least.
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

/// One point of the circle; a span is none where the person has no solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Direction from the middle of the board, rad from x_O towards y_O.
    pub angle_rad: f64,
    /// Over all standing places.
    pub free: Option<Span>,
    /// From the one standing place of the curve.
    pub fixed: Option<Span>,
}

/// Best and worst muscular comfort along a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The board's pose: upright, its worked face towards the person.
    pub x_wo: Pose,
    /// The one standing place; none when no point can be reached.
    pub x_wb_fixed: Option<Pose>,
    /// The points, counter-clockwise as the person sees them.
    pub points: [CurvePoint; POINTS],
}

/// For each point the span of its postures, for one place or for all.
type Spans = [Option<Span>; POINTS];

/// The best and the worst muscular comfort at each point of the circle.
pub fn muscular_curve(cut: &Cut<'_>) -> Curve {
    let x_wo = board_pose();
    let mut free: Spans = [None; POINTS];
    let mut by_place = BTreeMap::<GridPlace, (Pose, Spans)>::new();
    for point in 0..POINTS {
        let query = ResponseQuery {
            human: cut.human,
            collision: cut.collision,
            settings: cut.settings,
            operation: Operation::cut_on_circle(cut.radius_m, angle_rad(point), cut.force_n, cut.board_size_m[2]),
            floor_z_m: cut.floor_z_m,
            robot_points_w: &[],
            scene: Scene { link_poses: &[], holding: &[], board_size_m: cut.board_size_m, x_wo, person: &[] },
        };
        responses::visit(&query, |place, response| {
            let (_, spans) = by_place.entry(place).or_insert((response.x_wb, [None; POINTS]));
            for span in [&mut free[point], &mut spans[point]] {
                let alone = Span { worst: response.muscular, best: response.muscular };
                *span = Some(span.map_or(alone, |span| span.with(&response.muscular)));
            }
        });
    }
    let fixed = by_place.into_values().max_by(|(_, a), (_, b)| worth(a).partial_cmp(&worth(b)).unwrap_or(EQUAL));
    let (x_wb_fixed, fixed) = fixed.map_or((None, [None; POINTS]), |(x_wb, spans)| (Some(x_wb), spans));
    let points = std::array::from_fn(|i| CurvePoint { angle_rad: angle_rad(i), free: free[i], fixed: fixed[i] });
    Curve { x_wo, x_wb_fixed, points }
}

/// Comforts are numbers, so their sums always compare.
const EQUAL: std::cmp::Ordering = std::cmp::Ordering::Equal;

/// What makes a standing place good: how many points it reaches, then the sum of their best comforts.
fn worth(spans: &Spans) -> (usize, f64) {
    let reached = || spans.iter().flatten();
    (reached().count(), reached().map(|span| span.best.regularised).sum())
}

/// Direction of a point, counted from 0, from the middle of the board: rad from x_O towards y_O.
pub fn angle_rad(point: usize) -> f64 {
    TAU * point as f64 / POINTS as f64
}

/// The worked face towards +x_W, y_O up.
fn board_pose() -> Pose {
    let rotation = Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]);
    Isometry3::from_parts(Vector3::from(BOARD_P_WO_M).into(), UnitQuaternion::from_rotation_matrix(&rotation))
}
