//! The summary of a run as JSON and CSV, with one entry per scenario.

use serde::Serialize;

use super::{Outcome, SkipReason, Status, json::pretty, number_of};
use crate::model::{
    FORMAT,
    verdict::{CheckKind, Failure, VerdictKind},
};

/// The checks in a summary, with the names of their columns.
const FIGURES: [(&str, CheckKind); 6] = [
    ("slip_mm", CheckKind::Slip),
    ("slip_deg", CheckKind::SlipRotation),
    ("sag_mm", CheckKind::Sag),
    ("deflection_mm", CheckKind::Deflection),
    ("creep_mm_s", CheckKind::Creep),
    ("torque_ratio", CheckKind::TorqueRatio),
];

#[derive(Serialize)]
struct Summary<'a> {
    format: u32,
    benchdog: &'a str,
    scenarios: usize,
    ok: usize,
    failed: usize,
    crashed: usize,
    skipped: usize,
    /// True if the run was interrupted before all scenarios had started.
    interrupted: bool,
    outcomes: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    status: &'static str,
    verdict: Option<VerdictKind>,
    expected: Option<VerdictKind>,
    slip_mm: Option<f64>,
    slip_deg: Option<f64>,
    sag_mm: Option<f64>,
    deflection_mm: Option<f64>,
    creep_mm_s: Option<f64>,
    torque_ratio: Option<f64>,
    predicted_load_factor: Option<f64>,
    muscle_effort: Option<f64>,
    largest_activation: Option<f64>,
    first_failure: Option<&'a Failure>,
    explanation: String,
    /// The recording's path relative to the folder of the summary.
    recording: Option<String>,
}

/// `summary.json`: counts, and an object with figures per scenario; missing figures are null.
#[must_use]
pub fn json(outcomes: &[Outcome]) -> String {
    let [ok, failed, crashed, skipped] = Status::ALL.map(|status| number_of(outcomes, status));
    pretty(&Summary {
        format: FORMAT,
        benchdog: env!("CARGO_PKG_VERSION"),
        scenarios: outcomes.len(),
        ok,
        failed,
        crashed,
        skipped,
        interrupted: outcomes
            .iter()
            .any(|outcome| matches!(outcome, Outcome::Skipped { reason: SkipReason::Interrupted, .. })),
        outcomes: outcomes.iter().map(entry).collect(),
    })
}

fn entry(outcome: &Outcome) -> Entry<'_> {
    let verdict = outcome.verdict();
    let [slip_mm, slip_deg, sag_mm, deflection_mm, creep_mm_s, torque_ratio] = figures(outcome);
    let muscles = verdict.and_then(|verdict| verdict.muscles.as_ref());
    Entry {
        name: outcome.name(),
        status: outcome.status().name(),
        verdict: verdict.map(|verdict| verdict.verdict),
        expected: verdict.map(|verdict| verdict.expected),
        slip_mm,
        slip_deg,
        sag_mm,
        deflection_mm,
        creep_mm_s,
        torque_ratio,
        predicted_load_factor: predicted_load_factor(outcome),
        muscle_effort: muscles.map(|work| work.effort),
        largest_activation: muscles.map(|work| work.largest_activation),
        first_failure: verdict.and_then(|verdict| verdict.first_failure.as_ref()),
        explanation: outcome.sentence(),
        recording: recording_link(outcome),
    }
}

fn figures(outcome: &Outcome) -> [Option<f64>; 6] {
    FIGURES.map(|(_, kind)| outcome.verdict().and_then(|verdict| verdict.check(kind)).map(|check| check.value))
}

fn predicted_load_factor(outcome: &Outcome) -> Option<f64> {
    match outcome {
        Outcome::Judged { predicted_load_factor, .. } => *predicted_load_factor,
        Outcome::Crashed { .. } | Outcome::Skipped { .. } => None,
    }
}

/// The path of the recording relative to the folder of the reports, with `/` on every platform.
pub(super) fn recording_link(outcome: &Outcome) -> Option<String> {
    match outcome {
        Outcome::Judged { verdict, recording: Some(path), .. } => {
            Some(format!("{}/{}", verdict.name, path.file_name()?.to_str()?))
        }
        _ => None,
    }
}

/// `summary.csv`: one row per scenario; missing figures are empty.
///
/// # Errors
/// If the CSV writer fails.
pub fn csv(outcomes: &[Outcome]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let (first, last) = (
        ["scenario", "status", "verdict", "expected"],
        ["predicted_load_factor", "muscle_effort", "largest_activation"],
    );
    let failure = ["first_failure", "first_failure_s", "first_failure_load_factor", "explanation"];
    writer.write_record(first.into_iter().chain(FIGURES.map(|(name, _)| name)).chain(last).chain(failure))?;
    for outcome in outcomes {
        writer.write_record(record(outcome))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

fn record(outcome: &Outcome) -> Vec<String> {
    let verdict = outcome.verdict();
    let text = |text: Option<String>| text.unwrap_or_default();
    let figure = |value: Option<f64>| text(value.map(|value| format!("{value:.4}")));
    let failure = verdict.and_then(|verdict| verdict.first_failure.as_ref());
    let muscles = verdict.and_then(|verdict| verdict.muscles.as_ref());
    let mut cells = vec![
        outcome.name().to_owned(),
        outcome.status().name().to_owned(),
        text(verdict.map(|verdict| verdict.verdict.to_string())),
        text(verdict.map(|verdict| verdict.expected.to_string())),
    ];
    cells.extend(figures(outcome).map(figure));
    cells.push(figure(predicted_load_factor(outcome)));
    cells.push(figure(muscles.map(|work| work.effort)));
    cells.push(figure(muscles.map(|work| work.largest_activation)));
    cells.push(text(failure.map(|failure| failure.check.to_string())));
    cells.push(figure(failure.map(|failure| failure.time_s)));
    cells.push(figure(failure.map(|failure| failure.load_factor)));
    cells.push(outcome.sentence());
    cells
}
