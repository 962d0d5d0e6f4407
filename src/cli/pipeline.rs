//! The main path: scenario -> plan -> simulation -> judgement -> verdict, for one scenario.

use std::{collections::BTreeMap, time::Instant};

use super::{exit::CliError, maps::Maps, versions::versions};
use crate::{
    judge::{Judgement, judge},
    model::{
        FORMAT,
        plan::Plan,
        scenario::Scenario,
        trace::Trace,
        verdict::{Verdict, VerdictKind},
    },
    planner::{self, Onlooker, PlanOutcome},
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
pub fn run_scenario(loaded: &LoadedScenario, maps: &Maps) -> Result<Run, CliError> {
    let scenario = &loaded.scenario;
    let plan = match &loaded.plan {
        Some(plan) => plan.clone(),
        None => match timed_plan(scenario, &loaded.robot, maps, &mut planner::nobody)? {
            PlanOutcome::Found(plan) => *plan,
            PlanOutcome::Infeasible(why) => {
                let verdict = verdict_without_simulation(scenario, VerdictKind::Infeasible, why.to_string());
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
        let verdict = verdict_without_simulation(scenario, VerdictKind::Touches, touch);
        return Ok(Run { verdict, plan: Some(plan), simulated: None });
    }
    let trace = sim::simulate(robot, &plan, &Conditions::of(scenario)).map_err(CliError::Simulation)?;
    let judgement = judge(&trace, &scenario.limits);
    let seed = plan.planner.map_or(scenario.planner.seed, |planner| planner.seed);
    let verdict = judgement.to_verdict(&scenario.name, scenario.expect.verdict, seed, versions());
    Ok(Run { verdict, plan: Some(plan), simulated: Some((trace, judgement)) })
}

/// Plans a scenario, with the time that it took in the plan; the onlooker may end the search.
///
/// # Errors
/// When the scenario's person or tool is none.
pub fn timed_plan(
    scenario: &Scenario,
    robot: &Robot,
    maps: &Maps,
    onlooker: &mut Onlooker<'_>,
) -> Result<PlanOutcome, CliError> {
    Ok(maps.with_work(robot, scenario, |map, work, map_ms| {
        let start = Instant::now();
        let mut outcome = planner::plan_with(scenario, map, work, onlooker)?;
        if let PlanOutcome::Found(plan) = &mut outcome
            && let Some(record) = &mut plan.planner
        {
            record.wall_ms = Some(start.elapsed().as_secs_f64() * 1e3);
            record.map_ms = Some(map_ms);
        }
        Ok(outcome)
    })?)
}

/// The verdict on a scenario that has nothing to simulate.
fn verdict_without_simulation(scenario: &Scenario, verdict: VerdictKind, reason: String) -> Verdict {
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
