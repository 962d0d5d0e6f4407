//! Replanning: a hold for a task that has changed, from the holds that are known from the tasks before.
//!
//! The person has walked a step, the tool is to work at another point or with another force. Then the best hold is most often the
//! last one, moved a little. So the last plan's hold is transferred to the new task and refined. Beside it a few other holds are
//! kept up to date in the same way, and at every call four of the family's warm starts are tried: another hold takes over once it is
//! better by a margin. No map is made for the new task.

use std::sync::Arc;

use super::{
    assemble::verified,
    candidate::Candidate,
    evaluate::{Evaluator, Feasible},
    library::largest_joint_difference_rad,
    params::{
        RefinementRound,
        refine::GRASP,
        replan::{
            BEST_STEPS, BETTER, FIRST_ROUNDS, FIRST_STARTS, FRESH_PER_CALL, KNOWN_HOLDS, LAST_STEPS, OTHERS_STEPS,
            SAME_GRASP,
        },
    },
    problem::{Problem, Reachable},
    refine,
    transfer::{Solution, turns},
    warm_starts::{WarmStarts, distinct},
};
use crate::model::{
    board::BoardShape,
    grasp::EdgeGrasp,
    plan::Plan,
    scenario::{Optima, Scenario},
};

/// What a replanning may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Replanning {
    /// The most that each joint of the arms may move from where the last plan has it, rad (m for a prismatic joint); `None` if
    /// that is not limited.
    pub most_motion_rad: Option<f64>,
    /// True if the grippers stay where they are on the board: the robot holds it already.
    pub keep_grasps: bool,
    /// True if a task for which the known holds do not serve is planned as [`super::Planner::plan`] does, which may take
    /// seconds. Such a plan keeps neither limit above, so it is not tried if one of them is set.
    pub search: bool,
}

impl Default for Replanning {
    fn default() -> Self {
        Self { most_motion_rad: None, keep_grasps: false, search: true }
    }
}

/// A plan for a changed task.
#[derive(Clone, Debug, PartialEq)]
pub struct Replanned {
    /// The plan, checked as every plan.
    pub plan: Plan,
    /// The way from the last plan's hold to this one; `None` for the first plan.
    pub motion: Option<Motion>,
    /// True if no known hold served and the task was planned as [`super::Planner::plan`] does.
    pub searched: bool,
}

/// How far arms and board are apart in two plans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// The largest difference of a joint, rad (m for a prismatic joint).
    pub largest_joint_rad: f64,
    /// The length of the straight motion of all joints of all arms, the root of the sum of their squared differences, rad.
    pub length_rad: f64,
    /// Distance of the board's centres, m.
    pub board_m: f64,
    /// Rotation of the board, rad.
    pub board_rad: f64,
    /// True if a gripper grasps the board elsewhere or otherwise.
    pub regrasps: bool,
}

impl Motion {
    fn between(from: &Solution, to: &Solution) -> Self {
        let pairs = || from.candidate.arms.iter().zip(&to.candidate.arms);
        let squares = pairs().flat_map(|(a, b)| a.q_rad.iter().zip(&b.q_rad).map(|(a, b)| (a - b) * (a - b)));
        Self {
            largest_joint_rad: largest_joint_difference_rad(&from.candidate.arms, &to.candidate.arms),
            length_rad: squares.sum::<f64>().sqrt(),
            board_m: (from.x_wo.translation.vector - to.x_wo.translation.vector).norm(),
            board_rad: from.x_wo.rotation.angle_to(&to.x_wo.rotation),
            regrasps: pairs().any(|(a, b)| !is_same_grasp(&a.grasp, &b.grasp)),
        }
    }
}

fn is_same_grasp(one: &EdgeGrasp, other: &EdgeGrasp) -> bool {
    let parameters = |grasp: &EdgeGrasp| [grasp.along_m, grasp.depth_m, grasp.angle_rad];
    let near = parameters(one)
        .iter()
        .zip(parameters(other))
        .zip(GRASP)
        .all(|((a, b), scale)| (a - b).abs() <= SAME_GRASP * scale);
    one.edge == other.edge && one.flipped == other.flipped && near
}

/// The holds that are known from the tasks before.
pub struct KnownHolds {
    board: BoardShape,
    clearance_mm: f64,
    /// The optima of a normalised objective.
    optima: Option<Optima>,
    /// The solution of the last plan.
    last: Solution,
    /// Other solutions.
    others: Vec<Solution>,
    warm: Arc<WarmStarts>,
    /// The next of the warm starts that is tried.
    next: usize,
}

impl KnownHolds {
    /// True if they can serve a task: its board has the same shape and the robot keeps the same clearance.
    pub fn serve(&self, scenario: &Scenario) -> bool {
        self.board == scenario.object.shape() && self.clearance_mm == scenario.limits.clearance_mm
    }

    /// The optima of a normalised objective.
    pub fn optima(&self) -> Option<Optima> {
        self.optima
    }

    /// The way from the last hold to that of others.
    pub fn motion_to(&self, other: &Self) -> Motion {
        Motion::between(&self.last, &other.last)
    }

    /// The plan of a task from these holds, which are then those of this task; `None`, and the same holds, if no one serves.
    pub fn replan(&mut self, evaluator: &mut Evaluator<'_>, how: &Replanning) -> Option<Replanned> {
        let problem = &mut evaluator.problem;
        problem.reachable = how.most_motion_rad.map(|most_rad| Reachable {
            from_rad: self.last.candidate.arms.iter().map(|arm| arm.q_rad.clone()).collect(),
            most_rad,
        });
        if how.keep_grasps {
            problem.grasp_scales = [0.0; 3];
        }
        let mut ranked = self.ranked(evaluator, how);
        if ranked.is_empty() && !how.keep_grasps {
            ranked = from_warm_starts(evaluator, &self.warm);
        }
        let plan = first_verified(evaluator, &mut ranked)?;
        let (last, others) = solutions(&evaluator.problem, ranked)?;
        let motion = Motion::between(&self.last, &last);
        self.last = last;
        if !how.keep_grasps {
            self.others = others;
        }
        Some(Replanned { plan, motion: Some(motion), searched: false })
    }

    /// The holds for the evaluator's task: the last one, or another that takes over, then the others.
    fn ranked(&mut self, evaluator: &mut Evaluator<'_>, how: &Replanning) -> Vec<Feasible> {
        let last = start(evaluator, &self.last, 0);
        let last = refined(evaluator, last.into_iter().collect(), LAST_STEPS);
        let mut others = if how.keep_grasps { Vec::new() } else { self.refined_others(evaluator) };
        let better = |other: &&Feasible| {
            last.first().is_none_or(|last| other.objective - last.objective > BETTER * last.objective.abs())
        };
        let mut ranked = if others.first().filter(better).is_some() {
            refined(evaluator, vec![others.remove(0)], BEST_STEPS)
        } else {
            Vec::new()
        };
        ranked.extend(last);
        ranked.extend(others);
        ranked
    }

    /// The other solutions and the next warm starts, transferred and refined a little; the best first.
    fn refined_others(&mut self, evaluator: &mut Evaluator<'_>) -> Vec<Feasible> {
        let turns = turns(&evaluator.problem.robot.board);
        let fresh: Vec<_> =
            self.warm.solutions().flat_map(|solution| turns.iter().map(move |turn| (solution, *turn))).collect();
        let known = self.others.iter().map(|solution| (solution, 0));
        let tried = fresh.iter().cycle().skip(self.next).take(FRESH_PER_CALL.min(fresh.len())).copied();
        let starts: Vec<_> =
            known.chain(tried).filter_map(|(solution, turn)| start(evaluator, solution, turn)).collect();
        self.next = (self.next + FRESH_PER_CALL) % fresh.len().max(1);
        refined(evaluator, starts, OTHERS_STEPS)
    }
}

/// The first plan of a task from the warm starts of a family, and the holds that are known then; `None` if no start serves.
pub fn first(evaluator: &mut Evaluator<'_>, warm: &Arc<WarmStarts>) -> Option<(Plan, KnownHolds)> {
    let mut ranked = from_warm_starts(evaluator, warm);
    let plan = first_verified(evaluator, &mut ranked)?;
    let holds = known(evaluator, ranked, warm)?;
    Some((plan, holds))
}

/// The holds for a task from all warm starts, the best first.
fn from_warm_starts(evaluator: &mut Evaluator<'_>, warm: &WarmStarts) -> Vec<Feasible> {
    let starts = warm.starts(evaluator, FIRST_STARTS);
    refine::refine(evaluator, starts, &FIRST_ROUNDS)
}

/// The first plan that passes its check; the holds before it are removed.
fn first_verified(evaluator: &mut Evaluator<'_>, ranked: &mut Vec<Feasible>) -> Option<Plan> {
    let (number, plan) =
        ranked.iter().enumerate().find_map(|(number, found)| Some((number, verified(evaluator, found)?)))?;
    ranked.drain(..number);
    Some(plan)
}

/// The holds that are known after a plan of a task: that of the plan alone; `None` if the plan's grasps are not those of edges.
pub fn of_plan(evaluator: &mut Evaluator<'_>, plan: &Plan, warm: &Arc<WarmStarts>) -> Option<KnownHolds> {
    let candidate = Candidate::of_plan(&evaluator.problem, plan)?;
    let found = evaluator.evaluate(candidate).ok()?;
    known(evaluator, vec![found], warm)
}

fn known(evaluator: &Evaluator<'_>, ranked: Vec<Feasible>, warm: &Arc<WarmStarts>) -> Option<KnownHolds> {
    let problem = &evaluator.problem;
    let (last, others) = solutions(problem, ranked)?;
    Some(KnownHolds {
        board: problem.robot.board.clone(),
        clearance_mm: problem.scenario.limits.clearance_mm,
        optima: problem.scenario.comfort.optima,
        last,
        others,
        warm: warm.clone(),
        next: 0,
    })
}

/// The first solution, and the others that differ, in their order; `None` without any.
fn solutions(problem: &Problem<'_>, ranked: Vec<Feasible>) -> Option<(Solution, Vec<Solution>)> {
    let different = distinct(ranked, &problem.robot.board, KNOWN_HOLDS);
    let mut solutions = different.into_iter().map(|found| Solution::new(problem, found.candidate));
    Some((solutions.next()?, solutions.collect()))
}

/// A solution transferred to the evaluator's task so that it satisfies every constraint: of the ways to transfer it the first one
/// that does, the more comfortable one first.
fn start(evaluator: &mut Evaluator<'_>, solution: &Solution, quarters: usize) -> Option<Feasible> {
    let mut ways = solution.transfers(evaluator, quarters);
    ways.sort_by(|a, b| b.0.total_cmp(&a.0));
    ways.into_iter().find_map(|(_, candidate)| refine::repair(evaluator, candidate))
}

/// The starts after some steps of refinement, the best first.
fn refined(evaluator: &mut Evaluator<'_>, starts: Vec<Feasible>, steps: usize) -> Vec<Feasible> {
    let round = RefinementRound { candidates: starts.len(), steps };
    refine::refine(evaluator, starts, &[round])
}
