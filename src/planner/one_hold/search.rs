//! The search for one hold: as many pieces as possible, then the least comfortable of them as comfortable as possible.
//!
//! Every grasp of the library is estimated at all pieces by the posture map, and the best of them by their stability too;
//! boards oriented like theirs are resampled. The best estimates of both are evaluated exactly, and the best few are improved
//! by random steps of board, grasps and joints that shrink while none is better. That is a local search from a few starts: it
//! does not prove that no grasp serves more pieces or serves them better.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{
    super::{
        domain::{ANGLE_RAD, uniform},
        library::{ArmGrasp, BoardGrasp, LibraryEntry, resample},
        params::one_hold::{
            EVALUATED_PER_START, GRASP, JOINTS_RAD, NARROWER, RESAMPLED_BOARDS, SHIFT_M, TRIES_PER_STEP, TURN_RAD,
            WIDER,
        },
        watch::{Counter, Phase, begin},
    },
    coverage::{Coverage, PersonResponse, PiecesProblem, Score},
};
use crate::model::frames::Pose;

/// The best grasp that is found for the searched pieces.
pub fn search(problem: &mut PiecesProblem<'_>) -> Option<Coverage> {
    let mut starts = starts(problem);
    starts.truncate(problem.budget.one_hold.local_searches);
    let improved = starts.into_iter().map(|start| improve(problem, start));
    improved.min_by(|a, b| a.score.order(&b.score))
}

/// The grasps with the best coverage, evaluated exactly, the best first: of the library, and of boards oriented like the best
/// of the library.
fn starts(problem: &mut PiecesProblem<'_>) -> Vec<Coverage> {
    let library = problem.library;
    let mut estimated = best_estimates(problem, library.entries(problem.watch).unwrap_or_default());
    let natural = problem.natural_entries();
    begin(problem.watch, Phase::OneHold);
    estimated.extend(best_estimates(problem, &natural));
    estimated.sort_by(|a, b| a.0.order(&b.0));
    let boards: Vec<_> = estimated.iter().take(RESAMPLED_BOARDS).map(|(_, grasp)| grasp.x_wo).collect();
    let count = problem.budget.one_hold.resampled_boards;
    let resampled = resample(&library.robot, &boards, count, [problem.seed(), 1], &Counter::quiet(problem.watch));
    estimated.extend(best_estimates(problem, &resampled));
    estimated.sort_by(|a, b| a.0.order(&b.0));
    let mut coverages = Vec::new();
    for (_, grasp) in estimated.into_iter().take(EVALUATED_PER_START * problem.budget.starts) {
        if problem.is_exhausted() {
            break;
        }
        let pieces = problem.searched().to_vec();
        let responses = pieces.iter().map(|&piece| problem.response(grasp, piece, None)).collect();
        coverages.push(Coverage::new(grasp.clone(), responses));
    }
    coverages.retain(|coverage| coverage.score.served > 0);
    coverages.sort_by(|a, b| a.score.order(&b.score));
    coverages
}

/// The grasps with the best estimates, ordered by them with unstable pieces removed. Stability costs a hundred times as much as
/// an estimate, so it is computed for the best only.
fn best_estimates<'b>(problem: &mut PiecesProblem<'_>, entries: &'b [LibraryEntry]) -> Vec<(Score, &'b BoardGrasp)> {
    let until_stopped = entries.iter().take_while(|_| !problem.watch.is_stopped());
    let estimate = |LibraryEntry { grasp, .. }: &'b LibraryEntry| {
        let estimates = problem.estimates(grasp);
        (Score::of(estimates.iter().copied()), grasp, estimates)
    };
    let mut estimated: Vec<_> = until_stopped.map(estimate).collect();
    estimated.sort_by(|a, b| a.0.order(&b.0));
    estimated.truncate(problem.budget.one_hold.estimates);
    for (score, grasp, estimates) in &mut estimated {
        if problem.is_exhausted() {
            break;
        }
        problem.remove_unstable(grasp, estimates);
        *score = Score::of(estimates.iter().copied());
    }
    let mut estimated: Vec<_> = estimated.into_iter().map(|(score, grasp, _)| (score, grasp)).collect();
    estimated.sort_by(|a, b| a.0.order(&b.0));
    estimated
}

/// Random steps from a grasp, each kept if it is better.
fn improve(problem: &mut PiecesProblem<'_>, mut here: Coverage) -> Coverage {
    let mut scale = 1.0_f64;
    for _ in 0..TRIES_PER_STEP * problem.budget.one_hold.steps {
        if problem.is_exhausted() {
            break;
        }
        let better = displaced_grasp(problem, &here.grasp, scale).and_then(|grasp| better(problem, grasp, &here));
        scale = if better.is_some() { (WIDER * scale).min(1.0) } else { NARROWER * scale };
        here = better.unwrap_or(here);
    }
    here
}

/// A random collision-free grasp near another that the arms reach.
fn displaced_grasp(problem: &mut PiecesProblem<'_>, from: &BoardGrasp, scale: f64) -> Option<BoardGrasp> {
    let robot = &problem.library.robot;
    let random = &mut problem.random;
    let mut within = |most: f64| uniform(random, -scale * most, scale * most);
    let shift = Vector3::from_fn(|_, _| within(SHIFT_M));
    let turn = Vector3::from_fn(|_, _| within(TURN_RAD));
    let x_wo = displaced(&from.x_wo, shift, turn);
    let mut arms = Vec::with_capacity(from.arms.len());
    for (arm, own) in robot.arms.iter().zip(&from.arms) {
        let mut grasp = own.grasp;
        grasp.along_m += within(GRASP[0]);
        grasp.depth_m = (grasp.depth_m + within(GRASP[1])).clamp(arm.depth_m[0], arm.depth_m[1]);
        grasp.angle_rad = (grasp.angle_rad + within(GRASP[2])).clamp(ANGLE_RAD[0], ANGLE_RAD[1]);
        let seed: Vec<_> = own.q_rad.iter().map(|q| q + within(JOINTS_RAD)).collect();
        if !robot.fits(arm, &grasp) {
            return None;
        }
        arms.push(ArmGrasp { grasp, q_rad: arm.inverse.local(&(x_wo * grasp.x_og(&robot.board)), &seed).found()? });
    }
    let grasp = BoardGrasp { x_wo, arms };
    problem.is_clear(&grasp).then_some(grasp)
}

/// The coverage of a grasp if it is better than another; the pieces with the least objective are evaluated first.
fn better(problem: &mut PiecesProblem<'_>, grasp: BoardGrasp, than: &Coverage) -> Option<Coverage> {
    let objective = |response: &Option<PersonResponse>| response.map_or(f64::INFINITY, |response| response.objective);
    let pieces = problem.searched().to_vec();
    let mut order: Vec<_> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| objective(&than.responses[a]).total_cmp(&objective(&than.responses[b])));
    let mut responses = vec![None; order.len()];
    // The number of pieces that may still be served.
    let mut possible = order.len();
    for number in order {
        let response = problem.response(&grasp, pieces[number], than.responses[number].as_ref());
        possible -= usize::from(response.is_none());
        let too_few = possible < than.score.served;
        let too_bad =
            possible == than.score.served && response.is_some_and(|found| found.objective <= than.score.least);
        if too_few || too_bad {
            return None;
        }
        responses[number] = response;
    }
    let coverage = Coverage::new(grasp, responses);
    coverage.score.order(&than.score).is_lt().then_some(coverage)
}

/// A board pose turned and shifted about the board's centre.
fn displaced(x_wo: &Pose, shift_w_m: Vector3<f64>, turn_o_rad: Vector3<f64>) -> Pose {
    let rotation = x_wo.rotation * UnitQuaternion::from_scaled_axis(turn_o_rad);
    Isometry3::from_parts((x_wo.translation.vector + shift_w_m).into(), rotation)
}
