//! All branches of solutions of a seven-joint arm with a closed form: slices find the curves of the self-motion, the tracer follows
//! them, and the joint limits cut them.

use std::f64::consts::TAU;

use super::{
    branch::{Branch, Segment, branches_of},
    general::General,
    solution::is_finite,
    trace::{Angles, Curve, Point, Tracer},
};
use crate::model::frames::Pose;

/// Number of slices over the range of the free joint that seed curves.
const SEED_SLICES: usize = 20;

/// Number of postures over the joint ranges that seed curves between two slices.
const SEED_STARTS: usize = 32;

/// Distance within which a seed is on a curve, relative to the curve's step; the interpolation error is a hundredth.
const ON_CURVE: f64 = 0.02;

/// All solutions of a target.
#[derive(Clone, Debug)]
pub enum SelfMotion {
    /// The branches, longest first: at least one.
    Found(Vec<Branch>),
    /// The target is farther from the first joint than the chain's reach.
    OutOfReach {
        /// Distance of the target from the first joint, m.
        distance_m: f64,
        /// The chain's reach, m.
        reach_m: f64,
    },
    /// No solution within the limits was found.
    NotFound,
    /// The target is not finite.
    Malformed,
}

impl SelfMotion {
    /// The branches; empty if there are none.
    pub fn branches(&self) -> &[Branch] {
        match self {
            Self::Found(branches) => branches,
            Self::OutOfReach { .. } | Self::NotFound | Self::Malformed => &[],
        }
    }
}

/// An arm of seven joints whose solutions are known for each angle of one of them.
pub(super) trait Sliced {
    /// The general solver of the arm.
    fn general(&self) -> &General;
    /// The joint whose angle is given.
    fn free_joint(&self) -> usize;
    /// The solutions with the free joint at this angle, rad, without limits of the others.
    fn unlimited_slice(&self, target: &Pose, free_rad: f64) -> Vec<Angles>;
    /// Postures near curves that slices may miss.
    fn further_seeds(&self, target: &Pose) -> Vec<Angles>;
}

/// All branches of solutions within the joint limits, longest first. Of a joint range wider than one turn only the first turn
/// is searched.
pub(super) fn branches(arm: &impl Sliced, target: &Pose) -> SelfMotion {
    let chain = arm.general().chain();
    if !is_finite(target) {
        return SelfMotion::Malformed;
    }
    let (distance_m, reach_m) = ((target.translation.vector - chain.shoulder_w()).norm(), chain.reach_m());
    if distance_m > reach_m {
        return SelfMotion::OutOfReach { distance_m, reach_m };
    }
    let curves = curves(arm, target);
    let mut branches: Vec<Branch> =
        curves.iter().flat_map(|curve| branches_of(curve, chain, target, arm.free_joint())).collect();
    branches.sort_by(|a, b| b.length_rad().total_cmp(&a.length_rad()));
    if branches.is_empty() { SelfMotion::NotFound } else { SelfMotion::Found(branches) }
}

/// The curves of the self-motion within the limits of the free joint, without limits of the others.
fn curves(arm: &impl Sliced, target: &Pose) -> Vec<Curve> {
    let (chain, free_joint) = (arm.general().chain(), arm.free_joint());
    let Some(tracer) = Tracer::new(chain, target) else { return Vec::new() };
    let (lower, upper) = (chain.lower()[free_joint], chain.upper()[free_joint]);
    let mut curves: Vec<Curve> = Vec::new();
    let mut add = |seed: &Angles| {
        if curves.iter().any(|curve| passes(curve, seed, free_joint)) {
            return;
        }
        let on_curve = |start: &Point| curves.iter().any(|curve| passes(curve, &start.q, free_joint));
        let Some(start) = tracer.seeded(*seed).filter(|start| !on_curve(start)) else { return };
        let curve = tracer.curve(start);
        // Near a sharp bend a start may not match the curve that it is on; the curve through it does.
        if !curves.iter().any(|other| passes(&curve, &other.points[0].q, free_joint)) {
            curves.push(curve);
        }
    };
    for number in 0..=SEED_SLICES {
        let free_rad = lower + (upper - lower) * number as f64 / SEED_SLICES as f64;
        arm.unlimited_slice(target, free_rad).iter().for_each(&mut add);
    }
    for start in arm.further_seeds(target) {
        tracer.projected(start).iter().for_each(&mut add);
    }
    // A curve between two slices is short; a search from afar finds it.
    for number in 0..SEED_STARTS {
        let start = Angles::from_column_slice(&arm.general().start(number));
        tracer.projected(start).iter().for_each(&mut add);
    }
    curves
}

/// True if the curve passes through these angles, modulo full turns.
fn passes(curve: &Curve, seed: &Angles, free_joint: usize) -> bool {
    curve.points.array_windows().any(|[from, to]| {
        let step = (to.q - from.q).norm();
        let near = |joint: usize| {
            let offset = seed[joint] - from.q[joint];
            offset - (offset / TAU).round() * TAU
        };
        // One joint excludes most segments.
        if near(free_joint).abs() > 1.1 * step || near(0).abs() > 1.1 * step {
            return false;
        }
        let offset = Angles::from_fn(|joint, _| near(joint));
        let share = offset.dot(&(to.q - from.q)) / (step * step);
        if !(-0.1..=1.1).contains(&share) {
            return false;
        }
        let on_curve = Segment::new(from, to).point(share).q - from.q;
        (offset - on_curve).norm() <= ON_CURVE * step
    })
}
