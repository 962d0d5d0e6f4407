//! Time-optimal speed along a spline: TOPP-RA (Pham and Pham 2018, A New Approach to Time-Optimal Path Parameterization
//! Based on Reachability Analysis, IEEE Transactions on Robotics 34:3).
//!
//! With `x = ṡ²` and `u = s̈`, joint j moves with velocity `q'_j √x` and acceleration `q''_j x + q'_j u`. On a grid of
//! s, u is constant in each interval of length ds, so `x_{i+1} = x_i + 2 ds u_i`. The limits on acceleration are
//! imposed at both ends of each interval (the paper's interpolation scheme), those on velocity at the grid points.

use super::{
    limits::MotionLimits,
    spline::{Spline, SplinePoint},
};

/// Grid points in each interval between waypoints: accelerations inside a grid interval then exceed those at its ends by
/// 2 % at most (tests), for corners of 20 degrees at every waypoint too.
const PER_INTERVAL: usize = 8;
/// Least number of grid intervals: the duration of a line is then within 0.7 % of its closed form (tests).
const LEAST_GRID: usize = 100;
/// |q'| below which a joint's acceleration does not depend on u; q' is at most 1, since s is the chord length.
const STATIONARY: f64 = 1e-12;
/// Where limits are checked inside a grid interval, as a share of it.
const CHECKED_AT: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The speed along a spline that starts and ends at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    spline: Spline,
    per_interval: usize,
    /// Chord length at each grid point, rad or m.
    s: Vec<f64>,
    /// ds/dt at each grid point.
    rate: Vec<f64>,
    /// Time since the start at each grid point, s.
    time_s: Vec<f64>,
}

/// A constraint `-low <= u + slope x <= high` with `low, high >= 0`: `x = u = 0` fulfils it.
struct Band {
    slope: f64,
    low: f64,
    high: f64,
}

/// The constraints on (x, u) at a grid point.
struct Stage {
    bands: Vec<Band>,
    /// Largest x by the limits on velocity and on the acceleration of joints with q' = 0.
    most_x: f64,
}

impl Profile {
    /// The fastest profile of a spline with at least one interval and positive limits.
    ///
    /// It is slowed down so that the limits hold inside the grid intervals too: in the tests' drawn paths by 1 % at
    /// most, by 0.4 % if they are smooth.
    pub fn fastest(spline: Spline, limits: &MotionLimits) -> Self {
        let per_interval = PER_INTERVAL.max(LEAST_GRID.div_ceil(spline.intervals().max(1)));
        Self::on_grid(spline, limits, per_interval)
    }

    /// As [`Profile::fastest`], with a given number of grid points in each interval between waypoints.
    pub fn on_grid(spline: Spline, limits: &MotionLimits, per_interval: usize) -> Self {
        let s = grid(&spline, per_interval);
        let points: Vec<_> =
            (0..s.len()).map(|i| spline.at((i / per_interval).min(spline.intervals() - 1), s[i])).collect();
        let x = squared_rates(&s, &points, limits);
        let rate: Vec<f64> = x.iter().map(|x| x.sqrt()).collect();
        let mut time_s = vec![0.0; s.len()];
        for i in 1..s.len() {
            time_s[i] = time_s[i - 1] + 2.0 * (s[i] - s[i - 1]) / (rate[i - 1] + rate[i]);
        }
        let mut profile = Self { spline, per_interval, s, rate, time_s };
        profile.stretch(limits);
        profile
    }

    /// Duration, s.
    pub fn duration_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Joint positions, rad or m, and velocities, rad/s or m/s, at a time since the start, s, within the duration.
    pub fn at(&self, time_s: f64) -> (Vec<f64>, Vec<f64>) {
        let later = self.time_s.partition_point(|grid_s| *grid_s <= time_s);
        let i = later.clamp(1, self.s.len() - 1) - 1;
        let (point, rate, _) = self.state(i, time_s - self.time_s[i]);
        let velocity = point.first.iter().map(|first| first * rate).collect();
        (point.q, velocity)
    }

    /// The spline's point, ds/dt and d²s/dt² at a time after grid point i, s.
    fn state(&self, i: usize, after_s: f64) -> (SplinePoint, f64, f64) {
        let (low, high) = (self.s[i], self.s[i + 1]);
        let u = (self.rate[i + 1] * self.rate[i + 1] - self.rate[i] * self.rate[i]) / (2.0 * (high - low));
        let s = low + after_s * (self.rate[i] + 0.5 * u * after_s);
        (self.spline.at(i / self.per_interval, s.clamp(low, high)), (self.rate[i] + u * after_s).max(0.0), u)
    }

    /// Slows the whole profile down by the factor by which a limit is exceeded inside the grid intervals.
    fn stretch(&mut self, limits: &MotionLimits) {
        let mut factor = 1.0_f64;
        for i in 0..self.s.len() - 1 {
            for share in CHECKED_AT {
                let (point, rate, u) = self.state(i, share * (self.time_s[i + 1] - self.time_s[i]));
                for (joint, (velocity, acceleration)) in limits.velocity.iter().zip(&limits.acceleration).enumerate() {
                    let needed = (point.second[joint] * rate * rate + point.first[joint] * u).abs() / acceleration;
                    factor = factor.max(point.first[joint].abs() * rate / velocity).max(needed.sqrt());
                }
            }
        }
        self.rate.iter_mut().for_each(|rate| *rate /= factor);
        self.time_s.iter_mut().for_each(|time_s| *time_s *= factor);
    }
}

/// The chord lengths of the grid, with the knots exactly.
fn grid(spline: &Spline, per_interval: usize) -> Vec<f64> {
    let mut s = Vec::with_capacity(spline.intervals() * per_interval + 1);
    for pair in spline.knots.windows(2) {
        s.extend((0..per_interval).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / per_interval as f64));
    }
    s.extend(spline.knots.last());
    s
}

/// ṡ² at each grid point: the upper ends of the controllable sets backward, then the largest u forward.
///
/// Every controllable set contains 0, because `x = u = 0` fulfils all constraints, so it is given by its upper end. All
/// of them but the last one are positive, so no two neighbours of the result are 0 and the duration is finite.
fn squared_rates(s: &[f64], points: &[SplinePoint], limits: &MotionLimits) -> Vec<f64> {
    let last = s.len() - 1;
    let stages: Vec<_> = (0..last).map(|i| Stage::of(&points[i], &points[i + 1], s[i + 1] - s[i], limits)).collect();
    let mut controllable = vec![0.0; s.len()];
    for i in (0..last).rev() {
        let link = link(s[i + 1] - s[i], controllable[i + 1]);
        controllable[i] = stages[i].largest_x(&link);
    }
    let mut x = vec![0.0; s.len()];
    for i in 0..last {
        let ds = s[i + 1] - s[i];
        let u = stages[i].largest_u(&link(ds, controllable[i + 1]), x[i]);
        // Only rounding leaves the controllable set.
        x[i + 1] = (x[i] + 2.0 * ds * u).clamp(0.0, controllable[i + 1]);
    }
    x
}

/// `0 <= x + 2 ds u <= next`.
fn link(ds: f64, next: f64) -> Band {
    Band { slope: 1.0 / (2.0 * ds), low: 0.0, high: next / (2.0 * ds) }
}

impl Stage {
    fn of(here: &SplinePoint, next: &SplinePoint, ds: f64, limits: &MotionLimits) -> Self {
        let mut stage = Self { bands: Vec::with_capacity(2 * limits.velocity.len()), most_x: f64::INFINITY };
        for (joint, (velocity, acceleration)) in limits.velocity.iter().zip(&limits.acceleration).enumerate() {
            let first = here.first[joint].abs();
            if first > 0.0 {
                let most = velocity / first;
                stage.most_x = stage.most_x.min(most * most);
            }
            stage.limit(here.second[joint], here.first[joint], *acceleration);
            // At the interval's other end x is x + 2 ds u.
            stage.limit(next.second[joint], next.first[joint] + 2.0 * ds * next.second[joint], *acceleration);
        }
        stage
    }

    /// Adds `|of_x x + of_u u| <= acceleration`.
    fn limit(&mut self, of_x: f64, of_u: f64, acceleration: f64) {
        if of_u.abs() > STATIONARY {
            let most = acceleration / of_u.abs();
            self.bands.push(Band { slope: of_x / of_u, low: most, high: most });
        } else if of_x != 0.0 {
            self.most_x = self.most_x.min(acceleration / of_x.abs());
        }
    }

    /// The largest x for which some u fulfils all constraints: each pair of an upper and a lower bound of u bounds x
    /// (elimination of u by Fourier and Motzkin).
    fn largest_x(&self, link: &Band) -> f64 {
        let all = || self.bands.iter().chain([link]);
        let mut largest = self.most_x;
        for upper in all() {
            for lower in all() {
                let slope = upper.slope - lower.slope;
                if slope > 0.0 {
                    largest = largest.min((upper.high + lower.low) / slope);
                }
            }
        }
        largest
    }

    /// The largest u at a given x of the controllable set.
    fn largest_u(&self, link: &Band, x: f64) -> f64 {
        self.bands.iter().chain([link]).map(|band| band.high - band.slope * x).fold(f64::INFINITY, f64::min)
    }
}
