//! The report of a run as one HTML page. It works offline, in light and dark mode and in print, and contains no scripts.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{
    Outcome, Status, console, hold, muscles,
    plot::{Line, Plot},
    posture, stages,
    summary::recording_link,
    xml,
};
use crate::model::{
    measures::{HandMeasures, JointMeasures, Measures},
    plan::PostureFigures,
    verdict::{CheckKind, Verdict},
};

/// Elements that HTML leaves open and maud therefore does not close; closed here, the page is also well-formed XML.
const META: &str = "<meta charset=\"utf-8\"/><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>";

/// The cell of a figure that does not exist.
const NO_FIGURE: &str = "–";

/// The checks in the table of all scenarios.
const FIGURES: [CheckKind; 5] =
    [CheckKind::Slip, CheckKind::SlipRotation, CheckKind::Sag, CheckKind::Deflection, CheckKind::TorqueRatio];

/// Number of joints in the torque plot: those with the highest torque ratios.
const JOINTS_SHOWN: usize = 3;

/// The CSS classes of lines, by arm.
const HANDS: [&str; 2] = ["hand-0", "hand-1"];

/// The CSS classes of the joints' lines, highest torque ratio first.
const JOINTS: [&str; JOINTS_SHOWN] = ["joint-0", "joint-1", "joint-2"];

/// A page with this title as its heading, the style of all pages and a further one.
pub(super) fn document(title: &str, style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                (PreEscaped(META))
                title { (title) }
                style { (PreEscaped(include_str!("report.css"))) (PreEscaped(style)) }
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    };
    xml::legal(page.into_string())
}

/// The page: a table of all scenarios, then a section for each with checks and plots. Sections of failures are open.
#[must_use]
pub fn page(outcomes: &[Outcome]) -> String {
    let title = format!("Benchdog: {}", console::count(outcomes).trim_end());
    let body = html! {
        p.made { "Made by benchdog " (env!("CARGO_PKG_VERSION")) ". Equal runs give equal pages." }
        (table(outcomes))
        @for outcome in outcomes { (section(outcome)) }
    };
    document(&title, &[stages::STYLE, hold::STYLE].concat(), &body)
}

fn table(outcomes: &[Outcome]) -> Markup {
    html! {
        div.wide {
            table {
                tr {
                    @for head in ["scenario", "result", "verdict", "expected"] { th { (head) } }
                    @for head in ["slip mm", "slip deg", "sag mm", "deflection mm", "torque ratio", "predicted load factor"] {
                        th.n { (head) }
                    }
                    th { "recording" }
                }
                @for outcome in outcomes { (row(outcome)) }
            }
        }
    }
}

fn row(outcome: &Outcome) -> Markup {
    let (name, status, verdict) = (outcome.name(), outcome.status(), outcome.verdict());
    let text = |value: Option<String>| value.unwrap_or_else(|| NO_FIGURE.to_owned());
    let figure = |value: Option<f64>| text(value.map(|value| format!("{value:.2}")));
    let checked = |kind| figure(verdict.and_then(|verdict| verdict.check(kind)).map(|check| check.value));
    let load = match outcome {
        Outcome::Judged { predicted_load_factor, .. } => *predicted_load_factor,
        _ => None,
    };
    html! {
        tr {
            td.name { a href={ "#" (name) } { (name) } }
            td class=(status.name()) { (status.mark()) }
            td { (text(verdict.map(|verdict| verdict.verdict.to_string()))) }
            td { (text(verdict.map(|verdict| verdict.expected.to_string()))) }
            @for kind in FIGURES {
                td.n { (checked(kind)) }
            }
            td.n { (figure(load)) }
            td {
                @match recording_link(outcome) {
                    Some(link) => a href=(link) { ".rrd" },
                    None => (NO_FIGURE),
                }
            }
        }
    }
}

fn section(outcome: &Outcome) -> Markup {
    let (name, status) = (outcome.name(), outcome.status());
    let open = matches!(status, Status::Failed | Status::Crashed).then_some("open");
    html! {
        details id=(name) open=[open] {
            summary {
                h2 { (name) } " " span class=(status.name()) { (status.mark()) } " " (outcome.sentence())
            }
            @if let Outcome::Judged { verdict, posture, measures, scores, clearance, pictures, .. } = outcome {
                @if let Some(pictures) = pictures { (pictures.markup()) }
                (checks(verdict))
                @if let Some(confirmation) = &verdict.confirmation { p { "Confirmation: " (confirmation) } }
                @if let Some(figures) = posture { (person(figures)) }
                @if let Some(scores) = scores { p { "Posture: " (scores) } }
                @if let Some(work) = &verdict.muscles {
                    p { (muscles::sentence(work)) }
                    (PreEscaped(muscles::svg(work)))
                }
                @if let Some(clearance) = clearance { p { "Planned clearance of the robot: " (clearance) } }
                @if let Some(measures) = measures { (plots(verdict, measures)) }
                p.quiet { (origin(verdict)) }
            }
        }
    }
}

/// How the person stands and sees the work.
fn person(figures: &PostureFigures) -> Markup {
    html! {
        div.wide {
            table {
                tr {
                    @for (column, head) in posture::HEAD.iter().enumerate() { th.n[column > 1] { (head) } }
                }
                @for (constraint, figure) in figures.iter() {
                    tr {
                        @for (column, cell) in posture::row(constraint, &figure).iter().enumerate() {
                            td.n[column > 1] { (cell) }
                        }
                    }
                }
            }
        }
    }
}

/// Versions, seed and fingerprint of a verdict.
fn origin(verdict: &Verdict) -> String {
    let versions: Vec<_> = verdict.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    let trace = verdict.fingerprint.get(..16).unwrap_or("none");
    format!("{}; seed {}; trace {trace}", versions.join(", "), verdict.seed)
}

fn checks(verdict: &Verdict) -> Markup {
    html! {
        @if !verdict.checks.is_empty() {
            table {
                tr {
                    th { "check" }
                    th { "unit" }
                    @for head in ["value", "limit", "margin"] { th.n { (head) } }
                    th {}
                }
                @for check in &verdict.checks {
                    tr {
                        td { (check.name) }
                        td { (check.unit) }
                        td.n { (format!("{:.3}", check.value)) }
                        td.n { (check.limit_text()) }
                        td.n { (format!("{:.3}", check.margin)) }
                        td.failed { @if !check.passed { "FAIL" } }
                    }
                }
            }
        }
    }
}

fn plots(verdict: &Verdict, measures: &Measures) -> Markup {
    let hands = |series: for<'a> fn(&'a HandMeasures) -> &'a [f64]| {
        let hands = measures.hands.iter().zip(HANDS.into_iter().cycle());
        hands.map(|(hand, class)| Line { name: &hand.name, class, values: series(hand) }).collect::<Vec<_>>()
    };
    // Only of measured grippers.
    let measured = hands(|hand| &hand.grip_ratio).into_iter().filter(|line| !line.values.is_empty()).collect();
    let sag = Line { name: "tool point", class: "board", values: &measures.sag_mm };
    let deflection = Line { name: "tool point", class: "board", values: &measures.deflection_mm };
    let clearance = Line { name: "least distance", class: "board", values: &measures.clearance_mm };
    let load = Line { name: "multiple of the load", class: "load", values: &measures.load_factor };
    let joints = by_torque(verdict, measures).into_iter().zip(JOINTS);
    let joints = joints.map(|(joint, class)| Line { name: &joint.name, class, values: &joint.torque_ratio });
    let plots = [
        ("slip of the hands on the board", "slip", Some(CheckKind::Slip), hands(|hand| &hand.slip_mm)),
        ("rotation of the hands on the board", "rotation", Some(CheckKind::SlipRotation), hands(|hand| &hand.slip_deg)),
        ("wrench of the grippers", "wrench / limits", Some(CheckKind::GripWrench), measured),
        ("sag of the tool point", "sag", Some(CheckKind::Sag), vec![sag]),
        ("deflection of the tool point", "deflection", Some(CheckKind::Deflection), vec![deflection]),
        ("torque of the most loaded joints", "torque / limit", Some(CheckKind::TorqueRatio), joints.collect()),
        ("clearance of the robot", "clearance", Some(CheckKind::Clearance), vec![clearance]),
        ("applied load", "load factor", None, vec![load]),
    ];
    let is_measured = |lines: &[Line<'_>]| lines.iter().any(|line| !line.values.is_empty());
    let plot = |(title, quantity, kind, lines): (_, &str, Option<CheckKind>, _)| {
        let limit = kind.and_then(|kind| verdict.check(kind)).map(|check| check.limit);
        let failed = verdict.first_failure.as_ref().filter(|failure| Some(failure.check) == kind);
        let failed_s = failed.map(|failure| failure.time_s);
        let unit = kind.map_or("", CheckKind::unit);
        let axis = if unit.is_empty() { format!("{quantity}, 1") } else { format!("{quantity}, {unit}") };
        let unit = if unit == "1" { "" } else { unit };
        let (time_s, judged) = (&measures.time_s[..], measures.judged);
        Plot { title, axis: &axis, unit, time_s, judged, lines, limit, failed_s }.svg()
    };
    html! {
        div.plots {
            @for svg in plots.into_iter().filter(|(.., lines)| is_measured(lines)).map(plot) { (PreEscaped(svg)) }
        }
    }
}

fn by_torque<'a>(verdict: &Verdict, measures: &'a Measures) -> Vec<&'a JointMeasures> {
    let peak = |joint: &JointMeasures| verdict.peak_torque_ratio.get(&joint.name).copied().unwrap_or(0.0);
    let mut joints: Vec<_> = measures.joints.iter().collect();
    joints.sort_by(|a, b| peak(b).total_cmp(&peak(a)));
    joints
}
