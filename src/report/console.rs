//! Console output: a table of all scenarios, and the details of one. Plain text without colours, so that it can be piped
//! and compared.

use std::path::Path;

use super::{Outcome, Status, columns::aligned, explanation, muscles, number_of, posture};
use crate::model::{
    plan::PostureFigures,
    verdict::{Check, CheckKind, Verdict, VerdictKind},
};

/// The cell of a figure that does not exist.
const NO_FIGURE: &str = "-";

/// One outcome in a line: `FAIL  cut-03: expected holds, found deflects: ...`.
#[must_use]
pub fn line(outcome: &Outcome) -> String {
    let text = match outcome {
        Outcome::Judged { verdict, .. } if verdict.met => format!("{}: {}", verdict.verdict, explanation(verdict)),
        _ => outcome.sentence(),
    };
    format!("{:<5} {}: {text}", outcome.status().mark(), outcome.name())
}

/// One line per scenario, then one per failure or error, then the count.
///
/// The column `load` is the predicted compliant load factor of the plan. `wall_s` is the duration of each scenario, s, if
/// known.
#[must_use]
pub fn table(outcomes: &[Outcome], wall_s: &[Option<f64>]) -> String {
    let header = [
        "scenario",
        "verdict",
        "expected",
        "result",
        "slip mm",
        "slip deg",
        "sag mm",
        "deflection mm",
        "torque",
        "load",
        "time s",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let times = wall_s.iter().copied().chain(std::iter::repeat(None));
    rows.extend(outcomes.iter().zip(times).map(|(outcome, wall_s)| row(outcome, wall_s)));
    let mut text = aligned(&rows, 4);
    for outcome in outcomes.iter().filter(|outcome| matches!(outcome.status(), Status::Failed | Status::Crashed)) {
        text.push_str(&format!("{} {}: {}\n", outcome.status().mark(), outcome.name(), outcome.sentence()));
    }
    text.push_str(&count(outcomes));
    text
}

/// The details of one verdict: every check with value, limit and margin, the person's posture, the joints with the highest
/// torque ratios, the work of the person's muscles, and the path of the recording.
#[must_use]
pub fn details(verdict: &Verdict, posture: Option<&PostureFigures>, recording: Option<&Path>) -> String {
    let mut text = format!("{}: {}, expected {}: {}\n", verdict.name, verdict.verdict, verdict.expected, met(verdict));
    if !verdict.checks.is_empty() {
        let mut rows = vec![["check", "unit", "value", "limit", "margin", ""].map(str::to_owned).to_vec()];
        rows.extend(verdict.checks.iter().map(check_row));
        text.push_str(&aligned(&rows, 2));
    }
    if let Some(figures) = posture {
        text.push_str(&posture::table(figures));
    }
    let mut notes = vec![vec!["because".to_owned(), explanation(verdict)]];
    if let Some(confirmation) = &verdict.confirmation {
        notes.push(vec!["confirmation".to_owned(), confirmation.to_string()]);
    }
    if let Some(joints) = highest_torques(verdict) {
        notes.push(vec!["torque peaks".to_owned(), joints]);
    }
    if let Some(work) = &verdict.muscles {
        notes.extend(muscles::rows(work));
    }
    if let Some(path) = recording {
        notes.push(vec!["recording".to_owned(), path.display().to_string()]);
    }
    text.push_str(&aligned(&notes, 2));
    text
}

/// The line below a table of verdicts of these kinds that are not the expected ones; empty without one.
///
/// `benchdog explain slips says what this means and what helps`
#[must_use]
pub fn hint(unexpected: impl IntoIterator<Item = VerdictKind>) -> String {
    let mut names: Vec<&str> = Vec::new();
    for kind in unexpected {
        if !names.contains(&kind.name()) {
            names.push(kind.name());
        }
    }
    match names[..] {
        [] => String::new(),
        [name] => format!("benchdog explain {name} says what this means and what helps\n"),
        _ => format!("benchdog explain NAME says what a verdict means and what helps: {}\n", names.join(", ")),
    }
}

fn met(verdict: &Verdict) -> &'static str {
    if verdict.met { "ok" } else { "FAIL" }
}

fn row(outcome: &Outcome, wall_s: Option<f64>) -> Vec<String> {
    let figure = |value: Option<f64>| value.map_or(NO_FIGURE.to_owned(), |value| format!("{value:.2}"));
    let time = wall_s.map_or(NO_FIGURE.to_owned(), |wall_s| format!("{wall_s:.1}"));
    let Outcome::Judged { verdict, predicted_load_factor, .. } = outcome else {
        let mut row = vec![NO_FIGURE.to_owned(); 10];
        outcome.name().clone_into(&mut row[0]);
        outcome.status().mark().clone_into(&mut row[3]);
        row.push(time);
        return row;
    };
    let checked = |kind| figure(verdict.check(kind).map(|check| check.value));
    vec![
        verdict.name.clone(),
        verdict.verdict.to_string(),
        verdict.expected.to_string(),
        outcome.status().mark().to_owned(),
        checked(CheckKind::Slip),
        checked(CheckKind::SlipRotation),
        checked(CheckKind::Sag),
        checked(CheckKind::Deflection),
        checked(CheckKind::TorqueRatio),
        figure(*predicted_load_factor),
        time,
    ]
}

fn check_row(check: &Check) -> Vec<String> {
    let figure = |value: f64| format!("{value:.3}");
    vec![
        check.name.to_string(),
        check.unit.clone(),
        figure(check.value),
        check.limit_text(),
        figure(check.margin),
        if check.passed { String::new() } else { "FAIL".to_owned() },
    ]
}

/// `5 scenarios: 1 ok, 2 failed, 1 crashed, 1 skipped`.
#[must_use]
pub fn count(outcomes: &[Outcome]) -> String {
    let parts = Status::ALL.map(|status| (number_of(outcomes, status), status.name()));
    let counts: Vec<_> =
        parts.iter().filter(|part| part.0 > 0).map(|(number, what)| format!("{number} {what}")).collect();
    let plural = if outcomes.len() == 1 { "" } else { "s" };
    let tail = if counts.is_empty() { String::new() } else { format!(": {}", counts.join(", ")) };
    format!("{} scenario{plural}{tail}\n", outcomes.len())
}

/// The three joints with the highest torque ratios, highest first.
fn highest_torques(verdict: &Verdict) -> Option<String> {
    let mut joints: Vec<_> = verdict.peak_torque_ratio.iter().collect();
    joints.sort_by(|a, b| b.1.total_cmp(a.1));
    let list: Vec<_> = joints.iter().take(3).map(|(joint, ratio)| format!("{joint} {ratio:.2}")).collect();
    (!list.is_empty()).then(|| list.join(", "))
}
