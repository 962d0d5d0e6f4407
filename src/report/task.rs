//! Tables and page of a staged plan and its verdict.

use maud::{Markup, PreEscaped, html};

use super::{
    columns::aligned,
    comparison::{self, Comparison},
    csv_text::{cell, csv_text},
    html::document,
    plot::{Line, Plot},
    stages::{self, JudgedPlan},
};
use crate::{
    human::HumanError,
    model::{
        staged_plan::StagedPlan,
        staged_trace::StagedTrace,
        staged_verdict::{PersonOverTask, StageVerdict, StagedVerdict},
        trace::Sample,
        verdict::{CheckKind, VerdictKind},
    },
};

/// The checks in tables of stages.
const FIGURES: [CheckKind; 4] =
    [CheckKind::Slip, CheckKind::SlipRotation, CheckKind::Deflection, CheckKind::TorqueRatio];

/// Every n-th sample is in the plots: one each 10 ms at the usual time step.
const PLOTTED_EVERY: usize = 5;

/// One row per piece of the path: stage, place, objective and its share of that of the best hold for this piece alone, comforts,
/// effort, and the predicted load factor.
#[must_use]
pub fn path_csv(plan: &StagedPlan, best: &[Option<f64>]) -> String {
    let header = [
        "piece",
        "stage",
        "stroke",
        "from_m",
        "to_m",
        "objective",
        "kept",
        "muscular_regularised",
        "peripersonal_m",
        "effort",
        "compliant_load_factor",
        "x_m",
        "y_m",
    ];
    let rows = plan.worked_pieces().enumerate().map(|(number, (stage, worked))| {
        let comfort = worked.comfort.as_ref();
        let objective = comfort.map(|comfort| comfort.objective);
        let best = best.get(number).copied().flatten();
        let place = worked.human.as_ref().map(|human| human.x_wb.translation.vector);
        vec![
            (number + 1).to_string(),
            (stage + 1).to_string(),
            (worked.piece.stroke + 1).to_string(),
            format!("{:.4}", worked.piece.from_m),
            format!("{:.4}", worked.piece.to_m),
            cell(objective, 4),
            cell(objective.zip(best).map(|(objective, best)| objective / best), 4),
            cell(comfort.map(|comfort| comfort.muscular_regularised), 4),
            cell(comfort.map(|comfort| comfort.peripersonal_m), 4),
            cell(worked.muscles.as_ref().map(|muscles| muscles.effort), 6),
            cell(worked.stability.as_ref().map(|stability| stability.compliant_load_factor), 4),
            cell(place.map(|place| place.x), 4),
            cell(place.map(|place| place.y), 4),
        ]
    });
    csv_text(&header, rows)
}

/// One row per judged stage with its checks.
#[must_use]
pub fn stages_csv(verdict: &StagedVerdict) -> String {
    let header = ["stage", "kind", "from_s", "to_s", "verdict"].into_iter().map(str::to_owned);
    let header: Vec<String> = header.chain(FIGURES.iter().map(|kind| format!("{kind}_{}", unit(*kind)))).collect();
    let rows = verdict.stages.iter().map(|stage| {
        let StageVerdict { stage: number, kind, from_s, to_s, verdict, .. } = stage;
        let first =
            vec![number.to_string(), kind.clone(), format!("{from_s:.3}"), format!("{to_s:.3}"), verdict.to_string()];
        first.into_iter().chain(FIGURES.map(|kind| figure(stage, kind, 4))).collect()
    });
    csv_text(&header, rows)
}

fn unit(kind: CheckKind) -> &'static str {
    if kind.unit() == "1" { "ratio" } else { kind.unit() }
}

fn figure(stage: &StageVerdict, kind: CheckKind, digits: usize) -> String {
    let check = stage.checks.iter().find(|check| check.name == kind);
    check.map_or_else(String::new, |check| format!("{:.digits$}", check.value))
}

/// The stages in a table for the console, then the verdict, its confirmation and the person.
#[must_use]
pub fn table(verdict: &StagedVerdict) -> String {
    let header = ["stage", "kind", "verdict", "from s", "to s", "slip mm", "slip deg", "deflection mm", "torque ratio"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    rows.extend(verdict.stages.iter().map(|stage| {
        let times = [stage.from_s, stage.to_s].map(|time_s| format!("{time_s:.1}"));
        let first = [stage.stage.to_string(), stage.kind.clone(), stage.verdict.to_string()];
        first.into_iter().chain(times).chain(FIGURES.map(|kind| figure(stage, kind, 2))).collect()
    }));
    let mut text = aligned(&rows, 3);
    text.push_str(&summary(verdict));
    text.push('\n');
    text.extend(verdict.confirmation.as_ref().map(|confirmation| format!("confirmation: {confirmation}\n")));
    text.extend(verdict.person.as_ref().map(|person| format!("{}\n", person_in_words(person))));
    text
}

/// `whole-circle: holds; 5 motions, 8 regrasps, 240.1 s`.
fn summary(verdict: &StagedVerdict) -> String {
    let StagedVerdict { name, verdict: kind, moves, regrasps, duration_s, failed, .. } = verdict;
    let failed = failed
        .as_ref()
        .map_or_else(String::new, |failed| format!(" in stage {} ({}): {}", failed.stage, failed.kind, failed.reason));
    format!("{name}: {kind}{failed}; {moves} motions, {regrasps} regrasps, {duration_s:.1} s simulated")
}

fn person_in_words(person: &PersonOverTask) -> String {
    let PersonOverTask { mean_objective, least_objective, mean_effort, accumulated_effort_s, largest_step_m, .. } =
        person;
    format!(
        "person: objective {mean_objective:.1} in the mean, {least_objective:.1} at least; effort {mean_effort:.4} in the \
         mean, {accumulated_effort_s:.3} s accumulated; largest step {largest_step_m:.2} m"
    )
}

/// The report as one page: summary, timeline, comfort along the path, the comparison with other strategies if there is one, pictures
/// of the stages and their checks.
///
/// # Errors
/// If the person or the tool is invalid.
pub fn page(
    judged: &JudgedPlan<'_>,
    trace: Option<&StagedTrace>,
    comparison: Option<&Comparison>,
) -> Result<String, HumanError> {
    let JudgedPlan { plan, verdict, .. } = *judged;
    let body = html! {
        p.made { "Made by benchdog " (env!("CARGO_PKG_VERSION")) ". Equal runs give equal pages." }
        p { (summary(verdict)) "." }
        @if let Some(confirmation) = &verdict.confirmation { p { "Confirmation: " (confirmation) "." } }
        @if let Some(person) = &verdict.person { p { (person_in_words(person)) "." } }
        h2 { "Timeline" }
        (timeline(verdict))
        h2 { "Along the path" }
        (path(plan))
        @if let Some(comparison) = comparison { (comparison::section(comparison)) }
        @if let Some(trace) = trace { h2 { "Load and distance" } (plots(trace)) }
        h2 { "Stages" }
        (stages::pictures(judged)?)
        h2 { "Checks" }
        (checks(verdict))
    };
    let of_comparison = if comparison.is_some() { comparison::STYLE } else { "" };
    let style = [STYLE, stages::STYLE, of_comparison].concat();
    Ok(document(&format!("Benchdog task: {}", verdict.name), &style, &body))
}

/// The colours of the kinds of stages.
const STYLE: &str = "svg.stages rect.hold{fill:#4c8c4a}svg.stages rect.move{fill:#3f7cac}svg.stages rect.regrasp{fill:#d08c2f}\
                     svg.stages rect.failed{fill:#c8102e}svg.stages text{fill:currentColor;font-size:11px}\
                     svg.path rect{fill:#4c8c4a}svg.path text{fill:currentColor;font-size:11px}";

/// Width of the drawings, px.
const WIDTH_PX: f64 = 920.0;

/// Every stage as a rectangle over time, by its kind.
fn timeline(verdict: &StagedVerdict) -> Markup {
    let scale = WIDTH_PX / verdict.duration_s.max(1e-9);
    let class = |stage: &StageVerdict| {
        if stage.verdict == VerdictKind::Holds { stage.kind.clone() } else { "failed".to_owned() }
    };
    html! {
        svg.stages viewBox={ "0 0 " (WIDTH_PX) " 56" } role="img" aria-label="stages over time" {
            @for stage in &verdict.stages {
                a href={ "#stage-" (stage.stage) } {
                    rect class=(class(stage)) x=(format!("{:.1}", stage.from_s * scale)) y="4" height="30"
                        width=(format!("{:.1}", ((stage.to_s - stage.from_s) * scale - 1.0).max(0.5))) {
                        title { "stage " (stage.stage) ", " (stage.kind) ": " (stage.verdict.to_string()) }
                    }
                }
            }
            text x="0" y="50" { "0 s; holds green, motions blue, regrasps orange, a stage that fails red" }
            text x=(WIDTH_PX) y="50" text-anchor="end" { (format!("{:.0} s", verdict.duration_s)) }
        }
    }
}

/// The objective of every piece as a bar.
fn path(plan: &StagedPlan) -> Markup {
    let objectives: Vec<_> =
        plan.worked_pieces().map(|(stage, worked)| (stage, worked.comfort.map(|c| c.objective))).collect();
    let top = objectives.iter().filter_map(|(_, objective)| *objective).fold(1e-9, f64::max);
    let width = WIDTH_PX / objectives.len().max(1) as f64;
    html! {
        svg.path viewBox={ "0 -16 " (WIDTH_PX) " 172" } role="img" aria-label="objective along the path" {
            @for (number, (stage, objective)) in objectives.iter().enumerate() {
                @let height = 110.0 * objective.unwrap_or(0.0) / top;
                rect x=(format!("{:.1}", number as f64 * width)) y=(format!("{:.1}", 120.0 - height))
                    width=(format!("{:.1}", width - 2.0)) height=(format!("{height:.1}")) {
                    title { "piece " (number + 1) ", stage " (stage + 1) }
                }
                text x=(format!("{:.1}", (number as f64 + 0.5) * width)) y="134" text-anchor="middle" { (stage + 1) }
            }
            text x="0" y="-4" { "objective, 1: up to " (format!("{top:.1}")) }
            text x="0" y="148" { "pieces of the path, numbered by stage; the objective of the person's posture at each" }
        }
    }
}

/// Load factor and distances over time.
fn plots(trace: &StagedTrace) -> Markup {
    let samples: Vec<_> = trace.trace.samples.iter().step_by(PLOTTED_EVERY).collect();
    let time_s: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
    let load: Vec<f64> = samples.iter().map(|sample| sample.load_factor).collect();
    // Nothing is measured before the first step.
    let distance_mm = |sample: &&Sample| sample.person_distance_m.map(|distance_m| 1e3 * distance_m);
    let person: Option<Vec<f64>> = samples.iter().skip(1).map(distance_mm).collect();
    let plot = |title: &str, axis: &str, values: &[f64]| {
        let lines = vec![Line { name: "", class: "hand-0", values }];
        let time_s = &time_s[time_s.len() - values.len()..];
        Plot { title, axis, unit: "", time_s, judged: time_s.len(), lines, limit: None, failed_s: None }.svg()
    };
    html! {
        div.plots {
            (PreEscaped(plot("applied load", "load factor, 1", &load)))
            @if let Some(person) = person { (PreEscaped(plot("distance from the person", "distance, mm", &person))) }
        }
    }
}

/// The stages with their checks.
fn checks(verdict: &StagedVerdict) -> Markup {
    html! {
        div.wide {
            table {
                tr {
                    th { "stage" } th { "kind" } th { "verdict" } th.n { "from s" } th.n { "to s" }
                    @for kind in FIGURES { th.n { (kind.to_string()) " " (unit(kind)) } }
                }
                @for stage in &verdict.stages {
                    tr {
                        td { (stage.stage) } td { (stage.kind) } td { (stage.verdict.to_string()) }
                        td.n { (format!("{:.1}", stage.from_s)) } td.n { (format!("{:.1}", stage.to_s)) }
                        @for kind in FIGURES { td.n { (figure(stage, kind, 2)) } }
                    }
                }
            }
        }
    }
}
