//! The main path for one plan: check, simulate, judge. Commands and the Python package take it.
//!
//! [`run_plan`] gives the verdict on a plan, [`recording`] its recording, [`sweep`] the verdicts under many deviations. This module
//! knows no clock, terminal or file: a caller is told of progress by what it passes, and stops the work by a [`Stop`].

mod error;
#[cfg(feature = "mcap")]
pub mod mcap;
pub mod parallel;
#[cfg(feature = "recording")]
pub mod recording;
#[cfg(not(feature = "recording"))]
#[path = "no_recording.rs"]
pub mod recording;
pub mod sweep;
pub mod task_recording;
#[cfg(any(feature = "mcap", feature = "recording"))]
mod task_series;
pub mod versions;

use std::collections::BTreeMap;

pub use error::RunError;
use versions::versions;

use crate::{
    check::CheckedPlan,
    judge::{CRITERIA, Judgement, confirmed, judge},
    model::{
        FORMAT,
        lateral::LateralPush,
        load::Load,
        plan::{Plan, PostureFigures},
        scenario::Scenario,
        stop::Stop,
        trace::Trace,
        verdict::{Verdict, VerdictKind},
    },
    robot::Robot,
    scenario::material::bending_properties,
    sim::{self, Conditions, SimError},
    statics::{ContactModel, LoadFactorOutcome, StabilityWorkspace, bending_note},
};

/// A scenario or plan with its verdict.
#[derive(Debug)]
pub struct Run {
    /// The verdict.
    pub verdict: Verdict,
    /// The plan; `None` if none was found.
    pub plan: Option<Plan>,
    /// How the person stands and sees the work; `None` without a person.
    pub posture: Option<PostureFigures>,
    /// Trace and judgement; `None` if nothing was simulated.
    pub simulated: Option<(Trace, Judgement)>,
}

/// Simulates and judges a plan with a scenario's friction, phases, limits and expectation. The notes of the verdict begin with
/// what was filled in. A plan whose bodies meet in the
/// planned pose is not simulated; its verdict is `collides`, or `touches` if one is the person. Nor is one whose person would
/// not stand or see so; its verdict is `infeasible`.
///
/// # Errors
/// If the simulation cannot be set up from the plan, and after a stop.
pub fn run_plan(
    scenario: &Scenario,
    robot: &Robot,
    plan: Plan,
    filled_in: &[String],
    stop: &dyn Stop,
) -> Result<Run, RunError> {
    // After a stop the plan is the best so far, not that of the scenario.
    if stop.is_stopped() {
        return Err(SimError::Stopped.into());
    }
    let mut run = run_complete_plan(scenario, robot, plan, stop)?;
    run.verdict.notes.splice(..0, filled_in.iter().cloned());
    Ok(run)
}

fn run_complete_plan(scenario: &Scenario, robot: &Robot, plan: Plan, stop: &dyn Stop) -> Result<Run, RunError> {
    let checked = CheckedPlan::new(robot, &plan, &scenario.human, &scenario.tool)?;
    let (posture, muscles) = (checked.posture(), checked.muscles());
    let (verdict, simulated) = checked_and_judged(&checked, scenario, stop)?;
    tracing::info!(plan = plan.name, verdict = verdict.verdict.name(), "judged");
    Ok(Run { verdict: Verdict { muscles, ..verdict }, posture, plan: Some(plan), simulated })
}

/// The verdict on a plan with trace and judgement, if it was simulated.
fn checked_and_judged(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    stop: &dyn Stop,
) -> Result<(Verdict, Option<(Trace, Judgement)>), RunError> {
    if let Some((verdict, reason)) = checked.refusal(&scenario.limits) {
        return Ok((verdict_without_simulation(scenario, verdict, reason), None));
    }
    let (trace, judgement) = simulated_and_judged(checked, scenario, stop)?;
    let plan = checked.plan();
    let seed = plan.planner.map_or(scenario.planner.seed, |planner| planner.seed);
    let verdict = judgement.to_verdict(&scenario.name, scenario.expect.verdict, seed, versions());
    Ok((Verdict { notes: notes(checked, scenario), ..verdict }, Some((trace, judgement))))
}

/// The simulation of a plan and its judgement, confirmed at shorter time steps if it is near to a limit. A grasp that holds
/// the board only by the simulation, and provably not by the statics, has no verdict.
///
/// # Errors
/// If the simulation cannot be set up from the plan, and after a stop.
pub fn simulated_and_judged(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    stop: &dyn Stop,
) -> Result<(Trace, Judgement), RunError> {
    let run = |timestep_s: f64| {
        let mut conditions = Conditions::of(scenario);
        conditions.settings.timestep_s = timestep_s;
        let trace = sim::simulate_until(checked, &conditions, stop)?;
        let judgement = judge(&trace, &scenario.limits);
        Ok::<_, RunError>((trace, judgement))
    };
    let (trace, judgement) = confirmed(scenario.simulation.timestep_s, run)?;
    let refuted = judgement.verdict == VerdictKind::Holds && cannot_carry_the_weight(checked, scenario);
    if !refuted {
        return Ok((trace, judgement));
    }
    let reason =
        "the simulation holds the board, but the statics prove that the hands cannot carry its weight".to_owned();
    Ok((trace, Judgement { verdict: VerdictKind::NoVerdict, reason: Some(reason), ..judgement }))
}

/// The judgement on a plan under a multiple of its load, without confirmation.
///
/// # Errors
/// If the simulation cannot be set up from the plan, and after a stop.
pub fn judge_at(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    factor: f64,
    stop: &dyn Stop,
) -> Result<Judgement, RunError> {
    let conditions = Conditions::of(scenario).scaled(factor);
    let trace = sim::simulate_until(checked, &conditions, stop)?;
    Ok(judge(&trace, &scenario.limits))
}

/// True if the statics prove that the hands cannot carry the board's weight with the simulated friction and grip forces.
fn cannot_carry_the_weight(checked: &CheckedPlan<'_>, scenario: &Scenario) -> bool {
    let Ok(model) = ContactModel::under(checked, scenario.grip.friction, &scenario.uncertainty) else { return false };
    match StabilityWorkspace::new().friction_load_factor(&model) {
        Ok(LoadFactorOutcome::GravityInfeasible { certificate }) => {
            certificate.proves_infeasible(&model).unwrap_or(false)
        }
        _ => false,
    }
}

/// The sideways push of the simulation, and the assumptions that a plan strains.
fn notes(checked: &CheckedPlan<'_>, scenario: &Scenario) -> Vec<String> {
    let push = Conditions::of(scenario).lateral_push(checked).map(|push| push_note(&push, &scenario.load));
    let material = &scenario.object.material;
    let properties = bending_properties(material);
    let bending =
        properties.and_then(|properties| bending_note(checked.plan(), material, &properties, &scenario.limits));
    push.into_iter().chain(bending).collect()
}

/// The simulated sideways push in words.
fn push_note(push: &LateralPush, load: &Load) -> String {
    let share = load.lateral_share;
    format!("the hand also pushes sideways with {share} of the force, {push}, the worst direction by the statics")
}

/// The verdict on a scenario for which nothing was simulated.
pub fn verdict_without_simulation(scenario: &Scenario, verdict: VerdictKind, reason: String) -> Verdict {
    Verdict {
        format: FORMAT,
        criteria: CRITERIA,
        name: scenario.name.clone(),
        verdict,
        expected: scenario.expect.verdict,
        met: verdict == scenario.expect.verdict,
        checks: Vec::new(),
        self_checks: Vec::new(),
        first_failure: None,
        peak_torque_ratio: BTreeMap::new(),
        confirmation: None,
        reason: Some(reason),
        notes: Vec::new(),
        muscles: None,
        versions: versions(),
        seed: scenario.planner.seed,
        fingerprint: String::new(),
    }
}
