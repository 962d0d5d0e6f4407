//! A sweep as one HTML page, in the style of the report of a run: it works offline and contains no scripts.

use maud::{Markup, PreEscaped, html};

use super::{super::html::document, charts, console::decided, sentence};
use crate::{
    model::sweep::{Distribution, Variable},
    sweep::{
        record::RunRecord,
        summary::{SweepSummary, WorstRun},
    },
};

/// What this page has beyond the style of the report of a run.
const STYLE: &str = "\
h2 { display: block; margin: 1.6rem 0 .4rem; } table { margin: .4rem 0; }
.sweep rect.held { fill: var(--hand-0); } .sweep rect.other { fill: var(--limit); }
.sweep line.held { stroke: var(--hand-0); } .sweep line.other { stroke: var(--limit); } .sweep line.key { stroke-width: 6; }
.sweep line.error { stroke: var(--text); stroke-width: 1.2; } svg.indices { max-width: 34rem; }
";

/// `report.html`.
#[must_use]
pub fn report_page(
    summary: &SweepSummary,
    records: &[RunRecord],
    recordings: &dyn Fn(u64) -> Option<String>,
) -> String {
    let info = &summary.info;
    let title = format!("Benchdog: {} sweep", info.name);
    let result = match summary.met {
        Some(true) => ("ok", "ok"),
        Some(false) => ("failed", "FAIL"),
        None => ("", ""),
    };
    let body = html! {
        p.made { "Made by benchdog " (env!("CARGO_PKG_VERSION")) ". Equal sweeps give equal pages." }
        p { @if !result.1.is_empty() { span class=(result.0) { (result.1) } " " } strong { (sentence(summary)) } "." }
        p { (decided(summary)) "." }
        (verdicts(summary))
        (figures(summary, records))
        h2 { "What matters" }
        (PreEscaped(charts::importance(summary)))
        h2 { "Prediction and simulation" }
        p { "Over the " (summary.agreement.runs) " simulated runs." }
        div.plots { (PreEscaped(charts::agreement(&summary.agreement))) }
        (quantiles(summary))
        (worst(summary, recordings))
        (variables(summary))
        p.quiet {
            (info.runs) " runs, " (format!("{:?}", info.sampling).to_lowercase()) " points, seed " (info.seed)
            @if let Some(shard) = info.shard { ", part " (shard) }
            @if let Some(screen) = info.screen { "; simulated over predicted failing load " (format!("{:.3}", screen.ratio)) }
            ". Program " code { (short(&info.fingerprints.program)) } ", inputs " code { (short(&info.fingerprints.inputs)) } "; "
            (info.versions.iter().map(|(name, version)| format!("{name} {version}")).collect::<Vec<_>>().join(", ")) "."
        }
    };
    document(&title, STYLE, &body)
}

fn short(fingerprint: &str) -> &str {
    fingerprint.get(..12).unwrap_or(fingerprint)
}

fn verdicts(summary: &SweepSummary) -> Markup {
    let share = |runs: u64| format!("{:.1} %", 100.0 * runs as f64 / summary.done.max(1) as f64);
    html! {
        div.wide {
            table {
                tr { th { "verdict" } th.n { "runs" } th.n { "share" } th { "first limit crossed" } th.n { "runs" } }
                @let checks: Vec<_> = summary.first_checks.iter().collect();
                @for row in 0..summary.verdicts.len().max(checks.len()) {
                    tr {
                        @match summary.verdicts.iter().nth(row) {
                            Some((verdict, &runs)) => { td { (verdict) } td.n { (runs) } td.n { (share(runs)) } },
                            None => { td {} td {} td {} },
                        }
                        @match checks.get(row) {
                            Some((check, runs)) => { td { (check) } td.n { (runs) } },
                            None => { td {} td {} },
                        }
                    }
                }
            }
        }
    }
}

/// Histograms of load factor and deflection.
fn figures(summary: &SweepSummary, records: &[RunRecord]) -> Markup {
    let held = |run: &RunRecord| run.verdict == summary.info.expect.verdict;
    let predicted: Vec<(f64, bool)> =
        records.iter().filter_map(|run| Some((run.predicted?.load_factor, held(run)))).collect();
    let deflections: Vec<(f64, bool)> =
        records.iter().filter_map(|run| Some((run.measured?.deflection_mm, held(run)))).collect();
    let slips: Vec<(f64, bool)> = records.iter().filter_map(|run| Some((run.measured?.slip_mm, held(run)))).collect();
    html! {
        h2 { "Distributions" }
        div.plots {
            (PreEscaped(charts::histogram("Predicted load factor, all runs", "load factor, 1", &predicted, Some((1.0, "the load")))))
            (PreEscaped(charts::histogram("Deflection, simulated runs", "deflection, mm", &deflections, None)))
            (PreEscaped(charts::histogram("Slip, simulated runs", "slip, mm", &slips, None)))
        }
    }
}

fn quantiles(summary: &SweepSummary) -> Markup {
    html! {
        h2 { "Quantiles" }
        p { "All but the load factor are of simulated runs: those near to failing, if the statics decided others." }
        div.wide {
            table {
                tr {
                    th { "figure" } th.n { "runs" }
                    @for at in ["least", "1 %", "5 %", "25 %", "50 %", "75 %", "95 %", "99 %", "most"] { th.n { (at) } }
                }
                @for of in &summary.quantiles {
                    tr { td { (of.figure) } td.n { (of.runs) } @for value in &of.values { td.n { (format!("{value:.3}")) } } }
                }
            }
        }
    }
}

fn worst(summary: &SweepSummary, recordings: &dyn Fn(u64) -> Option<String>) -> Markup {
    let unusual = |run: &WorstRun| {
        let named = run.unusual.iter().map(|(name, sds)| format!("{name} {sds:+.1} sd"));
        named.collect::<Vec<_>>().join(", ")
    };
    let figure = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
    html! {
        @if !summary.worst.is_empty() {
            h2 { "Worst runs" }
            div.wide {
                table {
                    tr { th.n { "run" } th { "verdict" } th.n { "fails at" } th.n { "load factor" } th { "unusual values" } th { "recording" } }
                    @for run in &summary.worst {
                        tr {
                            td.n { (run.run) } td { (run.verdict) } td.n { (figure(run.failed_at)) } td.n { (figure(run.load_factor)) }
                            td { (unusual(run)) }
                            td { @match recordings(run.run) { Some(link) => a href=(link) { ".rrd" }, None => "–" } }
                        }
                    }
                }
            }
        }
    }
}

fn variables(summary: &SweepSummary) -> Markup {
    html! {
        h2 { "What varies" }
        div.wide {
            table {
                tr { th { "quantity" } th { "distribution" } th { "bounds" } th.n { "correlation" } th { "source" } }
                @for variable in &summary.info.variables {
                    tr {
                        td.name { (variable.name()) }
                        td { (distribution(&variable.distribution)) }
                        td { (bounds(variable)) }
                        td.n { (variable.correlation.map_or(String::new(), |of| of.to_string())) }
                        td.quiet { (variable.source.as_deref().unwrap_or("the scenario")) }
                    }
                }
            }
        }
    }
}

fn distribution(of: &Distribution) -> String {
    match of {
        Distribution::Normal { mean, sd } => format!("normal, mean {mean}, deviation {sd}"),
        Distribution::Uniform { low, high } => format!("uniform from {low} to {high}"),
        Distribution::LogNormal { median, sd_log } => {
            format!("log-normal, median {median}, deviation {sd_log} of the logarithm")
        }
        Distribution::Triangular { low, mode, high } => format!("triangular from {low} over {mode} to {high}"),
        Distribution::Discrete { values, .. } => format!("{} values", values.len()),
        Distribution::Measured { values } => format!("{} measured values", values.len()),
    }
}

fn bounds(variable: &Variable) -> String {
    match (variable.min, variable.max) {
        (None, None) => String::new(),
        (min, max) => {
            let end = |end: Option<f64>| end.map_or("–".to_owned(), |end| end.to_string());
            format!("{} to {}", end(min), end(max))
        }
    }
}
