//! Time-optimal timing of a joint path at limits of velocity and acceleration.
//!
//! The waypoints are joined by natural cubic splines ([`spline`]), each of which is passed as fast as the limits allow
//! ([`profile`]). The joints stop where the path turns sharply or where a spline would leave the polyline of the
//! waypoints.

mod limits;
mod profile;
mod spline;
#[cfg(test)]
mod tests;

pub use limits::MotionLimits;
use profile::Profile;
use spline::{Spline, corner_rad, distinct};

/// Samples are 10 ms apart.
const SAMPLES_PER_S: f64 = 100.0;
/// The joints stop where successive chords enclose more than this, 20 degrees: a smaller corner between waypoints of 3
/// degrees is rounded off by about 0.1 degrees.
const CORNER_RAD: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Largest distance of any joint from the polyline of the waypoints, 0.5 degrees, or as many radians in m for a sliding
/// joint.
const DEVIATION: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// Points in each interval at which the deviation is measured; it has at most two extrema there.
const DEVIATION_POINTS: usize = 7;

/// A path with its timing: at rest at both ends, continuous in position and velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Timed {
    /// Times of the samples, s: multiples of 0.01 s from 0, and the end.
    pub time_s: Vec<f64>,
    /// Joint positions of each sample, rad or m. The first and last ones are the first and last waypoints.
    pub q: Vec<Vec<f64>>,
    /// The pieces between stops, each with the time of its start, s.
    pieces: Vec<(f64, Profile)>,
}

/// Why a path cannot be timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TimingError {
    /// The path has no waypoint.
    #[error("the path has no waypoint")]
    Empty,
    /// A waypoint or the limits have another number of joints than the first waypoint.
    #[error("waypoints and limits differ in their number of joints")]
    Lengths,
    /// A waypoint is not finite.
    #[error("a waypoint is not finite")]
    Waypoint,
    /// A limit is not a positive number.
    #[error("a limit is not a positive number")]
    Limit,
}

/// The fastest motion along a path of all moving joints together, at rest at both ends.
///
/// Waypoints, rad or m, are to be dense: the joints stop at corners of more than 20 degrees, and wherever a smooth
/// curve would leave the polyline by more than 0.5 degrees in a joint. Equal neighbours are one waypoint.
///
/// # Errors
///
/// Waypoints and limits do not fit each other, or a number is not finite or, of the limits, not positive.
pub fn time(path: &[Vec<f64>], limits: &MotionLimits) -> Result<Timed, TimingError> {
    check(path, limits)?;
    let mut pieces = Vec::new();
    let mut end_s = 0.0;
    for spline in splines(&distinct(path)) {
        let profile = Profile::fastest(spline, limits);
        let start_s = end_s;
        end_s += profile.duration_s();
        pieces.push((start_s, profile));
    }
    let mut timed = Timed { time_s: vec![end_s], q: path.last().cloned().into_iter().collect(), pieces };
    // The last sample before the end is not so near that the difference of the two is rounding.
    let before_end =
        (0_u32..).map(|number| f64::from(number) / SAMPLES_PER_S).take_while(|time_s| *time_s < end_s - 1e-9);
    let before_end: Vec<f64> = before_end.collect();
    let q: Vec<_> = before_end.iter().map(|time_s| timed.at(*time_s).0).collect();
    timed.time_s.splice(..0, before_end);
    timed.q.splice(..0, q);
    Ok(timed)
}

impl Timed {
    /// Duration, s.
    pub fn duration_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Joint positions, rad or m, and velocities, rad/s or m/s, at a time, s; before the start and after the end at
    /// rest there.
    ///
    /// Between the samples this is the motion that the limits were applied to, not an interpolation of the samples.
    pub fn at(&self, time_s: f64) -> (Vec<f64>, Vec<f64>) {
        let time_s = time_s.max(0.0);
        let later = self.pieces.partition_point(|(start_s, _)| *start_s <= time_s);
        match (self.pieces.get(later.saturating_sub(1)), self.q.last()) {
            (Some((start_s, profile)), _) if time_s < self.duration_s() => profile.at(time_s - start_s),
            (_, Some(end)) => (end.clone(), vec![0.0; end.len()]),
            (_, None) => (Vec::new(), Vec::new()),
        }
    }
}

fn check(path: &[Vec<f64>], limits: &MotionLimits) -> Result<(), TimingError> {
    let joints = path.first().ok_or(TimingError::Empty)?.len();
    let rows = || [&limits.velocity, &limits.acceleration].into_iter();
    if path.iter().chain(rows()).any(|row| row.len() != joints) {
        return Err(TimingError::Lengths);
    }
    if !path.iter().flatten().all(|q| q.is_finite()) {
        return Err(TimingError::Waypoint);
    }
    if !rows().flatten().all(|limit| limit.is_finite() && *limit > 0.0) {
        return Err(TimingError::Limit);
    }
    Ok(())
}

/// The splines between stops. A stop is added in every spline that leaves its polyline too far, at the sharper end of
/// the interval where it does, until none does; a spline of two waypoints is a line.
fn splines(waypoints: &[Vec<f64>]) -> Vec<Spline> {
    let corners_rad = waypoints.windows(3).map(|three| corner_rad(&three[0], &three[1], &three[2]));
    let corners_rad: Vec<f64> = [0.0].into_iter().chain(corners_rad).chain([0.0]).collect();
    let inner = 1..waypoints.len().saturating_sub(1);
    let mut stops: Vec<usize> = inner.filter(|k| corners_rad[*k] > CORNER_RAD).collect();
    loop {
        let starts = [0].into_iter().chain(stops.iter().copied());
        let ends = stops.iter().copied().chain([waypoints.len().saturating_sub(1)]);
        let ranges: Vec<_> = starts.zip(ends).filter(|(start, end)| start < end).collect();
        let splines: Vec<_> = ranges.iter().map(|(start, end)| Spline::through(&waypoints[*start..=*end])).collect();
        let added = ranges.iter().zip(&splines).filter_map(|((start, end), spline)| {
            let deviations = (0..spline.intervals()).map(|interval| spline.deviation(interval, DEVIATION_POINTS));
            let (interval, deviation) = deviations.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
            let knots = [start + interval, start + interval + 1].into_iter().filter(|knot| start < knot && knot < end);
            let sharper = knots.max_by(|a, b| corners_rad[*a].total_cmp(&corners_rad[*b]))?;
            (deviation > DEVIATION).then_some(sharper)
        });
        let added: Vec<_> = added.collect();
        if added.is_empty() {
            return splines;
        }
        stops.extend(added);
        stops.sort_unstable();
    }
}
