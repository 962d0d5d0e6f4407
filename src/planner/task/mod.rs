//! Plans for whole tasks: holds, motions of the board and regrasps for a path that is cut or drilled
//! (docs/method.md#11-tasks).
//!
//! The way of the data: a plan for each piece by itself (the caller) → `holds`: all grips that serve pieces, with the board where
//! each piece is at a comfortable pose of the tool → `graph`: the cheapest way through the pieces, whose steps `transitions` checks →
//! `stages`: the staged plan, with timed motions.

mod free_motion;
mod graph;
mod grasp_loads;
mod grips;
mod hand_changes;
mod hold;
mod holds;
mod inputs;
mod level_poses;
mod motion;
mod places;
mod problem;
mod regrasp;
mod root;
mod stages;
mod timing;
mod transitions;

pub use graph::Ahead;
pub use inputs::TaskSearch;

use std::cell::OnceCell;

use self::{
    graph::{Costs, Found, Graph, Start, Step},
    holds::Holds,
    places::Places,
    problem::{Posture, TaskProblem},
    root::Root,
    stages::Stages,
    transitions::Transitions,
};
use super::{
    candidate::Candidate,
    library::BoardGrasp,
    outcome::{Infeasible, PlanError},
    params::task::{PLANNED_PIECES, ROOTS},
    problem::posture_map,
    watch::{Event, Phase, begin, go_on},
};
use crate::model::{
    plan::Plan,
    scenario::Scenario,
    staged_plan::StagedPlan,
    task::Task,
    tool_path::{Piece, Stroke},
};

/// The plan of a task.
#[derive(Clone, Debug)]
pub struct TaskPlan {
    /// The stages.
    pub staged: StagedPlan,
    /// The best plan for each piece by itself, which no robot can carry out without regrasping at every piece; `None` for pieces of
    /// a long path that were not planned by themselves.
    pub separate: Vec<Option<Plan>>,
}

/// Why there is no plan for a task.
#[derive(Clone, Debug)]
pub struct TaskInfeasible {
    /// The first piece that is not served, from 0.
    pub piece: usize,
    /// Where it is.
    pub place: Piece,
    /// Why no hold serves it by itself; `None` if one does, but it cannot be reached from holds for the pieces before.
    pub alone: Option<Box<Infeasible>>,
}

impl TaskInfeasible {
    /// For a piece of a task, or its last one if it has fewer.
    pub(super) fn new(task: &Task, piece: usize, alone: Option<Infeasible>) -> Self {
        let pieces = task.pieces();
        let piece = piece.min(pieces.len().saturating_sub(1));
        let nowhere = Piece { stroke: 0, from_m: 0.0, to_m: 0.0 };
        let place = pieces.get(piece).copied().unwrap_or(nowhere);
        Self { piece, place, alone: alone.map(Box::new) }
    }
}

impl std::fmt::Display for TaskInfeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { piece, place: Piece { stroke, from_m, .. }, alone } = self;
        write!(f, "piece {} of the path ({from_m:.3} m along stroke {}): ", piece + 1, stroke + 1)?;
        match alone {
            Some(why) => write!(f, "no hold serves it: {why}"),
            None => f.write_str("no hold that serves it is reached from holds for the pieces before"),
        }
    }
}

/// The scenarios of a task's pieces, named after the scenario and their number.
#[must_use]
pub fn pieces(scenario: &Scenario, task: &Task) -> Vec<Scenario> {
    let thickness_m = scenario.object.size_m[2];
    let of_piece = |(number, piece): (usize, &Piece)| {
        let operation = task.operation_of(piece, thickness_m)?;
        let name = format!("{}-{}", scenario.name, number + 1);
        Some(Scenario { name, operation, ..scenario.clone() })
    };
    task.pieces().iter().enumerate().filter_map(of_piece).collect()
}

/// The pieces that are planned by themselves: all of a short path, as many as a plan affords at equal distances of a long one.
pub fn planned_by_themselves(count: usize) -> Vec<usize> {
    evenly(count, PLANNED_PIECES)
}

/// At most `most` of `count` numbers at equal distances.
fn evenly(count: usize, most: usize) -> Vec<usize> {
    let chosen = count.min(most);
    (0..chosen).map(|number| number * count / chosen).collect()
}

impl TaskSearch<'_> {
    /// The staged plan. It is found part by part: `ready` is told of the plan so far whenever it has new stages, which stay as they
    /// are. After a stop before there was a whole one [`PlanError::Stopped`].
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn run(
        &self,
        ahead: Ahead,
        ready: &mut dyn FnMut(&StagedPlan),
    ) -> Result<Result<StagedPlan, TaskInfeasible>, PlanError> {
        let Self { task, pieces, robot, watch, .. } = *self;
        let mut problem = TaskProblem::new(task, pieces, self.best(), robot, watch)?;
        let roots = self.roots(&problem);
        begin(watch, Phase::Task);
        // Force and person are the same at all pieces, seen from the tool.
        let of_first = problem.of_piece(0);
        let map = posture_map(of_first.scenario, &of_first.human, watch);
        let places = Places::new(&problem, &map, &roots, self.is_closed());
        let (holds, with_level_poses) = (Holds::new(&problem, &roots, &places), OnceCell::new());
        let costs = Costs { per_move: task.move_cost, per_regrasp: task.regrasp_cost };
        let mut transitions = Transitions::new(&mut problem, &holds);
        let mut stages = Stages::new(self, &holds);
        let mut start = Start { piece: 0, hold: None };
        let mut all_served = holds.served_by_some();
        // Postures beside the robot are searched for only if those beside the board alone are too few, and level board poses are used
        // only if grips cannot be changed where the person works.
        for (is_level, is_nearby) in [(false, false), (false, true), (true, false), (true, true)] {
            let holds = match is_level {
                false => &holds,
                true => with_level_poses.get_or_init(|| holds.with_level_poses(transitions.problem)),
            };
            (transitions.holds, stages.holds) = (holds, holds);
            let serving = if is_nearby { &holds.serving_nearby } else { &holds.serving };
            let graph = Graph { arcs: &holds.arcs, serving, costs };
            let to_end = graph.costs_to_end();
            loop {
                go_on(watch)?;
                let found = graph.cheapest(&to_end, start, ahead, &mut transitions).ok_or(PlanError::Stopped)?;
                let steps = match found {
                    Found::Way(steps) => steps,
                    Found::Nothing { served } => {
                        all_served = all_served.max(served);
                        break;
                    }
                };
                // Each round adds stages, or excludes a step of this way.
                if stages.add(&mut transitions, &steps) {
                    start = Start { piece: stages.served(), hold: steps.last().map(Step::end) };
                    if let Some(plan) = &stages.plan {
                        ready(plan);
                    }
                }
                if start.piece == pieces.len() {
                    watch.tell(&Event::Found);
                    return stages.plan.map(Ok).ok_or(PlanError::Stopped);
                }
            }
        }
        Ok(Err(TaskInfeasible::new(task, all_served, None)))
    }

    /// The objective of the best hold for each piece alone: of pieces without a plan that of the nearest piece with one.
    fn best(&self) -> Vec<f64> {
        let objective = |plan: &Plan| plan.comfort.map_or(0.0, |comfort| comfort.objective);
        let known: Vec<_> = self.separate.iter().map(|plan| plan.as_ref().map(objective)).collect();
        let nearest = |piece: usize| {
            let planned =
                known.iter().enumerate().filter_map(|(number, best)| Some((number.abs_diff(piece), (*best)?)));
            planned.min_by_key(|(distance, _)| *distance).map_or(0.0, |(_, best)| best)
        };
        (0..known.len()).map(nearest).collect()
    }

    fn roots(&self, problem: &TaskProblem<'_>) -> Vec<Root> {
        let planned: Vec<_> = (0..self.separate.len()).filter(|&piece| self.separate[piece].is_some()).collect();
        let root = |chosen: usize| {
            let piece = planned[chosen];
            let plan = self.separate[piece].as_ref()?;
            let Candidate { work, arms } = Candidate::of_plan(problem.of_piece(piece), plan)?;
            let posture = Posture { x_wb: plan.human?.x_wb, q_h_rad: work.q_h_rad, roll_rad: work.roll_rad };
            let grasp = BoardGrasp { x_wo: plan.object.x_wo, arms };
            Some(Root { piece, grasp, posture, objective: problem.best[piece] })
        };
        evenly(planned.len(), ROOTS).into_iter().filter_map(root).collect()
    }

    /// True if the path ends where it begins, so that the last piece is beside the first one.
    fn is_closed(&self) -> bool {
        matches!(self.task.path[..], [Stroke::Circle { .. }])
    }
}
