//! The report files of a run, also of a run that was stopped.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
};

use serde_json::Value;

#[cfg(feature = "recording")]
use crate::process::printed_json;
use crate::process::{benchdog, command, json, slipping_scenario, stderr};

const REPORTS: [&str; 4] = ["report.html", "summary.csv", "summary.json", "junit.xml"];

/// Writes scenarios whose plan slips, each with an expected verdict.
fn scenarios(folder: &Path, names: &[(&str, &str)]) {
    for (name, expected) in names {
        slipping_scenario(folder, name, expected);
    }
}

/// Writes 20 scenarios, enough to stop a run in the middle; returns their names.
fn many(folder: &Path) -> Vec<String> {
    let names: Vec<_> = (0..20).map(|number| format!("hold-{number:02}")).collect();
    names.iter().for_each(|name| drop(slipping_scenario(folder, name, "slips")));
    names
}

#[test]
fn every_scenario_is_in_every_report() {
    let folder = tempfile::tempdir().unwrap();
    scenarios(folder.path(), &[("a", "slips"), ("b", "holds"), ("left-out", "slips")]);
    let output = benchdog(folder.path(), &["run", ".", "--filter", "[ab]", "--jobs", "1"]);
    assert_eq!(output.status.code(), Some(1));
    let out = folder.path().join("out");

    let summary = json(&out.join("summary.json"));
    let counts = ["scenarios", "ok", "failed", "crashed", "skipped"].map(|key| summary[key].as_u64().unwrap());
    assert_eq!(counts, [3, 1, 1, 0, 1]);
    let verdict = json(&out.join("b/verdict.json"));
    let outcome = &summary["outcomes"][1];
    assert_eq!((&outcome["name"], &outcome["status"]), (&verdict["name"], &Value::from("failed")));
    assert_eq!(outcome["first_failure"], verdict["first_failure"]);
    assert_eq!(outcome["slip_mm"], verdict["checks"][0]["value"]);

    let mut rows = csv::Reader::from_path(out.join("summary.csv")).unwrap();
    let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.iter().map(|row| row[0].to_owned()).collect::<Vec<_>>(), ["a", "b", "left-out"]);
    assert_eq!(rows.iter().map(|row| row[1].to_owned()).collect::<Vec<_>>(), ["ok", "failed", "skipped"]);
    let failed_s = verdict["first_failure"]["time_s"].as_f64().unwrap();
    assert_eq!((&rows[1][13], &rows[1][14]), ("slip", format!("{failed_s:.4}").as_str()));
    assert!(rows[1][16].starts_with("expected holds, found slips: slip"), "{rows:?}");

    assert_junit(&fs::read_to_string(out.join("junit.xml")).unwrap(), [3, 1, 0, 1]);
    assert_page(&out, 3);
}

/// Checks the JUnit format (the schema of the Jenkins xUnit plugin, and properties of a case as in its successors): allowed
/// elements and attributes, required attributes, and counts that agree with the cases.
fn assert_junit(text: &str, [tests, failures, errors, skipped]: [usize; 4]) {
    let document = roxmltree::Document::parse(text).unwrap();
    let root = document.root_element();
    let may_have = |node: roxmltree::Node, attributes: &[&str], children: &[&str]| {
        let (name, elements) = (node.tag_name().name(), node.children().filter(roxmltree::Node::is_element));
        assert!(node.attributes().all(|found| attributes.contains(&found.name())), "{name}");
        assert!(elements.map(|child| child.tag_name().name()).all(|found| children.contains(&found)), "{name}");
    };
    let counts = ["name", "tests", "failures", "errors", "skipped", "disabled", "time", "timestamp", "uuid"];
    assert_eq!(root.tag_name().name(), "testsuites");
    may_have(root, &counts, &["testsuite"]);
    for node in root.descendants().filter(roxmltree::Node::is_element) {
        match node.tag_name().name() {
            "testsuite" => {
                may_have(node, &counts, &["properties", "testcase", "system-out", "system-err"]);
                let count = |name| node.attribute(name).unwrap_or("0").parse::<usize>().unwrap();
                let with = |child| node.descendants().filter(|found| found.has_tag_name(child)).count();
                assert_eq!(["tests", "failures", "errors", "skipped"].map(count), [tests, failures, errors, skipped]);
                assert_eq!(["testcase", "failure", "error", "skipped"].map(with), [tests, failures, errors, skipped]);
            }
            "testcase" => {
                let children = ["properties", "skipped", "error", "failure", "system-out", "system-err"];
                may_have(node, &["name", "classname", "time", "assertions", "status"], &children);
                assert!(node.has_attribute("name") && node.has_attribute("classname"));
            }
            "property" => assert!(node.has_attribute("name") && node.has_attribute("value")),
            "failure" | "error" => may_have(node, &["message", "type"], &[]),
            "skipped" => may_have(node, &["message"], &[]),
            "testsuites" | "properties" => {}
            other => panic!("found <{other}>, which is not part of JUnit"),
        }
    }
}

/// The page is well-formed and self-contained, and its links have targets.
fn assert_page(out: &Path, scenarios: usize) {
    let text = fs::read_to_string(out.join("report.html")).unwrap();
    for fetched in ["http:", "https:", "//", "<script", "<link", "@import", "url(", "src="] {
        assert!(!text.contains(fetched), "found {fetched:?} in a page that must work offline");
    }
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let page = roxmltree::Document::parse_with_options(&text, options).unwrap();
    let with_id = |id: &str| page.descendants().any(|node| node.attribute("id") == Some(id));
    for link in page.descendants().filter_map(|node| node.attribute("href")) {
        match link.strip_prefix('#') {
            Some(id) => assert!(with_id(id), "{link}"),
            None => assert!(out.join(link).exists(), "{link}"),
        }
    }
    let sections: Vec<_> = page.descendants().filter(|node| node.has_tag_name("details")).collect();
    assert_eq!(sections.len(), scenarios);
    let plots = |section: &roxmltree::Node| {
        section.descendants().filter(|node| node.attribute("class") == Some("plot")).count()
    };
    // Slip, rotation, sag, deflection, torque, clearance and load of each simulated scenario.
    assert_eq!(sections.iter().map(plots).collect::<Vec<_>>(), [7, 7, 0]);
    // Only the section of the failure is open.
    assert_eq!(sections.iter().filter(|node| node.has_attribute("open")).count(), 1);
}

#[test]
fn equal_runs_write_equal_reports() {
    let folder = tempfile::tempdir().unwrap();
    scenarios(folder.path(), &[("a", "slips"), ("b", "holds")]);
    benchdog(folder.path(), &["run", ".", "--jobs", "1", "--out", "one"]);
    benchdog(folder.path(), &["run", ".", "--jobs", "2", "--out", "two"]);
    for report in REPORTS {
        let [one, two] = ["one", "two"].map(|out| fs::read(folder.path().join(out).join(report)).unwrap());
        assert!(one == two, "{report}: two runs differ");
    }
}

#[test]
fn fail_fast_skips_the_scenarios_after_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    scenarios(folder.path(), &[("a", "slips"), ("b", "holds"), ("c", "slips")]);
    let output = benchdog(folder.path(), &["run", ".", "--fail-fast", "--jobs", "1", "--record", "never"]);
    assert_eq!(output.status.code(), Some(1));
    let summary = json(&folder.path().join("out/summary.json"));
    let statuses: Vec<_> = summary["outcomes"].as_array().unwrap().iter().map(|o| o["status"].clone()).collect();
    assert_eq!(statuses, ["ok", "failed", "skipped"]);
    assert!(!folder.path().join("out/c").exists());
}

/// Starts a run of many scenarios and waits for the end of the first.
fn in_the_middle(folder: &Path) -> (Child, impl BufRead + use<>) {
    let mut child =
        command(folder, &["run", ".", "--jobs", "1"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("ok    hold-00: slips: "), "{line}");
    (child, stderr)
}

#[test]
fn a_killed_run_leaves_only_whole_files_and_no_report() {
    let folder = tempfile::tempdir().unwrap();
    let names = many(folder.path());
    let out = folder.path().join("out");
    // Results of an earlier run.
    for report in REPORTS {
        fs::create_dir_all(&out).unwrap();
        fs::write(out.join(report), "old").unwrap();
    }
    fs::create_dir_all(out.join("hold-19")).unwrap();
    fs::write(out.join("hold-19/verdict.json"), "old").unwrap();

    let (mut child, _stderr) = in_the_middle(folder.path());
    child.kill().unwrap();
    child.wait().unwrap();

    assert!(REPORTS.iter().all(|report| !out.join(report).exists()));
    assert!(!out.join("hold-19/verdict.json").exists());
    let mut finished = 0;
    for name in names {
        let of = |file: &str| out.join(&name).join(file);
        if of("verdict.json").exists() {
            finished += 1;
            assert_eq!(json(&of("verdict.json"))["verdict"], "slips");
            assert!(of("plan.json").exists(), "the verdict is written last");
        }
        if of("plan.json").exists() {
            assert_eq!(json(&of("plan.json"))["format"], 1);
        }
        #[cfg(feature = "recording")]
        if of("recording.rrd").exists() {
            benchdog::record::read_summary(&of("recording.rrd")).unwrap();
        }
    }
    assert!((1..20).contains(&finished), "{finished} scenarios had ended");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_reports_the_finished_scenarios() {
    let folder = tempfile::tempdir().unwrap();
    many(folder.path());
    let (child, mut stderr) = in_the_middle(folder.path());
    let signalled = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    let mut messages = String::new();
    std::io::Read::read_to_string(&mut stderr, &mut messages).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{messages}");
    assert!(messages.contains("interrupted: the finished scenarios are reported"), "{messages}");

    let summary = json(&folder.path().join("out/summary.json"));
    assert_eq!(summary["interrupted"], true);
    let [ok, skipped] = ["ok", "skipped"].map(|key| summary[key].as_u64().unwrap() as usize);
    assert!(ok >= 1 && skipped >= 1 && ok + skipped == 20, "{ok} ok, {skipped} skipped");
    assert_junit(&fs::read_to_string(folder.path().join("out/junit.xml")).unwrap(), [20, 0, 0, skipped]);
    assert!(String::from_utf8_lossy(&output.stdout).contains(&format!("20 scenarios: {ok} ok, {skipped} skipped")));
}

/// A limit on the size of files has the same effect as a full disk: writing fails.
#[cfg(unix)]
#[test]
fn a_full_disk_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    scenarios(folder.path(), &[("a", "slips"), ("b", "slips")]);
    let output = Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_benchdog")])
        .args(["run", ".", "--jobs", "1"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.starts_with("error: failed to write out/a/") && message.lines().count() == 1, "{message}");
    let left: Vec<_> = fs::read_dir(folder.path().join("out/a")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(feature = "recording")]
#[test]
fn a_recording_is_judged_again_from_the_file_alone() {
    let folder = tempfile::tempdir().unwrap();
    scenarios(folder.path(), &[("a", "slips")]);
    benchdog(folder.path(), &["run", "a.toml"]);
    let verdict = json(&folder.path().join("out/a/verdict.json"));
    let elsewhere = tempfile::tempdir().unwrap();
    fs::copy(folder.path().join("out/a/recording.rrd"), elsewhere.path().join("moved.rrd")).unwrap();
    drop(folder);

    let inspect = |more: &[&str]| {
        let output = benchdog(elsewhere.path(), &[&["inspect", "moved.rrd", "--format", "json"], more].concat());
        (printed_json(&output), output.status.code())
    };
    let (output, exit) = inspect(&[]);
    assert_eq!((&output["verdict"], &output["judged_again"], exit), (&verdict, &Value::Null, Some(0)));
    // With the same limits the stored trace gets the same verdict.
    let (output, exit) = inspect(&["--check"]);
    assert_eq!((&output["judged_again"], exit), (&verdict, Some(0)));
    // If slip is allowed, the deflection decides. The exit code is 1 because `slips` was expected.
    let (output, exit) = inspect(&["--slip-mm", "2000"]);
    assert_eq!((output["judged_again"]["verdict"].as_str(), exit), (Some("deflects"), Some(1)));
    assert_eq!(output["verdict"], verdict);
}
