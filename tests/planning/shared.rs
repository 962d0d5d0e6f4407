//! One planner for all tests, so that its maps are made once, and short forms for its plans.

use std::sync::LazyLock;

use benchdog::{
    model::{
        plan::Plan,
        scenario::{Budget, Scenario},
    },
    planner::{self, Outcome, Planner},
};

use crate::common::{baxter, scenario};

/// The planner of the built-in robot. A plan does not depend on the maps that it keeps: tests of that make their own.
pub static PLANNER: LazyLock<Planner> = LazyLock::new(|| {
    let planner = Planner::new(baxter());
    // Made once, also if several threads begin with it.
    planner.prepare_library(&scenario("quickstart"));
    planner
});

/// A scenario under `scenarios/` with the fast budget.
pub fn fast(name: &str) -> Scenario {
    let mut scenario = scenario(name);
    scenario.planner.budget = Budget::Fast;
    scenario
}

/// What a search found; panics with the reason if it found nothing.
pub fn found<T>(outcome: Outcome<T>) -> T {
    match outcome {
        Outcome::Found(found) => found,
        Outcome::Infeasible(why) => panic!("{why}"),
    }
}

/// The plan of a scenario.
pub fn plan(scenario: &Scenario) -> Plan {
    plan_by(&PLANNER, scenario)
}

/// The plan of a scenario by a planner of its own.
pub fn plan_by(planner: &Planner, scenario: &Scenario) -> Plan {
    match planner.plan(scenario).unwrap() {
        Outcome::Found(plan) => plan,
        Outcome::Infeasible(why) => panic!("{}, {}: {why}", scenario.name, scenario.planner.kind),
    }
}

/// The flaws that the verification of a plan finds.
pub fn flaws(plan: &Plan, scenario: &Scenario) -> Vec<String> {
    planner::verify(plan, scenario, baxter()).iter().map(ToString::to_string).collect()
}

/// Asserts that a plan satisfies every constraint.
#[track_caller]
pub fn verified(plan: &Plan, scenario: &Scenario) {
    assert_eq!(flaws(plan, scenario), [""; 0], "{}, {}", scenario.name, scenario.planner.kind);
}
