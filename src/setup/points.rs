//! Points spread over the robot's surface, from which distances to the person are measured.

use nalgebra::Point3;

use crate::robot::{BodyPoint, Robot};

/// Links whose shapes are all within this distance of their middle have one point, m.
const SMALL_M: f64 = 0.05;

/// Points of a larger link that an arm moves, and of one that stands still.
const MOVING_POINTS: usize = 4;
const FIXED_POINTS: usize = 3;

/// The most links that stand still and have points: the largest ones.
const MOST_FIXED_LINKS: usize = 6;

/// The points of a robot.
pub(super) fn body_points(robot: &Robot) -> Vec<BodyPoint> {
    let moves = robot.moved_links();
    let surfaces: Vec<Vec<Point3<f64>>> = (0..robot.links.len()).map(|link| surface_l(robot, link)).collect();
    let mut fixed: Vec<usize> =
        (0..robot.links.len()).filter(|&link| !moves[link] && !surfaces[link].is_empty()).collect();
    fixed.sort_by(|&a, &b| radius_m(&surfaces[b]).total_cmp(&radius_m(&surfaces[a])));
    fixed.truncate(MOST_FIXED_LINKS);
    let mut points = Vec::new();
    for (link, surface) in surfaces.iter().enumerate() {
        let count = match (moves[link], radius_m(surface) > SMALL_M) {
            (true, true) => MOVING_POINTS,
            (true, false) => 1,
            (false, _) if fixed.contains(&link) => FIXED_POINTS,
            (false, _) => 0,
        };
        points.extend(spread(surface, count).into_iter().map(|p_l| BodyPoint { link, p_l: rounded(p_l) }));
    }
    points
}

/// Points on the surface of a link's shapes, in its frame.
fn surface_l(robot: &Robot, link: usize) -> Vec<Point3<f64>> {
    let shapes = robot.links[link].shapes.iter();
    shapes.flat_map(|placed| placed.shape.surface_points().into_iter().map(move |p_s| placed.x_ls * p_s)).collect()
}

fn centre(points: &[Point3<f64>]) -> Point3<f64> {
    let count = points.len().max(1) as f64;
    Point3::from(points.iter().map(|point| point.coords).sum::<nalgebra::Vector3<f64>>() / count)
}

fn radius_m(points: &[Point3<f64>]) -> f64 {
    let centre = centre(points);
    points.iter().map(|point| (point - centre).norm()).fold(0.0, f64::max)
}

/// A few of the points, far from each other: the farthest from the middle first, then always the one farthest from those chosen.
fn spread(points: &[Point3<f64>], count: usize) -> Vec<Point3<f64>> {
    let middle = centre(points);
    let mut chosen: Vec<Point3<f64>> = Vec::new();
    while chosen.len() < count.min(points.len()) {
        let distance = |point: &Point3<f64>| {
            let others = if chosen.is_empty() { std::slice::from_ref(&middle) } else { &chosen[..] };
            others.iter().map(|other| (point - other).norm()).fold(f64::INFINITY, f64::min)
        };
        let Some(farthest) = points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))) else { break };
        if distance(farthest) <= 0.0 {
            break;
        }
        chosen.push(*farthest);
    }
    chosen
}

/// Tenths of a millimetre.
fn rounded(point: Point3<f64>) -> Point3<f64> {
    point.map(|v| (v * 1e4).round() / 1e4)
}
