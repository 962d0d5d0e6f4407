//! Warm starts: solutions of a few tasks of a family, transferred to a new task.
//!
//! A few tasks of a family are solved with a larger budget than a plan's: first from the grasp library, then from resampled
//! boards oriented like the best solutions so far and from the solutions of the other tasks. The best that differ are kept.
//! To transfer a solution, the board is turned by quarters about its normal (a rectangle is the same after half a turn, and
//! nearly so after a quarter; a plate only after the turns that leave its outline as it is), then the person or the board moves so that the tool is where the new task needs it. A
//! transferred candidate that violates a constraint slightly is repaired.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    candidate::Candidate,
    evaluate::{Evaluator, Feasible},
    library::{GraspLibrary, GraspPattern, GraspingRobot, LibraryEntry, PostureMap, resample},
    made_once::MadeOnce,
    map_store::{self, MapKind},
    natural_boards::{entries_for_place, natural_entries},
    outcome::PlanError,
    params::{
        SearchBudget, WarmStartBudget, per_pattern,
        screening::{STARTS_PER_PATTERN, TRANSFERS},
        warm_starts::{KEPT, KEPT_PER_PATTERN, SAME_OPTIMUM},
    },
    problem::{self, Problem},
    refine, screen,
    stats::SearchStats,
    task_family::{TaskFamily, solved_tasks},
    transfer::{Solution, turns},
    watch::{Counter, Phase, Watch, go_on},
};
use crate::{
    comfort,
    human::Human,
    model::{
        board::BoardShape,
        plan::Comfort,
        scenario::{PlannerKind, Scenario},
    },
};

/// The warm starts of one task family. They do not depend on which of the family's tasks asked for them.
pub struct WarmStarts {
    /// The family that they serve.
    pub family: TaskFamily,
    /// The family's scenario, with the optima of a normalised objective.
    shared: Scenario,
    human: Human,
    postures: MadeOnce<PostureMap>,
    natural_entries: MadeOnce<Vec<LibraryEntry>>,
    /// The solutions of each solved task.
    solutions: Vec<Vec<Solution>>,
}

/// The solutions of a family as they are kept: the candidates of each solved task. The rest follows from candidate and task.
#[derive(Serialize, Deserialize)]
struct KeptSolutions(Vec<Vec<Candidate>>);

impl WarmStarts {
    /// Solves the tasks of a family, unless the library's store has their solutions. `shared` is the family's scenario, with the
    /// optima of a normalised objective filled in.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn new(
        family: TaskFamily,
        shared: &Scenario,
        library: &GraspLibrary,
        watch: &dyn Watch,
    ) -> Result<Self, PlanError> {
        let mut warm = Self {
            family,
            shared: shared.clone(),
            human: Human::new(&shared.human, &shared.tool)?,
            postures: MadeOnce::default(),
            natural_entries: MadeOnce::default(),
            solutions: Vec::new(),
        };
        let budget = if shared.planner.kind == PlannerKind::Random { None } else { WarmStartBudget::of(shared) };
        let Some(budget) = budget else { return Ok(warm) };
        let tasks = solved_tasks(shared);
        let source = library.source(MapKind::WarmStarts, Some(shared));
        let kept: Option<KeptSolutions> = map_store::read(library.store(), &source);
        match kept.map(|kept| solutions_of_kept(kept, &tasks, &library.robot, watch)).transpose()?.flatten() {
            Some(solutions) => warm.solutions = solutions,
            None => {
                warm.solve(&tasks, library, &budget, shared.planner.seed, watch)?;
                go_on(watch)?;
                map_store::write(library.store(), &source, &warm.kept());
            }
        }
        go_on(watch)?;
        Ok(warm)
    }

    /// The posture map of the family.
    ///
    /// # Errors
    /// After a stop.
    pub fn postures(&self, watch: &dyn Watch) -> Result<&PostureMap, PlanError> {
        self.postures.get_or_make(|| {
            let postures = problem::posture_map(&self.shared, &self.human, watch);
            go_on(watch)?;
            Ok(postures)
        })
    }

    /// Grasps of the boards that natural postures ask for.
    ///
    /// # Errors
    /// After a stop.
    pub fn natural_entries(&self, robot: &GraspingRobot, watch: &dyn Watch) -> Result<&[LibraryEntry], PlanError> {
        self.natural_entries
            .get_or_make(|| {
                let count = SearchBudget::of(&self.shared).natural_boards;
                let entries = natural_entries(&self.shared, &self.human, robot, self.postures(watch)?, count, watch);
                go_on(watch)?;
                Ok(entries)
            })
            .map(Vec::as_slice)
    }

    /// The solutions as they are kept.
    fn kept(&self) -> KeptSolutions {
        let candidates = |task: &Vec<Solution>| task.iter().map(|solution| solution.candidate.clone()).collect();
        KeptSolutions(self.solutions.iter().map(candidates).collect())
    }

    /// The solutions of all tasks.
    pub fn solutions(&self) -> impl Iterator<Item = &Solution> {
        self.solutions.iter().flatten()
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
                (library.entries(watch)?, self.natural_entries(&library.robot, watch)?, &budget.first)
            } else {
                let boards: Vec<_> = self.solutions().map(|solution| solution.x_wo).collect();
                resampled =
                    resample(&library.robot, &boards, budget.resampled_boards, [seed, pass], &Counter::quiet(watch));
                (&resampled[..], &[][..], &budget.later)
            };
            let entries: Vec<_> = entries.iter().chain(natural).collect();
            let share = KEPT / tasks.len().max(1);
            // Each task uses the solutions of the pass before, so their order does not matter.
            let solve = |(task, of_place): (&Scenario, &Vec<LibraryEntry>)| {
                let entries = entries.iter().copied().chain(of_place);
                let solved = self.solve_task(task, &library.robot, entries, task_budget, share, watch);
                counter.advance();
                solved
            };
            let found: Result<Vec<_>, PlanError> = tasks.par_iter().zip(&of_place).map(solve).collect();
            self.solutions = found?;
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
            Ok(entries_for_place(task, &human, &library.robot, self.postures(watch)?, count, watch))
        };
        tasks.iter().map(of_task).collect()
    }

    /// Solves one task from the solutions so far and the given entries; at most `share` solutions.
    fn solve_task<'e>(
        &self,
        task: &Scenario,
        robot: &GraspingRobot,
        entries: impl Iterator<Item = &'e LibraryEntry>,
        budget: &SearchBudget,
        share: usize,
        watch: &dyn Watch,
    ) -> Result<Vec<Solution>, PlanError> {
        let mut evaluator = Evaluator::new(Problem::new(task, robot, watch)?, SearchStats::unlimited(watch));
        let mut starts = self.starts(&mut evaluator, budget.warm_starts);
        starts.extend(screen::screen(&mut evaluator, entries, self.postures(watch)?, budget));
        let refined = refine::refine(&mut evaluator, starts, &budget.rounds);
        let found = distinct(refined, &robot.board, share);
        Ok(found.into_iter().map(|found| Solution::new(&evaluator.problem, found.candidate)).collect())
    }

    /// Transfers the solutions to the evaluator's task: at most `count` candidates that satisfy every constraint. They are
    /// ranked by the sum of their objectives after the transfer and in the task that they come from: the former says how
    /// well a solution fits, the latter what refinement can make of it.
    pub fn starts(&self, evaluator: &mut Evaluator<'_>, count: usize) -> Vec<Feasible> {
        let mut transferred = Vec::with_capacity(8 * self.solutions.len());
        let turns = turns(&evaluator.problem.robot.board);
        for solution in self.solutions() {
            let at_origin = comfort::weighted(solution.comfort, &evaluator.problem.objective).objective;
            for quarters in &turns {
                let transfers = solution.transfers(evaluator, *quarters).into_iter();
                transferred.extend(transfers.map(|(objective, candidate)| (objective + at_origin, candidate)));
            }
        }
        transferred.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<Feasible> = Vec::with_capacity(count);
        let most_alike = per_pattern(STARTS_PER_PATTERN, evaluator.problem.robot.arms.len());
        for (_, candidate) in transferred.into_iter().take(TRANSFERS) {
            if kept.len() == count || evaluator.stats.is_exhausted() {
                break;
            }
            let alike = kept.iter().filter(|other| other.candidate.pattern() == candidate.pattern()).count();
            if alike == most_alike {
                continue;
            }
            kept.extend(refine::repair(evaluator, candidate));
        }
        kept
    }

    /// The largest value of a comfort among the solutions; `None` without a solution.
    pub fn best(&self, of: impl Fn(&Comfort) -> f64) -> Option<f64> {
        self.solutions().map(|solution| of(&solution.comfort)).max_by(f64::total_cmp)
    }
}

/// The solutions of kept ones; `None` if these are not of the tasks and the robot.
fn solutions_of_kept(
    KeptSolutions(kept): KeptSolutions,
    tasks: &[Scenario],
    robot: &GraspingRobot,
    watch: &dyn Watch,
) -> Result<Option<Vec<Vec<Solution>>>, PlanError> {
    let mut candidates = kept.iter().flatten();
    if kept.len() != tasks.len() || !candidates.all(|candidate| robot.has_form_of(&candidate.arms)) {
        return Ok(None);
    }
    let solved = |(task, candidates): (&Scenario, Vec<Candidate>)| {
        let problem = Problem::new(task, robot, watch)?;
        Ok(candidates.into_iter().map(|candidate| Solution::new(&problem, candidate)).collect())
    };
    tasks.iter().zip(kept).map(solved).collect::<Result<_, _>>().map(Some)
}

/// The best `count` solutions that differ: at most [`KEPT_PER_PATTERN`] of two arms have the same pattern but for a turn of the board, and those
/// have different objectives.
pub fn distinct(found: Vec<Feasible>, board: &BoardShape, count: usize) -> Vec<Feasible> {
    let mut kept: Vec<(Feasible, GraspPattern)> = Vec::with_capacity(count);
    for solution in found {
        if kept.len() == count {
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
