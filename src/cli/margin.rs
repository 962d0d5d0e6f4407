//! `benchdog margin`: the load raised until the hold fails, beside what the statics predict.

use serde::Serialize;

use super::{
    args::{Format, MarginArgs},
    exit::{CliError, Exit},
    output,
    predicted::{Predicted, predicted},
};
use crate::{
    judge::{FailingLoad, Judgement, failing_load, judge},
    model::{
        plan::Plan,
        scenario::Scenario,
        verdict::{Check, VerdictKind},
    },
    planner,
    robot::Robot,
    scenario,
    sim::{self, Conditions},
};

/// How much load a hold stands, by the simulation and by both predictions.
#[derive(Clone, Debug, Serialize)]
struct Margin {
    name: String,
    /// The multiple of the load up to which the simulated hold stands.
    load_factor: f64,
    /// The smallest multiple that was found to fail, at most 0.1 % more; none when the hold stands 100 times the load.
    fails_at: Option<f64>,
    /// What becomes of the hold there.
    ended_by: VerdictKind,
    /// The check that says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    check: Option<Check>,
    /// Why there is no such check, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// What the statics predict.
    predicted: Option<Predicted>,
    /// Why there is no prediction.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_prediction: Option<String>,
    /// How many simulations it took.
    simulations: usize,
    /// What the author expected, and whether it is so.
    expected: VerdictKind,
    met: bool,
}

/// Finds and reports the margin of a plan.
pub fn margin(args: &MarginArgs) -> Result<Exit, CliError> {
    let (plan, robot, scenario) = scenario::plan_and_scenario(&args.plan, args.scenario.as_deref())?;
    let margin = margin_of(&plan, &robot, &scenario)?;
    match args.format {
        Format::Human => output::print(&for_people(&margin))?,
        Format::Json => {
            // Serialisation fails only for maps with keys that are no strings, and there are none.
            let text = serde_json::to_string_pretty(&margin).expect("a margin has only string keys");
            output::print(&format!("{text}\n"))?;
        }
    }
    Ok(if margin.met { Exit::Met } else { Exit::NotMet })
}

fn margin_of(plan: &Plan, robot: &Robot, scenario: &Scenario) -> Result<Margin, CliError> {
    // A plan that can be simulated has a margin even without a prediction.
    let (predicted, no_prediction) = match predicted(plan, robot, scenario) {
        Ok(predicted) => (Some(predicted), None),
        Err(reason) => (None, Some(reason)),
    };
    let expected = scenario.expect.verdict;
    let empty = Margin {
        name: plan.name.clone(),
        load_factor: 0.0,
        fails_at: Some(0.0),
        ended_by: VerdictKind::Touches,
        check: None,
        reason: None,
        predicted,
        no_prediction,
        simulations: 0,
        expected,
        met: expected == VerdictKind::Touches,
    };
    if let Some(touch) = planner::first_touch(plan, &scenario.tool, robot)? {
        return Ok(Margin { reason: Some(touch), ..empty });
    }
    let guess = empty.predicted.as_ref().map_or(1.0, |predicted| predicted.compliant);
    let FailingLoad { holds_at, fails_at, judgement, simulations } = simulated(plan, robot, scenario, guess)?;
    let failed = judgement.first_failure.as_ref().map(|failure| failure.check);
    let met = match expected {
        VerdictKind::Holds => holds_at >= scenario.limits.load_factor,
        // The load itself fails as expected, or a load beyond it does.
        other => judged(plan, robot, scenario, 1.0)?.verdict == other && other != VerdictKind::NoVerdict,
    };
    Ok(Margin {
        load_factor: holds_at,
        fails_at,
        ended_by: judgement.verdict,
        check: judgement.checks.into_iter().find(|check| Some(check.name) == failed),
        reason: judgement.reason,
        simulations,
        met,
        ..empty
    })
}

/// The load at which a plan's hold fails in simulation; the search begins at `guess`.
///
/// # Errors
/// When the simulation cannot be built from the plan.
pub fn simulated(plan: &Plan, robot: &Robot, scenario: &Scenario, guess: f64) -> Result<FailingLoad, CliError> {
    failing_load(guess, |factor| judged(plan, robot, scenario, factor))
}

/// What becomes of the hold under a multiple of its load.
fn judged(plan: &Plan, robot: &Robot, scenario: &Scenario, factor: f64) -> Result<Judgement, CliError> {
    let trace = sim::simulate(robot, plan, &Conditions::of(scenario).scaled(factor)).map_err(CliError::Simulation)?;
    Ok(judge(&trace, &scenario.limits))
}

fn for_people(margin: &Margin) -> String {
    let why = match (&margin.check, &margin.reason) {
        (Some(check), _) => format!(" ({} {:.3} {}, at most {})", check.name, check.value, check.unit, check.limit),
        (None, Some(reason)) => format!(" ({reason})"),
        (None, None) => String::new(),
    };
    let end = match margin.fails_at {
        Some(_) => format!("then {}{why}", margin.ended_by),
        None => "the largest tried".to_owned(),
    };
    let met = if margin.met { "ok" } else { "FAIL" };
    let mut text = format!(
        "{}: holds up to {:.3} times the load, {end}; expected {}: {met}\n",
        margin.name, margin.load_factor, margin.expected
    );
    text.push_str(&format!(
        "simulated            {:7.3}  {} simulations, each with its whole load\n",
        margin.load_factor, margin.simulations
    ));
    match (&margin.predicted, &margin.no_prediction) {
        (Some(predicted), _) => text.push_str(&predicted.for_people()),
        (None, Some(reason)) => text.push_str(&format!("prediction           none: {reason}\n")),
        (None, None) => {}
    }
    text
}
