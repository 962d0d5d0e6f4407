//! The convex hull of points in a plane.

/// A point in the plane of a picture.
pub type Point2 = [f64; 2];

/// Twice the signed area of a triangle: positive if its corners are in counter-clockwise order.
fn turn(a: Point2, b: Point2, c: Point2) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The corners of the convex hull in counter-clockwise order, by Andrew's monotone chain (A. M. Andrew, "Another
/// efficient algorithm for convex hulls in two dimensions", 1979).
#[must_use]
pub fn convex_hull(mut points: Vec<Point2>) -> Vec<Point2> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull = half(points.iter().copied());
    hull.pop();
    hull.extend(half(points.into_iter().rev()));
    hull.pop();
    hull
}

/// The lower half of the hull if the points are sorted from left to right, the upper half if from right to left.
fn half(points: impl Iterator<Item = Point2>) -> Vec<Point2> {
    let mut hull: Vec<Point2> = Vec::new();
    for point in points {
        while let [.., a, b] = hull[..]
            && turn(a, b, point) <= 0.0
        {
            hull.pop();
        }
        hull.push(point);
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_its_corners() {
        let inside = vec![[1.0, 1.0], [0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [1.0, 0.0], [0.5, 1.5]];
        assert_eq!(convex_hull(inside), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    }

    #[test]
    fn every_point_is_inside_or_on_the_hull() {
        // A golden-angle spiral: no three points on a line, many inside the hull.
        let point = |k: u32| {
            let (sin, cos) = libm::sincos(2.399_963 * f64::from(k));
            [f64::from(k) * cos, f64::from(k) * sin]
        };
        let hull = convex_hull((0..60).map(point).collect());
        assert!(hull.len() > 5 && hull.len() < 60);
        for (index, &from) in hull.iter().enumerate() {
            let to = hull[(index + 1) % hull.len()];
            // Rounding of products of numbers up to 60.
            assert!((0..60).all(|k| turn(from, to, point(k)) > -1e-10), "edge {index}");
        }
    }
}
