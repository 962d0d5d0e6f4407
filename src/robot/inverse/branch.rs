//! Branches of solutions: the parts of a self-motion within the joint limits.

use std::f64::consts::TAU;

use super::{
    solution::RESIDUAL_TOLERANCE,
    trace::{Angles, Curve, Point, Tracer},
};
use crate::{model::frames::Pose, robot::chain::Chain};

/// A connected set of solutions within the joint limits: a path of the arm with its gripper fixed.
///
/// Positions on it are arc lengths from its start in joint space, rad.
#[derive(Clone, Debug)]
pub struct Branch {
    chain: Chain,
    target: Pose,
    samples: Vec<BranchSample>,
    closed: bool,
}

/// A solution on a branch.
#[derive(Clone, Copy, Debug)]
pub struct BranchSample {
    /// The angles, rad.
    pub q_rad: [f64; 7],
    /// The unit tangent of the branch.
    pub tangent: [f64; 7],
    /// Arc length from the start of the branch, along the chords between samples, rad.
    pub arc_rad: f64,
}

impl Branch {
    /// The samples: both ends, the turning points of the free joint, and enough between that the branch deviates from the
    /// chords by a few per cent of their length.
    pub fn samples(&self) -> &[BranchSample] {
        &self.samples
    }

    /// True if the branch is a closed curve; the last sample is then the first.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The length of the branch, rad.
    pub fn length_rad(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.arc_rad)
    }

    /// The arc length and the solution nearest to these angles; `None` if the angles are malformed.
    fn nearest(&self, q_rad: &[f64]) -> Option<(f64, Vec<f64>)> {
        let wanted = Angles::from_row_slice(<&[f64; 7]>::try_from(q_rad).ok()?);
        let mut best = (f64::INFINITY, 0, 0.0);
        for (number, [from, to]) in self.samples.array_windows().enumerate() {
            let (share, distance) = nearest_on_chord(from, to, &wanted);
            if distance < best.0 {
                best = (distance, number, share);
            }
        }
        if !best.0.is_finite() {
            return None;
        }
        let [from, to] = [&self.samples[best.1], &self.samples[best.1 + 1]];
        let guess = Segment::between(from, to).point(best.2);
        let tracer = Tracer::new(&self.chain, &self.target)?;
        // The foot of the perpendicular, in two iterations of the tangent.
        let foot = tracer
            .settled(guess.q, &guess.tangent, &wanted)
            .and_then(|foot| tracer.settled(foot.q, &foot.tangent, &wanted))
            .filter(|foot| self.chain.within_limits(foot.q.as_slice(), RESIDUAL_TOLERANCE))
            .filter(|foot| (foot.q - guess.q).norm() <= to.arc_rad - from.arc_rad);
        match foot {
            Some(foot) => {
                let (share, _) = nearest_on_chord(from, to, &foot.q);
                Some((from.arc_rad + share * (to.arc_rad - from.arc_rad), self.clamped(&foot.q)))
            }
            None => {
                let end = if best.2 < 0.5 { from } else { to };
                Some((end.arc_rad, end.q_rad.to_vec()))
            }
        }
    }

    /// True if a solution on the branch is within `tolerance_rad` of these angles in every joint.
    pub fn contains(&self, q_rad: &[f64], tolerance_rad: f64) -> bool {
        let near = |found: &[f64]| found.iter().zip(q_rad).all(|(a, b)| (a - b).abs() <= tolerance_rad);
        self.nearest(q_rad).is_some_and(|(_, found)| near(&found))
    }

    /// Clamps angles that are beyond the limits by rounding.
    fn clamped(&self, q: &Angles) -> Vec<f64> {
        let limits = self.chain.lower().iter().zip(self.chain.upper());
        q.iter().zip(limits).map(|(q, (lower, upper))| q.clamp(*lower, *upper)).collect()
    }
}

/// The nearest point of a chord: position on it (0 to 1) and squared distance.
fn nearest_on_chord(from: &BranchSample, to: &BranchSample, wanted: &Angles) -> (f64, f64) {
    let from_q = Angles::from(from.q_rad);
    let (chord, offset) = (Angles::from(to.q_rad) - from_q, wanted - from_q);
    let share = (offset.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
    (share, (offset - chord * share).norm_squared())
}

/// The parts of a curve within the limits of a chain whose joints turn by at most one turn.
pub(super) fn branches_of(curve: &Curve, chain: &Chain, target: &Pose, free_joint: usize) -> Vec<Branch> {
    let Some(tracer) = Tracer::new(chain, target) else { return Vec::new() };
    let mut clip = Clip { chain, tracer, free_joint, arcs: Vec::new(), open: None };
    for [from, to] in curve.points.array_windows() {
        clip.add(&Segment::new(from, to));
    }
    let arcs = clip.finished(curve);
    let branch = |(points, closed): (Vec<Point>, bool)| {
        let mut arc_rad = 0.0;
        let mut last: Option<Angles> = None;
        let samples = points.iter().map(|point| {
            arc_rad += last.map_or(0.0, |last| (point.q - last).norm());
            last = Some(point.q);
            BranchSample { q_rad: point.q.into(), tangent: point.tangent.into(), arc_rad }
        });
        let samples = samples.collect();
        Branch { chain: chain.clone(), target: *target, samples, closed }
    };
    arcs.into_iter().map(branch).collect()
}

/// Cuts a curve into arcs within the limits.
struct Clip<'a> {
    chain: &'a Chain,
    tracer: Tracer<'a>,
    free_joint: usize,
    arcs: Vec<Vec<Point>>,
    /// The arc at the end of the last segment.
    open: Option<Vec<Point>>,
}

impl Clip<'_> {
    /// Cuts a segment at limits and at turning points of the free joint.
    fn add(&mut self, segment: &Segment) {
        let mut cuts: Vec<(f64, Option<(usize, f64)>)> = vec![(0.0, None), (1.0, None)];
        for joint in 0..7 {
            self.add_crossings(&mut cuts, joint, &segment.joint(joint));
        }
        cuts.extend(segment.joint(self.free_joint).turning_points().into_iter().map(|share| (share, None)));
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        for [from, to] in cuts.array_windows() {
            if to.0 - from.0 <= f64::EPSILON {
                continue;
            }
            let Some(turns) = self.turns_within(&segment.point(0.5 * (from.0 + to.0)).q) else {
                self.arcs.extend(self.open.take().filter(|arc| arc.len() > 1));
                continue;
            };
            if self.open.is_none() {
                self.open = Some(self.settled(segment, *from, &turns).into_iter().collect());
            }
            let end = self.settled(segment, *to, &turns);
            if let Some(arc) = &mut self.open {
                let apart = |end: &Point| arc.last().is_none_or(|last| (end.q - last.q).norm() > RESIDUAL_TOLERANCE);
                arc.extend(end.filter(apart));
            }
        }
    }

    /// Adds the positions at which a joint crosses its limits, modulo full turns.
    fn add_crossings(&self, cuts: &mut Vec<(f64, Option<(usize, f64)>)>, joint: usize, cubic: &Cubic) {
        let [least, most] = cubic.bounds();
        for limit in [self.chain.lower()[joint], self.chain.upper()[joint]] {
            let (first, last) = (((least - limit) / TAU).ceil() as i64, ((most - limit) / TAU).floor() as i64);
            for turn in first..=last {
                let level = limit + turn as f64 * TAU;
                cuts.extend(cubic.crossings(level).into_iter().map(|share| (share, Some((joint, level)))));
            }
        }
    }

    /// Full turns, rad, that bring every angle within its limits; `None` if there are none.
    fn turns_within(&self, q: &Angles) -> Option<Angles> {
        let mut turns = Angles::zeros();
        for joint in 0..7 {
            let turn = ((self.chain.lower()[joint] - q[joint]) / TAU).ceil() * TAU;
            if q[joint] + turn > self.chain.upper()[joint] {
                return None;
            }
            turns[joint] = turn;
        }
        Some(turns)
    }

    /// The solution at a cut of a segment, exactly at the limit if the cut is one. `None` if the iteration does not converge or
    /// another limit is exceeded; the arc then ends at its last sample.
    fn settled(&self, segment: &Segment, (share, limit): (f64, Option<(usize, f64)>), turns: &Angles) -> Option<Point> {
        let mut guess = segment.point(share);
        let along = guess.tangent;
        let mut row = along;
        if let Some((joint, level)) = limit {
            guess.q[joint] = level;
            row = Angles::zeros();
            row[joint] = 1.0_f64.copysign(along[joint]);
        }
        let point = self
            .tracer
            .settled(guess.q, &row, &guess.q)
            .filter(|point| (point.q - guess.q).norm() < 0.5 * segment.length_rad)?;
        let mut q = point.q + turns;
        if !self.chain.within_limits(q.as_slice(), LIMIT_SLACK_RAD) {
            return None;
        }
        for (joint, q) in q.iter_mut().enumerate() {
            *q = q.clamp(self.chain.lower()[joint], self.chain.upper()[joint]);
        }
        let tangent = if point.tangent.dot(&along) < 0.0 { -point.tangent } else { point.tangent };
        Some(Point { q, tangent })
    }

    /// The arcs, and whether each is closed. Joins the two parts of an arc in which the trace began.
    fn finished(mut self, curve: &Curve) -> Vec<(Vec<Point>, bool)> {
        let meets = |end: &Point, start: &Point| (end.q - start.q).amax() < 1e-6;
        if let Some(mut last) = self.open.take().filter(|arc| arc.len() > 1) {
            let first = self.arcs.first();
            let joins =
                |first: &Vec<Point>| curve.closed && last.last().zip(first.first()).is_some_and(|(a, b)| meets(a, b));
            if first.is_some_and(joins) {
                last.extend(self.arcs.remove(0).into_iter().skip(1));
            }
            self.arcs.push(last);
        }
        let closed = |arc: &Vec<Point>| {
            arc.len() > 2 && curve.closed && arc.first().zip(arc.last()).is_some_and(|(a, b)| meets(b, a))
        };
        self.arcs
            .into_iter()
            .map(|arc| {
                let is = closed(&arc);
                (arc, is)
            })
            .collect()
    }
}

/// Tolerance of limits at the end of an arc, rad: rounding of the Newton iteration.
const LIMIT_SLACK_RAD: f64 = 1e-9;

/// A part of a curve between two points: cubic Hermite interpolation.
pub(super) struct Segment {
    coefficients: [Angles; 4],
    pub length_rad: f64,
}

impl Segment {
    pub fn new(from: &Point, to: &Point) -> Self {
        let chord = to.q - from.q;
        let length_rad = chord.norm();
        let [start, end] = [from.tangent * length_rad, to.tangent * length_rad];
        Self { coefficients: [from.q, start, chord * 3.0 - start * 2.0 - end, start + end - chord * 2.0], length_rad }
    }

    fn between(from: &BranchSample, to: &BranchSample) -> Self {
        let point = |sample: &BranchSample| Point { q: sample.q_rad.into(), tangent: sample.tangent.into() };
        Self::new(&point(from), &point(to))
    }

    /// Angles and tangent at a parameter from 0 to 1.
    pub fn point(&self, share: f64) -> Point {
        let [a, b, c, d] = &self.coefficients;
        let q = a + (b + (c + d * share) * share) * share;
        let slope = b + (c * 2.0 + d * (3.0 * share)) * share;
        Point { q, tangent: slope / slope.norm() }
    }

    fn joint(&self, joint: usize) -> Cubic {
        Cubic(std::array::from_fn(|power| self.coefficients[power][joint]))
    }
}

/// The angle of one joint over a segment: `c0 + c1 u + c2 u^2 + c3 u^3`, u from 0 to 1.
struct Cubic([f64; 4]);

impl Cubic {
    fn at(&self, u: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + (b + (c + d * u) * u) * u
    }

    /// Bounds from Bernstein coefficients.
    fn bounds(&self) -> [f64; 2] {
        let [a, b, c, d] = self.0;
        let corners = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        [corners.into_iter().fold(f64::INFINITY, f64::min), corners.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Turning points strictly between 0 and 1, in order.
    fn turning_points(&self) -> Vec<f64> {
        let [_, b, c, d] = self.0;
        let discriminant = c * c - 3.0 * b * d;
        if discriminant <= 0.0 {
            return Vec::new();
        }
        // Both roots of `b + 2 c u + 3 d u^2` without cancellation.
        let half = -(c + discriminant.sqrt().copysign(c));
        let mut roots: Vec<f64> = [half / (3.0 * d), b / half].into_iter().filter(|u| *u > 0.0 && *u < 1.0).collect();
        roots.sort_by(f64::total_cmp);
        roots
    }

    /// Parameters from 0 to 1 at which it has this value.
    fn crossings(&self, level: f64) -> Vec<f64> {
        let [least, most] = self.bounds();
        if !(least..=most).contains(&level) {
            return Vec::new();
        }
        let mut ends = vec![0.0];
        ends.extend(self.turning_points());
        ends.push(1.0);
        let mut crossings = Vec::new();
        for &[mut low, mut high] in ends.array_windows() {
            let (at_low, at_high) = (self.at(low) - level, self.at(high) - level);
            if at_low * at_high > 0.0 {
                continue;
            }
            // 45 bisections reach rounding.
            for _ in 0..45 {
                let middle = 0.5 * (low + high);
                if (self.at(middle) - level) * at_low > 0.0 { low = middle } else { high = middle }
            }
            crossings.push(0.5 * (low + high));
        }
        crossings
    }
}
