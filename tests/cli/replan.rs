//! `benchdog replan`: every request has one answer, in order; a request that is not valid changes nothing.

use std::{io::Write, process::Stdio};

use serde_json::{Value, json};

use crate::{
    common::root,
    process::{command, stderr},
};

/// The answers to requests, the exit code, and standard error.
fn answers(arguments: &[&str], requests: &[Value]) -> (Vec<Value>, i32, String) {
    let text: String = requests
        .iter()
        .map(|request| request.as_str().map_or_else(|| request.to_string(), str::to_owned) + "\n")
        .collect();
    let mut process = command(root(), &[&["replan", "scenarios/quickstart.toml"], arguments].concat())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    process.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = process.wait_with_output().unwrap();
    let lines = String::from_utf8(output.stdout.clone()).unwrap();
    let answers = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (answers, output.status.code().unwrap(), stderr(&output))
}

#[test]
fn every_request_has_an_answer_in_order() {
    let place =
        json!({"x_m": 0.92, "y_m": -0.21, "heading_deg": 166.0, "place_tolerance_m": 0.1, "heading_tolerance_deg": 10});
    let requests = [
        json!({"id": "free"}),
        json!({"id": 2, "human": place}),
        json!({"human": {"x_m": 0.9}}),
        json!({"id": 3, "operation": {"kind": "drill", "point_m": [0.03, 0.0], "force_n": 17.0}, "most_motion_deg": 45}),
        json!({"id": 4, "human": {"x_m": -9.0, "y_m": 0.0, "heading_deg": 0.0}, "search": false}),
    ];
    let (answers, code, _) = answers(&[], &requests);
    let column = |key: &str| answers.iter().map(|answer| answer[key].clone()).collect::<Vec<_>>();
    assert_eq!(column("id"), [json!("free"), json!(2), Value::Null, json!(3), json!(4)]);
    assert_eq!(column("line"), [1, 2, 3, 4, 5].map(Value::from));
    assert_eq!(column("result"), ["found", "found", "error", "found", "infeasible"].map(Value::from));
    let reason = answers[2]["reason"].as_str().unwrap();
    assert!(reason.starts_with("standard input:3: human.y_m: found nothing, expected a position"), "{reason}");
    // The request that was not valid changed nothing: the person stands where the second one says.
    let stands = |answer: &Value| answer["plan"]["human"]["x_wb"]["translation_m"][0].as_f64().unwrap();
    assert!((stands(&answers[3]) - 0.92).abs() <= 0.1 + 1e-9);
    assert!(answers[0]["motion"].is_null() && answers[3]["motion"]["largest_joint_deg"].as_f64().unwrap() <= 45.0);
    assert_eq!(answers[3]["plan"]["operation"]["wrench_o"][2], -17.0);
    // The worst of the answers.
    assert_eq!(code, 2);
}

#[test]
fn the_same_requests_have_the_same_answers() {
    let requests = [json!({}), json!({"operation": {"kind": "drill", "point_m": [0.05, 0.02], "force_n": 15}})];
    let without_times = || {
        let (mut answers, code, _) = answers(&[], &requests);
        answers.iter_mut().for_each(|answer| answer["wall_ms"] = Value::Null);
        (answers, code)
    };
    let (one, code) = without_times();
    assert_eq!(code, 0);
    assert_eq!((one, code), without_times());
}

#[test]
fn a_plan_that_does_not_keep_the_limits_is_no_start() {
    let (answers, code, error) = answers(&["--plan", "scenarios/plans/cut-rim.json"], &[json!({})]);
    assert!(answers.is_empty(), "{answers:?}");
    assert_eq!(code, 2);
    assert!(error.contains("scenarios/plans/cut-rim.json: found a plan that breaks a limit"), "{error}");
}

#[test]
fn an_answer_has_the_id_of_its_request_valid_or_not() {
    let (answers, code, _) =
        answers(&[], &[json!({"id": "a", "person": 1}), json!("no JSON"), json!({"id": {"b": 2}, "force_n": 3})]);
    assert_eq!(
        answers.iter().map(|answer| answer["id"].clone()).collect::<Vec<_>>(),
        [json!("a"), Value::Null, json!({"b": 2})]
    );
    assert!(answers.iter().all(|answer| answer["result"] == "error"));
    assert_eq!(code, 2);
}
