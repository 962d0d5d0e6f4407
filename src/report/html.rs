//! The report of a run as one HTML page. It works offline, in light and dark mode and in print, and contains no scripts.

use std::fmt::Write as _;

use super::{
    Outcome, Status, console,
    plot::{Line, Plot, escape},
    summary::recording_link,
};
use crate::model::{
    measures::{JointMeasures, Measures},
    verdict::{Check, CheckKind, Verdict},
};

/// Number of joints in the torque plot: those with the highest torque ratios.
const JOINTS_SHOWN: usize = 3;

/// The CSS classes of lines, by arm.
const HANDS: [&str; 2] = ["hand-0", "hand-1"];

/// The CSS classes of the joints' lines, highest torque ratio first.
const JOINTS: [&str; JOINTS_SHOWN] = ["joint-0", "joint-1", "joint-2"];

/// The page: a table of all scenarios, then a section for each with checks and plots. Sections of failures are open.
pub fn page(outcomes: &[Outcome]) -> String {
    let count = console::count(outcomes);
    let mut body = String::new();
    push(&mut body, format_args!("<h1>Benchdog: {}</h1>", escape(count.trim_end())));
    push(
        &mut body,
        format_args!(
            "<p class=\"made\">Made by benchdog {}. Equal runs give equal pages.</p>",
            env!("CARGO_PKG_VERSION")
        ),
    );
    table(&mut body, outcomes);
    for outcome in outcomes {
        section(&mut body, outcome);
    }
    let style = include_str!("report.css");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>Benchdog: {}</title>\n\
         <style>\n{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escape(count.trim_end())
    )
}

fn table(body: &mut String, outcomes: &[Outcome]) {
    let words = ["scenario", "result", "verdict", "expected"].map(|head| format!("<th>{head}</th>")).concat();
    let figures = ["slip mm", "slip deg", "deflection mm", "torque ratio", "predicted load factor"];
    let figures = figures.map(|head| format!("<th class=\"n\">{head}</th>")).concat();
    push(body, format_args!("<div class=\"wide\"><table>\n<tr>{words}{figures}<th>recording</th></tr>"));
    for outcome in outcomes {
        row(body, outcome);
    }
    push(body, format_args!("</table></div>"));
}

fn row(body: &mut String, outcome: &Outcome) {
    let (name, status) = (escape(outcome.name()), outcome.status());
    let (class, mark) = (status.name(), status.mark());
    let verdict = outcome.verdict();
    let text = |value: Option<String>| format!("<td>{}</td>", value.unwrap_or_else(|| "–".to_owned()));
    let figure = |value: Option<f64>| {
        format!("<td class=\"n\">{}</td>", value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}")))
    };
    let checked = |kind| figure(verdict.and_then(|verdict| verdict.check(kind)).map(|check| check.value));
    let load = match outcome {
        Outcome::Judged { predicted_load_factor, .. } => *predicted_load_factor,
        _ => None,
    };
    let cells = [
        format!("<td class=\"name\"><a href=\"#{name}\">{name}</a></td>"),
        format!("<td class=\"{class}\">{mark}</td>"),
        text(verdict.map(|verdict| verdict.verdict.to_string())),
        text(verdict.map(|verdict| verdict.expected.to_string())),
        checked(CheckKind::Slip),
        checked(CheckKind::SlipRotation),
        checked(CheckKind::Deflection),
        checked(CheckKind::TorqueRatio),
        figure(load),
        text(recording_link(outcome).map(|link| format!("<a href=\"{}\">.rrd</a>", escape(&link)))),
    ];
    push(body, format_args!("<tr>{}</tr>", cells.concat()));
}

fn section(body: &mut String, outcome: &Outcome) {
    let (name, status) = (escape(outcome.name()), outcome.status());
    let open = if matches!(status, Status::Failed | Status::Crashed) { " open=\"open\"" } else { "" };
    let (class, mark) = (status.name(), status.mark());
    push(
        body,
        format_args!(
            "<details id=\"{name}\"{open}>\n<summary><h2>{name}</h2> <span class=\"{class}\">{mark}</span> {}</summary>",
            escape(&outcome.sentence())
        ),
    );
    if let Outcome::Judged { verdict, measures, .. } = outcome {
        checks(body, verdict);
        if let Some(measures) = measures {
            plots(body, verdict, measures);
        }
        let versions: Vec<_> = verdict.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
        let versions = escape(&versions.join(", "));
        let trace = verdict.fingerprint.get(..16).unwrap_or("none");
        push(body, format_args!("<p class=\"quiet\">{versions}; seed {}; trace {trace}</p>", verdict.seed));
    }
    push(body, format_args!("</details>"));
}

fn checks(body: &mut String, verdict: &Verdict) {
    if verdict.checks.is_empty() {
        return;
    }
    let figures = ["value", "limit", "margin"].map(|head| format!("<th class=\"n\">{head}</th>")).concat();
    push(body, format_args!("<table>\n<tr><th>check</th><th>unit</th>{figures}<th></th></tr>"));
    for Check { name, value, limit, margin, unit, passed } in &verdict.checks {
        let figures = [value, limit, margin].map(|figure| format!("<td class=\"n\">{figure:.3}</td>")).concat();
        let mark = if *passed { "" } else { "FAIL" };
        let unit = escape(unit);
        push(body, format_args!("<tr><td>{name}</td><td>{unit}</td>{figures}<td class=\"failed\">{mark}</td></tr>"));
    }
    push(body, format_args!("</table>"));
}

fn plots(body: &mut String, verdict: &Verdict, measures: &Measures) {
    push(body, format_args!("<div class=\"plots\">"));
    let hands = |series: fn(&crate::model::measures::HandMeasures) -> &[f64]| {
        let line = |(arm, hand)| {
            let hand: &crate::model::measures::HandMeasures = hand;
            Line { name: &hand.name, class: HANDS[arm % HANDS.len()], values: series(hand) }
        };
        measures.hands.iter().enumerate().map(line).collect::<Vec<_>>()
    };
    let deflection = Line { name: "tool point", class: "board", values: &measures.deflection_mm };
    let load = Line { name: "multiple of the load", class: "load", values: &measures.load_factor };
    let joints = by_torque(verdict, measures).into_iter().zip(JOINTS);
    let joints = joints.map(|(joint, class)| Line { name: &joint.name, class, values: &joint.torque_ratio });
    let plots = [
        ("slip of the hands on the board, mm", Some(CheckKind::Slip), hands(|hand| &hand.slip_mm)),
        ("rotation of the hands on the board, deg", Some(CheckKind::SlipRotation), hands(|hand| &hand.slip_deg)),
        ("deflection of the tool point, mm", Some(CheckKind::Deflection), vec![deflection]),
        ("joint torque / limit, most loaded joints", Some(CheckKind::TorqueRatio), joints.collect()),
        ("load factor", None, vec![load]),
    ];
    for (title, kind, lines) in plots {
        let limit = kind.and_then(|kind| verdict.check(kind)).map(|check| check.limit);
        let failed = verdict.first_failure.as_ref().filter(|failure| Some(failure.check) == kind);
        let failed_s = failed.map(|failure| failure.time_s);
        body.push_str(&Plot { title, time_s: &measures.time_s, lines, limit, failed_s }.svg());
    }
    push(body, format_args!("</div>"));
}

fn by_torque<'a>(verdict: &Verdict, measures: &'a Measures) -> Vec<&'a JointMeasures> {
    let peak = |joint: &JointMeasures| verdict.peak_torque_ratio.get(&joint.name).copied().unwrap_or(0.0);
    let mut joints: Vec<_> = measures.joints.iter().collect();
    joints.sort_by(|a, b| peak(b).total_cmp(&peak(a)));
    joints
}

fn push(body: &mut String, line: std::fmt::Arguments) {
    // Writing into a string cannot fail.
    let _ = writeln!(body, "{line}");
}
