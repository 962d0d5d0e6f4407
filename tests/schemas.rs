//! The JSON Schemas in `schemas/` are up to date, and written files are valid under them.

use std::{fs, path::Path, process::Command};

use serde_json::Value;

fn committed(of: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("schemas/{of}.schema.json"));
    fs::read_to_string(path).unwrap()
}

fn benchdog(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .output()
        .unwrap();
    output.stdout
}

#[track_caller]
fn assert_valid(of: &str, instance: &Value) {
    let schema: Value = serde_json::from_str(&committed(of)).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<_> = validator.iter_errors(instance).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
}

#[test]
fn committed_schemas_are_up_to_date() {
    for of in ["scenario", "plan", "verdict"] {
        let printed = String::from_utf8(benchdog(&["schema", of])).unwrap();
        assert_eq!(printed, committed(of), "run `just schemas`");
    }
}

#[test]
fn a_plan_and_its_verdict_are_valid() {
    let out = tempfile::tempdir().unwrap();
    benchdog(&["run", "scenarios/quickstart.toml", "--record", "never", "--out", out.path().to_str().unwrap()]);
    for of in ["plan", "verdict"] {
        let path = out.path().join(format!("quickstart/{of}.json"));
        assert_valid(of, &serde_json::from_slice(&fs::read(path).unwrap()).unwrap());
    }
}

#[test]
fn every_scenario_is_valid() {
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let table: toml::Table = toml::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            assert_valid("scenario", &serde_json::to_value(table).unwrap());
        }
    }
}

#[test]
fn a_plan_without_its_arms_is_not_valid() {
    let schema: Value = serde_json::from_str(&committed("plan")).unwrap();
    let plan = serde_json::json!({"format": 1, "name": "x", "robot": "baxter"});
    assert!(!jsonschema::is_valid(&schema, &plan));
}
