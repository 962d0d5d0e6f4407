//! The optima that a normalised objective is over: what the planners of either comfort alone reach.

use super::{Infeasible, PlanOutcome, RobotMap, WorkMap, nobody, plan_with};
use crate::{
    human::HumanError,
    model::scenario::{ComfortSettings, Optima, PlannerKind, PlannerSettings, ResponseKind, Scenario},
};

/// The planners whose results are the optima: muscular, peripersonal.
const ALONE: [PlannerKind; 2] = [PlannerKind::Muscular, PlannerKind::Peripersonal];

/// True when a scenario asks for a normalised objective and does not say what the optima are. Of the planners only that of
/// both comforts looks at it.
pub fn are_missing(scenario: &Scenario) -> bool {
    let ComfortSettings { peripersonal_share, optima, .. } = scenario.comfort;
    scenario.planner.kind == PlannerKind::Comfort && peripersonal_share.is_some() && optima.is_none()
}

/// The scenario with the optima of its normalised objective, which two plans find first; as it is where it asks for none or
/// has them. The inner error tells why there is no plan at all.
///
/// # Errors
/// As [`super::plan`].
pub fn with_optima(scenario: &Scenario, map: &RobotMap) -> Result<Result<Scenario, Infeasible>, HumanError> {
    if !are_missing(scenario) {
        return Ok(Ok(scenario.clone()));
    }
    found(scenario, map, &maps(scenario, map)?)
}

/// The maps of the two planners' kinds of work.
pub(super) fn maps(scenario: &Scenario, map: &RobotMap) -> Result<[WorkMap; 2], HumanError> {
    let [muscular, peripersonal] = ALONE.map(|kind| WorkMap::new(&alone(scenario, kind), map));
    Ok([muscular?, peripersonal?])
}

/// As [`with_optima`], for a scenario whose optima are missing.
pub(super) fn found(
    scenario: &Scenario,
    map: &RobotMap,
    maps: &[WorkMap; 2],
) -> Result<Result<Scenario, Infeasible>, HumanError> {
    let mut comforts = [0.0; 2];
    for ((kind, work), best) in ALONE.into_iter().zip(maps).zip(&mut comforts) {
        match plan_with(&alone(scenario, kind), map, work, &mut nobody)? {
            // One of its weights is 1 and the other 0.
            PlanOutcome::Found(plan) => *best = plan.comfort.map_or(0.0, |comfort| comfort.objective),
            PlanOutcome::Infeasible(why) => return Ok(Err(why)),
        }
    }
    let [muscular_regularised, peripersonal_m] = comforts;
    Ok(Ok(with(scenario, Optima { muscular_regularised, peripersonal_m })))
}

/// A scenario with optima.
pub(super) fn with(scenario: &Scenario, optima: Optima) -> Scenario {
    Scenario { comfort: ComfortSettings { optima: Some(optima), ..scenario.comfort }, ..scenario.clone() }
}

/// The scenario of a planner that looks at one comfort alone. The person's best answer is what is looked for: the mean is
/// never better.
fn alone(scenario: &Scenario, kind: PlannerKind) -> Scenario {
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
}
