//! Inverse kinematics: the joint angles that bring a gripper to a pose.
//!
//! Two ways: a closed form for arms whose axes intersect in pairs, chosen by the geometry of the chain and never by a
//! robot's name, and a damped least-squares search for every other chain. This module knows nothing of grasps or
//! objectives; a target that cannot be reached is an outcome, not an error.

mod branch;
mod closed_form;
mod general;
mod manifold;
mod slice;
mod trace;

pub use branch::{Branch, BranchSample, Interval};
pub use closed_form::ClosedForm;
pub use general::General;
pub use manifold::SelfMotion;

use super::chain::Chain;
use crate::model::frames::Pose;

/// What a solution may be off: metres in position and radians in orientation.
pub const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// Two solutions nearer than this in every joint are one, rad.
const SAME_SOLUTION_RAD: f64 = 1e-6;

/// Steps that a search from a near seed may take.
const NEAR_STEPS: usize = 12;

/// Slices, and then starts, that are tried when no solution is found near a seed.
const FALLBACK_SLICES: usize = 32;
const FALLBACK_STARTS: usize = 60;

/// What became of a search for one solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Solution {
    /// Angles within the limits whose gripper pose is the target's within [`RESIDUAL_TOLERANCE`], rad.
    Found(Vec<f64>),
    /// The target lies farther from the shoulder than the chain is long.
    OutOfReach {
        /// Distance of the target from the first joint, m.
        distance_m: f64,
        /// The chain's reach, m.
        reach_m: f64,
    },
    /// The search ended beside the target: there is no solution, or none was found.
    NotFound {
        /// How far the best angles are off, as the norm of metres and radians together.
        residual: f64,
    },
    /// The target or the seed has a component that is not a finite number, or the seed is of the wrong length.
    Malformed,
}

impl Solution {
    /// The angles, if there are any, rad.
    pub fn found(self) -> Option<Vec<f64>> {
        match self {
            Self::Found(q_rad) => Some(q_rad),
            Self::OutOfReach { .. } | Self::NotFound { .. } | Self::Malformed => None,
        }
    }
}

/// The inverse kinematics of one chain.
#[derive(Clone, Debug)]
pub enum InverseKinematics {
    /// For seven joints whose axes intersect in pairs.
    ClosedForm(Box<ClosedForm>),
    /// For every other chain.
    General(General),
}

impl InverseKinematics {
    /// The best way for this chain.
    pub fn for_chain(chain: &Chain) -> Self {
        match ClosedForm::new(chain) {
            Some(closed_form) => Self::ClosedForm(Box::new(closed_form)),
            None => Self::General(General::new(chain)),
        }
    }

    /// The solution that a damped search reaches from `seed` (rad, one angle a joint), which is near the seed when the
    /// target is near the seed's pose. Fast, and no more than that: the search may end at a limit.
    pub fn local(&self, target: &Pose, seed: &[f64]) -> Solution {
        self.general().solve_from(target, seed)
    }

    /// As [`InverseKinematics::local`], for a seed that is known to be near: what does not converge soon is given up.
    pub fn near(&self, target: &Pose, seed: &[f64]) -> Solution {
        self.general().solve_within(target, seed, NEAR_STEPS)
    }

    /// The solution of [`InverseKinematics::local`]; failing that the nearest to `seed` of what all other means find,
    /// which takes a thousand times longer.
    pub fn nearest(&self, target: &Pose, seed: &[f64]) -> Solution {
        let local = self.local(target, seed);
        if !matches!(local, Solution::NotFound { .. }) {
            return local;
        }
        let mut solutions = self.samples(target, FALLBACK_SLICES);
        if solutions.is_empty() {
            solutions = self.general().solutions(target, FALLBACK_STARTS);
        }
        let distance = |q_rad: &[f64]| q_rad.iter().zip(seed).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let nearest = solutions.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(local, Solution::Found)
    }

    /// Solutions from all over the set of solutions, within limits and [`RESIDUAL_TOLERANCE`], in an order that is
    /// always the same. `effort` is the number of slices of the closed form, evenly spread over the range of its free
    /// joint, each with up to a dozen solutions, or else the number of starts of the search, each with at most one.
    /// Empty when none was found.
    pub fn samples(&self, target: &Pose, effort: usize) -> Vec<Vec<f64>> {
        match self {
            Self::ClosedForm(closed_form) => closed_form.manifold(target, effort),
            Self::General(general) => general.solutions(target, effort),
        }
    }

    fn general(&self) -> &General {
        match self {
            Self::ClosedForm(closed_form) => closed_form.general(),
            Self::General(general) => general,
        }
    }
}

/// True when every number of a pose is finite.
fn is_finite(pose: &Pose) -> bool {
    pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|v| v.is_finite())
}

/// True when these angles are among the solutions already.
fn holds(solutions: &[Vec<f64>], q_rad: &[f64]) -> bool {
    let same = |other: &Vec<f64>| other.iter().zip(q_rad).all(|(a, b)| (a - b).abs() < SAME_SOLUTION_RAD);
    solutions.iter().any(same)
}
