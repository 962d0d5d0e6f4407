//! Repair of a candidate that violates constraints slightly.

use nalgebra::{DMatrix, DVector};

use super::{
    super::{
        candidate::Candidate,
        evaluate::{self, Evaluator, Feasible, Rejected},
        outcome::Rejection,
        params::refine::{RADIUS_RANGE, REPAIR_STEPS},
        qp,
    },
    linearization::Linearization,
};

/// The candidate itself if it satisfies every constraint, or else one near it that does: the shortest steps that satisfy the
/// linearised constraints are made until the exact ones are satisfied. `None` if a few steps do not lead there.
pub fn repair(evaluator: &mut Evaluator<'_>, mut candidate: Candidate) -> Option<Feasible> {
    for step_number in 0..=REPAIR_STEPS {
        if evaluator.stats.is_exhausted() {
            return None;
        }
        evaluator.stats.count();
        let rejected = match evaluator.evaluate(candidate) {
            Ok(found) => return Some(found),
            Err(rejected) => *rejected,
        };
        evaluator.stats.reject(rejected.why);
        if crate::planner::params::knob("GIVEUP", 1) == 1 {
            let utilisation = if rejected.why == Rejection::Collision && step_number == 0 {
                evaluator.assess(&rejected.candidate, &rejected.configuration.placement.x_wo).utilisation
            } else {
                rejected.stability.utilisation
            };
            if utilisation > 2.0 {
                return None;
            }
        }
        candidate = step(evaluator, rejected)?;
    }
    None
}

/// The shortest step that satisfies the linearised constraints. Stability is among them only if it is what is violated: it
/// costs more than all others, and a candidate that collides has to move anyway.
fn step(evaluator: &mut Evaluator<'_>, rejected: Rejected) -> Option<Candidate> {
    let Rejected { candidate, configuration, stability, .. } = rejected;
    let comfort = evaluate::comfort(&evaluator.problem, &candidate, &configuration);
    let here = Feasible { objective: comfort.objective, candidate, configuration, comfort, stability };
    let mut linearization = Linearization::new(&evaluator.problem, &here);
    linearization.include_stability(evaluator, &here);
    let count = linearization.gradient.len();
    let identity = DMatrix::identity(count, count);
    let d = qp::solve(&DVector::zeros(count), &identity, &linearization.constraints, RADIUS_RANGE[1])?;
    linearization.variables.apply(&evaluator.problem, &here.candidate, &d)
}
