//! The rows that tables, pictures and conclusions are computed from.

use serde::{Deserialize, Serialize};

use crate::{
    human::BODY_POINTS,
    model::{
        operation::OperationKind,
        plan::{Comfort, Plan},
        scenario::PlannerKind,
        verdict::{CheckKind, Verdict, VerdictKind},
    },
};

/// The seed whose hold is simulated and drawn, and the only one of planners whose average over seeds is not asked for.
pub const FIRST_SEED: u64 = 1;

/// One hold: an operation, planned by one planner with one seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldRow {
    /// The operation's name.
    pub operation: String,
    /// Cut or drill.
    pub kind: OperationKind,
    /// The planner.
    pub planner: PlannerKind,
    /// Its seed.
    pub seed: u64,
    /// The plan; none when the planner found none.
    pub plan: Option<Plan>,
    /// Why there is no plan.
    pub infeasible: Option<String>,
    /// What became of it in simulation; none when it was not simulated.
    pub verdict: Option<Verdict>,
    /// The largest multiple of the load that holds in simulation; none when it was not looked for.
    pub load_factor_simulated: Option<f64>,
    /// The verdict on a little more.
    pub ended_by: Option<VerdictKind>,
    /// Time of the plan, ms.
    pub plan_ms: f64,
    /// Time of the simulation under the load, ms.
    pub simulate_ms: Option<f64>,
}

impl HoldRow {
    /// The comfort of the plan.
    pub fn comfort(&self) -> Option<&Comfort> {
        self.plan.as_ref()?.comfort.as_ref()
    }

    /// The regularised muscular comfort that the plan is rated by: the mean of the person's answers where it has one.
    pub fn muscular(&self) -> Option<f64> {
        let comfort = self.comfort()?;
        Some(comfort.average.map_or(comfort.muscular_regularised, |average| average.muscular_regularised))
    }

    /// As [`Self::muscular`], the peripersonal comfort as a sum over the points of the body, on the scale of the paper's
    /// captions.
    pub fn peripersonal_scaled(&self) -> Option<f64> {
        let comfort = self.comfort()?;
        comfort.average.map_or(comfort.peripersonal_scaled, |average| Some(BODY_POINTS as f64 * average.peripersonal_m))
    }

    /// The worst value of a check in simulation.
    pub fn value(&self, check: CheckKind) -> Option<f64> {
        self.verdict.as_ref()?.check(check).map(|check| check.value)
    }
}

/// Holds planned under an assumption that differs from the default in one thing.
#[derive(Clone, Debug)]
pub struct Variant {
    /// What differs, in words.
    pub name: String,
    /// The holds.
    pub holds: Vec<HoldRow>,
}

/// All that the report is made from.
#[derive(Clone, Debug)]
pub struct Reproduction {
    /// Every hold, operation by operation in the order of tables, in each planner by planner, seed by seed.
    pub holds: Vec<HoldRow>,
    /// How many seeds the random planner had.
    pub random_seeds: u64,
    /// The comfort planner's holds when it asks for the paper's stability alone, which is a best case.
    pub best_case: Vec<HoldRow>,
    /// The sensitivity analysis: first the default, then what differs from it; empty when it was left out.
    pub sensitivity: Vec<Variant>,
    /// The seeds of the random planner in the sensitivity analysis.
    pub sensitivity_seeds: u64,
    /// What this run left out, in words; none of a whole run.
    pub left_out: Option<String>,
}

impl Reproduction {
    /// The holds that are simulated and drawn: one an operation and planner.
    pub fn first_seeds(&self) -> impl Iterator<Item = &HoldRow> {
        self.holds.iter().filter(|hold| hold.seed == FIRST_SEED)
    }

    /// The hold of an operation by a planner.
    pub fn hold(&self, operation: &str, planner: PlannerKind) -> Option<&HoldRow> {
        self.first_seeds().find(|hold| hold.operation == operation && hold.planner == planner)
    }

    /// The operation that is drawn: in the middle of the evaluation's, so that it is no border case.
    pub fn drawn(&self, kind: OperationKind) -> Option<&str> {
        let preferred = if kind == OperationKind::Cut { "cut-05" } else { "drill-5" };
        let mut of_kind = self.first_seeds().filter(|hold| hold.kind == kind);
        let first = of_kind.next()?;
        Some(of_kind.find(|hold| hold.operation == preferred).unwrap_or(first).operation.as_str())
    }
}

/// The kinds of operation of the evaluation, in the order of the paper's table.
pub const KINDS: [OperationKind; 2] = [OperationKind::Cut, OperationKind::Drill];

/// The paper's word for the operations of a kind.
pub fn task(kind: OperationKind) -> &'static str {
    match kind {
        OperationKind::Cut => "cutting",
        OperationKind::Drill => "drilling",
        OperationKind::Wrench => "wrenching",
    }
}
