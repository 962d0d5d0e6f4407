//! All jobs of a run in order, and the evaluation from their results.

use super::{
    evaluation::{HoldRow, Reproduction, Variant},
    jobs::{self, Job, Stage},
    paper::Evaluation,
    sensitivity,
};
use crate::scenario::LoadedScenario;

/// How much of the evaluation a run covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Number of seeds of the random planner.
    pub random_seeds: u64,
    /// Number of seeds of the random planner in the sensitivity analysis; `None` if the analysis is left out.
    pub sensitivity_seeds: Option<u64>,
    /// The last step of the jobs with the first seed.
    pub first: Stage,
    /// True if the comfort planner is also run with the paper's stability alone.
    pub best_case: bool,
    /// True if the comfort planner is also run by the effort of the muscles.
    pub by_muscles: bool,
}

impl Scope {
    /// The whole evaluation.
    #[must_use]
    pub fn full(evaluation: Evaluation) -> Self {
        // The sensitivity analysis is about what the paper does not state, so it has the paper's person. Its variants share their seeds,
        // so a few seeds are enough to compare them.
        let sensitivity_seeds = (evaluation == Evaluation::Printed).then_some(4);
        Self { random_seeds: 20, sensitivity_seeds, first: Stage::FailingLoad, ..Self::quick(evaluation) }
    }

    /// Fewer random plans, no failing loads, no sensitivity analysis.
    #[must_use]
    pub fn quick(evaluation: Evaluation) -> Self {
        Self {
            // Without a natural posture the random planner takes most of the time.
            random_seeds: if evaluation == Evaluation::Natural { 3 } else { 1 },
            sensitivity_seeds: None,
            first: Stage::Simulate,
            best_case: true,
            by_muscles: evaluation == Evaluation::Natural,
        }
    }
}

/// The jobs of a run: the evaluation, operation by operation; the comfort planner with the paper's stability alone; the same by
/// the effort of the muscles; the sensitivity analysis, variant by variant.
pub struct Schedule {
    /// All jobs.
    pub jobs: Vec<Job>,
    /// Number of jobs of the evaluation.
    evaluation: usize,
    /// Number of jobs with the paper's stability alone.
    best_case: usize,
    /// Number of jobs by the effort of the muscles.
    by_muscles: usize,
    /// Name and number of jobs of each variant.
    variants: Vec<(&'static str, usize)>,
}

impl Schedule {
    /// The jobs for these operations.
    #[must_use]
    pub fn new(operations: &[LoadedScenario], scope: &Scope) -> Self {
        let scenarios = || operations.iter().map(|operation| &operation.scenario);
        let mut jobs: Vec<Job> =
            scenarios().flat_map(|scenario| jobs::jobs_of(scenario, scope.random_seeds, scope.first)).collect();
        let evaluation = jobs.len();
        if scope.best_case {
            jobs.extend(scenarios().map(jobs::best_case));
        }
        let best_case = jobs.len() - evaluation;
        if scope.by_muscles {
            jobs.extend(scenarios().map(jobs::by_muscles));
        }
        let by_muscles = jobs.len() - evaluation - best_case;
        let mut variants = Vec::new();
        for variant in scope.sensitivity_seeds.map_or(&[][..], |_| &sensitivity::VARIANTS) {
            let before = jobs.len();
            for scenario in scenarios().filter(|scenario| sensitivity::includes(&scenario.name)) {
                jobs.extend(variant.jobs(scenario, scope.sensitivity_seeds.unwrap_or(0)));
            }
            variants.push((variant.name, jobs.len() - before));
        }
        Self { jobs, evaluation, best_case, by_muscles, variants }
    }

    /// The evaluation from the results of all jobs, in the order of the jobs.
    #[must_use]
    pub fn reproduction(&self, results: Vec<HoldRow>, scope: &Scope, left_out: Option<String>) -> Reproduction {
        let mut rest = results.into_iter();
        let mut next = |count: usize| rest.by_ref().take(count).collect::<Vec<_>>();
        let (holds, best_case, by_muscles) = (next(self.evaluation), next(self.best_case), next(self.by_muscles));
        let mut sensitivity = Vec::new();
        if let Some(seeds) = scope.sensitivity_seeds {
            // The results without a change are those of the evaluation.
            let own = holds.iter().filter(|hold| hold.seed <= seeds && sensitivity::includes(&hold.operation));
            let default = ("as reproduced", own.cloned().collect::<Vec<_>>());
            let others = self.variants.iter().map(|&(name, count)| (name, next(count)));
            sensitivity = std::iter::once(default)
                .chain(others)
                .filter(|(_, holds)| !holds.is_empty())
                .map(|(name, holds)| Variant { name: name.to_owned(), holds })
                .collect();
        }
        Reproduction {
            holds,
            random_seeds: scope.random_seeds,
            best_case,
            by_muscles,
            sensitivity,
            sensitivity_seeds: scope.sensitivity_seeds.unwrap_or(0),
            left_out,
        }
    }
}
