//! The optima of a normalised objective (docs/method.md#39-normalised-objective): a step before planning.
//!
//! A normalised objective divides each comfort by the best that its own planner reaches. Two plans find these optima unless
//! the scenario states them.

use crate::model::scenario::{ComfortSettings, Optima, PlannerKind, PlannerSettings, ResponseKind, Scenario};

/// The planners whose results are the optima: muscular, peripersonal.
const ALONE: [PlannerKind; 2] = [PlannerKind::Muscular, PlannerKind::Peripersonal];

/// True if a scenario asks for a normalised objective and does not state the optima. Only the planner of both comforts uses
/// it.
pub fn needs_optima(scenario: &Scenario) -> bool {
    let ComfortSettings { peripersonal_share, optima, .. } = scenario.comfort;
    scenario.planner.kind == PlannerKind::Comfort && peripersonal_share.is_some() && optima.is_none()
}

/// The scenarios of the two planners that find the optima. They use the person's best response: the mean is never better.
pub fn alone(scenario: &Scenario) -> [Scenario; 2] {
    ALONE.map(|kind| {
        let [weight_muscular, weight_peripersonal] = ALONE.map(|other| f64::from(u8::from(other == kind)));
        Scenario {
            comfort: ComfortSettings {
                person: ResponseKind::Best,
                peripersonal_share: None,
                weight_muscular,
                weight_peripersonal,
                ..scenario.comfort
            },
            planner: PlannerSettings { kind, ..scenario.planner.clone() },
            ..scenario.clone()
        }
    })
}

/// A scenario with optima.
pub fn with_optima(scenario: &Scenario, optima: Optima) -> Scenario {
    let comfort = ComfortSettings { optima: Some(optima), ..scenario.comfort };
    Scenario { comfort, ..scenario.clone() }
}
