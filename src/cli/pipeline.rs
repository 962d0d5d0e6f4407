//! The main path: scenario -> plan -> simulation -> judgement -> verdict, for one scenario.

use std::time::Instant;

use super::{exit::CliError, versions::versions};
use crate::{
    judge::{Judgement, judge},
    model::{
        FORMAT,
        plan::Plan,
        scenario::{Expectation, Scenario},
        trace::Trace,
        verdict::{Verdict, VerdictKind},
    },
    planner::{self, PlanOutcome},
    robot::Robot,
    scenario::LoadedScenario,
    sim,
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
/// When the simulation cannot be built from the plan.
pub fn run_scenario(loaded: &LoadedScenario) -> Result<Run, CliError> {
    let scenario = &loaded.scenario;
    let plan = match &loaded.plan {
        Some(plan) => plan.clone(),
        None => match timed_plan(scenario, &loaded.robot) {
            PlanOutcome::Found(plan) => *plan,
            PlanOutcome::Infeasible(why) => {
                return Ok(Run { verdict: infeasible(scenario, why.to_string()), plan: None, simulated: None });
            }
        },
    };
    run_plan(scenario, &loaded.robot, plan)
}

/// Simulates and judges a plan under a scenario's friction, phases, limits and expectation.
///
/// # Errors
/// When the simulation cannot be built from the plan.
pub fn run_plan(scenario: &Scenario, robot: &Robot, plan: Plan) -> Result<Run, CliError> {
    let trace = sim::simulate(robot, &plan, scenario.grip.friction, &scenario.simulation)
        .map_err(|source| CliError::Simulation { name: plan.name.clone(), source })?;
    let judgement = judge(&trace, &scenario.limits);
    let verdict = verdict(scenario, &judgement);
    Ok(Run { verdict, plan: Some(plan), simulated: Some((trace, judgement)) })
}

/// Plans a scenario, with the time that it took in the plan.
pub fn timed_plan(scenario: &Scenario, robot: &Robot) -> PlanOutcome {
    let start = Instant::now();
    let mut outcome = planner::plan(scenario, robot);
    if let PlanOutcome::Found(plan) = &mut outcome
        && let Some(record) = &mut plan.planner
    {
        record.wall_ms = Some(start.elapsed().as_secs_f64() * 1e3);
    }
    outcome
}

fn verdict(scenario: &Scenario, judgement: &Judgement) -> Verdict {
    Verdict {
        verdict: judgement.verdict,
        met: is_met(judgement.verdict, scenario.expect),
        checks: judgement.checks.clone(),
        first_failure: judgement.first_failure.clone(),
        peak_torque_ratio: judgement.peak_torque_ratio.clone(),
        reason: judgement.reason.clone(),
        fingerprint: judgement.fingerprint.clone(),
        ..blank_verdict(scenario)
    }
}

fn infeasible(scenario: &Scenario, reason: String) -> Verdict {
    let verdict = VerdictKind::Infeasible;
    Verdict { verdict, met: is_met(verdict, scenario.expect), reason: Some(reason), ..blank_verdict(scenario) }
}

/// Without a verdict there is nothing that could meet an expectation.
fn is_met(verdict: VerdictKind, expect: Expectation) -> bool {
    verdict == expect.verdict && verdict != VerdictKind::NoVerdict
}

/// What every verdict on a scenario says, whatever became of it.
fn blank_verdict(scenario: &Scenario) -> Verdict {
    Verdict {
        format: FORMAT,
        name: scenario.name.clone(),
        verdict: VerdictKind::NoVerdict,
        expected: scenario.expect.verdict,
        met: false,
        checks: Vec::new(),
        first_failure: None,
        peak_torque_ratio: Default::default(),
        reason: None,
        versions: versions(),
        seed: scenario.planner.seed,
        fingerprint: String::new(),
    }
}
