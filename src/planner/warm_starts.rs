//! Warm starts: solutions of a few tasks of a family, transferred to a new task.
//!
//! A few tasks of a family are solved with a larger budget than a plan's: first from the grasp library, then from resampled
//! boards oriented like the best solutions so far and from the solutions of the other tasks. The best that differ are kept.
//! To transfer a solution, the board is turned by quarters about its normal (a rectangle is the same after half a turn, and
//! nearly so after a quarter; a plate only after the turns that leave its outline as it is), then the person or the board moves so that the tool is where the new task needs it. A
//! transferred candidate that violates a constraint slightly is repaired.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::{
    candidate::{Candidate, WorkPose},
    evaluate::{self, Configuration, Evaluator, Feasible},
    library::{ArmGrasp, BoardGrasp, GraspLibrary, GraspPattern, GraspingRobot, LibraryEntry, PostureMap, resample},
    natural_boards::{entries_for_place, natural_entries},
    outcome::{PlanError, Rejection},
    params::{
        SearchBudget, WarmStartBudget, per_pattern,
        screening::{REPAIRS_PER_START, STARTS_PER_PATTERN},
        warm_starts::{KEPT, KEPT_PER_PATTERN, SAME_OPTIMUM},
    },
    problem::{self, Problem},
    refine,
    screen::{self, align, aligning_roll},
    stats::SearchStats,
    task_family::{TaskFamily, solved_tasks},
    watch::{Counter, Phase, Watch, go_on},
};
use crate::{
    comfort,
    human::Human,
    model::{
        board::{BoardShape, Edge, QUARTERS},
        frames::Pose,
        grasp::EdgeGrasp,
        plan::Comfort,
        scenario::{PlannerKind, Scenario},
    },
};

/// The warm starts of one task family. They do not depend on which of the family's tasks asked for them.
pub struct WarmStarts {
    /// The family that they serve.
    pub family: TaskFamily,
    /// The posture map of the family; `None` for the random planner, which does not use it.
    pub postures: Option<PostureMap>,
    /// Grasps of the boards that natural postures ask for.
    pub entries: Vec<LibraryEntry>,
    solutions: Vec<Solution>,
}

/// A solution of one of the solved tasks.
#[derive(Clone, Debug)]
struct Solution {
    candidate: Candidate,
    x_wo: Pose,
    comfort: Comfort,
    /// The tool tip on the board.
    p_ot_m: Point3<f64>,
}

impl WarmStarts {
    /// Solves the tasks of a family. `shared` is the family's scenario, with the optima of a normalised objective filled in.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn new(
        family: TaskFamily,
        shared: &Scenario,
        library: &GraspLibrary,
        watch: &dyn Watch,
    ) -> Result<Self, PlanError> {
        let human = Human::new(&shared.human, &shared.tool)?;
        let planner = &shared.planner;
        if planner.kind == PlannerKind::Random {
            return Ok(Self { family, postures: None, entries: Vec::new(), solutions: Vec::new() });
        }
        let postures = problem::posture_map(shared, &human, watch);
        let (seed, budget) = (planner.seed, WarmStartBudget::of(shared));
        let count = SearchBudget::of(shared).natural_boards;
        let entries = natural_entries(shared, &human, &library.robot, &postures, count, watch);
        let mut warm = Self { family, postures: Some(postures), entries, solutions: Vec::new() };
        if let Some(budget) = budget {
            warm.solve(&solved_tasks(shared), library, &budget, seed, watch)?;
        }
        go_on(watch)?;
        Ok(warm)
    }

    /// Solves the tasks pass by pass, at first from the library, then from boards oriented like the best solutions so far.
    fn solve(
        &mut self,
        tasks: &[Scenario],
        library: &GraspLibrary,
        budget: &WarmStartBudget,
        seed: u64,
        watch: &dyn Watch,
    ) -> Result<(), PlanError> {
        let of_place = self.entries_for_place(tasks, library, budget.later.natural_boards, watch)?;
        for pass in 0..budget.passes {
            go_on(watch)?;
            let counter = Counter::new(watch, Phase::WarmStarts { pass: pass + 1, passes: budget.passes }, tasks.len());
            let resampled;
            let (entries, natural, task_budget) = if pass == 0 {
                (&library.entries, &self.entries[..], &budget.first)
            } else {
                let boards: Vec<_> = self.solutions.iter().map(|solution| solution.x_wo).collect();
                resampled =
                    resample(&library.robot, &boards, budget.resampled_boards, [seed, pass], &Counter::quiet(watch));
                (&resampled, &[][..], &budget.later)
            };
            let entries: Vec<_> = entries.iter().chain(natural).collect();
            // Each task uses the solutions of the pass before, so their order does not matter.
            let solve = |(task, of_place): (&Scenario, &Vec<LibraryEntry>)| {
                let solved = self.solve_task(task, &library.robot, &entries, of_place, task_budget, watch);
                counter.advance();
                solved
            };
            let found: Result<Vec<_>, PlanError> = tasks.par_iter().zip(&of_place).map(solve).collect();
            self.solutions = found?.concat();
        }
        Ok(())
    }

    /// The entries of each task for a person in the given place; empty if the place is free.
    fn entries_for_place(
        &self,
        tasks: &[Scenario],
        library: &GraspLibrary,
        count: usize,
        watch: &dyn Watch,
    ) -> Result<Vec<Vec<LibraryEntry>>, PlanError> {
        let of_task = |task: &Scenario| {
            let human = Human::new(&task.human, &task.tool)?;
            let postures = self.postures.as_ref();
            Ok(postures.map_or_else(Vec::new, |postures| {
                entries_for_place(task, &human, &library.robot, postures, count, watch)
            }))
        };
        tasks.iter().map(of_task).collect()
    }

    /// Solves one task from the solutions so far and the given entries.
    fn solve_task(
        &self,
        task: &Scenario,
        robot: &GraspingRobot,
        entries: &[&LibraryEntry],
        of_place: &[LibraryEntry],
        budget: &SearchBudget,
        watch: &dyn Watch,
    ) -> Result<Vec<Solution>, PlanError> {
        let mut evaluator = Evaluator::new(Problem::new(task, robot, watch)?, SearchStats::unlimited(watch));
        let mut starts = self.starts(&mut evaluator, budget.warm_starts);
        if let Some(postures) = &self.postures {
            let entries = entries.iter().copied().chain(of_place);
            starts.extend(screen::screen(&mut evaluator, entries, postures, budget));
        }
        let found = distinct(refine::refine(&mut evaluator, starts, &budget.rounds), &robot.board);
        let p_ot_m = task.operation.x_ot.translation.vector.into();
        let solution = |Feasible { candidate, configuration, comfort, .. }| Solution {
            candidate,
            x_wo: configuration.placement.x_wo,
            comfort,
            p_ot_m,
        };
        Ok(found.into_iter().map(solution).collect())
    }

    /// Transfers the solutions to the evaluator's task: at most `count` candidates that satisfy every constraint. They are
    /// ranked by the sum of their objectives after the transfer and in the task that they come from: the former says how
    /// well a solution fits, the latter what refinement can make of it.
    pub fn starts(&self, evaluator: &mut Evaluator<'_>, count: usize) -> Vec<Feasible> {
        let mut transferred = Vec::with_capacity(8 * self.solutions.len());
        for solution in &self.solutions {
            let at_origin = comfort::weighted(solution.comfort, &evaluator.problem.objective).objective;
            let board = &evaluator.problem.robot.board;
            let turns: Vec<_> = (0..QUARTERS).filter(|quarters| board.turns(*quarters)).collect();
            for quarters in turns {
                for candidate in solution.transferred(&evaluator.problem, quarters) {
                    let Some(candidate) = candidate else {
                        evaluator.stats.count();
                        evaluator.stats.reject(Rejection::RobotReach);
                        continue;
                    };
                    let configuration = Configuration::new(&evaluator.problem, &candidate);
                    let objective = evaluate::comfort(&evaluator.problem, &candidate, &configuration).objective;
                    transferred.push((objective + at_origin, candidate));
                }
            }
        }
        transferred.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<Feasible> = Vec::with_capacity(count);
        let mut repairs = 0;
        let most_alike = per_pattern(STARTS_PER_PATTERN, evaluator.problem.robot.arms.len());
        for (_, candidate) in transferred {
            if kept.len() == count || repairs == REPAIRS_PER_START * count || evaluator.stats.is_exhausted() {
                break;
            }
            let alike = kept.iter().filter(|other| other.candidate.pattern() == candidate.pattern()).count();
            if alike == most_alike {
                continue;
            }
            repairs += 1;
            kept.extend(refine::repair(evaluator, candidate));
        }
        kept
    }

    /// The largest value of a comfort among the solutions; `None` without a solution.
    pub fn best(&self, of: impl Fn(&Comfort) -> f64) -> Option<f64> {
        self.solutions.iter().map(|solution| of(&solution.comfort)).max_by(f64::total_cmp)
    }
}

impl Solution {
    /// The solution with the board turned by quarters about its normal and the tool where the problem's operation needs it:
    /// once with the board left in place and the person moved, once with the person left in place and the board moved.
    fn transferred(&self, problem: &Problem<'_>, quarters: usize) -> [Option<Candidate>; 2] {
        let grasp = BoardGrasp { x_wo: self.x_wo, arms: self.candidate.arms.clone() };
        let Some(grasp) = turned(problem.robot, &grasp, quarters) else { return [None, None] };
        [self.with_person_moved(problem, &grasp), self.with_board_moved(problem, &grasp)]
    }

    fn with_person_moved(&self, problem: &Problem<'_>, grasp: &BoardGrasp) -> Option<Candidate> {
        let q_h_rad = &self.candidate.work.q_h_rad;
        let x_bt = problem.human.tool_pose_b(q_h_rad);
        align(problem, grasp, q_h_rad, &x_bt)
    }

    fn with_board_moved(&self, problem: &Problem<'_>, grasp: &BoardGrasp) -> Option<Candidate> {
        let work = self.candidate.work;
        let x_bt = problem.human.tool_pose_b(&work.q_h_rad);
        let roll_rad = aligning_roll(problem, &grasp.x_wo, &x_bt);
        let mut candidate = Candidate { work: WorkPose { roll_rad, ..work }, arms: grasp.arms.clone() };
        // The tip stays where it is, and the board moves under it.
        let p_ot_m = Point3::from(problem.scenario.operation.x_ot.translation.vector);
        let missed = self.x_wo * self.p_ot_m - candidate.x_wo(problem) * p_ot_m;
        candidate.work.p_wo_xy_m[0] += missed.x;
        candidate.work.p_wo_xy_m[1] += missed.y;
        let x_wo = candidate.x_wo(problem);
        problem.robot.follow(&mut candidate.arms, &x_wo).then_some(candidate)
    }
}

/// The grasp with the board turned by quarters about its normal: each gripper takes the edge that is now where its own was.
/// `None` if the outline is another one then, or an arm cannot make up for the board's unequal sides.
fn turned(robot: &GraspingRobot, grasp: &BoardGrasp, quarters: usize) -> Option<BoardGrasp> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 * quarters as f64);
    let x_wo = Isometry3::from_parts(grasp.x_wo.translation, grasp.x_wo.rotation * turn);
    let arms = grasp.arms.iter().map(|ArmGrasp { grasp, q_rad }| {
        let edge = robot.board.turned(grasp.edge, QUARTERS - quarters)?;
        let along_m = match robot.board.plate {
            // The outline is the same, and so is the place on it.
            Some(_) => grasp.along_m,
            None => grasp.along_m * half_length_m(robot, edge) / half_length_m(robot, grasp.edge),
        };
        Some(ArmGrasp { grasp: EdgeGrasp { edge, along_m, ..*grasp }, q_rad: q_rad.clone() })
    });
    let mut arms = arms.collect::<Option<Vec<_>>>()?;
    // After half a turn the grippers are where they were.
    (quarters.is_multiple_of(2) || robot.follow(&mut arms, &x_wo)).then_some(BoardGrasp { x_wo, arms })
}

/// Half the length of an edge of a box, m.
fn half_length_m(robot: &GraspingRobot, edge: Edge) -> f64 {
    robot.board.edge(edge).along_m[1]
}

/// The best solutions that differ: at most [`KEPT_PER_PATTERN`] of two arms have the same pattern but for a turn of the board, and those
/// have different objectives.
fn distinct(found: Vec<Feasible>, board: &BoardShape) -> Vec<Feasible> {
    let mut kept: Vec<(Feasible, GraspPattern)> = Vec::with_capacity(KEPT);
    for solution in found {
        if kept.len() == KEPT {
            break;
        }
        let pattern = solution.candidate.normalised_pattern(board);
        let mut alike = kept.iter().filter(|(_, other)| *other == pattern);
        let same = |(other, _): &(Feasible, _)| {
            (other.objective - solution.objective).abs() < SAME_OPTIMUM * solution.objective.abs()
        };
        let most_alike = per_pattern(KEPT_PER_PATTERN, solution.candidate.arms.len());
        if alike.clone().count() < most_alike && !alike.any(same) {
            kept.push((solution, pattern));
        }
    }
    kept.into_iter().map(|(solution, _)| solution).collect()
}
