//! Other configurations of the arms for a grasp: the same board pose and grasps, other joint angles.
//!
//! An arm with a redundant joint, or with several branches of its inverse kinematics, reaches a grasp in many ways.
//! Refinement follows one of them continuously and never changes the branch. All branches are enumerated here, and the
//! combinations of the arms' solutions are tested from the one that is farthest from its joint limits.

use super::{
    candidate::Candidate,
    evaluate::{Evaluator, Feasible},
    library::{ArmGrasp, GraspingArm, largest_joint_difference_rad},
    params::select::{COMBINATIONS, CONFIGURATIONS, SOLUTION_STARTS},
};
use crate::{
    model::frames::Pose,
    robot::{
        Chain,
        bimanual::{Combination, Combinations, RankedSolutions},
    },
};

/// Feasible candidates with the grasp of `found` whose arms differ from it, and from each other, by more than `apart_rad` in
/// some joint; at most [`CONFIGURATIONS`].
pub fn other_configurations(evaluator: &mut Evaluator<'_>, found: &Feasible, apart_rad: f64) -> Vec<Feasible> {
    let Feasible { candidate, configuration, .. } = found;
    let robot = evaluator.problem.robot;
    let solutions: Vec<_> = robot
        .arms
        .iter()
        .zip(&candidate.arms)
        .map(|(arm, own)| solutions(arm, &configuration.placement.x_wo, &own.grasp.x_og(&robot.board)))
        .collect();
    let mut kept: Vec<Feasible> = Vec::new();
    for combination in Combinations::new(&solutions).take(COMBINATIONS) {
        if kept.len() == CONFIGURATIONS || evaluator.stats.is_exhausted() {
            break;
        }
        let other = with_joints(candidate, &combination);
        let differs = |known: &Candidate| largest_joint_difference_rad(&known.arms, &other.arms) > apart_rad;
        if !differs(candidate) || !kept.iter().all(|known| differs(&known.candidate)) {
            continue;
        }
        evaluator.stats.count();
        match evaluator.evaluate(other) {
            Ok(feasible) => kept.push(feasible),
            Err(rejected) => evaluator.stats.reject(rejected.why),
        }
    }
    kept
}

/// All solutions of an arm for a grasp, those farthest from the joint limits first.
fn solutions(arm: &GraspingArm, x_wo: &Pose, x_og: &Pose) -> RankedSolutions {
    let least_margin = |q_rad: &[f64]| -limit_margin(&arm.chain, q_rad);
    RankedSolutions::of_arm(&arm.inverse, &(x_wo * x_og), SOLUTION_STARTS, least_margin)
}

/// The least distance of a joint from its nearer limit as a share of half its range: 1 in the middle, 0 at a limit.
fn limit_margin(chain: &Chain, q_rad: &[f64]) -> f64 {
    let limits = chain.lower().iter().zip(chain.upper());
    let margin = |(q, (low, high)): (&f64, (&f64, &f64))| (q - low).min(high - q) / (0.5 * (high - low));
    q_rad.iter().zip(limits).map(margin).fold(f64::INFINITY, f64::min)
}

fn with_joints(candidate: &Candidate, combination: &Combination<'_>) -> Candidate {
    let arms = candidate.arms.iter().zip(&combination.q_rad);
    let arms = arms.map(|(arm, q_rad)| ArmGrasp { grasp: arm.grasp, q_rad: q_rad.to_vec() }).collect();
    Candidate { work: candidate.work, arms }
}
