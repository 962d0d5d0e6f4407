//! The nearest miss: of the candidates that kept every constraint but stability, the one that resists most, and what would make
//! it stable enough.

use super::{
    candidate::Candidate,
    evaluate::{contact_model, contact_model_with},
    outcome::{MOST_FRICTION, NearMiss, Remedy},
    params::near_miss::{FRICTION_STEP, GRIP_STEP_N, KEPT, LOAD_STEPS},
    problem::Problem,
};
use crate::{
    model::{
        frames::Pose,
        scenario::{Grip, Limits, StabilityKind},
    },
    statics::{ContactModel, ContactModelError, LimitCrossing, LoadFactorOutcome, StabilityWorkspace},
};

/// The candidates whose utilisation of stability is lowest among those that violate nothing else, the lowest first.
#[derive(Default)]
pub struct NearMisses {
    kept: Vec<Miss>,
}

/// A candidate that violates nothing but stability.
#[derive(Clone)]
pub struct Miss {
    /// Above 1, infinite if there is no equilibrium.
    utilisation: f64,
    pub candidate: Candidate,
    x_wo: Pose,
}

impl NearMisses {
    /// Keeps a candidate if it is among the nearest.
    pub fn add(&mut self, utilisation: f64, candidate: &Candidate, x_wo: &Pose) {
        let place = self.kept.partition_point(|miss| miss.utilisation <= utilisation);
        if place < KEPT {
            self.kept.insert(place, Miss { utilisation, candidate: candidate.clone(), x_wo: *x_wo });
            self.kept.truncate(KEPT);
        }
    }

    /// The candidates, the nearest first.
    pub fn candidates(&self) -> impl Iterator<Item = &Candidate> {
        self.kept.iter().map(|miss| &miss.candidate)
    }

    /// The candidate that resists the largest multiple of the load; `None` if none was kept, or none resists less than is required.
    pub fn nearest(&self, problem: &Problem<'_>) -> Option<NearMiss> {
        let mut solver = Solver { problem, limits: problem.stability_limits(), stability: StabilityWorkspace::new() };
        let mut best: Option<(&Miss, f64, String)> = None;
        for miss in &self.kept {
            let Some((load_factor, limit)) = solver.resisted(miss) else { continue };
            if best.as_ref().is_none_or(|&(_, most, _)| load_factor > most) {
                best = Some((miss, load_factor, limit));
            }
        }
        let (miss, load_factor, first_limit) = best?;
        let required = solver.limits.load_factor;
        (load_factor < required).then(|| NearMiss {
            load_factor,
            required,
            first_limit,
            grip_force: solver.grip_force(miss),
            friction: solver.friction(miss),
            load_share: solver.load_share(miss),
            force_n: problem.scenario.operation.wrench_o.force_n.norm(),
        })
    }
}

/// Solves the stability of grasps under other grip forces, frictions and loads.
struct Solver<'p> {
    problem: &'p Problem<'p>,
    limits: Limits,
    stability: StabilityWorkspace,
}

impl Solver<'_> {
    /// The multiple of the load that a grasp resists, and the limit that is crossed above it.
    fn resisted(&mut self, miss: &Miss) -> Option<(f64, String)> {
        let model = contact_model(self.problem, &miss.candidate, &miss.x_wo).ok()?;
        if self.problem.scenario.planner.stability == StabilityKind::Paper {
            return match self.stability.load_factor(&model).ok()? {
                LoadFactorOutcome::Solved(solved) => Some((solved.load_factor, solved.binding.into_iter().next()?)),
                LoadFactorOutcome::GravityInfeasible { .. } => Some((0.0, "the weight alone".to_owned())),
                LoadFactorOutcome::Unknown { .. } => None,
            };
        }
        let found = self.stability.compliant_load_factor(&model, &self.limits).ok()?;
        let limit = match found.first_limit? {
            LimitCrossing::NoEquilibrium { binding } => {
                binding.into_iter().next().unwrap_or_else(|| "the weight alone".to_owned())
            }
            LimitCrossing::Unknown { .. } => return None,
            limit => limit.to_string(),
        };
        Some((found.load_factor, limit))
    }

    /// The smallest sufficient grip force up to the largest of every gripper.
    fn grip_force(&mut self, miss: &Miss) -> Option<Remedy> {
        let Grip { force_n: now, .. } = self.problem.scenario.grip;
        let arms = self.problem.robot.robot.arms.iter();
        let most_n = arms.map(|arm| arm.gripper.max_force_n).fold(f64::INFINITY, f64::min);
        self.least(miss, now, most_n, GRIP_STEP_N, |grip, force_n| Grip { force_n, ..grip })
    }

    /// The smallest sufficient friction.
    fn friction(&mut self, miss: &Miss) -> Option<Remedy> {
        let Grip { friction: now, .. } = self.problem.scenario.grip;
        self.least(miss, now, MOST_FRICTION, FRICTION_STEP, |grip, friction| Grip { friction, ..grip })
    }

    /// The smallest multiple of `step` from `now` to `most` with which the grasp is stable enough: that it is, is solved for
    /// the value itself; that smaller ones are not, assumes that more is never worse.
    fn least(
        &mut self,
        miss: &Miss,
        now: f64,
        most: f64,
        step: f64,
        with: impl Fn(Grip, f64) -> Grip,
    ) -> Option<Remedy> {
        let value = |steps: u32| f64::from(steps) * step;
        let (problem, grip) = (self.problem, self.problem.scenario.grip);
        let mut is_enough = |steps: u32| {
            self.is_stable(contact_model_with(problem, &miss.candidate, &miss.x_wo, &with(grip, value(steps))))
        };
        let [mut too_few, mut enough] = [now, most].map(|value| (value / step).floor() as u32);
        if too_few >= enough || !is_enough(enough) {
            return None;
        }
        while enough - too_few > 1 {
            let middle = too_few.midpoint(enough);
            if is_enough(middle) {
                enough = middle;
            } else {
                too_few = middle;
            }
        }
        Some(Remedy { now, enough: value(enough) })
    }

    /// The largest share of the load, in whole steps, with which the grasp is stable enough.
    fn load_share(&mut self, miss: &Miss) -> Option<f64> {
        let share = |steps: u32| f64::from(steps) / f64::from(LOAD_STEPS);
        let problem = self.problem;
        let mut is_stable = |steps: u32| {
            let model = contact_model(problem, &miss.candidate, &miss.x_wo);
            self.is_stable(model.map(|model| ContactModel { load: model.load.scaled(share(steps)), ..model }))
        };
        let [mut few, mut too_many] = [0, LOAD_STEPS];
        while too_many - few > 1 {
            let middle = few.midpoint(too_many);
            if is_stable(middle) {
                few = middle;
            } else {
                too_many = middle;
            }
        }
        (few > 0).then(|| share(few))
    }

    fn is_stable(&mut self, model: Result<ContactModel, ContactModelError>) -> bool {
        let kind = self.problem.scenario.planner.stability;
        let utilisation = model.and_then(|model| self.stability.utilisation(&model, &self.limits, kind));
        utilisation.is_ok_and(|utilisation| utilisation <= 1.0)
    }
}
