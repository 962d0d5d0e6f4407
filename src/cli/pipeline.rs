//! The main path: scenario -> plan -> simulation -> judgement -> verdict, for one scenario.

use std::collections::BTreeMap;

use super::{exit::CliError, planners::Planners, versions::versions};
use crate::{
    judge::{Judgement, judge},
    model::{
        FORMAT,
        plan::Plan,
        scenario::Scenario,
        trace::Trace,
        verdict::{Verdict, VerdictKind},
    },
    planner::{self, Outcome},
    robot::Robot,
    scenario::LoadedScenario,
    sim::{self, Conditions},
};

/// One scenario, run to its verdict.
#[derive(Debug)]
pub struct Run {
    /// The verdict.
    pub verdict: Verdict,
    /// The plan that was judged; none when there is none.
    pub plan: Option<Plan>,
    /// The simulation, with what the judge made of it; none when there was nothing to simulate.
    pub simulated: Option<(Trace, Judgement)>,
}

/// Plans where the scenario names no plan, then simulates and judges.
///
/// # Errors
/// When the person or the tool is none, or the simulation cannot be built from the plan.
pub fn run_scenario(loaded: &LoadedScenario, planners: &Planners) -> Result<Run, CliError> {
    let scenario = &loaded.scenario;
    let plan = match &loaded.plan {
        Some(plan) => plan.clone(),
        None => match planners.timed_plan(scenario, &loaded.robot, None)? {
            Outcome::Found(plan) => plan,
            Outcome::Infeasible(why) => {
                let verdict = without_simulation(scenario, VerdictKind::Infeasible, why.to_string());
                return Ok(Run { verdict, plan: None, simulated: None });
            }
        },
    };
    run_plan(scenario, &loaded.robot, plan)
}

/// Simulates and judges a plan, if nothing in it touches what it must not, under a scenario's friction, phases, limits and expectation.
///
/// # Errors
/// When the simulation cannot be built from the plan.
pub fn run_plan(scenario: &Scenario, robot: &Robot, plan: Plan) -> Result<Run, CliError> {
    if let Some(touch) = planner::first_touch(&plan, &scenario.tool, robot)? {
        let verdict = without_simulation(scenario, VerdictKind::Touches, touch);
        return Ok(Run { verdict, plan: Some(plan), simulated: None });
    }
    let trace = sim::simulate(robot, &plan, &Conditions::of(scenario)).map_err(CliError::Simulation)?;
    let judgement = judge(&trace, &scenario.limits);
    let seed = plan.planner.map_or(scenario.planner.seed, |planner| planner.seed);
    let verdict = judgement.to_verdict(&scenario.name, scenario.expect.verdict, seed, versions());
    Ok(Run { verdict, plan: Some(plan), simulated: Some((trace, judgement)) })
}

/// The verdict on a scenario that has nothing to simulate.
fn without_simulation(scenario: &Scenario, verdict: VerdictKind, reason: String) -> Verdict {
    Verdict {
        format: FORMAT,
        name: scenario.name.clone(),
        verdict,
        expected: scenario.expect.verdict,
        met: verdict == scenario.expect.verdict,
        checks: Vec::new(),
        self_checks: Vec::new(),
        first_failure: None,
        peak_torque_ratio: BTreeMap::new(),
        reason: Some(reason),
        versions: versions(),
        seed: scenario.planner.seed,
        fingerprint: String::new(),
    }
}
