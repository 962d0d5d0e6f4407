//! `--robust`: a plan that holds with a probability, at the cost of comfort.

use std::fs;

use serde_json::Value;

use crate::{
    common::root,
    process::{benchdog, json, stderr},
};

/// The quickstart whose force alone varies, by this share.
fn scenario(sd: f64) -> String {
    let quickstart = fs::read_to_string(root().join("scenarios/quickstart.toml")).unwrap();
    format!(
        "{quickstart}\n[sweep]\nruns = 60\n\n[sweep.force_factor]\nkind = \"normal\"\nmean = 1.0\nsd = {sd}\nmin = 0.3\n"
    )
}

#[test]
fn a_robust_plan_holds_as_often_as_it_says_and_costs_comfort() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (toml, usual, robust) = (path("s.toml"), path("usual.json"), path("robust.json"));
    fs::write(&toml, scenario(0.1)).unwrap();
    let plan = |file: &str, options: &[&str]| -> Value {
        let output = benchdog(root(), &[&["plan", &toml, "-o", file], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(std::path::Path::new(file))
    };
    let (usual_plan, robust_plan) = (plan(&usual, &[]), plan(&robust, &["--robust=0.98"]));
    let record = &robust_plan["planner"]["robust"];
    assert!(record["probability"].as_f64().unwrap() >= 0.98 && record["runs"].as_u64().unwrap() >= 200, "{record}");
    assert!(usual_plan["planner"]["robust"].is_null());
    let objective = |plan: &Value| plan["comfort"]["objective"].as_f64().unwrap();
    assert!(objective(&robust_plan) < objective(&usual_plan));
    // The limits are those of the scenario, not those that the search required.
    assert_eq!(robust_plan["scenario"]["limits"], usual_plan["scenario"]["limits"]);
    // Other draws than the planner's.
    let probability = |plan: &str, out: &str| {
        let output =
            benchdog(root(), &["sweep", plan, "--runs", "80", "--seed", "9", "--worst", "0", "--out", &path(out)]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let summary = json(&folder.path().join(out).join("sweep.json"));
        summary["estimate"]["probability"].as_f64().unwrap()
    };
    // At 0.98 six or more of 80 independent runs fail once in 150 seeds.
    assert!(probability(&robust, "of-robust") > 0.93);
    assert!(probability(&usual, "of-usual") < 0.9);
}

#[test]
fn without_a_plan_that_holds_often_enough_the_best_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let toml = folder.path().join("s.toml");
    fs::write(&toml, scenario(1.5).replace("min = 0.3", "min = 0.1")).unwrap();
    let output = benchdog(root(), &["plan", toml.to_str().unwrap(), "--robust=0.9"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("no feasible plan: the best plan holds with probability 0."), "{said}");
    assert!(output.stdout.is_empty());
}

#[test]
fn a_probability_that_no_sweep_shows_is_refused() {
    for wrong in ["--robust=1", "--robust=0.4", "--robust=often"] {
        let output = benchdog(root(), &["plan", "scenarios/quickstart.toml", wrong]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("expected a number from 0.5 to 0.999"), "{}", stderr(&output));
    }
}
