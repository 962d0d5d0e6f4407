//! The summary in Markdown; format version and verdict as JSON.

use std::fmt::Write as _;

use rerun::TextDocument;
use serde::{Deserialize, Serialize};

use super::{
    entity::entity,
    error::RecordError,
    input::RecordingInput,
    messages::Messages,
    scene::{ARROW_M_PER_N, operation_label},
};
use crate::model::{
    FORMAT,
    muscle_work::{BusyMuscle, MuscleWork},
    plan::Plan,
    verdict::Verdict,
};

/// The entity of the format version.
pub(super) const ABOUT: &str = "about";

/// The format of a file, readable by all versions.
#[derive(Serialize, Deserialize)]
pub(super) struct About {
    /// The format version.
    pub format: u32,
    /// The version of Benchdog that wrote it.
    pub benchdog: String,
}

/// Logs the documents.
pub(super) fn log(messages: &mut Messages, input: &RecordingInput) -> Result<(), RecordError> {
    let about = About { format: FORMAT, benchdog: env!("CARGO_PKG_VERSION").to_owned() };
    let about = serde_json::to_string(&about).map_err(RecordError::encode)?;
    messages.log_static(&entity(&[ABOUT]), &TextDocument::new(about).with_media_type("application/json"))?;
    let text = markdown(input.plan, input.verdict);
    messages.log_static(&entity(&["summary"]), &TextDocument::new(text).with_media_type("text/markdown"))?;
    let json = serde_json::to_string_pretty(input.verdict).map_err(RecordError::encode)?;
    messages.log_static(&entity(&["verdict"]), &TextDocument::new(json).with_media_type("application/json"))
}

/// The summary.
pub(super) fn markdown(plan: &Plan, verdict: &Verdict) -> String {
    let mut text = format!("# {}: {}\n\n", verdict.name, verdict.verdict);
    let met = if verdict.met { "as expected" } else { "**not as expected**" };
    push(&mut text, format_args!("Expected {}: {met}.", verdict.expected));
    if let Some(failure) = &verdict.first_failure {
        let (time_s, load) = (failure.time_s, failure.load_factor);
        push(
            &mut text,
            format_args!("First limit crossed: {} at {time_s:.3} s, load factor {load:.2}.", failure.check),
        );
    }
    if let Some(reason) = &verdict.reason {
        push(&mut text, format_args!("{reason}"));
    }
    checks(&mut text, verdict);
    figures(&mut text, plan);
    if let Some(work) = &verdict.muscles {
        muscles(&mut text, work);
    }
    colours(&mut text, plan, verdict.muscles.is_some());
    push(&mut text, format_args!("\n**Made by**: {}", versions(verdict)));
    text
}

/// The busiest muscles of the working arm, effort and endurance.
fn muscles(text: &mut String, work: &MuscleWork) {
    push(text, format_args!("\n**Muscles of the working arm**: {work}"));
    push(text, format_args!("\n| muscle | activation | where |\n|---|---:|---|"));
    for BusyMuscle { name, region, activation } in &work.busiest {
        push(text, format_args!("| {name} | {:.1} % | {region} |", 100.0 * activation));
    }
}

fn colours(text: &mut String, plan: &Plan, with_muscles: bool) {
    let scale_mm = ARROW_M_PER_N * 1e3;
    push(text, format_args!("\n**Colours**"));
    // The colours of the palette for hands in order; further arms repeat them.
    for (index, arm) in plan.arms.iter().enumerate() {
        push(text, format_args!("- {}: {} hand", ["blue", "orange"][index % 2], arm.name));
    }
    push(text, format_args!("- yellow: board"));
    push(text, format_args!("- violet: tool and load"));
    push(text, format_args!("- green: person"));
    if with_muscles {
        push(
            text,
            format_args!(
                "- cream, orange, dark red: muscles of the working arm at rest, at 15 %, at 50 % and above; a region has the \
                 colour of its busiest muscle"
            ),
        );
    }
    push(
        text,
        format_args!("- light green: line of sight from the eyes to the tool tip; the sector in front of the person"),
    );
    push(text, format_args!("- pink: limits; orange-red: what crossed one"));
    push(text, format_args!("- white: points of person and robot of the peripersonal metric; hidden at first"));
    push(
        text,
        format_args!("\nArrows are forces on the board, {scale_mm:.0} mm/N: 10 N are {:.0} mm.", 10.0 * scale_mm),
    );
}

fn versions(verdict: &Verdict) -> String {
    let versions: Vec<_> = verdict.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    let trace = verdict.fingerprint.get(..16).unwrap_or("none");
    format!("{}; seed {}; trace `{trace}`", versions.join(", "), verdict.seed)
}

fn checks(text: &mut String, verdict: &Verdict) {
    if verdict.checks.is_empty() {
        return;
    }
    push(text, format_args!("\n| check | value | limit | margin | unit | |\n|---|---:|---:|---:|---|---|"));
    for check in &verdict.checks {
        let (value, limit, margin) = (check.value, check.limit_text(), check.margin);
        let mark = if check.passed { "" } else { "**FAIL**" };
        push(text, format_args!("| {} | {value:.3} | {limit} | {margin:.3} | {} | {mark} |", check.name, check.unit));
    }
}

/// The plan and its predictions.
fn figures(text: &mut String, plan: &Plan) {
    let [x_m, y_m, _] = plan.operation.x_ot.translation.vector.into();
    let grips: Vec<_> = plan.arms.iter().map(|arm| format!("{} {:.0} N", arm.name, arm.grip_force_n)).collect();
    let operation = operation_label(&plan.operation);
    push(text, format_args!("\n**Plan**: {operation} at ({x_m:.3}, {y_m:.3}) m; grip {}", grips.join(", ")));
    if let Some(stability) = &plan.stability {
        let (best, compliant) = (stability.load_factor, stability.compliant_load_factor);
        let deflection_mm = stability.predicted_deflection_mm;
        push(
            text,
            format_args!(
                "Predicted: load factor {best:.2} at best, {compliant:.2} with compliant arms, \
             deflection {deflection_mm:.2} mm"
            ),
        );
        if let Some(lateral) = &stability.lateral {
            push(text, format_args!("Sideways push: {lateral}, the worst direction"));
        }
    }
    if let Some(clearance) = &plan.clearance {
        push(text, format_args!("Clearance of the robot: {clearance}"));
    }
    if let Some(comfort) = &plan.comfort {
        let (muscular, peripersonal_m) = (comfort.muscular_regularised, comfort.peripersonal_m);
        let scores = comfort.scores().map(|scores| format!("; {scores}")).unwrap_or_default();
        push(text, format_args!("Comfort: muscular {muscular:.1}, peripersonal {peripersonal_m:.3} m{scores}"));
    }
}

fn push(text: &mut String, paragraph: std::fmt::Arguments) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{paragraph}  ");
}
