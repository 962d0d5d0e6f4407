//! The JSON Schemas in `schemas/` are up to date, and written files are valid under them.

use std::fs;

use serde_json::Value;

use crate::{
    common::root,
    process::{benchdog, text_of_both},
};

fn committed(of: &str) -> String {
    fs::read_to_string(root().join(format!("schemas/{of}.schema.json"))).unwrap()
}

/// Validates against the schema of a file format; the error lists every violation.
fn validate(of: &str, instance: &Value) -> Result<(), String> {
    let path = format!("{of}.schema.json");
    let (mut compiler, mut schemas) = (boon::Compiler::new(), boon::Schemas::new());
    compiler.add_resource(&path, serde_json::from_str(&committed(of)).unwrap()).unwrap();
    let schema = compiler.compile(&path, &mut schemas).unwrap();
    schemas.validate(instance, schema).map_err(|error| error.to_string())
}

#[test]
fn committed_schemas_are_up_to_date() {
    for of in
        ["scenario", "plan", "verdict", "staged-plan", "staged-verdict", "sweep", "replan-request", "replan-answer"]
    {
        let printed = String::from_utf8(benchdog(root(), &["schema", of]).stdout).unwrap();
        assert_eq!(printed, committed(of), "run `just schemas`");
    }
}

#[test]
fn a_plan_and_its_verdict_are_valid() {
    for of in ["plan", "verdict"] {
        let written = serde_json::from_str(text_of_both(&format!("quickstart/{of}.json"))).unwrap();
        assert_eq!(validate(of, &written), Ok(()));
    }
}

#[test]
fn every_scenario_is_valid() {
    for entry in fs::read_dir(root().join("scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let table: toml::Table = toml::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            assert_eq!(validate("scenario", &serde_json::to_value(table).unwrap()), Ok(()));
        }
    }
}

#[test]
fn a_plan_without_its_arms_is_not_valid() {
    let plan = serde_json::json!({"format": 1, "name": "x", "robot": "baxter"});
    let error = validate("plan", &plan).unwrap_err();
    assert!(error.contains("arms"), "{error}");
}
