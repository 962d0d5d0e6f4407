//! Repair of a candidate that violates constraints slightly.

use nalgebra::{DMatrix, DVector};

use super::{
    super::{
        candidate::Candidate,
        evaluate::{self, Evaluator, Feasible, Rejected},
        outcome::Rejection,
        params::refine::{HOPELESS_UTILISATION, RADIUS_RANGE, REPAIR_STEPS},
        qp,
    },
    linearization::Linearization,
};
use crate::model::plan::PostureConstraint;

/// The candidate itself if it satisfies every constraint, or else one near it that does: the shortest steps that satisfy the
/// linearised constraints are made until the exact ones are satisfied. `None` if a few steps do not lead there.
pub fn repair(evaluator: &mut Evaluator<'_>, mut candidate: Candidate) -> Option<Feasible> {
    for round in 0..=REPAIR_STEPS {
        if evaluator.stats.is_exhausted() {
            return None;
        }
        evaluator.stats.count();
        let rejected = match evaluator.evaluate(candidate) {
            Ok(found) => return Some(found),
            Err(rejected) => *rejected,
        };
        evaluator.stats.reject(rejected.why);
        if is_hopeless(evaluator, &rejected, round == 0) {
            return None;
        }
        candidate = step(evaluator, rejected)?;
    }
    None
}

/// True if a candidate is too far from stability for a repair. That of one that collides is tested at the `first` round alone.
fn is_hopeless(evaluator: &mut Evaluator<'_>, rejected: &Rejected, first: bool) -> bool {
    let Rejected { candidate, configuration, stability, why } = rejected;
    let collides = matches!(why, Rejection::Collision | Rejection::Posture(PostureConstraint::LineOfSight));
    let utilisation = if collides && first {
        evaluator.assess(candidate, &configuration.placement.x_wo).utilisation
    } else {
        stability.utilisation
    };
    utilisation > HOPELESS_UTILISATION
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
