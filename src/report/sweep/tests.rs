//! The reports of sweeps that are made here, whose results are known.

use std::collections::BTreeMap;

use super::*;
use crate::{
    model::{
        scenario::Expectation,
        sweep::{Distribution, Quantity, Sampling, Variable},
        verdict::{CheckKind, VerdictKind},
    },
    sweep::{
        Dimension,
        info::{Fingerprints, SweepInfo},
        record::{Decided, MeasuredRun, PredictedRun, RunRecord},
        summary::summarise,
    },
};

fn variable(quantity: Quantity) -> Variable {
    let distribution = Distribution::Uniform { low: 0.5, high: 1.5 };
    Variable { quantity, distribution, min: None, max: None, nominal: None, correlation: None, source: None }
}

fn dimension(name: &str, quantity: Quantity) -> Dimension {
    Dimension { name: name.into(), quantity, unit: "a factor".into() }
}

fn info(probability: Option<f64>) -> SweepInfo {
    SweepInfo {
        format: 1,
        name: "a <b> & \"c\"".into(),
        expect: Expectation { verdict: VerdictKind::Holds, probability, confidence: 0.95 },
        runs: 200,
        until: None,
        sampling: Sampling::Independent,
        seed: 4,
        shard: None,
        screen: None,
        recorded: 2,
        variables: vec![variable(Quantity::Force), variable(Quantity::Friction)],
        dimensions: vec![dimension("force_factor", Quantity::Force), dimension("friction_factor", Quantity::Friction)],
        fingerprints: Fingerprints { program: "a".repeat(64), inputs: "b".repeat(64) },
        versions: BTreeMap::from([("benchdog".into(), "0.0.0".into())]),
    }
}

/// 200 runs, of which those with the largest forces, a quarter, fail: the load factor is 2 minus the force. The friction, which
/// goes through its values 7 times, does not matter.
fn records() -> Vec<RunRecord> {
    let run = |index: u64| {
        let force = 0.5 + index as f64 / 200.0;
        let fails = index >= 150;
        let measured = MeasuredRun {
            slip_mm: 0.1,
            slip_deg: 0.2,
            deflection_mm: 4.0 * force,
            torque_ratio: 0.3,
            failed_at: fails.then_some(2.0 - force),
            first_check: fails.then_some(CheckKind::Deflection),
        };
        RunRecord {
            index,
            values: vec![force, 0.5 + (index * 7 % 200) as f64 / 200.0],
            predicted: Some(PredictedRun { load_factor: 2.0 - force, deflection_mm: 1.0 }),
            decided: Decided::Simulated,
            verdict: if fails { VerdictKind::Deflects } else { VerdictKind::Holds },
            measured: Some(measured),
        }
    };
    (0..200).map(run).collect()
}

fn page(probability: Option<f64>) -> String {
    let link = |run: u64| (run == 199).then(|| format!("recordings/run-{run:06}.rrd"));
    report_page(&summarise(&info(probability), &records()), &records(), &link)
}

/// The numbers of an attribute of the elements that start so.
fn numbers(page: &str, element: &str, attribute: &str) -> Vec<f64> {
    let number = |rest: &str| rest.split_once(attribute)?.1.split('"').next()?.parse().ok();
    page.split(element).skip(1).filter_map(number).collect()
}

/// The part of the page with the chart of this name.
fn chart<'a>(page: &'a str, name: &str) -> &'a str {
    let start = page.find(&format!("aria-label=\"{name}")).unwrap_or_else(|| panic!("no chart {name}"));
    page[start..].split("</svg>").next().unwrap()
}

#[test]
fn the_sentence_has_probability_interval_confidence_and_expectation() {
    // Wilson's interval of 150 of 200: (0.75 + z^2 / 400 -+ z sqrt(0.1875 / 200 + z^2 / 160000)) / (1 + z^2 / 200), z = 1.95996.
    let of = |probability| sentence(&summarise(&info(probability), &records()));
    assert_eq!(of(None), "holds with probability 0.7500, 0.6857 to 0.8049 at 95 % confidence");
    assert!(of(Some(0.99)).ends_with(" at 95 % confidence, expected at least 0.99"));
}

#[test]
fn the_page_says_whether_the_expectation_is_met() {
    let mark = |probability, mark: &str| page(probability).contains(mark);
    assert!(mark(Some(0.6), "<span class=\"ok\">ok</span>") && mark(Some(0.7), "<span class=\"failed\">FAIL</span>"));
    assert!(!mark(None, "<span class=\"ok\">") && !mark(None, "<span class=\"failed\">"));
}

#[test]
fn equal_sweeps_give_equal_pages_with_escaped_names() {
    let page = page(None);
    assert_eq!(page, self::page(None));
    assert!(page.contains("<h1>Benchdog: a &lt;b&gt; &amp; &quot;c&quot; sweep</h1>"));
    assert!(!page.contains("<b>") && !page.contains("NaN") && !page.contains("<script"));
}

#[test]
fn the_page_links_the_recordings_that_exist() {
    let page = page(None);
    assert_eq!(page.matches("href=").count(), 1);
    assert!(page.contains("<a href=\"recordings/run-000199.rrd\">.rrd</a>"));
}

/// All heights of bars, in units of the axis, sum to the number of runs.
#[test]
fn the_histogram_counts_every_run_by_its_outcome() {
    let page = page(None);
    let chart = chart(&page, "Predicted load factor, all runs");
    let sum = |class: &str| numbers(chart, &format!("<rect class=\"{class}\""), "height=\"").iter().sum::<f64>();
    let (held, other) = (sum("held"), sum("other"));
    // Heights are rounded to 0.1 px in 36 bins, which shifts each sum by at most 1.8 px.
    assert!(held > 0.0 && (other / (held + other) - 0.25).abs() < 3.6 / (held + other), "{held} {other}");
}

/// The prediction is perfect: its curve goes up at 0 and right at 1.
#[test]
fn the_curve_of_a_perfect_prediction_is_a_corner() {
    let page = page(None);
    let chart = chart(&page, "Prediction against simulation: area 1.000");
    let points = chart.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
    let on_edge = |point: &str| point.starts_with("60.0,") || point.ends_with(",26.0");
    assert!(points.split(' ').count() > 10 && points.split(' ').all(on_edge), "{points}");
}

#[test]
fn the_console_lists_what_matters_and_no_negative_share() {
    let mut summary = summarise(&info(None), &records());
    let text = text(&summary);
    assert!(text.contains("\nverdict   runs   share\nholds      150  75.0 %\ndeflects    50  25.0 %\n"), "{text}");
    let listed = |text: &str, name: &str| text.lines().any(|line| line.starts_with(name) && line.contains(" ± "));
    assert!(listed(&text, "force_factor") && text.contains("\n000199     deflects at 0.50 of the load  "), "{text}");
    assert!(text.contains("\nprediction: 1.000 of the area under its curve over 200 simulated runs\n"));
    summary.importance[0].holds.value = -0.05;
    let text = super::text(&summary);
    assert!(text.contains("  0.0 ± ") && !text.contains(" -5.0"), "{text}");
}

#[test]
fn no_run_gives_a_page_without_charts_of_runs() {
    let summary = summarise(&info(None), &[]);
    let page = report_page(&summary, &[], &|_| None);
    assert!(page.contains("holds with probability 0.0000, 0.0000 to 1.0000") && !page.contains("NaN"), "{page}");
    assert!(text(&summary).starts_with("a <b> & \"c\": holds with probability 0.0000"));
}

#[cfg(feature = "cli")]
#[test]
fn the_test_case_fails_with_the_sentence() {
    let of = |probability| junit(&summarise(&info(probability), &records())).unwrap();
    assert!(of(Some(0.6)).contains("failures=\"0\"") && of(None).contains("failures=\"0\""));
    let failed = of(Some(0.9));
    assert!(failed.contains("failures=\"1\"") && failed.contains("expected at least 0.9"), "{failed}");
}
