//! Damped least squares with joint limits, for any chain of revolute joints.

use nalgebra::{Matrix6, Vector6};

use super::solution::{RESIDUAL_TOLERANCE, Solution, contains, is_finite};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Residual at which the iteration stops: a tenth of the tolerance.
const TARGET_RESIDUAL: f64 = 0.1 * RESIDUAL_TOLERANCE;

/// Maximum number of steps; converging starts need 5 to 30.
const MAX_STEPS: usize = 60;

/// Initial damping, and its factors after a good and after a bad step.
const DAMPING: f64 = 1e-3;
const DAMPING_AFTER_GOOD: f64 = 0.1;
const DAMPING_AFTER_BAD: f64 = 8.0;

/// Damping at which the search stops at a local minimum.
const MAX_DAMPING: f64 = 1e6;

/// Levenberg-Marquardt on the pose error, with joints fixed while they push against a limit.
#[derive(Clone, Debug)]
pub struct General {
    chain: Chain,
}

impl General {
    /// The solver of this chain.
    pub fn new(chain: &Chain) -> Self {
        Self { chain: chain.clone() }
    }

    /// The chain.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The solution to which the search converges from `seed`, clamped to the limits.
    ///
    /// Minimises `|p_t - p|^2 + |log(R_t R')|^2` (m, rad) with steps `J' (J J' + mu I)^-1 e`.
    pub fn solve_from(&self, target: &Pose, seed: &[f64]) -> Solution {
        self.solve_within(target, seed, MAX_STEPS)
    }

    /// As [`General::solve_from`] with a maximum number of steps.
    pub fn solve_within(&self, target: &Pose, seed: &[f64], max_steps: usize) -> Solution {
        if seed.len() != self.chain.dof() || !seed.iter().all(|q| q.is_finite()) || !is_finite(target) {
            return Solution::Malformed;
        }
        let distance_m = (target.translation.vector - self.chain.shoulder_w()).norm();
        let reach_m = self.chain.reach_m();
        if distance_m > reach_m {
            return Solution::OutOfReach { distance_m, reach_m };
        }
        self.search(target, seed, max_steps)
    }

    fn search(&self, target: &Pose, seed: &[f64], max_steps: usize) -> Solution {
        let mut here = State::new(&self.chain, target, self.clamped(seed.to_vec()));
        let mut damping = DAMPING;
        for _ in 0..max_steps {
            if here.residual <= TARGET_RESIDUAL {
                return Solution::Found(here.q_rad);
            }
            let Some(q_rad) = self.step(&here, damping) else { break };
            let there = State::new(&self.chain, target, q_rad);
            if there.residual < here.residual {
                here = there;
                damping *= DAMPING_AFTER_GOOD;
            } else {
                damping = (damping * DAMPING_AFTER_BAD).max(f64::EPSILON);
                if damping > MAX_DAMPING {
                    break;
                }
            }
        }
        if here.residual <= RESIDUAL_TOLERANCE {
            Solution::Found(here.q_rad)
        } else {
            Solution::NotFound { residual: here.residual }
        }
    }

    /// The angles after one damped step; `None` if the system is singular.
    fn step(&self, here: &State, damping: f64) -> Option<Vec<f64>> {
        let mut normal = Matrix6::from_diagonal_element(damping);
        let free: Vec<bool> = (0..self.chain.dof()).map(|joint| !self.is_blocked(here, joint)).collect();
        for (column, _) in here.columns.iter().zip(&free).filter(|(_, free)| **free) {
            normal.ger(1.0, column, column, 1.0);
        }
        let lambda = normal.cholesky()?.solve(&here.error);
        let moved = here.q_rad.iter().zip(&here.columns).zip(&free);
        Some(self.clamped(moved.map(|((q, column), free)| if *free { q + column.dot(&lambda) } else { *q }).collect()))
    }

    /// True for a joint at a limit that the step would push beyond it.
    fn is_blocked(&self, here: &State, joint: usize) -> bool {
        let slope = here.columns[joint].dot(&here.error);
        let q = here.q_rad[joint];
        (q <= self.chain.lower()[joint] && slope < 0.0) || (q >= self.chain.upper()[joint] && slope > 0.0)
    }

    fn clamped(&self, mut q_rad: Vec<f64>) -> Vec<f64> {
        let limits = self.chain.lower().iter().zip(self.chain.upper());
        for (q, (lower, upper)) in q_rad.iter_mut().zip(limits) {
            *q = q.clamp(*lower, *upper);
        }
        q_rad
    }

    /// The first solution from at most `starts` postures, which fill the joint ranges evenly, the middle first; else the outcome
    /// with the smallest residual.
    pub fn solve(&self, target: &Pose, starts: usize) -> Solution {
        let mut nearest = Solution::NotFound { residual: f64::INFINITY };
        for start in 0..starts {
            match (self.solve_from(target, &self.start(start)), &nearest) {
                (Solution::NotFound { residual }, Solution::NotFound { residual: least }) => {
                    nearest = Solution::NotFound { residual: residual.min(*least) };
                }
                (outcome, _) => return outcome,
            }
        }
        nearest
    }

    /// The distinct solutions from `starts` postures, which fill the joint ranges evenly.
    pub fn solutions(&self, target: &Pose, starts: usize) -> Vec<Vec<f64>> {
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        for start in 0..starts {
            let q_rad = match self.solve_from(target, &self.start(start)) {
                Solution::Found(q_rad) => q_rad,
                Solution::NotFound { .. } => continue,
                Solution::OutOfReach { .. } | Solution::Malformed => break,
            };
            if !contains(&solutions, &q_rad) {
                solutions.push(q_rad);
            }
        }
        solutions
    }

    /// Element of a quasirandom sequence that fills the joint ranges evenly, the middle first: the additive recurrence on powers of `1 / phi`, `phi^(n + 1) = phi + 1` (M. Roberts, "The unreasonable effectiveness of
    /// quasirandom sequences", 2018).
    pub(super) fn start(&self, number: usize) -> Vec<f64> {
        let dof = self.chain.dof();
        let mut phi = 2.0_f64;
        for _ in 0..64 {
            phi = (1.0 + phi).powf(1.0 / (dof as f64 + 1.0));
        }
        let limits = self.chain.lower().iter().zip(self.chain.upper());
        let place = |joint: usize| (0.5 + number as f64 * phi.powi(-(joint as i32 + 1))).fract();
        limits.enumerate().map(|(joint, (lower, upper))| lower + (upper - lower) * place(joint)).collect()
    }

    /// Refines a nearly exact solution by Newton's method within the limits; `None` if it does not converge.
    pub(super) fn polished(&self, target: &Pose, q_rad: Vec<f64>) -> Option<Vec<f64>> {
        let mut here = State::new(&self.chain, target, self.clamped(q_rad));
        // Quadratic convergence from 1e-4 needs three steps; the fourth is for arms near a singularity.
        for _ in 0..4 {
            if here.residual <= TARGET_RESIDUAL {
                break;
            }
            here = State::new(&self.chain, target, self.step(&here, f64::EPSILON)?);
        }
        (here.residual <= RESIDUAL_TOLERANCE).then_some(here.q_rad)
    }
}

/// Angles, Jacobian and pose error of a step.
struct State {
    q_rad: Vec<f64>,
    /// Columns of the Jacobian in W axes.
    columns: Vec<Vector6<f64>>,
    /// Target minus pose: m, then rad.
    error: Vector6<f64>,
    residual: f64,
}

impl State {
    fn new(chain: &Chain, target: &Pose, q_rad: Vec<f64>) -> Self {
        let mut columns = vec![Vector6::zeros(); q_rad.len()];
        let x_wg = chain.pose_and_columns(&q_rad, &mut columns);
        let mut error = Vector6::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&(target.translation.vector - x_wg.translation.vector));
        error.fixed_rows_mut::<3>(3).copy_from(&(target.rotation * x_wg.rotation.inverse()).scaled_axis());
        let residual = error.norm();
        Self { q_rad, columns, error, residual }
    }
}
