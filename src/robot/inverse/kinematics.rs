//! The choice of a solver by the geometry of a chain.

use super::{closed_form::ClosedForm, decomposed::Decomposed, general::General, solution::Solution};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Maximum number of steps from a near seed.
const NEAR_STEPS: usize = 12;

/// Numbers of slices and of starts that are tried if there is no solution near a seed.
const FALLBACK_SLICES: usize = 32;
const FALLBACK_STARTS: usize = 60;

/// The inverse kinematics of one chain.
#[derive(Clone, Debug)]
pub enum InverseKinematics {
    /// For seven joints whose axes intersect in pairs.
    ClosedForm(Box<ClosedForm>),
    /// For six joints that decompose into position and rotation, and for seven with these beyond a free joint.
    Decomposed(Box<Decomposed>),
    /// For all other chains.
    General(General),
}

impl InverseKinematics {
    /// A closed form if the chain has its structure, else the general solver.
    pub fn for_chain(chain: &Chain) -> Self {
        if !chain.is_revolute() {
            return Self::General(General::new(chain));
        }
        if let Some(closed_form) = ClosedForm::new(chain) {
            return Self::ClosedForm(Box::new(closed_form));
        }
        match Decomposed::new(chain) {
            Some(decomposed) => Self::Decomposed(Box::new(decomposed)),
            None => Self::General(General::new(chain)),
        }
    }

    /// The solver's name for messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ClosedForm(_) | Self::Decomposed(_) => "closed-form",
            Self::General(_) => "numerical",
        }
    }

    /// The solution to which damped least squares converges from `seed` (rad, one angle per joint). It is near the seed if the
    /// target is near the seed's pose. Fast, but the search may end at a limit.
    pub fn local(&self, target: &Pose, seed: &[f64]) -> Solution {
        self.general().solve_from(target, seed)
    }

    /// As [`InverseKinematics::local`] with few steps, for a seed that is near a solution.
    pub fn near(&self, target: &Pose, seed: &[f64]) -> Solution {
        self.general().solve_within(target, seed, NEAR_STEPS)
    }

    /// The solution of [`InverseKinematics::local`] or, without one, the nearest to `seed` of
    /// [`InverseKinematics::samples`], which takes a thousand times longer.
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

    /// Solutions spread over the set of solutions, within the limits, in a fixed order. `effort` is the number of slices of a
    /// closed form, evenly spread over the range of its free joint, each with up to a dozen solutions; or the number of starts
    /// of the general solver, each with at most one. Six joints with a closed form have all their solutions. Empty if none was
    /// found.
    pub fn samples(&self, target: &Pose, effort: usize) -> Vec<Vec<f64>> {
        match self {
            Self::ClosedForm(closed_form) => closed_form.manifold(target, effort),
            Self::Decomposed(decomposed) => decomposed.samples(target, effort),
            Self::General(general) => general.solutions(target, effort),
        }
    }

    /// The samples of all branches of solutions of seven joints with a closed form, all solutions of six, and for other chains the
    /// solutions from `starts` starts. Empty if none was found.
    pub fn all(&self, target: &Pose, starts: usize) -> Vec<Vec<f64>> {
        let motion = match self {
            Self::ClosedForm(closed_form) => Some(closed_form.branches(target)),
            Self::Decomposed(decomposed) => decomposed.branches(target),
            Self::General(_) => None,
        };
        let Some(motion) = motion else { return self.samples(target, starts) };
        let samples = motion.branches().iter().flat_map(|branch| branch.samples());
        samples.map(|sample| sample.q_rad.to_vec()).collect()
    }

    fn general(&self) -> &General {
        match self {
            Self::ClosedForm(closed_form) => closed_form.general(),
            Self::Decomposed(decomposed) => decomposed.general(),
            Self::General(general) => general,
        }
    }
}
