//! The verdict on a staged plan (`docs/method.md#115-judgement-of-stages`).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::verdict::{Check, Confirmation, Failure, VerdictKind};

/// The verdict on a staged plan: that of its first stage that does not hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StagedVerdict {
    /// The file format, 2.
    pub format: u32,
    /// The number of the criteria by which it was judged (`docs/method.md#88-verdict`); 0 in files from before they were
    /// numbered.
    #[serde(default)]
    pub criteria: u32,
    /// The name of the plan.
    pub name: String,
    /// The verdict.
    pub verdict: VerdictKind,
    /// The expected verdict.
    pub expected: VerdictKind,
    /// True if the verdict is the expected one.
    pub met: bool,
    /// The first stage that does not hold; absent if all do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<FailedStage>,
    /// Simulations of the whole plan at shorter time steps, if a stage of the first one was too near to a limit to decide. Absent if
    /// none was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confirmation: Option<Confirmation>,
    /// The stages that were judged, in their order.
    pub stages: Vec<StageVerdict>,
    /// The number of changes of one hand's grasp.
    pub regrasps: usize,
    /// The number of motions of the board.
    pub moves: usize,
    /// Simulated time, s.
    pub duration_s: f64,
    /// The person over the task; absent without a person.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person: Option<PersonOverTask>,
    /// Versions of Benchdog and its engines.
    pub versions: BTreeMap<String, String>,
    /// Seed of the search.
    pub seed: u64,
    /// SHA-256 of the trace; empty if nothing was simulated.
    pub fingerprint: String,
}

/// Where a plan fails.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FailedStage {
    /// The number of the stage, from 1.
    pub stage: usize,
    /// `hold`, `move` or `regrasp`.
    pub kind: String,
    /// The first limit that was crossed; times are those of the whole task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_failure: Option<Failure>,
    /// Why, in words.
    pub reason: String,
}

/// The verdict on one stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StageVerdict {
    /// The number of the stage, from 1.
    pub stage: usize,
    /// `hold`, `move` or `regrasp`.
    pub kind: String,
    /// Its beginning, s.
    pub from_s: f64,
    /// Its end, s.
    pub to_s: f64,
    /// The verdict.
    pub verdict: VerdictKind,
    /// Value, limit and margin of every check.
    pub checks: Vec<Check>,
    /// The self-checks of the simulation.
    pub self_checks: Vec<Check>,
}

/// The person over a task. Means are over the length of cuts, or over holes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PersonOverTask {
    /// Mean objective.
    pub mean_objective: f64,
    /// Least objective.
    pub least_objective: f64,
    /// Mean muscular effort: sum of the squares of all activations.
    pub mean_effort: f64,
    /// Effort accumulated while the tool works, s: the integral of the effort over time.
    pub accumulated_effort_s: f64,
    /// Largest displacement of the body between two pieces, m.
    pub largest_step_m: f64,
    /// Sum of these displacements, m.
    pub steps_m: f64,
}
