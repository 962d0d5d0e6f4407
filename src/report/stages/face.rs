//! The worked face of the board seen along its normal, always with x_O to the right: path and grasps.

use std::fmt::Write as _;

use nalgebra::{Point3, Vector3};

use super::{
    drawing::{corner_m, trails_of},
    scene::StageScene,
};
use crate::{model::board::BoardShape, report::bodies::ARM_COLOURS};

/// Longer side of the drawing, px.
const SIDE_PX: f64 = 116.0;

/// How far hands reach beyond the edge of the board, m.
const HAND_M: f64 = 0.1;

/// Width of a hand, m.
const HAND_WIDTH_M: f64 = 0.035;

/// The face of a stage as SVG.
#[must_use]
pub fn svg(scene: &StageScene, board: &BoardShape) -> String {
    let outline = board.outline_m();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in &outline {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis] - HAND_M);
            high[axis] = high[axis].max(point[axis] + HAND_M);
        }
    }
    let px_per_m = SIDE_PX / (high[0] - low[0]).max(high[1] - low[1]);
    let px = |[x, y]: [f64; 2]| [(x - low[0]) * px_per_m, (high[1] - y) * px_per_m];
    let [width, height] = [0, 1].map(|axis| (high[axis] - low[axis]) * px_per_m);
    let mut body = format!(
        "<svg class=\"face\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" role=\"img\" \
         aria-label=\"the worked face of the board\">"
    );
    // Writing to a string does not fail, so the results are ignored.
    let holes = board.plate.iter().flat_map(|plate| plate.holes_m().iter());
    let d: String = std::iter::once(&outline)
        .chain(holes)
        .map(|ring| closed(&ring.iter().map(|p| px(*p)).collect::<Vec<_>>()))
        .collect();
    let _ = writeln!(body, "<path class=\"board\" fill-rule=\"evenodd\" d=\"{d}\"/>");
    let _ = writeln!(body, "<path class=\"corner\" d=\"{}\"/>", closed(&corner_m(board).map(px)));
    let parts = &scene.path;
    for (class, trails) in [("to-come", &parts.to_come), ("done", &parts.done), ("now", &parts.now)] {
        trails_of(&mut body, class, trails.iter().map(|trail| trail.iter().map(|p| px(*p)).collect()));
    }
    let width_px = HAND_WIDTH_M * px_per_m;
    let mut hand = |class: &str, (point_o, ahead_o): (Point3<f64>, Vector3<f64>)| {
        let back_o = point_o - ahead_o * HAND_M;
        let [[x1, y1], [x2, y2]] = [point_o, back_o].map(|p| px([p.x, p.y]));
        let _ = writeln!(
            body,
            "<path class=\"{class}\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke-width=\"{width_px:.1}\"/>"
        );
    };
    for mark in &scene.hands {
        let colour = mark.arm % ARM_COLOURS;
        if let Some(before) = mark.before_o {
            hand(&format!("grip was c{colour}"), before);
        }
        hand(&format!("grip c{colour}"), (mark.point_o, mark.ahead_o));
    }
    body.push_str("</svg>");
    body
}

fn closed(points: &[[f64; 2]]) -> String {
    let points: Vec<_> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    format!("M{}Z", points.join(" "))
}
