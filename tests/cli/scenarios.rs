//! Every file in `scenarios/` meets its expectation.

use std::{collections::BTreeMap, fs, path::PathBuf, process::Command};

use serde_json::Value;

fn scenario_files() -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    files
}

#[test]
fn every_scenario_meets_its_expectation() {
    let files = scenario_files();
    let out = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .args(["run", "--format", "json", "--record", "never", "--out"])
        .arg(out.path())
        .args(&files)
        .output()
        .unwrap();
    let verdicts: Vec<Value> = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    assert_eq!(verdicts.len(), files.len());
    for verdict in &verdicts {
        assert_eq!(verdict["met"], true, "{verdict:#}");
    }
    assert_eq!(output.status.code(), Some(0));
    assert_reasons_differ(&verdicts);
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
