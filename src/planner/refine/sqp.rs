//! Sequential quadratic programming with a trust region, in rounds of successive halving.
//!
//! A step is accepted if it is feasible and improves the objective; one that violates a constraint because of curvature is
//! corrected once or twice before the trust region shrinks. The Hessian is a damped BFGS approximation. Stability costs a
//! hundred times as much as all other constraints together: it is linearised when a step has violated it; its gradient is
//! then updated by Broyden's method and recomputed when the refinement stalls.

use nalgebra::{DMatrix, DVector};

use super::{
    super::{
        assessment,
        evaluate::{self, Configuration, Evaluator, Feasible},
        outcome::Rejection,
        params::{
            RefinementRound,
            refine::{CORRECTIONS, GOOD, LEAST_GAIN, POOR, RADIUS_RANGE, SHRINK, START_RADIUS},
        },
        problem::Problem,
        qp::{self, LinearConstraint},
    },
    linearization::{Linearization, Shifted},
};

/// Refines the starts round by round; the best first.
pub fn refine(evaluator: &mut Evaluator<'_>, starts: Vec<Feasible>, rounds: &[RefinementRound]) -> Vec<Feasible> {
    let mut iterates: Vec<_> = starts.into_iter().map(|start| Iterate::new(&evaluator.problem, start)).collect();
    for round in rounds {
        for iterate in iterates.iter_mut().take(round.candidates) {
            iterate.run(evaluator, round.steps);
        }
        iterates.sort_by(|a, b| b.here.objective.total_cmp(&a.here.objective));
        tracing::debug!(
            candidates = iterates.len().min(round.candidates),
            steps = round.steps,
            evaluations = evaluator.stats.candidates(),
            objective = iterates.first().map(|best| best.here.objective),
            "refined a round"
        );
    }
    iterates.into_iter().map(|iterate| iterate.here).collect()
}

/// The state of one refinement.
#[derive(Clone)]
struct Iterate {
    here: Feasible,
    linearization: Linearization,
    /// Approximate Hessian of the negative objective, positive definite.
    hessian: DMatrix<f64>,
    /// Half the side of the trust region.
    radius: f64,
}

/// The result of a trial step.
enum Trial {
    /// A feasible candidate.
    Feasible(Box<Feasible>),
    /// A violated constraint: the constraints with margins corrected for the linearisation's error.
    Violated(Vec<LinearConstraint>),
    /// A step from which nothing can be learned: the arms cannot follow, or the search was stopped.
    Failed,
}

impl Iterate {
    fn new(problem: &Problem<'_>, here: Feasible) -> Self {
        let linearization = Linearization::new(problem, &here);
        let count = linearization.gradient.len();
        // Scaled so that the first step is about as long as the trust region.
        let hessian = DMatrix::identity(count, count) * (0.2 * linearization.gradient.amax());
        Self { here, linearization, hessian, radius: START_RADIUS }
    }

    fn run(&mut self, evaluator: &mut Evaluator<'_>, steps: usize) {
        for _ in 0..steps {
            if self.radius < RADIUS_RANGE[0] || evaluator.stats.is_exhausted() {
                break;
            }
            if !self.step(evaluator) {
                break;
            }
        }
    }

    /// One step; false if no step promises a gain.
    fn step(&mut self, evaluator: &mut Evaluator<'_>) -> bool {
        let mut constraints = self.linearization.constraints.clone();
        for _ in 0..=CORRECTIONS {
            if evaluator.stats.is_exhausted() {
                return false;
            }
            let gradient = &self.linearization.gradient;
            let Some(d) = qp::solve(gradient, &self.hessian, &constraints, self.radius) else { break };
            let gain = gradient.dot(&d) - 0.5 * d.dot(&(&self.hessian * &d));
            if gain < LEAST_GAIN * self.here.objective.abs() {
                return self.linearization.refresh_stability(evaluator, &self.here);
            }
            evaluator.stats.count();
            match self.trial(evaluator, &d, &constraints) {
                Trial::Feasible(there) => {
                    let ratio = (there.objective - self.here.objective) / gain;
                    if ratio > 0.0 {
                        self.accept(&evaluator.problem, *there, &d);
                    }
                    if ratio > GOOD && d.amax() > 0.9 * self.radius {
                        self.radius = (2.0 * self.radius).min(RADIUS_RANGE[1]);
                    } else if ratio < POOR {
                        self.radius *= SHRINK;
                    }
                    return true;
                }
                Trial::Violated(corrected) => constraints = corrected,
                Trial::Failed => break,
            }
        }
        // An updated gradient of stability may be the cause.
        if !self.linearization.refresh_stability(evaluator, &self.here) {
            self.radius *= SHRINK;
        }
        true
    }

    fn trial(&mut self, evaluator: &mut Evaluator<'_>, d: &DVector<f64>, constraints: &[LinearConstraint]) -> Trial {
        let problem = &evaluator.problem;
        let Some(candidate) = self.linearization.variables.apply(problem, &self.here.candidate, d) else {
            return Trial::Failed;
        };
        let configuration = Configuration::new(problem, &candidate);
        let comfort = evaluate::comfort(problem, &candidate, &configuration);
        let mut corrected = constraints.to_vec();
        // The margins of the bodies are those of the collision test.
        if self.linearization.correct(problem, &candidate, &configuration, &comfort, d, &mut corrected) {
            return Trial::Violated(corrected);
        }
        if !evaluator.stats.may_evaluate()
            || evaluate::test_placement(&evaluator.problem, &candidate).is_err()
            || evaluate::test_sight(&evaluator.problem, &configuration).is_err()
        {
            return Trial::Failed;
        }
        let x_wo = &configuration.placement.x_wo;
        let stability = evaluator.assess(&candidate, x_wo);
        let learned = match assessment::test_stability(&evaluator.problem, &candidate.arms, x_wo, &stability) {
            Ok(()) => {
                return Trial::Feasible(Box::new(evaluator.feasible(candidate, configuration, comfort, stability)));
            }
            Err(Rejection::LoadedCollision) => {
                let there = Shifted { candidate: &candidate, configuration: &configuration, shift: &stability.shift };
                self.linearization.correct_loaded(&evaluator.problem, there, d, &mut corrected)
            }
            Err(_) => {
                let utilisation = stability.utilisation;
                self.linearization.correct_stability(evaluator, &self.here, utilisation, d, &mut corrected)
            }
        };
        if learned { Trial::Violated(corrected) } else { Trial::Failed }
    }

    /// Moves to a candidate and updates the Hessian.
    fn accept(&mut self, problem: &Problem<'_>, there: Feasible, d: &DVector<f64>) {
        let mut linearization = Linearization::new(problem, &there);
        linearization.update_stability(&self.linearization, &self.here, &there, d);
        // Damped BFGS (Powell 1978) on the negative objective.
        let y = &self.linearization.gradient - &linearization.gradient;
        let bd = &self.hessian * d;
        let (dbd, dy) = (d.dot(&bd), d.dot(&y));
        if dbd > 0.0 {
            let theta = if dy >= 0.2 * dbd { 1.0 } else { 0.8 * dbd / (dbd - dy) };
            let r = y * theta + &bd * (1.0 - theta);
            self.hessian += &r * r.transpose() / d.dot(&r) - &bd * bd.transpose() / dbd;
        }
        self.linearization = linearization;
        self.here = there;
    }
}
