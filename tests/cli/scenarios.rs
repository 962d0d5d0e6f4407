//! Every file in `scenarios/` meets its expectation.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::{
    common::root,
    process::{argument, benchdog, printed_json},
};

#[test]
fn every_scenario_meets_its_expectation() {
    let out = tempfile::tempdir().unwrap();
    let files = std::fs::read_dir(root().join("scenarios")).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    // `run` leaves tasks out.
    let scenarios = files.filter(|path| !benchdog::scenario::is_task(&std::fs::read_to_string(path).unwrap())).count();
    let arguments = ["run", "scenarios", "--format", "json", "--record", "never", "--out", argument(out.path())];
    let output = benchdog(root(), &arguments);
    let verdicts = printed_json(&output);
    let verdicts = verdicts.as_array().unwrap();
    assert_eq!(verdicts.len(), scenarios);
    for verdict in verdicts {
        assert_eq!(verdict["met"], true, "{verdict:#}");
    }
    assert_eq!(output.status.code(), Some(0));
    assert_reasons_differ(verdicts);
}

/// Asserts that the scenarios show successes and several kinds of failure.
fn assert_reasons_differ(verdicts: &[Value]) {
    let mut count = BTreeMap::<&str, usize>::new();
    for verdict in verdicts {
        *count.entry(verdict["verdict"].as_str().unwrap()).or_default() += 1;
    }
    assert!(count["holds"] >= 2, "{count:?}");
    assert!(count["slips"] >= 2, "{count:?}");
    assert!(count.contains_key("infeasible"), "{count:?}");
    assert!(count.contains_key("deflects") || count.contains_key("saturates"), "{count:?}");
}
