//! Reports compared word for word.

use std::{collections::BTreeMap, fs, path::Path};

use super::*;
use crate::model::{
    muscle_work::{BusyMuscle, MuscleWork},
    verdict::{Check, CheckKind, Failure},
};

fn check(name: CheckKind, value: f64, limit: f64) -> Check {
    Check {
        name,
        value,
        limit,
        margin: name.margin(value, limit),
        unit: name.unit().into(),
        passed: name.margin(value, limit) >= 0.0,
    }
}

fn holding() -> Verdict {
    Verdict {
        format: 1,
        criteria: 1,
        name: "drill-center".into(),
        verdict: VerdictKind::Holds,
        expected: VerdictKind::Holds,
        met: true,
        checks: vec![
            check(CheckKind::Slip, 0.125, 1.0),
            check(CheckKind::SlipRotation, 0.5, 2.0),
            check(CheckKind::Deflection, 1.5, 5.0),
            check(CheckKind::TorqueRatio, 0.75, 1.0),
        ],
        self_checks: Vec::new(),
        first_failure: None,
        peak_torque_ratio: BTreeMap::from([("left_s0".into(), 0.25), ("left_w1".into(), 0.75)]),
        confirmation: None,
        reason: None,
        notes: Vec::new(),
        muscles: None,
        versions: BTreeMap::from([("benchdog".into(), "0.1.0".into())]),
        seed: 1,
        fingerprint: "00ff".into(),
    }
}

fn deflecting() -> Verdict {
    let mut checks = holding().checks;
    checks[2] = check(CheckKind::Deflection, 16.25, 15.0);
    Verdict {
        name: "cut-03".into(),
        verdict: VerdictKind::Deflects,
        met: false,
        checks,
        first_failure: Some(Failure { check: CheckKind::Deflection, time_s: 1.32, load_factor: 0.82 }),
        ..holding()
    }
}

fn infeasible() -> Verdict {
    Verdict {
        name: "too-heavy".into(),
        verdict: VerdictKind::Infeasible,
        met: false,
        checks: Vec::new(),
        peak_torque_ratio: BTreeMap::new(),
        reason: Some("no candidate of 400 is stable".into()),
        notes: Vec::new(),
        ..holding()
    }
}

/// A judged outcome without anything but its verdict.
fn judged(verdict: Verdict) -> Outcome {
    Outcome::Judged {
        verdict: Box::new(verdict),
        predicted_load_factor: None,
        posture: None,
        scores: None,
        clearance: None,
        measures: None,
        pictures: None,
        recording: None,
    }
}

fn outcomes() -> Vec<Outcome> {
    let judged = |verdict, predicted_load_factor| Outcome::Judged {
        verdict: Box::new(verdict),
        predicted_load_factor,
        posture: None,
        scores: predicted_load_factor.map(|_| "RULA 3 (arm and wrist 4), REBA 5".into()),
        clearance: None,
        measures: None,
        pictures: None,
        recording: None,
    };
    vec![
        judged(holding(), Some(3.7)),
        judged(deflecting(), None),
        judged(infeasible(), None),
        Outcome::Crashed { name: "bad.toml".into(), message: "line 3: found \"x\", expected a number".into() },
        Outcome::Skipped { name: "cut-04".into(), reason: SkipReason::Filtered },
    ]
}

#[test]
fn the_hint_names_each_unexpected_verdict_once() {
    use VerdictKind::{Pivots, Slips};
    assert_eq!(console::hint([]), "");
    for kinds in [vec![Pivots], vec![Pivots; 3]] {
        assert_eq!(console::hint(kinds), "benchdog explain pivots says what this means and what helps\n");
    }
    let two = "benchdog explain NAME says what a verdict means and what helps: pivots, slips\n";
    assert_eq!(console::hint([Pivots, Slips, Pivots]), two);
}

#[test]
fn the_table_lists_complains_and_counts() {
    let expected = "\
scenario      verdict     expected  result   slip mm  slip deg  sag mm  deflection mm  torque  load  time s
drill-center  holds       holds     ok          0.12      0.50       -           1.50    0.75  3.70     2.3
cut-03        deflects    holds     FAIL        0.12      0.50       -          16.25    0.75     -    10.0
too-heavy     infeasible  holds     FAIL           -         -       -              -       -     -       -
bad.toml      -           -         ERROR          -         -       -              -       -     -       -
cut-04        -           -         skipped        -         -       -              -       -     -       -
FAIL cut-03: expected holds, found deflects: deflection 16.25 mm, limit 15 mm, first crossed at 1.320 s under 0.82 of \
         the load
FAIL too-heavy: expected holds, found infeasible: no candidate of 400 is stable
ERROR bad.toml: line 3: found \"x\", expected a number
5 scenarios: 1 ok, 2 failed, 1 crashed, 1 skipped
";
    assert_eq!(console::table(&outcomes(), &[Some(2.34), Some(9.96)]), expected);
}

#[test]
fn the_details_show_value_limit_and_margin_of_every_check() {
    let expected = "\
cut-03: deflects, expected holds: FAIL
check          unit   value   limit  margin
slip           mm     0.125   1.000   0.875
slip_rotation  deg    0.500   2.000   1.500
deflection     mm    16.250  15.000  -1.250  FAIL
torque_ratio   1      0.750   1.000   0.250
because       deflection 16.25 mm, limit 15 mm, first crossed at 1.320 s under 0.82 of the load
torque peaks  left_w1 0.75, left_s0 0.25
recording     out/cut-03.rrd
";
    assert_eq!(console::details(&deflecting(), None, Some(Path::new("out/cut-03.rrd"))), expected);
}

#[cfg(feature = "cli")]
#[test]
fn junit_tells_failures_from_errors() {
    let expected = r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites name="benchdog" tests="3" skipped="1" failures="1" errors="1">
    <testsuite name="benchdog" tests="3" skipped="1" errors="1" failures="1">
        <testcase name="too-heavy" classname="benchdog">
            <failure message="expected holds, found infeasible: no candidate of 400 is stable" type="infeasible"/>
        </testcase>
        <testcase name="bad.toml" classname="benchdog">
            <error message="line 3: found &quot;x&quot;, expected a number"/>
        </testcase>
        <testcase name="cut-04" classname="benchdog">
            <skipped message="left out by --filter"/>
        </testcase>
    </testsuite>
</testsuites>
"#;
    assert_eq!(junit::document(&outcomes()[2..]).unwrap(), expected);
    let figures = junit::document(&outcomes()[..1]).unwrap();
    assert!(figures.contains(r#"<property name="slip [mm]" value="0.1250"/>"#), "{figures}");
}

#[test]
fn json_reads_back_as_the_verdicts_it_came_from() {
    let read: Vec<Verdict> = serde_json::from_str(&json::verdicts(&outcomes())).unwrap();
    assert_eq!(read, [holding(), deflecting(), infeasible()]);
    assert_eq!(serde_json::from_str::<Verdict>(&json::verdict(&deflecting())).unwrap(), deflecting());
    assert!(json::verdict(&holding()).contains("\"name\": \"slip_rotation\""));
}

#[test]
fn files_are_written_whole_or_not_at_all() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("new/verdict.json");
    file::write_whole(&path, b"one").unwrap();
    file::write_whole(&path, b"two").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "nothing is left beside the file");

    // A directory stands where a file is wanted: the rename fails, and the message names the file.
    let taken = directory.path().join("taken");
    fs::create_dir_all(taken.join("inside")).unwrap();
    let error = file::write_whole(&taken, b"three").unwrap_err();
    assert!(error.to_string().starts_with(&format!("failed to write {}: ", taken.display())), "{error}");
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2, "nothing is left beside the directory");
}

#[test]
fn a_limit_from_below_is_shown_as_one_everywhere() {
    let mut verdict = holding();
    verdict.checks.push(check(CheckKind::Clearance, -1.25, 0.0));
    verdict.verdict = VerdictKind::Collides;
    verdict.first_failure = Some(Failure { check: CheckKind::Clearance, time_s: 1.32, load_factor: 0.82 });
    let table = console::details(&verdict, None, None);
    let row: Vec<_> = table.lines().find(|line| line.starts_with("clearance")).unwrap().split_whitespace().collect();
    assert_eq!(row, ["clearance", "mm", "-1.250", ">=", "0.000", "-1.250", "FAIL"]);
    let expected = "clearance -1.25 mm, at least 0 mm, first crossed at 1.320 s under 0.82 of the load";
    assert_eq!(explanation(&verdict), expected);
    let outcome = Outcome::Judged {
        verdict: Box::new(verdict),
        predicted_load_factor: None,
        posture: None,
        scores: None,
        clearance: Some("5.00 mm between left_wrist and the board".into()),
        measures: None,
        pictures: None,
        recording: None,
    };
    let page = html::page(&[outcome]);
    assert!(page.contains("&gt;= 0.000") && page.contains("5.00 mm between left_wrist and the board"), "{page}");
}

/// A file may be named so, and its error quote it.
#[cfg(feature = "cli")]
#[test]
fn page_and_junit_report_are_xml_whatever_names_and_messages_contain() {
    let odd = "a\0\u{1b}[31m<b>&amp;]]>\"'\u{85}\u{fffe}\u{ffff}\u{202e}";
    let outcomes = [Outcome::Crashed { name: odd.into(), message: odd.into() }];
    for text in [html::page(&outcomes), junit::document(&outcomes).unwrap()] {
        let text = text.replace("<!DOCTYPE html>", "");
        let document = roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        let shown = document.descendants().filter_map(|node| node.attribute("message").or_else(|| node.text()));
        assert!(shown.filter(|shown| shown.contains("<b>&amp;]]>")).count() > 0, "{text}");
    }
}

#[test]
fn the_page_states_the_scores_of_the_posture_where_there_are_any() {
    let page = html::page(&outcomes());
    assert_eq!(page.matches("Posture: RULA 3 (arm and wrist 4), REBA 5").count(), 1);
}

/// What the muscles do: the longest name of the file and one that ends a chart at 30 %.
fn work() -> MuscleWork {
    let muscle =
        |name: &str, region: &str, activation| BusyMuscle { name: name.into(), region: region.into(), activation };
    MuscleWork {
        effort: 0.0689,
        largest_activation: 0.24,
        endurance_s: Some(351.7),
        missing_nm: None,
        busiest: vec![
            muscle("brachialis", "front of the upper arm", 0.24),
            muscle("flexor digitorum superficialis of the little finger", "palm side of the forearm", 0.06),
        ],
    }
}

#[test]
fn the_details_tell_what_the_muscles_do() {
    let verdict = Verdict { muscles: Some(work()), ..holding() };
    let text = console::details(&verdict, None, None);
    let lines = "muscles       effort 0.069, largest activation 24 %; can be held about 6 min (estimate)
busiest       brachialis 24 %, flexor digitorum superficialis of the little finger 6 %\n";
    assert!(text.ends_with(lines), "{text}");
    let weak = MuscleWork { missing_nm: Some(1.28), ..work() };
    assert!(
        muscles::table(&weak).starts_with("muscles  effort 0.069, largest activation 24 %; cannot: 1.3 N m missing\n")
    );
}

#[test]
fn the_page_has_a_bar_as_long_as_the_activation_of_each_muscle() {
    let text = muscles::svg(&work());
    let chart = roxmltree::Document::parse(&text).unwrap();
    let class = |class| chart.descendants().filter(move |node| node.attribute("class") == Some(class));
    let number = |node: roxmltree::Node, name| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let [tracks, bars] =
        ["track", "muscle"].map(|name| class(name).map(|bar| number(bar, "width")).collect::<Vec<_>>());
    // The axis ends at 30 %. Coordinates have one digit.
    for (activation, (track, bar)) in [0.24, 0.06].iter().zip(tracks.iter().zip(&bars)) {
        assert!((bar / track - activation / 0.3).abs() < 0.1 / track, "{activation}: {bar} of {track}");
    }
    let limit = class("limit").next().unwrap();
    let bar = class("muscle").next().unwrap();
    assert!((number(limit, "x1") - number(bar, "x") - tracks[0] / 2.0).abs() < 0.1);
    let child = |name: &str| chart.root_element().children().find(|node| node.has_tag_name(name)).unwrap().text();
    assert_eq!(child("title"), Some("Activation of the busiest muscles"));
    assert_eq!(child("desc"), Some(&*work().busiest_in_words()));

    let page = |work: MuscleWork| html::page(&[judged(Verdict { muscles: Some(work), ..holding() })]);
    assert!(page(work()).contains("effort 0.069 (sum of squared activations); can be held about 6 min (by the"));
    let weak = MuscleWork { missing_nm: Some(1.28), ..work() };
    assert!(page(weak).contains("cannot: 1.3 N m missing (the muscles"));
    assert!(!html::page(&outcomes()).contains("class=\"muscles\""));
}

#[test]
fn summaries_have_effort_and_largest_activation() {
    let outcomes = [judged(Verdict { muscles: Some(work()), ..holding() }), judged(holding())];
    let text = String::from_utf8(summary::csv(&outcomes).unwrap()).unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let header = rows.headers().unwrap().clone();
    let columns = ["muscle_effort", "largest_activation"].map(|name| header.iter().position(|h| h == name).unwrap());
    let cells: Vec<_> =
        rows.records().map(|row| columns.map(|column| row.as_ref().unwrap()[column].to_owned())).collect();
    assert_eq!(cells, [["0.0689", "0.2400"], ["", ""]]);
    let json: serde_json::Value = serde_json::from_str(&summary::json(&outcomes)).unwrap();
    assert_eq!(json["outcomes"][0]["muscle_effort"], 0.0689);
    assert!(json["outcomes"][1]["largest_activation"].is_null());
}
