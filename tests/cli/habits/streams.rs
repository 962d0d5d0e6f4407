//! `-`: standard input and standard output in place of files.

use std::fs;

use super::{plan, with_input, without_times};
use crate::{
    bad_input::{PLAN, SCENARIO, assert_refused},
    common::root,
    process::{benchdog, contents, folder, json, slipping_scenario, stderr},
};

#[test]
fn a_plan_on_standard_input_is_simulated_as_from_a_file() {
    let files = folder(&[("plan.json", PLAN)]);
    let from_file = benchdog(files.path(), &["simulate", "plan.json"]);
    let piped = tempfile::tempdir().unwrap();
    let from_pipe = with_input(piped.path(), &["simulate", "-"], PLAN.as_bytes());
    let text = |bytes: &[u8]| without_times(std::str::from_utf8(bytes).unwrap());
    assert_eq!((text(&from_pipe.stdout), from_pipe.status.code()), (text(&from_file.stdout), Some(0)));
    assert_eq!(contents(&piped.path().join("out")), contents(&files.path().join("out")));
}

#[test]
fn a_plan_of_one_command_is_the_input_of_another() {
    let scenario = fs::read(root().join("scenarios/quickstart.toml")).unwrap();
    let place = tempfile::tempdir().unwrap();
    let planned = with_input(place.path(), &["plan", "-", "--budget", "fast", "-o", "-"], &scenario);
    assert_eq!(planned.status.code(), Some(0), "{}", stderr(&planned));
    let by_default = with_input(place.path(), &["plan", "-", "--budget", "fast"], &scenario);
    let [first, second] = [&planned, &by_default].map(|output| {
        let mut plan: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        plan["planner"].as_object_mut().unwrap().retain(|key, _| !key.ends_with("_ms"));
        plan
    });
    assert_eq!(first, second, "- is standard output, as without an option");
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0, "no file is written");
    let judged = with_input(place.path(), &["simulate", "-", "--record", "never"], &planned.stdout);
    assert_eq!(judged.status.code(), Some(0), "{}", stderr(&judged));
    assert_eq!(json(&place.path().join("out/quickstart/verdict.json"))["verdict"], "holds");
}

#[test]
fn paths_in_a_scenario_on_standard_input_are_relative_to_the_working_directory() {
    let place = tempfile::tempdir().unwrap();
    let path = slipping_scenario(place.path(), "piped", "slips");
    let text = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    let output = with_input(place.path(), &["run", "-", "--record", "never"], &text);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let margin = with_input(place.path(), &["sweep", "-", "--runs", "4", "--worst", "0"], &text);
    assert_eq!(margin.status.code(), Some(0), "a scenario by its content: {}", stderr(&margin));
    let plan = fs::read(place.path().join("plans/cut-rim-weak-grip.json")).unwrap();
    let of_plan = with_input(place.path(), &["sweep", "-", "--runs", "4", "--worst", "0", "--out", "p"], &plan);
    assert_eq!(of_plan.status.code(), Some(0), "a plan by its content: {}", stderr(&of_plan));
}

#[test]
fn messages_call_the_standard_input_by_a_name() {
    let place = tempfile::tempdir().unwrap();
    let spoilt = SCENARIO.replace("friction = 0.6", "friction = 6.0");
    for command in ["run", "plan", "front"] {
        let output = with_input(place.path(), &[command, "-"], spoilt.as_bytes());
        assert_refused(&output, "<stdin>:14: grip.friction: found 6, expected at most 2 (a Coulomb coefficient)");
    }
    let output = with_input(place.path(), &["task", "-"], SCENARIO.as_bytes());
    assert!(stderr(&output).starts_with("error: <stdin>:7: operation: found [operation], expected [task]"));
    let output = with_input(place.path(), &["simulate", "-"], SCENARIO.as_bytes());
    assert_refused(&output, "<stdin>: found TOML, expected a plan in JSON; a scenario is given to `benchdog run`");
    let output = with_input(place.path(), &["run", "-"], PLAN.as_bytes());
    assert_refused(
        &output,
        "<stdin>: found a plan in JSON, expected a scenario in TOML; a plan is given to `benchdog simulate`",
    );
}

#[test]
fn standard_input_is_one_file_at_most() {
    let place = tempfile::tempdir().unwrap();
    plan(place.path(), "cut-rim.json", "a.json", "one");
    let twice =
        "<stdin>: failed to read the file: found `-` twice, expected it once: the standard input can be read once";
    assert_refused(&with_input(place.path(), &["run", "-", "-"], SCENARIO.as_bytes()), twice);
    assert_refused(&with_input(place.path(), &["margin", "-", "--scenario", "-"], PLAN.as_bytes()), twice);
    let requests = "-: found standard input, which has the requests, expected a file";
    assert_refused(&with_input(place.path(), &["replan", "-"], SCENARIO.as_bytes()), requests);
    let top = "-o -: found standard output, expected a folder beside --top";
    assert_refused(&with_input(place.path(), &["plan", "-", "--top", "2", "-o", "-"], SCENARIO.as_bytes()), top);
    assert!(!place.path().join("out").exists());
}

#[test]
fn an_export_on_standard_output_is_that_of_a_file() {
    let place = folder(&[("plan.json", PLAN)]);
    let output = benchdog(place.path(), &["export", "plan.json", "--mjcf", "scene.xml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = with_input(place.path(), &["export", "-", "--mjcf", "-"], PLAN.as_bytes());
    assert_eq!(output.stdout, fs::read(place.path().join("scene.xml")).unwrap());
    assert!(!place.path().join("-").exists());
}

/// What a file calls so is a file.
#[test]
fn a_scenario_cannot_name_the_standard_input() {
    let text = format!("{SCENARIO}\n[load]\nkind = \"measured\"\nfile = \"<stdin>\"\n");
    let place = folder(&[("a.toml", &text)]);
    let output = with_input(place.path(), &["run", "a.toml"], b"t_s,x_n,y_n,z_n\n0,0,0,1\n1,0,0,1\n");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("load.file: failed to read <stdin>: "), "{}", stderr(&output));
}
