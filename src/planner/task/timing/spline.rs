//! Natural cubic splines through waypoints, and their distance from the polyline of the waypoints.

/// Waypoints nearer than this are one, rad or m: the direction of a shorter chord is the rounding of inverse
/// kinematics.
const SAME: f64 = 1e-6;

/// A point of a spline with its derivatives with respect to the chord length s, one entry for each joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplinePoint {
    /// Joint positions, rad or m.
    pub q: Vec<f64>,
    /// dq/ds.
    pub first: Vec<f64>,
    /// d²q/ds².
    pub second: Vec<f64>,
}

/// A cubic spline through waypoints by chord length, twice continuously differentiable, with `d²q/ds² = 0` at both
/// ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Chord length at each waypoint: the sum of the Euclidean distances before it, rad or m. It increases strictly.
    pub knots: Vec<f64>,
    waypoints: Vec<Vec<f64>>,
    /// d²q/ds² at each waypoint.
    seconds: Vec<Vec<f64>>,
}

impl Spline {
    /// The spline through waypoints of which no two neighbours are equal ([`distinct`]).
    pub fn through(waypoints: &[Vec<f64>]) -> Self {
        let mut knots = vec![0.0];
        let mut length = 0.0;
        for pair in waypoints.windows(2) {
            length += distance(&pair[0], &pair[1]);
            knots.push(length);
        }
        let seconds = seconds(&knots, waypoints);
        Self { knots, waypoints: waypoints.to_vec(), seconds }
    }

    /// The number of intervals between waypoints.
    pub fn intervals(&self) -> usize {
        self.waypoints.len().saturating_sub(1)
    }

    /// The point at a chord length s within an interval.
    pub fn at(&self, interval: usize, s: f64) -> SplinePoint {
        let (low, high) = (self.knots[interval], self.knots[interval + 1]);
        let h = high - low;
        let (a, b) = ((high - s) / h, (s - low) / h);
        let mut point = SplinePoint::default();
        for joint in 0..self.waypoints[interval].len() {
            let [q0, q1] = [interval, interval + 1].map(|knot| self.waypoints[knot][joint]);
            let [m0, m1] = [interval, interval + 1].map(|knot| self.seconds[knot][joint]);
            point.q.push(a * q0 + b * q1 + ((a * a * a - a) * m0 + (b * b * b - b) * m1) * h * h / 6.0);
            point.first.push((q1 - q0) / h + ((1.0 - 3.0 * a * a) * m0 + (3.0 * b * b - 1.0) * m1) * h / 6.0);
            point.second.push(a * m0 + b * m1);
        }
        point
    }

    /// Largest distance of any joint of an interval's spline from the nearest point of its chord, rad or m, at the
    /// given number of points inside the interval.
    pub fn deviation(&self, interval: usize, points: usize) -> f64 {
        let (from, to) = (&self.waypoints[interval], &self.waypoints[interval + 1]);
        let h = self.knots[interval + 1] - self.knots[interval];
        let mut largest = 0.0_f64;
        for number in 1..=points {
            let s = self.knots[interval] + h * number as f64 / (points + 1) as f64;
            let q = self.at(interval, s).q;
            let along: f64 = (0..q.len()).map(|joint| (q[joint] - from[joint]) * (to[joint] - from[joint])).sum();
            let share = (along / (h * h)).clamp(0.0, 1.0);
            let off = |joint: usize| (q[joint] - from[joint] - share * (to[joint] - from[joint])).abs();
            largest = (0..q.len()).map(off).fold(largest, f64::max);
        }
        largest
    }
}

/// The waypoints without those that repeat their predecessor within 1e-6 rad or m. The first and last ones stay
/// exactly.
pub fn distinct(path: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for waypoint in path {
        if kept.last().is_none_or(|last| distance(last, waypoint) > SAME) {
            kept.push(waypoint.clone());
        }
    }
    if let (Some(last), Some(end)) = (kept.last(), path.last())
        && last != end
    {
        // Within `SAME` of the last kept waypoint, which gives way unless it is the start and the two can be told
        // apart.
        if kept.len() > 1 || distance(last, end) <= f64::EPSILON {
            kept.pop();
        }
        kept.push(end.clone());
    }
    kept
}

/// Angle between the chords before and after a waypoint, rad.
pub fn corner_rad(before: &[f64], here: &[f64], after: &[f64]) -> f64 {
    let unit = |from: &[f64], to: &[f64]| {
        let length = distance(from, to);
        from.iter().zip(to).map(|(from, to)| (to - from) / length).collect::<Vec<_>>()
    };
    let (first, second) = (unit(before, here), unit(here, after));
    let norm = |sign: f64| first.iter().zip(&second).map(|(a, b)| (b + sign * a) * (b + sign * a)).sum::<f64>().sqrt();
    // Of two unit vectors: exact for small angles too, unlike the arc cosine.
    2.0 * libm::atan2(norm(-1.0), norm(1.0))
}

/// The Euclidean distance.
pub fn distance(from: &[f64], to: &[f64]) -> f64 {
    from.iter().zip(to).map(|(from, to)| (to - from) * (to - from)).sum::<f64>().sqrt()
}

/// The second derivatives of the natural spline at its knots: a tridiagonal system, diagonally dominant, by elimination
/// without pivots (Press et al., Numerical Recipes, section 3.3).
fn seconds(knots: &[f64], waypoints: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let joints = waypoints.first().map_or(0, Vec::len);
    let mut seconds = vec![vec![0.0; joints]; knots.len()];
    let mut upper = vec![0.0; knots.len()];
    for k in 1..knots.len().saturating_sub(1) {
        let (h0, h1) = (knots[k] - knots[k - 1], knots[k + 1] - knots[k]);
        let pivot = 2.0 * (h0 + h1) - h0 * upper[k - 1];
        upper[k] = h1 / pivot;
        for joint in 0..joints {
            let slope0 = (waypoints[k][joint] - waypoints[k - 1][joint]) / h0;
            let slope1 = (waypoints[k + 1][joint] - waypoints[k][joint]) / h1;
            seconds[k][joint] = (6.0 * (slope1 - slope0) - h0 * seconds[k - 1][joint]) / pivot;
        }
    }
    for k in (1..knots.len().saturating_sub(1)).rev() {
        let (before, after) = seconds.split_at_mut(k + 1);
        before[k].iter_mut().zip(&after[0]).for_each(|(second, next)| *second -= upper[k] * next);
    }
    seconds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spline_meets_its_waypoints_and_is_smooth_there() {
        let waypoints: Vec<Vec<f64>> = (0..20)
            .map(|k| {
                let (sine, cosine) = libm::sincos(0.05 * f64::from(k * k) / 4.0);
                vec![sine, cosine]
            })
            .collect();
        let spline = Spline::through(&distinct(&waypoints));
        let last = spline.intervals() - 1;
        for interval in 0..last {
            let knot = spline.knots[interval + 1];
            let (left, right) = (spline.at(interval, knot), spline.at(interval + 1, knot));
            let rows = [(left.q, right.q), (left.first, right.first), (left.second, right.second)];
            for (left, right) in rows {
                // Rounding of numbers of the order of 1.
                assert!(distance(&left, &right) < 1e-10);
            }
        }
        for (end, interval) in [(spline.knots[0], 0), (spline.knots[last + 1], last)] {
            assert!(spline.at(interval, end).second.iter().all(|second| second.abs() < 1e-12));
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_positions() {
        let waypoints = [vec![0.0, 0.0], vec![0.1, 0.02], vec![0.2, 0.01], vec![0.25, -0.03]];
        let spline = Spline::through(&waypoints);
        for interval in 0..3 {
            let s = 0.3 * spline.knots[interval] + 0.7 * spline.knots[interval + 1];
            let [before, here, after] = [s - 1e-4, s, s + 1e-4].map(|s| spline.at(interval, s));
            for joint in 0..2 {
                let first = (after.q[joint] - before.q[joint]) / 2e-4;
                let second = (after.q[joint] - 2.0 * here.q[joint] + before.q[joint]) / 1e-8;
                // The third derivative, of the order of 100, times 1e-8 / 6; and rounding over 1e-8.
                assert!((first - here.first[joint]).abs() < 1e-5);
                assert!((second - here.second[joint]).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn repeated_waypoints_are_dropped_and_the_ends_stay() {
        let tiny = 1e-9;
        let path = [[0.0], [0.0], [tiny], [0.1], [0.1 + tiny], [0.2], [0.2 - tiny]].map(Vec::from);
        assert_eq!(distinct(&path), [[0.0], [0.1], [0.2 - tiny]].map(Vec::from));
        assert_eq!(distinct(&[[0.0], [tiny]].map(Vec::from)), [[0.0], [tiny]].map(Vec::from));
        assert_eq!(distinct(&[[0.0], [0.0]].map(Vec::from)), [[0.0]].map(Vec::from));
    }

    #[test]
    fn a_corner_is_the_angle_between_its_chords() {
        let angle = |after: [f64; 2]| corner_rad(&[-1.0, 0.0], &[0.0, 0.0], &after);
        assert!(angle([2.0, 0.0]).abs() < 1e-15);
        assert!((angle([0.0, 3.0]) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((angle([-1.0, 0.0]) - std::f64::consts::PI).abs() < 1e-15);
        assert!((angle([1.0, 1e-9]) - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn a_spline_leaves_a_corner_and_keeps_to_a_line() {
        let line = Spline::through(&[[0.0, 0.0], [0.1, 0.2], [0.3, 0.6]].map(Vec::from));
        assert!((0..2).all(|interval| line.deviation(interval, 7) < 1e-15));
        let corner = Spline::through(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(Vec::from));
        // By hand: at the corner d²q/ds² = (-1.5, 1.5), so at the middle of the first chord joint 1 is off by 1.5 (1/8
        // - 1/2) / 6.
        assert!((corner.deviation(0, 1) - 0.09375).abs() < 1e-12);
    }
}
