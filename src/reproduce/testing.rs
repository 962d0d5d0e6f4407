//! Rows for the tests of this module.

use super::evaluation::HoldRow;
use crate::model::{
    operation::OperationKind,
    plan::{Comfort, Plan},
    scenario::PlannerKind,
};

/// A result with these comforts and otherwise the plan of a scenario.
pub fn hold(operation: &str, planner: PlannerKind, seed: u64, muscular: f64, peripersonal_m: f64) -> HoldRow {
    let mut plan: Plan = serde_json::from_str(include_str!("../../scenarios/plans/cut-rim.json")).unwrap();
    plan.comfort = Some(Comfort {
        muscular: 2.0 * muscular,
        muscular_regularised: muscular,
        peripersonal_m,
        peripersonal_scaled: Some(64.0 * peripersonal_m),
        objective: muscular + 64.0 * peripersonal_m,
        activations: [0.0; 7],
        muscular_intrinsic: None,
        shoulder: None,
        average: None,
        rula: None,
        reba: None,
    });
    HoldRow {
        operation: operation.to_owned(),
        kind: if operation.starts_with("cut") { OperationKind::Cut } else { OperationKind::Drill },
        planner,
        seed,
        plan: Some(plan),
        infeasible: None,
        verdict: None,
        load_factor_simulated: None,
        ended_by: None,
        plan_ms: 1.0,
        simulate_ms: None,
    }
}
