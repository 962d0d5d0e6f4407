//! The nearest miss: of the candidates that kept every constraint but stability, the one that resists most, and what would make
//! it stable enough.

use super::{
    assessment::assess_cases,
    candidate::Candidate,
    contact::{load_cases, load_cases_with},
    outcome::{MOST_FRICTION, NearMiss, Remedy},
    params::near_miss::{FRICTION_STEP, GRIP_STEP_N, KEPT, LOAD_STEPS},
    problem::Problem,
};
use crate::{
    model::{
        frames::Pose,
        scenario::{Grip, Limits, StabilityKind},
    },
    statics::{ContactModelError, LimitCrossing, LoadCases, LoadFactorOutcome, StabilityWorkspace},
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
    pub utilisation: f64,
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

    /// The candidates that are kept, the nearest first.
    pub fn kept(&self) -> &[Miss] {
        &self.kept
    }

    /// The candidate that resists the largest multiple of the load; `None` if none was kept, or none resists less than is
    /// required. After a stop it is not complete.
    pub fn nearest(&self, problem: &Problem<'_>) -> Option<NearMiss> {
        let mut solver = Solver { problem, limits: problem.stability_limits(), stability: StabilityWorkspace::new() };
        let mut best: Option<(f64, String)> = None;
        for miss in &self.kept {
            if problem.stop.is_stopped() {
                return None;
            }
            let Some((load_factor, limit)) = solver.resisted(miss) else { continue };
            if best.as_ref().is_none_or(|&(most, _)| load_factor > most) {
                best = Some((load_factor, limit));
            }
        }
        let (load_factor, first_limit) = best?;
        let required = solver.limits.load_factor;
        (load_factor < required).then(|| NearMiss {
            load_factor,
            required,
            first_limit,
            grip_force: solver.grip_force(&self.kept),
            friction: solver.friction(&self.kept),
            load_share: solver.load_share(&self.kept),
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
        let cases = load_cases(self.problem, &miss.candidate, &miss.x_wo).ok()?;
        if self.problem.scenario.planner.stability == StabilityKind::Paper {
            return match self.stability.least_load_factor(&cases).ok()?.1 {
                LoadFactorOutcome::Solved(solved) => Some((solved.load_factor, solved.binding.into_iter().next()?)),
                LoadFactorOutcome::GravityInfeasible { .. } => Some((0.0, "the weight alone".to_owned())),
                LoadFactorOutcome::Unknown { .. } => None,
            };
        }
        let (_, found) = self.stability.least_compliant_load_factor(&cases, &self.limits).ok()?;
        let limit = match found.first_limit? {
            LimitCrossing::NoEquilibrium { binding } => {
                binding.into_iter().next().unwrap_or_else(|| "the weight alone".to_owned())
            }
            LimitCrossing::Unknown { .. } => return None,
            limit => limit.to_string(),
        };
        Some((found.load_factor, limit))
    }

    /// The smallest grip force, up to the largest of every gripper, with which one of the grasps is stable enough.
    fn grip_force(&mut self, misses: &[Miss]) -> Option<Remedy> {
        let Grip { force_n: now, .. } = self.problem.scenario.grip;
        let pads = self.problem.robot.robot.arms.iter().filter_map(|arm| arm.gripper.holding.pads());
        let most_n = pads.map(|pads| pads.max_force_n).reduce(f64::min)?;
        self.least(misses, [now, most_n], GRIP_STEP_N, |grip, force_n| Grip { force_n, ..grip })
    }

    /// The smallest friction with which one of the grasps is stable enough.
    fn friction(&mut self, misses: &[Miss]) -> Option<Remedy> {
        let Grip { friction: now, .. } = self.problem.scenario.grip;
        self.least(misses, [now, MOST_FRICTION], FRICTION_STEP, |grip, friction| Grip { friction, ..grip })
    }

    /// The smallest multiple of `step` from `now` to `most` with which one of the grasps is stable enough.
    fn least(
        &mut self,
        misses: &[Miss],
        [now, most]: [f64; 2],
        step: f64,
        with: impl Fn(Grip, f64) -> Grip,
    ) -> Option<Remedy> {
        let (problem, grip) = (self.problem, self.problem.scenario.grip);
        let [few, many] = [now, most].map(|value| (value / step).floor() as u32);
        let enough = smallest(misses, [few, many], |miss, steps| {
            let grip = with(grip, f64::from(steps) * step);
            self.is_stable(load_cases_with(problem, &miss.candidate, &miss.x_wo, &grip))
        });
        enough.map(|enough| Remedy { now, enough: f64::from(enough) * step })
    }

    /// The largest share of the load, in whole steps, with which one of the grasps is stable enough.
    fn load_share(&mut self, misses: &[Miss]) -> Option<f64> {
        let problem = self.problem;
        let share = |removed: u32| f64::from(LOAD_STEPS - removed) / f64::from(LOAD_STEPS);
        let removed = smallest(misses, [0, LOAD_STEPS - 1], |miss, removed| {
            let cases = load_cases(problem, &miss.candidate, &miss.x_wo);
            self.is_stable(cases.map(|cases| cases.scaled(share(removed))))
        });
        removed.map(share)
    }

    /// True if a grasp resists these loads. Whether the robot stays clear under it is not asked: a
    /// grasp nearby may, and the limit that the message is about is that of stability.
    fn is_stable(&mut self, cases: Result<LoadCases, ContactModelError>) -> bool {
        let is_stopped = self.problem.stop.is_stopped();
        !is_stopped && assess_cases(self.problem, &mut self.stability, cases, &mut None).utilisation <= 1.0
    }
}

/// The smallest number in `(too_few, most]` that is enough for one of the misses; `None` if `most` is enough for none. That
/// it is enough is tested for the number itself; that smaller ones are not assumes that more is never worse.
fn smallest(misses: &[Miss], [too_few, most]: [u32; 2], mut is_enough: impl FnMut(&Miss, u32) -> bool) -> Option<u32> {
    let mut best = None;
    for miss in misses {
        let mut enough = best.map_or(most, |best: u32| best - 1);
        if enough <= too_few || !is_enough(miss, enough) {
            continue;
        }
        let mut less = too_few;
        while enough - less > 1 {
            let middle = less.midpoint(enough);
            if is_enough(miss, middle) {
                enough = middle;
            } else {
                less = middle;
            }
        }
        best = Some(enough);
    }
    best
}
