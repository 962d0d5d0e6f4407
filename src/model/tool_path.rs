//! The path that a tool follows on the worked face: strokes, between which the tool is lifted
//! (`docs/method.md#111-path-and-pieces`).

use std::f64::consts::{PI, TAU};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The largest turn of a piece of a stroke, rad: a sixteenth of a circle, as in the paper's evaluation of a cut.
const MOST_TURN_RAD: f64 = TAU / 16.0;

/// A corner of a line that turns by more than this, rad, is the end of a piece: the tool stops there, and its force goes to zero
/// before it turns.
pub const CORNER_RAD: f64 = PI / 6.0;

/// Rounding of lengths, m.
const ROUNDING_M: f64 = 1e-9;

/// What the tool does without being lifted. Points are on the worked face, m along x_O and y_O from its centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "lowercase")]
pub enum Stroke {
    /// A hole that is drilled.
    Hole {
        /// Its centre.
        point_m: [f64; 2],
    },
    /// A cut along straight segments.
    Line {
        /// At least two points.
        points_m: Vec<[f64; 2]>,
    },
    /// A cut along a whole circle, counter-clockwise seen from +z_O.
    Circle {
        /// Its centre.
        centre_m: [f64; 2],
        /// Its radius, m.
        radius_m: f64,
        /// Direction from the centre to where the cut begins, degrees from x_O towards y_O.
        start_deg: f64,
    },
}

/// Where the tool is on a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolPlace {
    /// The point on the face, m.
    pub point_m: [f64; 2],
    /// Unit vector along the cut; `None` at a hole.
    pub direction: Option<[f64; 2]>,
}

/// A part of a stroke for which posture and stability are computed at one place: its middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// The stroke, from 0.
    pub stroke: usize,
    /// Its beginning, m from the stroke's beginning; 0 of a hole.
    pub from_m: f64,
    /// Its end, m from the stroke's beginning; 0 of a hole.
    pub to_m: f64,
}

impl Piece {
    /// Its length, m; 0 of a hole.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.to_m - self.from_m
    }

    /// Its weight in means over a path: its length, m, or 1 of a hole.
    #[must_use]
    pub fn weight(&self) -> f64 {
        let length_m = self.length_m();
        if length_m > 0.0 { length_m } else { 1.0 }
    }

    /// Its middle, m from the stroke's beginning.
    #[must_use]
    pub fn middle_m(&self) -> f64 {
        (self.from_m + self.to_m) / 2.0
    }
}

/// A straight part of a line.
struct Segment {
    from_m: [f64; 2],
    direction: [f64; 2],
    length_m: f64,
}

impl Stroke {
    /// Its length, m; 0 of a hole.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        match self {
            Self::Hole { .. } => 0.0,
            Self::Line { points_m } => segments(points_m).map(|segment| segment.length_m).sum(),
            Self::Circle { radius_m, .. } => TAU * radius_m,
        }
    }

    /// Where the tool is after a length; at a corner it has the direction of the next segment.
    #[must_use]
    pub fn at(&self, along_m: f64) -> ToolPlace {
        match self {
            Self::Hole { point_m } => ToolPlace { point_m: *point_m, direction: None },
            Self::Line { points_m } => on_line(points_m, along_m),
            Self::Circle { centre_m: [x_m, y_m], radius_m, start_deg } => {
                let (sin, cos) = libm::sincos(start_deg.to_radians() + along_m / radius_m);
                ToolPlace { point_m: [x_m + radius_m * cos, y_m + radius_m * sin], direction: Some([-sin, cos]) }
            }
        }
    }

    /// Its pieces as beginnings and ends, m: none longer than `longest_m`, none that turns by more than a sixteenth of a circle or
    /// contains a corner.
    #[must_use]
    pub fn pieces(&self, longest_m: f64) -> Vec<[f64; 2]> {
        match self {
            Self::Hole { .. } => vec![[0.0; 2]],
            Self::Line { points_m } => pieces_of_line(points_m, longest_m),
            Self::Circle { .. } => {
                let length_m = self.length_m();
                let count = (length_m / longest_m - ROUNDING_M).ceil().max(TAU / MOST_TURN_RAD) as usize;
                let end_m = |number: usize| length_m * number as f64 / count as f64;
                (0..count).map(|number| [end_m(number), end_m(number + 1)]).collect()
            }
        }
    }

    /// True if the tool turns at once by more than [`CORNER_RAD`] after this length.
    #[must_use]
    pub fn has_corner_at(&self, along_m: f64) -> bool {
        let Self::Line { points_m } = self else { return false };
        let mut here_m = 0.0;
        let segments: Vec<_> = segments(points_m).collect();
        segments.windows(2).any(|pair| {
            here_m += pair[0].length_m;
            (here_m - along_m).abs() < ROUNDING_M && turn_rad(&pair[0], &pair[1]).abs() > CORNER_RAD
        })
    }

    /// Points of the stroke that are at most `spacing_m` apart, both ends included.
    #[must_use]
    pub fn outline_m(&self, spacing_m: f64) -> Vec<[f64; 2]> {
        match self {
            Self::Hole { point_m } => vec![*point_m],
            Self::Line { points_m } => points_m.clone(),
            Self::Circle { .. } => {
                let length_m = self.length_m();
                let count = (length_m / spacing_m).ceil().max(TAU / MOST_TURN_RAD) as usize;
                (0..=count).map(|number| self.at(length_m * (number % count) as f64 / count as f64).point_m).collect()
            }
        }
    }
}

/// The segments of a line without those of no length.
fn segments(points_m: &[[f64; 2]]) -> impl Iterator<Item = Segment> {
    points_m.windows(2).filter_map(|pair| {
        let [dx_m, dy_m] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length_m = libm::hypot(dx_m, dy_m);
        let direction = [dx_m / length_m, dy_m / length_m];
        (length_m > 0.0).then_some(Segment { from_m: pair[0], direction, length_m })
    })
}

fn on_line(points_m: &[[f64; 2]], along_m: f64) -> ToolPlace {
    let mut left_m = along_m.max(0.0);
    let mut place = ToolPlace { point_m: points_m.first().copied().unwrap_or_default(), direction: None };
    for Segment { from_m: [x_m, y_m], direction: [dx, dy], length_m } in segments(points_m) {
        let on_m = left_m.min(length_m);
        place = ToolPlace { point_m: [x_m + on_m * dx, y_m + on_m * dy], direction: Some([dx, dy]) };
        if left_m < length_m {
            break;
        }
        left_m -= length_m;
    }
    place
}

/// The angle from one segment's direction to another's, rad, from -pi to pi.
fn turn_rad(from: &Segment, to: &Segment) -> f64 {
    let ([ax, ay], [bx, by]) = (from.direction, to.direction);
    libm::atan2(ax * by - ay * bx, ax * bx + ay * by)
}

/// Segments are joined while their turns add up to at most [`MOST_TURN_RAD`] and their lengths to at most `longest_m`; a longer
/// segment is divided into equal parts.
fn pieces_of_line(points_m: &[[f64; 2]], longest_m: f64) -> Vec<[f64; 2]> {
    let segments: Vec<_> = segments(points_m).collect();
    let mut pieces: Vec<[f64; 2]> = Vec::new();
    // Beginning of the piece that is still open, and how far it has turned.
    let mut open: Option<(f64, f64)> = None;
    let mut here_m = 0.0;
    for (number, segment) in segments.iter().enumerate() {
        let turned_rad = number.checked_sub(1).map_or(0.0, |last| turn_rad(&segments[last], segment));
        let joined = open.filter(|(from_m, turn_rad)| {
            here_m + segment.length_m - from_m <= longest_m + ROUNDING_M
                && (turn_rad + turned_rad).abs() <= MOST_TURN_RAD
                && turned_rad.abs() <= CORNER_RAD
        });
        let end_m = here_m + segment.length_m;
        if let Some((from_m, turn_rad)) = joined {
            open = Some((from_m, turn_rad + turned_rad));
        } else {
            pieces.extend(open.map(|(from_m, _)| [from_m, here_m]));
            let count = (segment.length_m / longest_m - ROUNDING_M).ceil().max(1.0) as usize;
            let part_m = |part: usize| here_m + segment.length_m * part as f64 / count as f64;
            pieces.extend((1..count).map(|part| [part_m(part - 1), part_m(part)]));
            open = Some((part_m(count - 1), 0.0));
        }
        here_m = end_m;
    }
    pieces.extend(open.map(|(from_m, _)| [from_m, here_m]));
    pieces
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ends_meet(pieces: &[[f64; 2]], length_m: f64) -> bool {
        pieces[0][0] == 0.0
            && (pieces[pieces.len() - 1][1] - length_m).abs() < 1e-12
            && pieces.windows(2).all(|pair| (pair[0][1] - pair[1][0]).abs() < 1e-15)
    }

    #[test]
    fn a_circle_of_12_cm_has_16_pieces() {
        let circle = Stroke::Circle { centre_m: [0.0; 2], radius_m: 0.12, start_deg: -11.25 };
        let pieces = circle.pieces(0.05);
        assert_eq!(pieces.len(), 16);
        assert!(ends_meet(&pieces, circle.length_m()));
        // The middle of the first piece is on +x_O, where the tool moves along +y_O.
        let ToolPlace { point_m: [x_m, y_m], direction } = circle.at((pieces[0][0] + pieces[0][1]) / 2.0);
        assert!((x_m - 0.12).abs() < 1e-12 && y_m.abs() < 1e-12);
        assert!((direction.unwrap()[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_square_has_four_corners() {
        let square = Stroke::Line { points_m: vec![[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, 0.0]] };
        assert!((square.length_m() - 0.4).abs() < 1e-15);
        assert_eq!(square.pieces(0.05).len(), 8);
        assert_eq!(square.pieces(0.11).len(), 4);
        let corners = [0.05, 0.1, 0.2, 0.3, 0.4].map(|along_m| square.has_corner_at(along_m));
        assert_eq!(corners, [false, true, true, true, false]);
        assert_eq!(square.at(0.1).direction, Some([0.0, 1.0]));
    }

    #[test]
    fn a_hole_is_one_piece_without_length() {
        let hole = Stroke::Hole { point_m: [0.1, -0.2] };
        assert_eq!((hole.length_m(), hole.pieces(0.05)), (0.0, vec![[0.0, 0.0]]));
        assert_eq!(hole.at(0.0), ToolPlace { point_m: [0.1, -0.2], direction: None });
    }

    proptest! {
        #[test]
        fn pieces_cover_a_line_and_neither_turn_nor_reach_too_far(
            steps in prop::collection::vec((0.001..0.2_f64, -0.6..0.6_f64), 1..30),
            longest_m in 0.01..0.2_f64,
        ) {
            let mut points_m = vec![[0.0, 0.0]];
            let (mut x_m, mut y_m, mut heading) = (0.0, 0.0, 0.0_f64);
            for (length_m, turn) in steps {
                heading += turn;
                x_m += length_m * heading.cos();
                y_m += length_m * heading.sin();
                points_m.push([x_m, y_m]);
            }
            let line = Stroke::Line { points_m };
            let pieces = line.pieces(longest_m);
            prop_assert!(ends_meet(&pieces, line.length_m()));
            for [from_m, to_m] in pieces {
                prop_assert!(to_m > from_m && to_m - from_m <= longest_m + 1e-9);
                // Just inside, so that a corner at an end does not count.
                let [[ax, ay], [bx, by]] = [from_m + 1e-7, to_m - 1e-7].map(|at_m| line.at(at_m).direction.unwrap());
                let turned = libm::atan2(ax * by - ay * bx, ax * bx + ay * by);
                prop_assert!(turned.abs() <= MOST_TURN_RAD + 1e-9);
            }
        }
    }
}
