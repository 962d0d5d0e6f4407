//! The results of the evaluation, from which tables, pictures and conclusions are computed.

use serde::{Deserialize, Serialize};

use crate::{
    human::BODY_POINTS,
    model::{
        operation::OperationKind,
        plan::{Comfort, Plan, PostureFigures},
        scenario::PlannerKind,
        verdict::{CheckKind, Verdict, VerdictKind},
    },
};

/// The seed whose plans are simulated and drawn, and the only seed of all planners except the random one.
pub const FIRST_SEED: u64 = 1;

/// The result for one operation, planner and seed.
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
    /// The plan; `None` if the planner found none.
    pub plan: Option<Plan>,
    /// Why there is no plan.
    pub infeasible: Option<String>,
    /// The verdict of the simulation; `None` if it was not simulated.
    pub verdict: Option<Verdict>,
    /// The largest load factor that holds in simulation; `None` if it was not searched.
    pub load_factor_simulated: Option<f64>,
    /// The verdict on the failing load just above it.
    pub ended_by: Option<VerdictKind>,
    /// Duration of planning, ms.
    pub plan_ms: f64,
    /// Duration of the simulation of the load, ms.
    pub simulate_ms: Option<f64>,
}

impl HoldRow {
    /// The comfort of the plan.
    #[must_use]
    pub fn comfort(&self) -> Option<&Comfort> {
        self.plan.as_ref()?.comfort.as_ref()
    }

    /// How the person stands and sees the work.
    #[must_use]
    pub fn posture(&self) -> Option<PostureFigures> {
        self.plan.as_ref()?.human?.posture
    }

    /// The regularised muscular comfort by which plans are compared: the mean over the person's responses if the plan has one,
    /// else that of the best response.
    #[must_use]
    pub fn muscular(&self) -> Option<f64> {
        let comfort = self.comfort()?;
        Some(comfort.average.map_or(comfort.muscular_regularised, |average| average.muscular_regularised))
    }

    /// As [`Self::muscular`], for the peripersonal comfort as a sum over the body points, the scale of the paper's captions.
    #[must_use]
    pub fn peripersonal_scaled(&self) -> Option<f64> {
        let comfort = self.comfort()?;
        comfort.average.map_or(comfort.peripersonal_scaled, |average| Some(BODY_POINTS as f64 * average.peripersonal_m))
    }

    /// The effort of the muscles, the sum of their squared activations.
    #[must_use]
    pub fn effort(&self) -> Option<f64> {
        Some(self.plan.as_ref()?.muscles.as_ref()?.effort)
    }

    /// The worst value of a check in simulation.
    #[must_use]
    pub fn value(&self, check: CheckKind) -> Option<f64> {
        self.verdict.as_ref()?.check(check).map(|check| check.value)
    }
}

/// Results under an assumption that differs from the default.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The assumption.
    pub name: String,
    /// The results.
    pub holds: Vec<HoldRow>,
}

/// What the front of both comforts says of one operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrontRow {
    /// The operation's name.
    pub operation: String,
    /// Cut or drill.
    pub kind: OperationKind,
    /// Number of points that no other point dominates.
    pub points: usize,
    /// The best muscular comfort and the best peripersonal comfort, m, of any point.
    pub optima: [f64; 2],
    /// The largest objective of any point, with the scenario's weights.
    pub best_objective: f64,
}

/// What the comfort planner keeps of a front, as shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept {
    /// Of the best muscular comfort.
    pub muscular: f64,
    /// Of the best peripersonal comfort.
    pub peripersonal: f64,
    /// Of the best objective with the scenario's weights.
    pub objective: f64,
}

impl FrontRow {
    /// What the comfort planner's plan for this operation keeps; `None` without a plan.
    #[must_use]
    pub fn kept(&self, natural: &Reproduction) -> Option<Kept> {
        let comfort = natural.hold(&self.operation, PlannerKind::Comfort)?.comfort()?;
        Some(Kept {
            muscular: comfort.muscular_regularised / self.optima[0],
            peripersonal: comfort.peripersonal_m / self.optima[1],
            objective: comfort.objective / self.best_objective,
        })
    }
}

/// A strategy for the whole circle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CircleRow {
    /// Its name for readers.
    pub strategy: String,
    /// How many pieces of the circle it serves.
    pub served: usize,
    /// Mean effort of the muscles over these.
    pub mean_effort: Option<f64>,
    /// The staged plan's mean effort over the same pieces, divided by it.
    pub staged_ratio: Option<f64>,
    /// Mean objective over the pieces that it serves.
    pub mean_objective: Option<f64>,
}

/// The whole circle, cut while the robot moves and regrasps the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// The verdict of the simulation of all stages.
    pub verdict: VerdictKind,
    /// Number of pieces.
    pub pieces: usize,
    /// Numbers of motions and of regrasps.
    pub moves_and_regrasps: [usize; 2],
    /// Simulated duration, s.
    pub duration_s: f64,
    /// The staged plan and what it is compared with.
    pub rows: Vec<CircleRow>,
}

/// All that a run of the command finds.
#[derive(Clone, Debug)]
pub struct Results {
    /// A person who stands naturally, with the intrinsic metric.
    pub natural: Reproduction,
    /// The paper's formulas as printed.
    pub printed: Reproduction,
    /// The fronts of the natural evaluation; empty if they were left out.
    pub fronts: Vec<FrontRow>,
    /// The whole circle; `None` if it was left out.
    pub circle: Option<Circle>,
}

/// The results of one evaluation.
#[derive(Clone, Debug)]
pub struct Reproduction {
    /// The results by operation, planner and seed, in the order of tables.
    pub holds: Vec<HoldRow>,
    /// Number of seeds of the random planner.
    pub random_seeds: u64,
    /// The comfort planner's results with the paper's stability constraint alone, which is a best case.
    pub best_case: Vec<HoldRow>,
    /// The comfort planner's results by the effort of the muscles; empty for the evaluation as printed.
    pub by_muscles: Vec<HoldRow>,
    /// The sensitivity analysis, starting with the default assumptions; empty if it was left out.
    pub sensitivity: Vec<Variant>,
    /// Number of seeds of the random planner in the sensitivity analysis.
    pub sensitivity_seeds: u64,
    /// What this run left out; `None` if nothing.
    pub left_out: Option<String>,
}

impl Reproduction {
    /// The results with the first seed: one per operation and planner.
    pub fn first_seeds(&self) -> impl Iterator<Item = &HoldRow> {
        self.holds.iter().filter(|hold| hold.seed == FIRST_SEED)
    }

    /// The result of a planner for an operation, with the first seed.
    #[must_use]
    pub fn hold(&self, operation: &str, planner: PlannerKind) -> Option<&HoldRow> {
        self.first_seeds().find(|hold| hold.operation == operation && hold.planner == planner)
    }

    /// The operation that is drawn: one from the middle of the circle or of the grid if there is a result, else the first.
    #[must_use]
    pub fn drawn(&self, kind: OperationKind) -> Option<&str> {
        let preferred = if kind == OperationKind::Cut { "cut-05" } else { "drill-5" };
        let mut of_kind = self.first_seeds().filter(|hold| hold.kind == kind);
        let first = of_kind.next()?;
        Some(of_kind.find(|hold| hold.operation == preferred).unwrap_or(first).operation.as_str())
    }
}

/// The kinds of operation of the evaluation, in the order of the paper's table.
pub const KINDS: [OperationKind; 2] = [OperationKind::Cut, OperationKind::Drill];

/// The name of a kind of operation in the tables.
#[must_use]
pub fn task(kind: OperationKind) -> &'static str {
    match kind {
        OperationKind::Cut => "cutting",
        OperationKind::Drill => "drilling",
        OperationKind::Wrench => "wrenching",
    }
}
