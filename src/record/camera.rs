//! Where the camera of the scene is when a recording is opened: it sees hands, tool and person.

use nalgebra::{Point3, Vector3};

use super::input::{Capsule, RecordingInput};
use crate::model::plan::ArmHold;

/// The scene is at least this wide, m: the camera then sees the person from head to feet.
const LEAST_SPAN_M: f64 = 1.35;

/// Shares of the distance between robot and person by which the camera may be farther towards the person, nearest to the middle
/// first, and heights over the target, as shares of the span.
const ALONG: [f64; 4] = [0.25, 0.7, -0.2, 1.1];
const HEIGHTS: [f64; 3] = [0.45, 0.8, 0.15];

/// Distance of the camera from the target, as a share of the span.
const AWAY: f64 = 1.45;

/// Line of sight is not tested nearer to its end than this, m: hands and tool touch the board.
const END_M: f64 = 0.06;

/// Half the thickness of the board for lines of sight, at least, m.
const HALF_BOARD_M: f64 = 0.01;

/// A position of the camera and what it looks at, in W, m.
pub(super) struct Camera {
    /// The position.
    pub eye_w: Vector3<f64>,
    /// What is in the middle.
    pub target_w: Vector3<f64>,
}

impl Camera {
    /// From the side that the worked face of the board looks to, or from the other one, where most of hands, tool and head are not
    /// hidden by the board or the person; of equal places the first.
    pub fn of(input: &RecordingInput) -> Self {
        let x_wo = input.plan.object.x_wo;
        let robot = Vector3::zeros();
        // Without a person, a point in front of the board.
        let person = input.plan.human.map_or(x_wo.translation.vector + Vector3::x() * 0.6, |human| {
            human.x_wb.translation.vector + Vector3::z() * (0.6 * human.height_m)
        });
        let apart = person - robot;
        let side = Vector3::z().cross(&apart).normalize();
        let face_w = x_wo.rotation * Vector3::z();
        let side = if side.dot(&face_w) < 0.0 { -side } else { side };
        let target_w = (2.0 * x_wo.translation.vector + person + robot) / 4.0;
        let span_m = apart.norm().max(LEAST_SPAN_M);
        let marks = marks_w(input);
        let mut best = (0, target_w + side * AWAY * span_m);
        for side in [side, -side] {
            for (along, height) in ALONG.iter().flat_map(|along| HEIGHTS.map(|height| (along, height))) {
                let eye_w = target_w + side * (AWAY * span_m) + apart * *along + Vector3::z() * (height * span_m);
                let seen = marks.iter().filter(|mark| is_seen(input, &eye_w, mark)).count() + 1;
                if seen > best.0 {
                    best = (seen, eye_w);
                }
            }
        }
        Self { eye_w: best.1, target_w }
    }
}

/// What is to be seen, in W: where the hands hold the board, the tool tip, the head.
fn marks_w(input: &RecordingInput) -> Vec<Point3<f64>> {
    let x_wo = input.plan.object.x_wo;
    let grasp_w = |hold: &ArmHold| {
        let arm = &input.robot.arms[input.robot.arm_index(&hold.name)?];
        Some(x_wo * hold.x_og * Point3::from(arm.gripper.grasp_point_g()))
    };
    let mut marks: Vec<_> = input.plan.arms.iter().filter_map(grasp_w).collect();
    marks.push(x_wo * Point3::from(input.plan.operation.x_ot.translation.vector));
    marks.extend(input.person.map(|person| person.line_of_sight_w[0]));
    marks
}

/// True if neither the board nor a part of the person is between the camera and a point.
fn is_seen(input: &RecordingInput, eye_w: &Vector3<f64>, mark_w: &Point3<f64>) -> bool {
    let way = mark_w.coords - eye_w;
    let end_w = eye_w + way * (1.0 - END_M / way.norm().max(END_M));
    let object = &input.plan.object;
    let [x, y, z] = object.size_m.map(|side_m| side_m / 2.0);
    let in_o = |p_w: &Vector3<f64>| object.x_wo.inverse() * Point3::from(*p_w);
    let half_m = Vector3::new(x, y, z.max(HALF_BOARD_M));
    let is_hidden_by_board = meets_box(&in_o(eye_w), &in_o(&end_w), &half_m);
    let hides = |capsule: &Capsule| {
        let [a, b] = capsule.ends_w;
        segment_distance([*eye_w, end_w], [a.coords, b.coords]) < capsule.radius_m
    };
    !is_hidden_by_board && !input.person.is_some_and(|person| person.capsules.iter().any(hides))
}

/// True if a segment meets a box about the origin with these half sides.
fn meets_box(from: &Point3<f64>, to: &Point3<f64>, half_m: &Vector3<f64>) -> bool {
    let way = to - from;
    let mut span = [0.0_f64, 1.0_f64];
    for axis in 0..3 {
        // Along an axis that the segment is perpendicular to, the divisions give infinities of the right signs.
        let ends = [-half_m[axis], half_m[axis]].map(|side| (side - from[axis]) / way[axis]);
        span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
    }
    span[0] < span[1]
}

/// The distance of two segments, by points on the second one 1/16 of its length apart: enough for what hides a mark.
fn segment_distance([a, b]: [Vector3<f64>; 2], [c, d]: [Vector3<f64>; 2]) -> f64 {
    let way = b - a;
    let to_point = |p: Vector3<f64>| {
        let share = ((p - a).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (a + way * share - p).norm()
    };
    (0..=16).map(|part| to_point(c + (d - c) * (f64::from(part) / 16.0))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_through_a_box_meets_it_and_one_beside_it_does_not() {
        let half_m = Vector3::new(0.2, 0.2, 0.01);
        let meets = |from: [f64; 3], to: [f64; 3]| meets_box(&from.into(), &to.into(), &half_m);
        assert!(meets([0.0, 0.0, 1.0], [0.05, 0.0, -1.0]));
        assert!(!meets([0.0, 0.0, 1.0], [0.0, 0.0, 0.02]));
        assert!(!meets([0.3, 0.0, 1.0], [0.3, 0.0, -1.0]));
        assert!(meets([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
    }

    #[test]
    fn the_distance_of_crossing_segments_is_that_of_their_lines() {
        let x = [Vector3::new(-1.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0)];
        let y = [Vector3::new(0.0, -1.0, 0.3), Vector3::new(0.0, 1.0, 0.3)];
        assert!((segment_distance(x, y) - 0.3).abs() < 1e-12);
    }
}
