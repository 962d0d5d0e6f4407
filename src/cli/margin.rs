//! `benchdog margin`: the load at which a plan fails in simulation, and the predicted load factors
//! (`docs/method.md#89-failing-load`).

use serde::Serialize;

use super::{
    args::MarginArgs,
    exit::{CliError, Exit},
    format::Format,
    output,
    predicted::{Predicted, predicted},
    progress::Progress,
};
use crate::{
    check::CheckedPlan,
    judge::{FailingLoad, failing_load},
    model::{
        scenario::Scenario,
        verdict::{Check, VerdictKind},
    },
    pipeline::judge_at,
    scenario::{self, LoadedPlan},
};

/// The load factors of a plan by simulation and by both predictions.
#[derive(Clone, Debug, Serialize)]
struct Margin {
    name: String,
    /// The largest simulated multiple of the load at which the plan does not fail.
    load_factor: f64,
    /// The smallest simulated multiple at which it fails, at most 0.1 % more; `None` if it does not fail at 100.
    fails_at: Option<f64>,
    /// The verdict at that multiple.
    ended_by: VerdictKind,
    /// The check that fails there.
    #[serde(skip_serializing_if = "Option::is_none")]
    check: Option<Check>,
    /// Why there is no such check.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    /// The predictions.
    predicted: Option<Predicted>,
    /// Why there is no prediction.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_prediction: Option<String>,
    /// Number of simulations.
    simulations: usize,
    /// The expected verdict.
    expected: VerdictKind,
    /// Whether the expectation is met.
    met: bool,
}

/// Finds and reports the margin of a plan.
pub fn margin(args: &MarginArgs) -> Result<Exit, CliError> {
    let progress = Progress::begin("reading the plan", "")?;
    let LoadedPlan { plan, filled_in, robot, scenario, .. } =
        scenario::load_plan(&args.plan, args.scenario.as_deref())?;
    filled_in.iter().for_each(|note| progress.message(&output::note(note)));
    let checked = CheckedPlan::new(&robot, &plan, &scenario.human, &scenario.tool)?;
    let margin = margin_of(&checked, &scenario, &progress)?;
    progress.finish();
    match args.format {
        Format::Human => output::report(&text(&margin))?,
        Format::Json => {
            // Serialisation fails only for maps whose keys are not strings.
            let text = serde_json::to_string_pretty(&margin).expect("a margin has only string keys");
            output::print(&format!("{text}\n"))?;
        }
    }
    Ok(if margin.met { Exit::Met } else { Exit::NotMet })
}

fn margin_of(checked: &CheckedPlan<'_>, scenario: &Scenario, progress: &Progress) -> Result<Margin, CliError> {
    // A plan without predictions may still be simulated.
    let (predicted, no_prediction) = match predicted(checked, scenario) {
        Ok(predicted) => (Some(predicted), None),
        Err(reason) => (None, Some(reason)),
    };
    let expected = scenario.expect.verdict;
    let empty = Margin {
        name: checked.plan().name.clone(),
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
    if let Some((ended_by, reason)) = checked.refusal(&scenario.limits) {
        return Ok(Margin { reason: Some(reason), ended_by, met: expected == ended_by, ..empty });
    }
    let guess = empty.predicted.as_ref().map_or(1.0, |predicted| predicted.compliant);
    let FailingLoad { holds_at, fails_at, judgement, simulations } = simulated(checked, scenario, guess, progress)?;
    let failed = judgement.first_failure.as_ref().map(|failure| failure.check);
    let met = match expected {
        VerdictKind::Holds => holds_at >= scenario.limits.load_factor,
        // The verdict on the load itself, not on the failing load, must be the expected one.
        other => judge_at(checked, scenario, 1.0, progress)?.verdict == other && other != VerdictKind::NoVerdict,
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

/// The load at which a plan fails in simulation. The search starts at `guess`.
///
/// # Errors
/// If the simulation cannot be set up from the plan, and after a stop.
pub fn simulated(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    guess: f64,
    progress: &Progress,
) -> Result<FailingLoad, CliError> {
    failing_load(guess, |factor| {
        progress.does(&format!("simulating {factor:.3} times the load"));
        Ok(judge_at(checked, scenario, factor, progress)?)
    })
}

fn text(margin: &Margin) -> String {
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
    text.push_str(&format!("simulated            {:7.3}  {} simulations\n", margin.load_factor, margin.simulations));
    match (&margin.predicted, &margin.no_prediction) {
        (Some(predicted), _) => text.push_str(&predicted.text()),
        (None, Some(reason)) => text.push_str(&format!("prediction           none: {reason}\n")),
        (None, None) => {}
    }
    text
}
