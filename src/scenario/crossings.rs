//! Where the lines and circles of a path cross themselves and one another.

use crate::model::tool_path::Stroke;

/// Points and segments that are nearer than this touch, m: far above the rounding of coordinates on a board.
const TOUCH_M: f64 = 1e-9;

/// Where a path crosses itself.
pub struct Crossing {
    /// The earlier stroke and the later one, from 0; they may be the same.
    pub strokes: [usize; 2],
    /// The number of the segment in the later stroke, from 0.
    pub part: usize,
    /// The point, m.
    pub point_m: [f64; 2],
}

/// The first crossing of a path, in the order of its segments; circles are taken as chords about `spacing_m` long.
pub fn first_crossing(path: &[Stroke], spacing_m: f64) -> Option<Crossing> {
    let segments = segments(path, spacing_m);
    segments.iter().enumerate().find_map(|(number, a)| {
        segments[number + 1..].iter().find_map(|b| {
            let point_m = meeting(a, b)?;
            Some(Crossing { strokes: [a.stroke, b.stroke], part: b.part, point_m })
        })
    })
}

/// A straight part of a path.
struct Segment {
    /// The stroke, from 0.
    stroke: usize,
    /// Its number in the stroke, from 0.
    part: usize,
    /// True if it is the last one of its stroke.
    is_last: bool,
    ends_m: [[f64; 2]; 2],
}

/// The segments of all strokes in the order of the path.
fn segments(path: &[Stroke], spacing_m: f64) -> Vec<Segment> {
    let mut segments = Vec::new();
    for (stroke, of_path) in path.iter().enumerate() {
        let points = of_path.outline_m(spacing_m);
        let count = points.len().saturating_sub(1);
        segments.extend(points.windows(2).enumerate().map(|(part, pair)| Segment {
            stroke,
            part,
            is_last: part + 1 == count,
            ends_m: [pair[0], pair[1]],
        }));
    }
    segments
}

/// A point where a segment meets a later one otherwise than by the end that they share.
fn meeting(a: &Segment, b: &Segment) -> Option<[f64; 2]> {
    let is_same = a.stroke == b.stroke;
    if is_same && b.part == a.part + 1 {
        return fold(&a.ends_m, &b.ends_m);
    }
    let is_closed = || {
        let [dx_m, dy_m] = minus(&a.ends_m[0], &b.ends_m[1]);
        libm::hypot(dx_m, dy_m) <= TOUCH_M
    };
    if is_same && a.part == 0 && b.is_last && is_closed() {
        return fold(&b.ends_m, &a.ends_m);
    }
    crossing(&a.ends_m, &b.ends_m)
}

/// Where a segment goes back over the one that ends where it begins: the nearer of the two outer ends.
fn fold([a, b]: &[[f64; 2]; 2], [_, c]: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (back, on) = (minus(a, b), minus(c, b));
    let [back_m, on_m] = [back, on].map(|[x, y]| libm::hypot(x, y));
    let is_back = back[0] * on[0] + back[1] * on[1] > 0.0;
    // The nearer outer end is within TOUCH_M of the other segment.
    let is_over = cross(back, on).abs() <= TOUCH_M * back_m.max(on_m);
    (is_back && is_over).then_some(if on_m < back_m { *c } else { *a })
}

fn minus(p: &[f64; 2], q: &[f64; 2]) -> [f64; 2] {
    [p[0] - q[0], p[1] - q[1]]
}

fn cross(p: [f64; 2], q: [f64; 2]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// A point where two segments meet.
fn crossing([a, b]: &[[f64; 2]; 2], [c, d]: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
    if boxes_are_apart([a, b], [c, d]) {
        return None;
    }
    let (ab, cd, ac) = (minus(b, a), minus(d, c), minus(c, a));
    let determinant = cross(ab, cd);
    let [ab_m, cd_m] = [ab, cd].map(|[x, y]| libm::hypot(x, y));
    if determinant.abs() <= 1e-12 * ab_m * cd_m {
        // Parallel: they meet if they are on one line, since their boxes do; then an end of one is on the other.
        let is_on_line = cross(ab, ac).abs() <= TOUCH_M * ab_m;
        let is_in_both = |end: &[f64; 2]| !boxes_are_apart([a, b], [end; 2]) && !boxes_are_apart([c, d], [end; 2]);
        return [c, d, a, b].into_iter().copied().find(|end| is_on_line && is_in_both(end));
    }
    let [s, t] = [cross(ac, cd) / determinant, cross(ac, ab) / determinant];
    let within = |share: f64| (-1e-9..=1.0 + 1e-9).contains(&share);
    (within(s) && within(t)).then(|| [a[0] + s * ab[0], a[1] + s * ab[1]])
}

/// True if the boxes about two segments, along the axes, are more than [`TOUCH_M`] apart.
fn boxes_are_apart([a, b]: [&[f64; 2]; 2], [c, d]: [&[f64; 2]; 2]) -> bool {
    (0..2).any(|axis| {
        a[axis].max(b[axis]) < c[axis].min(d[axis]) - TOUCH_M || c[axis].max(d[axis]) < a[axis].min(b[axis]) - TOUCH_M
    })
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64;

    use super::*;

    fn meets(path: &[Stroke]) -> bool {
        first_crossing(path, 0.005).is_some()
    }

    fn line(points_m: &[[f64; 2]]) -> Stroke {
        Stroke::Line { points_m: points_m.to_vec() }
    }

    #[test]
    fn a_figure_of_eight_crosses_itself_and_a_closed_square_does_not() {
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]])]));
        assert!(!meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, 0.0]])]));
        // A line that goes back on itself.
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.05, 0.05], [0.05, 0.0], [0.02, 0.0]])]));
        let circle = Stroke::Circle { centre_m: [0.0; 2], radius_m: 0.1, start_deg: 20.0 };
        assert!(!meets(std::slice::from_ref(&circle)));
        assert!(meets(&[circle.clone(), line(&[[0.0, 0.0], [0.2, 0.0]])]));
        assert!(!meets(&[circle, line(&[[0.0, 0.0], [0.05, 0.0]])]));
    }

    #[test]
    fn a_line_that_goes_straight_back_over_itself_crosses_itself() {
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.05, 0.0]])]));
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.3], [0.0, 0.0]])]));
        // The last segment comes to the beginning over the first one.
        assert!(meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.05, 0.0], [0.0, 0.0]])]));
        assert!(!meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]])]));
        // A narrow point, 1 mm wide at 10 cm, is no fold.
        assert!(!meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.0, 0.001]])]));
    }

    /// Files round the end of a closed line otherwise than its beginning.
    #[test]
    fn a_line_that_is_closed_but_for_rounding_does_not_cross_itself() {
        for error_m in [1e-16, -1e-16, 1e-12, -1e-12] {
            let end_m = [error_m, error_m];
            assert!(!meets(&[line(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], end_m])]), "{error_m}");
        }
    }

    #[test]
    fn lines_on_one_line_meet_where_they_overlap() {
        let along = |from_m: f64, to_m: f64| [[from_m, 0.0], [to_m, 0.0]];
        assert_eq!(crossing(&along(0.0, 0.2), &along(0.1, 0.3)), Some([0.1, 0.0]));
        assert_eq!(crossing(&along(0.1, 0.2), &along(0.0, 0.3)), Some([0.1, 0.0]));
        assert_eq!(crossing(&along(0.0, 0.2), &along(0.3, 0.2)), Some([0.2, 0.0]));
        assert_eq!(crossing(&along(0.0, 0.1), &along(0.2, 0.3)), None);
        assert_eq!(crossing(&along(0.0, 0.2), &[[0.0, 0.001], [0.2, 0.001]]), None);
    }

    /// Points on an ellipse in the order of their angles are the corners of a convex outline, open or closed.
    #[test]
    fn drawn_convex_lines_never_cross() {
        let mut random = Pcg64::new(5, 0);
        for case in 0..300 {
            let count = 3 + case % 40;
            let [wide_m, high_m] = [0; 2].map(|_| 0.02 + 0.2 * random.random::<f64>());
            let mut points_m: Vec<[f64; 2]> = (0..count)
                .map(|number| {
                    // At least a fifth of the angle between two points, so that no two are one.
                    let part = number as f64 + 0.8 * random.random::<f64>();
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * part / count as f64);
                    [wide_m * cos, high_m * sin]
                })
                .collect();
            assert!(!meets(&[line(&points_m)]), "{case}: open {points_m:?}");
            points_m.push(points_m[0]);
            assert!(!meets(&[line(&points_m)]), "{case}: closed {points_m:?}");
        }
    }

    /// Two loops with one crossing in the middle, turned and moved; where they cross is the drawn place.
    #[test]
    fn drawn_figures_of_eight_cross_in_their_middle() {
        let mut random = Pcg64::new(6, 0);
        for case in 0..300 {
            let mut draw = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
            let [x_m, y_m] = [draw(-0.2, 0.2), draw(-0.2, 0.2)];
            let (sin, cos) = libm::sincos(draw(0.0, std::f64::consts::TAU));
            let place = |[u, v]: [f64; 2]| [x_m + u * cos - v * sin, y_m + u * sin + v * cos];
            let [left_m, right_m, high_m] = [draw(0.02, 0.2), draw(0.02, 0.2), draw(0.01, 0.1)];
            // Diagonals with slopes of plus and minus `slope` through the middle, and the edge on the right.
            let slope = high_m / 0.1;
            let corners = [
                [-left_m, -slope * left_m],
                [right_m, slope * right_m],
                [right_m, -slope * right_m],
                [-left_m, slope * left_m],
            ];
            let points_m = corners.map(place);
            assert!(meets(&[line(&points_m)]), "{case}: {points_m:?}");
            let [met_x_m, met_y_m] = crossing(&[points_m[0], points_m[1]], &[points_m[2], points_m[3]]).unwrap();
            // Rounding of coordinates below 1 m, 1e-16, over the least angle of the diagonals, 0.2 rad.
            assert!(libm::hypot(met_x_m - x_m, met_y_m - y_m) < 1e-12, "{case}: [{met_x_m}, {met_y_m}]");
        }
    }

    /// Points in the order of their angles about a point between them make a star-shaped line, which never meets itself.
    #[test]
    fn drawn_star_shaped_lines_never_cross() {
        let mut random = Pcg64::new(3, 0);
        for case in 0..300 {
            let mut angles: Vec<f64> = (0..8).map(|_| random.random::<f64>() * 6.0).collect();
            angles.sort_by(f64::total_cmp);
            let mut points_m = vec![[0.0, 0.0]];
            for angle in angles {
                let [x, y] = points_m[points_m.len() - 1];
                let length_m = 0.01 + 0.1 * random.random::<f64>();
                points_m.push([x + length_m * angle.cos(), y + length_m * angle.sin()]);
            }
            let star = in_order_of_angle(&points_m);
            assert!(!meets(&[line(&star)]), "{case}: {star:?}");
        }
    }

    /// The points in the order of their angles about their mean, closed.
    fn in_order_of_angle(points_m: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mean = [0, 1].map(|axis| points_m.iter().map(|point| point[axis]).sum::<f64>() / points_m.len() as f64);
        let mut ordered = points_m.to_vec();
        let angle = |point: &[f64; 2]| (point[1] - mean[1]).atan2(point[0] - mean[0]);
        ordered.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        ordered.push(ordered[0]);
        ordered
    }
}
