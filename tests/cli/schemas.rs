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
        assert_eq!(validate(of, &serde_json::from_slice(&fs::read(path).unwrap()).unwrap()), Ok(()));
    }
}

#[test]
fn every_scenario_is_valid() {
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")).unwrap() {
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
