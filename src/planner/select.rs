//! The best plans that differ from one another.

use super::{
    assemble::{accepted, assemble},
    configurations::other_configurations,
    evaluate::{Evaluator, Feasible},
    library::GraspLibrary,
    outcome::Rejection,
    params::{
        RefinementRound, SearchBudget,
        select::{CONFIGURATION_STEPS, STARTS_PER_PLAN},
    },
    refine,
    search::search,
    warm_starts::WarmStarts,
    watch::Watch,
};
use crate::model::{
    grasp::grasped_edge,
    plan::{ArmHold, Plan},
    scenario::ResponseKind,
};

/// Plans whose boards are farther apart than this differ, m.
pub const APART_M: f64 = 0.05;
/// Plans whose boards are turned against each other by more than this differ, rad: 15 degrees.
pub const APART_RAD: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Plans in which a joint of the robot differs by more than this differ, rad: 30 degrees.
pub const JOINT_APART_RAD: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// True if two plans differ: an arm grasps another edge, the board is farther away than 5 cm or turned by more than
/// 15 degrees, or a joint of the robot differs by more than 30 degrees. The person's posture does not count.
#[must_use]
pub fn differ(one: &Plan, other: &Plan) -> bool {
    let (a, b) = (&one.object.x_wo, &other.object.x_wo);
    let apart = (a.translation.vector - b.translation.vector).norm() > APART_M;
    let turned = a.rotation.angle_to(&b.rotation) > APART_RAD;
    let boards = [one, other].map(|plan| plan.object.shape());
    let arms_differ = |(a, b): (&ArmHold, &ArmHold)| {
        let joint = a.q_rad.iter().zip(&b.q_rad).any(|(a, b)| (a - b).abs() > JOINT_APART_RAD);
        joint || grasped_edge(&a.x_og, &boards[0]) != grasped_edge(&b.x_og, &boards[1])
    };
    apart || turned || one.arms.len() != other.arms.len() || one.arms.iter().zip(&other.arms).any(arms_differ)
}

/// The best `wanted` plans that [`differ`] from one another, perhaps fewer than wanted. The search is that of one
/// plan with more starts; the best grasps are also tried with other configurations of the arms. Every plan is checked.
pub fn top(
    evaluator: &mut Evaluator<'_>,
    library: &GraspLibrary,
    warm: &WarmStarts,
    wanted: usize,
    watch: &dyn Watch,
) -> Vec<Plan> {
    let budget = SearchBudget::of(evaluator.problem.scenario);
    let starts = budget.starts.max(STARTS_PER_PLAN.saturating_mul(wanted));
    let mut budget = SearchBudget { starts, warm_rounds: None, ..budget };
    for round in &mut budget.rounds {
        round.candidates = round.candidates.max(2 * wanted) + budget.warm_starts;
    }
    let found = search(evaluator, library, warm, &budget, watch);
    best_that_differ(evaluator, found, wanted)
}

/// The best `wanted` plans that [`differ`] from one another among candidates, each also with other configurations of the arms.
/// After a stop they are those that were checked before, and at least the best.
pub fn best_that_differ(evaluator: &mut Evaluator<'_>, found: Vec<Feasible>, wanted: usize) -> Vec<Plan> {
    let found = with_other_configurations(evaluator, found, wanted);
    let mut plans: Vec<Plan> = Vec::with_capacity(wanted);
    for found in found {
        // After a stop the best is checked, and no more: there may be many.
        if plans.len() == wanted || (!plans.is_empty() && evaluator.problem.stop.is_stopped()) {
            break;
        }
        let evaluations = evaluator.stats.candidates();
        let Some(plan) = assemble(evaluator, &found, evaluations) else {
            evaluator.stats.reject(Rejection::Stability);
            continue;
        };
        // The comparison is cheap beside the check.
        if plans.iter().all(|other| differ(other, &plan)) {
            plans.extend(accepted(evaluator, plan));
        }
    }
    plans
}

/// The candidates, the best `wanted` of them also with other configurations of the arms, refined; the best first.
fn with_other_configurations(evaluator: &mut Evaluator<'_>, found: Vec<Feasible>, wanted: usize) -> Vec<Feasible> {
    // The mean response ranks candidates by another objective than refinement's.
    if evaluator.problem.objective.person == ResponseKind::Mean || evaluator.problem.stop.is_stopped() {
        return found;
    }
    let stop = evaluator.problem.stop;
    let other = |found: &Feasible| other_configurations(evaluator, found, JOINT_APART_RAD);
    let others: Vec<_> = found.iter().take(wanted).take_while(|_| !stop.is_stopped()).flat_map(other).collect();
    let round = RefinementRound { candidates: others.len(), steps: CONFIGURATION_STEPS };
    let mut all = found;
    all.extend(refine::refine(evaluator, others, &[round]));
    all.sort_by(|a, b| b.objective.total_cmp(&a.objective));
    all
}
