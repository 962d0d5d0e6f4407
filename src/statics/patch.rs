//! The rectangular contact patch between a pad and a face.

use nalgebra::{Isometry2, Point2, Vector2};

use crate::model::plate::OutlineSide;

/// Mean distance of a rectangle's points from its centre, `e = (1/A) integral of r dA`, m, for half sides `a`, `b`:
///
/// `e = d/3 + a^2/(6 b) asinh(b/a) + b^2/(6 a) asinh(a/b)`, `d = sqrt(a^2 + b^2)`.
///
/// A patch under uniform pressure with total normal force N holds the torsion `mu e N` about its centre. Both half
/// sides must be positive.
#[must_use]
pub fn mean_distance_from_centre_m(half_sides_m: [f64; 2]) -> f64 {
    let [a, b] = half_sides_m;
    a.hypot(b) / 3.0 + a * a / (6.0 * b) * (b / a).asinh() + b * b / (6.0 * a) * (a / b).asinh()
}

/// Clips a pad that overhangs a face to a rectangle along the pad's axes inside both.
///
/// The face is the rectangle of half sides `face_half_m` about its own centre; `x_fp` is the pad's pose in the face.
/// For each edge of the face with a corner of the pad beyond it, one side of the pad is moved inward until no corner
/// is: the side whose move leaves the larger area. The result is inside the true intersection, so it errs on the safe
/// side; for a pad with sides parallel to the face's it is the intersection.
///
/// Returns the clipped rectangle's centre in the face and its half sides along the pad's axes, m; `None` if it is
/// empty.
#[must_use]
pub fn clip_to_rectangle(
    face_half_m: [f64; 2],
    x_fp: &Isometry2<f64>,
    pad_half_m: [f64; 2],
) -> Option<(Point2<f64>, [f64; 2])> {
    let edge = |axis: usize, side: f64| {
        let mut outward_f = Vector2::zeros();
        outward_f[axis] = side;
        (outward_f, face_half_m[axis])
    };
    let edges = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)].map(|(axis, side)| edge(axis, side));
    clip(edges.into_iter(), x_fp, pad_half_m)
}

/// As [`clip_to_rectangle`], for a face with a convex outline; its holes are left out of account.
#[must_use]
pub fn clip_to_outline(
    sides: &[OutlineSide],
    x_fp: &Isometry2<f64>,
    pad_half_m: [f64; 2],
) -> Option<(Point2<f64>, [f64; 2])> {
    clip(sides.iter().map(|side| (Vector2::from(side.outward), side.reach_m)), x_fp, pad_half_m)
}

/// Clips a pad to half planes `outward . p <= reach` of the face.
fn clip(
    edges: impl Iterator<Item = (Vector2<f64>, f64)>,
    x_fp: &Isometry2<f64>,
    pad_half_m: [f64; 2],
) -> Option<(Point2<f64>, [f64; 2])> {
    let mut low = Vector2::new(-pad_half_m[0], -pad_half_m[1]);
    let mut high = -low;
    for (outward_f, face_reach_m) in edges {
        // In pad coordinates.
        let outward_p = x_fp.rotation.inverse() * outward_f;
        let reach_m = face_reach_m - outward_f.dot(&x_fp.translation.vector);
        trim(&mut low, &mut high, &outward_p, reach_m)?;
    }
    let centre_p = (low + high) / 2.0;
    let half = (high - low) / 2.0;
    Some((x_fp * Point2::from(centre_p), [half.x, half.y]))
}

/// Moves one side of the box inward until it lies in the half plane `outward . p <= reach_m`; `None` if it becomes
/// empty.
fn trim(low: &mut Vector2<f64>, high: &mut Vector2<f64>, outward: &Vector2<f64>, reach_m: f64) -> Option<()> {
    let farthest = |axis: usize| if outward[axis] > 0.0 { high[axis] } else { low[axis] };
    let excess_m = outward[0] * farthest(0) + outward[1] * farthest(1) - reach_m;
    if excess_m <= 0.0 {
        return Some(());
    }
    // The share of the box that remains if this axis is cut; cutting an axis along the edge has no effect.
    let remaining = |axis: usize| 1.0 - excess_m / (outward[axis].abs() * (high[axis] - low[axis]));
    let axis = if remaining(0) >= remaining(1) { 0 } else { 1 };
    if remaining(axis).is_nan() || remaining(axis) <= 0.0 {
        return None;
    }
    let cut_m = excess_m / outward[axis].abs();
    if outward[axis] > 0.0 {
        high[axis] -= cut_m;
    } else {
        low[axis] += cut_m;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_distance_agrees_with_quadrature() {
        for half in [[0.0202, 0.0180], [0.01, 0.03], [1.0, 1.0]] {
            let cells = 400;
            let at = |axis: usize, i: usize| half[axis] * ((i as f64 + 0.5) / cells as f64);
            let sum: f64 =
                (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))).map(|(i, j)| at(0, i).hypot(at(1, j))).sum();
            let quadrature = sum / (cells * cells) as f64;
            // The midpoint rule on 400 x 400 cells is accurate to about 1e-6 (second order except at the tip of the
            // cone).
            approx::assert_relative_eq!(mean_distance_from_centre_m(half), quadrature, max_relative = 3e-6);
        }
    }

    #[test]
    fn the_reference_pad_has_its_published_radius() {
        // 40.4 x 36.0 mm: 14.63 mm as four figures.
        assert!((mean_distance_from_centre_m([0.0202, 0.0180]) - 14.63e-3).abs() < 0.5e-5);
    }

    #[test]
    fn an_aligned_pad_is_clipped_to_the_intersection() {
        let x_fp = Isometry2::new(Vector2::new(0.24, 0.19), 0.0);
        let (centre, half) = clip_to_rectangle([0.25, 0.20], &x_fp, [0.02, 0.018]).unwrap();
        // x from 0.22 to 0.25, y from 0.172 to 0.20; rounding only.
        assert!((centre - Point2::new(0.235, 0.186)).norm() < 1e-15);
        assert!((half[0] - 0.015).abs() < 1e-15 && (half[1] - 0.014).abs() < 1e-15);
    }

    #[test]
    fn a_pad_inside_is_unchanged_and_one_outside_is_empty() {
        let inside = Isometry2::new(Vector2::new(0.1, -0.1), 0.7);
        let (centre, half) = clip_to_rectangle([0.25, 0.20], &inside, [0.02, 0.018]).unwrap();
        assert_eq!((centre, half), (Point2::new(0.1, -0.1), [0.02, 0.018]));
        let outside = Isometry2::new(Vector2::new(0.3, 0.0), 0.7);
        assert!(clip_to_rectangle([0.25, 0.20], &outside, [0.02, 0.018]).is_none());
    }

    /// For a rectangle both are the same function; for a triangle the remainder is inside all three sides.
    #[test]
    fn an_outline_clips_as_its_half_planes_do() {
        let side = |outward: [f64; 2], reach_m: f64| OutlineSide { outward, reach_m, along_m: [-1.0, 1.0] };
        let rectangle =
            [side([1.0, 0.0], 0.25), side([-1.0, 0.0], 0.25), side([0.0, 1.0], 0.2), side([0.0, -1.0], 0.2)];
        let tilted = std::f64::consts::FRAC_1_SQRT_2;
        let triangle = [side([tilted, tilted], 0.1), side([-tilted, tilted], 0.1), side([0.0, -1.0], 0.1)];
        for (x, y, angle) in [(0.24, 0.19, 0.3), (0.0, 0.0, 1.0), (0.1, 0.02, -0.4), (0.05, 0.0, 2.0)] {
            let x_fp = Isometry2::new(Vector2::new(x, y), angle);
            let pad = [0.0202, 0.018];
            assert_eq!(clip_to_outline(&rectangle, &x_fp, pad), clip_to_rectangle([0.25, 0.2], &x_fp, pad));
            let Some((centre, half)) = clip_to_outline(&triangle, &x_fp, pad) else { continue };
            for corner in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let p = centre + x_fp.rotation * Vector2::new(corner[0] * half[0], corner[1] * half[1]);
                let inside = |side: &OutlineSide| Vector2::from(side.outward).dot(&p.coords) <= side.reach_m + 1e-12;
                assert!(triangle.iter().all(inside), "{p}");
            }
        }
    }

    proptest::proptest! {
        /// Conservative: every corner of what remains lies in the face and in the pad.
        #[test]
        fn what_remains_lies_in_both(x in -0.3..0.3, y in -0.25..0.25, angle in -4.0..4.0) {
            let (face, pad) = ([0.25, 0.20], [0.0202, 0.018]);
            let x_fp = Isometry2::new(Vector2::new(x, y), angle);
            if let Some((centre, half)) = clip_to_rectangle(face, &x_fp, pad) {
                for corner in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                    let offset_p = Vector2::new(corner[0] * half[0], corner[1] * half[1]);
                    let corner_f = centre + x_fp.rotation * offset_p;
                    let corner_p = x_fp.inverse() * corner_f;
                    // Rounding of lengths below 1 m.
                    proptest::prop_assert!(corner_f.x.abs() <= face[0] + 1e-12 && corner_f.y.abs() <= face[1] + 1e-12);
                    proptest::prop_assert!(corner_p.x.abs() <= pad[0] + 1e-12 && corner_p.y.abs() <= pad[1] + 1e-12);
                }
            }
        }
    }
}
