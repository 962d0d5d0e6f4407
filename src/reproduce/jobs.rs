//! The jobs of the evaluation: a scenario with its planner and seed, and whether the plan is simulated.

use serde::Serialize;

use super::evaluation::FIRST_SEED;
use crate::model::scenario::{MuscularMetric, PlannerKind, Scenario, StabilityKind};

/// The last step of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Stage {
    /// Plan only.
    Plan,
    /// Plan, then simulate the load.
    Simulate,
    /// Plan, simulate the load, then search the failing load.
    FailingLoad,
}

/// One plan of the evaluation.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scenario, with planner and seed.
    pub scenario: Scenario,
    /// What differs from the default settings; `None` for the evaluation itself.
    pub variant: Option<&'static str>,
    /// The last step.
    pub stage: Stage,
}

/// The jobs of one operation: each planner once, the random planner with seeds 1 to `random_seeds`. Plans with the first
/// seed go to the stage `first`, the others are only planned.
#[must_use]
pub fn jobs_of(scenario: &Scenario, random_seeds: u64, first: Stage) -> Vec<Job> {
    let mut jobs = Vec::new();
    for kind in PlannerKind::ALL {
        let seeds = if kind == PlannerKind::Random { random_seeds } else { 1 };
        for seed in FIRST_SEED..FIRST_SEED + seeds {
            let mut scenario = scenario.clone();
            scenario.planner.kind = kind;
            scenario.planner.seed = seed;
            jobs.push(Job { scenario, variant: None, stage: if seed == FIRST_SEED { first } else { Stage::Plan } });
        }
    }
    jobs
}

/// The comfort planner with the paper's stability constraint alone: some contact forces balance the load.
#[must_use]
pub fn best_case(scenario: &Scenario) -> Job {
    comfort_variant(scenario, "the paper's stability", |scenario| scenario.planner.stability = StabilityKind::Paper)
}

/// The comfort planner with the effort of the muscles as its muscular comfort.
#[must_use]
pub fn by_muscles(scenario: &Scenario) -> Job {
    comfort_variant(scenario, "by muscles", |scenario| scenario.comfort.muscular = MuscularMetric::Muscles)
}

/// The comfort planner's job with another setting, simulated.
fn comfort_variant(scenario: &Scenario, name: &'static str, change: fn(&mut Scenario)) -> Job {
    let mut scenario = scenario.clone();
    scenario.planner.kind = PlannerKind::Comfort;
    scenario.planner.seed = FIRST_SEED;
    change(&mut scenario);
    Job { scenario, variant: Some(name), stage: Stage::Simulate }
}

impl Job {
    /// The name in messages, such as `cut-01 random 7`.
    #[must_use]
    pub fn name(&self) -> String {
        let planner = &self.scenario.planner;
        let variant = self.variant.map_or_else(String::new, |name| format!(" ({name})"));
        format!("{} {} {}{variant}", self.scenario.name, planner.kind, planner.seed)
    }

    /// The subfolder of the variant; empty for the evaluation itself.
    #[must_use]
    pub fn folder(&self) -> String {
        self.variant.map_or_else(String::new, |name| name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"))
    }

    /// The name of the job's files without extension, such as `cut-01-random-7`.
    #[must_use]
    pub fn stem(&self) -> String {
        let planner = &self.scenario.planner;
        format!("{}-{}-{}", self.scenario.name, planner.kind, planner.seed)
    }
}
