//! Polygons in a plane: areas and moments, convexity, distances, triangles. Corners are `[x, y]` in m, in order; the last one is
//! joined to the first. Counter-clockwise is seen from +z.

/// A point of the plane, m.
pub type Point = [f64; 2];

/// Integrals over an area: `A`, `[integral of x, of y]` and `[integral of x^2, of y^2, of x y]`, m^2, m^3 and m^4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaMoments {
    /// The area, m^2.
    pub area_m2: f64,
    /// First moments about the origin, m^3.
    pub first_m3: [f64; 2],
    /// Second moments about the origin, m^4.
    pub second_m4: [f64; 3],
}

impl AreaMoments {
    /// The moments of a polygon by Green's theorem, exact; negative if it is clockwise.
    #[must_use]
    pub fn of(corners: &[Point]) -> Self {
        let mut sum = Self::default();
        for ([x0, y0], [x1, y1]) in sides(corners) {
            let cross = x0 * y1 - x1 * y0;
            sum.area_m2 += cross / 2.0;
            sum.first_m3[0] += (x0 + x1) * cross / 6.0;
            sum.first_m3[1] += (y0 + y1) * cross / 6.0;
            sum.second_m4[0] += (x0 * x0 + x0 * x1 + x1 * x1) * cross / 12.0;
            sum.second_m4[1] += (y0 * y0 + y0 * y1 + y1 * y1) * cross / 12.0;
            sum.second_m4[2] += (x0 * y1 + 2.0 * x0 * y0 + 2.0 * x1 * y1 + x1 * y0) * cross / 24.0;
        }
        sum
    }

    /// The moments of what is left if another area is cut out.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        Self {
            area_m2: self.area_m2 - other.area_m2,
            first_m3: std::array::from_fn(|k| self.first_m3[k] - other.first_m3[k]),
            second_m4: std::array::from_fn(|k| self.second_m4[k] - other.second_m4[k]),
        }
    }

    /// The centroid, m.
    #[must_use]
    pub fn centroid_m(&self) -> Point {
        self.first_m3.map(|first_m3| first_m3 / self.area_m2)
    }

    /// Second moments `[xx, yy, xy]` about the centroid, per area, m^2.
    #[must_use]
    pub fn central_m2(&self) -> [f64; 3] {
        let [x, y] = self.centroid_m();
        let [xx, yy, xy] = self.second_m4.map(|second_m4| second_m4 / self.area_m2);
        [xx - x * x, yy - y * y, xy - x * y]
    }
}

/// The sides of a polygon.
pub fn sides(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]))
}

/// A regular polygon of the area of a circle, counter-clockwise.
#[must_use]
pub fn circle(centre_m: Point, radius_m: f64, corners: usize) -> Vec<Point> {
    let turn_rad = std::f64::consts::TAU / corners as f64;
    let reach_m = radius_m * (turn_rad / libm::sin(turn_rad)).sqrt();
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(turn_rad * k as f64);
        [centre_m[0] + reach_m * cos, centre_m[1] + reach_m * sin]
    };
    (0..corners).map(corner).collect()
}

/// `(a - o) x (b - o)`, m^2: positive if `o, a, b` turn counter-clockwise.
#[must_use]
pub fn cross(o: Point, a: Point, b: Point) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

/// Distance of two points, m.
#[must_use]
pub fn distance_m(a: Point, b: Point) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

/// True if a point is inside a polygon: a ray from it crosses the sides an odd number of times.
#[must_use]
pub fn contains(corners: &[Point], p: Point) -> bool {
    let crossed = |(a, b): &(Point, Point)| {
        (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    sides(corners).filter(crossed).count() % 2 == 1
}

/// Distance of a point from a segment, m.
fn distance_from_segment_m(p: Point, (a, b): (Point, Point)) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 { ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / squared } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    distance_m(p, [a[0] + share * along[0], a[1] + share * along[1]])
}

/// Distance of a point from the sides of a polygon, m.
#[must_use]
pub fn distance_from_sides_m(corners: &[Point], p: Point) -> f64 {
    sides(corners).map(|side| distance_from_segment_m(p, side)).fold(f64::INFINITY, f64::min)
}

/// True if two segments have a point in common.
#[must_use]
pub fn segments_meet((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let apart = |p: Point, q: Point, r: Point, s: Point| {
        let (one, other) = (cross(p, q, r), cross(p, q, s));
        (one > 0.0 && other > 0.0) || (one < 0.0 && other < 0.0)
    };
    let boxes_meet = (0..2).all(|k| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]));
    boxes_meet && !apart(a, b, c, d) && !apart(c, d, a, b)
}

/// The least distance of the sides of two polygons, m; 0 if they cross.
#[must_use]
pub fn distance_of_sides_m(one: &[Point], other: &[Point]) -> f64 {
    if sides(one).any(|side| sides(other).any(|against| segments_meet(side, against))) {
        return 0.0;
    }
    let from_other = one.iter().map(|&p| distance_from_sides_m(other, p));
    let from_one = other.iter().map(|&p| distance_from_sides_m(one, p));
    from_other.chain(from_one).fold(f64::INFINITY, f64::min)
}

/// The first side that meets another one that does not follow it; `None` for a simple polygon.
#[must_use]
pub fn crossing_side(corners: &[Point]) -> Option<usize> {
    let all: Vec<_> = sides(corners).collect();
    let count = all.len();
    let crosses = |&k: &usize| {
        let apart = |other: usize| other != k && (k + 1) % count != other && (other + 1) % count != k;
        (0..count).any(|other| apart(other) && segments_meet(all[k], all[other]))
    };
    (0..count).find(crosses)
}

/// The convex hull, counter-clockwise (Andrew's monotone chain).
#[must_use]
pub fn convex_hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let chain = |points: &mut dyn Iterator<Item = &Point>| {
        let mut hull: Vec<Point> = Vec::new();
        for &point in points {
            while hull.len() >= 2 && cross(hull[hull.len() - 2], hull[hull.len() - 1], point) <= 0.0 {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    [chain(&mut sorted.iter()), chain(&mut sorted.iter().rev())].concat()
}

/// The largest separation of two convex, counter-clockwise polygons along the normals of their sides, m: at least 0 if and only
/// if their interiors are disjoint, and never more than their distance.
#[must_use]
pub fn separation_m(one: &[Point], other: &[Point]) -> f64 {
    let beyond = |of: &[Point], against: &[Point]| {
        let along = |(a, b): (Point, Point)| {
            let length_m = distance_m(a, b);
            let behind = against.iter().map(|&p| -cross(a, b, p) / length_m);
            behind.fold(f64::INFINITY, f64::min)
        };
        sides(of).map(along).fold(f64::NEG_INFINITY, f64::max)
    };
    beyond(one, other).max(beyond(other, one))
}

/// Triangles of a simple, counter-clockwise polygon with holes, as corners, counter-clockwise. They cover the polygon without
/// the holes exactly (cutting of ears after joining each hole to the outline).
#[must_use]
pub fn triangles(outline: &[Point], holes: &[Vec<Point>]) -> Vec<[Point; 3]> {
    let mut rest = outline.to_vec();
    let mut open: Vec<&Vec<Point>> = holes.iter().collect();
    while !open.is_empty() {
        let Some((hole, from, to)) = shortest_bridge(&rest, &open) else { break };
        let hole = open.remove(hole);
        // Along the bridge, round the hole clockwise, and back.
        let round = (0..=hole.len()).map(|k| hole[(to + hole.len() - k) % hole.len()]);
        let joined: Vec<Point> = round.chain(std::iter::once(rest[from])).collect();
        rest.splice(from + 1..from + 1, joined);
    }
    let mut found = Vec::with_capacity(rest.len());
    while rest.len() >= 3 {
        let count = rest.len();
        let corner = |k: usize| [rest[(k + count - 1) % count], rest[k], rest[(k + 1) % count]];
        // Without an ear only flat corners are left.
        let Some(ear) = (0..count).find(|&k| is_ear(&rest, &corner(k))) else { break };
        let triangle = corner(ear);
        if cross(triangle[0], triangle[1], triangle[2]) > 0.0 {
            found.push(triangle);
        }
        rest.remove(ear);
    }
    found
}

/// The shortest segment from a corner of a polygon to a corner of a hole that meets no side: hole, corner, corner of the hole.
fn shortest_bridge(rest: &[Point], holes: &[&Vec<Point>]) -> Option<(usize, usize, usize)> {
    let all_sides: Vec<_> = sides(rest).chain(holes.iter().flat_map(|hole| sides(hole))).collect();
    let is_free = |a: Point, b: Point| {
        all_sides.iter().all(|&(c, d)| [a, b].contains(&c) || [a, b].contains(&d) || !segments_meet((a, b), (c, d)))
    };
    let mut bridges: Vec<_> = holes
        .iter()
        .enumerate()
        .flat_map(|(hole, corners)| (0..corners.len()).map(move |to| (hole, to)))
        .flat_map(|(hole, to)| (0..rest.len()).map(move |from| (hole, from, to)))
        .collect();
    let length_m = |&(hole, from, to): &(usize, usize, usize)| distance_m(rest[from], holes[hole][to]);
    bridges.sort_by(|a, b| length_m(a).total_cmp(&length_m(b)));
    bridges.into_iter().find(|&(hole, from, to)| is_free(rest[from], holes[hole][to]))
}

/// True if no other corner lies in the triangle of a corner that is not reflex.
fn is_ear(rest: &[Point], triangle: &[Point; 3]) -> bool {
    let [a, b, c] = *triangle;
    let turn = cross(a, b, c);
    if turn < 0.0 {
        return false;
    }
    let is_inside = |p: Point| cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0;
    turn == 0.0 || rest.iter().all(|&p| triangle.contains(&p) || !is_inside(p))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Rounding of a few products of lengths below 1 m.
    const ROUNDING: f64 = 1e-14;

    fn regular(count: usize, reach_m: f64) -> Vec<Point> {
        (0..count)
            .map(|k| {
                let (sin, cos) = libm::sincos(TAU * k as f64 / count as f64);
                [reach_m * cos, reach_m * sin]
            })
            .collect()
    }

    fn moved(corners: &[Point], [x, y]: Point) -> Vec<Point> {
        corners.iter().map(|[px, py]| [px + x, py + y]).collect()
    }

    #[test]
    fn a_right_triangle_has_the_moments_of_the_textbook() {
        let (b, h) = (0.3, 0.2);
        let found = AreaMoments::of(&[[0.0, 0.0], [b, 0.0], [0.0, h]]);
        assert!((found.area_m2 - b * h / 2.0).abs() < ROUNDING);
        let [x, y] = found.centroid_m();
        assert!((x - b / 3.0).abs() < ROUNDING && (y - h / 3.0).abs() < ROUNDING);
        let expected = [b * b / 18.0, h * h / 18.0, -b * h / 36.0];
        for (found, expected) in found.central_m2().iter().zip(expected) {
            assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
        }
    }

    #[test]
    fn a_regular_polygon_has_the_moments_of_the_textbook_wherever_it_is() {
        for count in 3..12 {
            let (reach_m, turn) = (0.25, TAU / count as f64);
            let found = AreaMoments::of(&moved(&regular(count, reach_m), [0.1, -0.3]));
            assert!((found.area_m2 - count as f64 / 2.0 * reach_m * reach_m * turn.sin()).abs() < ROUNDING);
            // I = A R^2 (2 + cos(2 pi / n)) / 12 about every axis in the plane.
            let expected = reach_m * reach_m * (2.0 + turn.cos()) / 12.0;
            let [xx, yy, xy] = found.central_m2();
            assert!((xx - expected).abs() < ROUNDING && (yy - expected).abs() < ROUNDING && xy.abs() < ROUNDING);
            let [x, y] = found.centroid_m();
            assert!((x - 0.1).abs() < ROUNDING && (y + 0.3).abs() < ROUNDING);
        }
    }

    #[test]
    fn a_circle_keeps_its_area() {
        let found = AreaMoments::of(&circle([0.2, 0.1], 0.05, 32));
        assert!((found.area_m2 - std::f64::consts::PI * 0.0025).abs() < ROUNDING);
        assert!((found.centroid_m()[0] - 0.2).abs() < ROUNDING);
    }

    #[test]
    fn inside_outside_and_distances() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(contains(&square, [0.5, 0.9]) && !contains(&square, [1.1, 0.5]));
        assert!((distance_from_sides_m(&square, [0.5, 0.8]) - 0.2).abs() < ROUNDING);
        assert!((distance_from_sides_m(&square, [2.0, 2.0]) - 2.0_f64.sqrt()).abs() < ROUNDING);
        assert!((distance_of_sides_m(&square, &moved(&square, [1.5, 0.0])) - 0.5).abs() < ROUNDING);
        assert_eq!(distance_of_sides_m(&square, &moved(&square, [0.5, 0.5])), 0.0);
        assert!((separation_m(&square, &moved(&square, [1.5, 0.3])) - 0.5).abs() < ROUNDING);
        assert!((separation_m(&square, &moved(&square, [0.9, 0.0])) + 0.1).abs() < ROUNDING);
    }

    #[test]
    fn a_polygon_that_crosses_itself_is_found() {
        assert_eq!(crossing_side(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Some(0));
        assert_eq!(crossing_side(&regular(7, 0.3)), None);
    }

    #[test]
    fn a_hull_leaves_out_what_is_inside() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.2], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]];
        assert_eq!(convex_hull(&points), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    }

    /// The triangles have the area and the moments of the polygon, and all turn counter-clockwise.
    #[test]
    fn triangles_cover_a_plate_with_holes_exactly() {
        let outline = regular(9, 0.4);
        let concave = vec![[-0.1, -0.1], [0.0, -0.05], [0.1, -0.1], [0.05, 0.0], [-0.05, 0.0]];
        let holes = [circle([0.2, 0.1], 0.06, 32), circle([-0.15, 0.15], 0.04, 12), concave];
        for count in 0..=holes.len() {
            let holes = &holes[..count];
            let expected =
                holes.iter().fold(AreaMoments::of(&outline), |all, hole| all.without(&AreaMoments::of(hole)));
            let found = triangles(&outline, holes);
            // Each hole adds two corners to those of the polygon.
            let corners = outline.len() + holes.iter().map(|hole| hole.len() + 2).sum::<usize>();
            assert!(found.len() <= corners - 2, "{} {corners}", found.len());
            let [mut area_m2, mut xx_m4] = [0.0; 2];
            for triangle in &found {
                let moments = AreaMoments::of(triangle);
                assert!(moments.area_m2 > 0.0);
                area_m2 += moments.area_m2;
                xx_m4 += moments.second_m4[0];
            }
            assert!((area_m2 - expected.area_m2).abs() < ROUNDING, "{area_m2} {}", expected.area_m2);
            assert!((xx_m4 - expected.second_m4[0]).abs() < ROUNDING);
        }
    }
}
