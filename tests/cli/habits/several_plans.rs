//! `benchdog simulate` on several plans.

use std::fs;

use super::{plan, without_times};
use crate::{
    bad_input::assert_refused,
    process::{benchdog, contents, json, stderr},
    task::circle_plan,
};

#[test]
fn plans_files_folders_and_patterns_are_simulated_into_one_report() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), "cut-rim.json", "a.json", "one");
    plan(folder.path(), "cut-rim-weak-grip.json", "more/b.json", "two");
    plan(folder.path(), "cut-rim.json", "more/c.json", "three");
    plan(folder.path(), "cut-rim.json", "other/d.json", "four");
    let arguments = ["simulate", "a.json", "more", "other/*.json", "--junit", "junit.xml", "--record", "never"];
    let output = benchdog(folder.path(), &arguments);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let names: Vec<_> = text.lines().filter_map(|line| line.split("  ").next()).take(5).collect();
    assert_eq!(names, ["scenario", "one", "two", "three", "four"], "{text}{}", stderr(&output));
    assert!(text.contains("\n4 scenarios: 3 ok, 1 failed\n"), "{text}");
    assert_eq!(output.status.code(), Some(1), "the worst result is that of the command");
    for (name, verdict) in [("one", "holds"), ("two", "slips"), ("three", "holds"), ("four", "holds")] {
        assert_eq!(json(&folder.path().join("out").join(name).join("verdict.json"))["verdict"], verdict, "{name}");
    }
    let junit = fs::read_to_string(folder.path().join("junit.xml")).unwrap();
    assert_eq!(junit.matches("<testcase ").count(), 4);
    assert_eq!(junit.matches("<failure").count(), 1);
    // By itself each has the same verdict, and the same whatever the number of threads.
    let before = contents(&folder.path().join("out"));
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    let again = benchdog(folder.path(), &[&arguments[..], &["--jobs", "1"]].concat());
    assert_eq!(without_times(&String::from_utf8(again.stdout).unwrap()), without_times(&text));
    benchdog(folder.path(), &["simulate", "more/b.json", "--record", "never"]);
    assert_eq!(contents(&folder.path().join("out")), before);
}

#[test]
fn one_name_twice_is_refused_before_anything_is_simulated() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), "cut-rim.json", "a.json", "same");
    plan(folder.path(), "cut-rim.json", "b.json", "same");
    let output = benchdog(folder.path(), &["simulate", "a.json", "b.json"]);
    assert_refused(&output, "b.json: name: found \"same\", which is also the name of a.json");
    let output = benchdog(folder.path(), &["simulate", "a.json", "a.json"]);
    assert_refused(&output, "a.json: name: found \"same\", which is also the name of a.json");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_plan_with_a_fault_among_others_is_refused_before_anything_is_simulated() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), "cut-rim.json", "a.json", "one");
    fs::write(folder.path().join("b.json"), "{\"format\": 1}").unwrap();
    let output = benchdog(folder.path(), &["simulate", "a.json", "b.json"]);
    assert_refused(&output, "b.json:1: missing field `name`");
    let output = benchdog(folder.path(), &["simulate", "none/*.json"]);
    assert_refused(&output, "none/*.json: found no file that matches, expected plans");
    assert!(!folder.path().join("out").exists());
}

/// A task's plan has a report of its own: by itself it is simulated, among others it must not be lost silently.
#[test]
fn a_plan_of_a_task_that_is_named_among_others_is_refused_and_one_that_a_folder_has_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), "cut-rim.json", "plans/a.json", "one");
    plan(folder.path(), "cut-rim.json", "plans/b.json", "two");
    fs::write(folder.path().join("plans/task.json"), circle_plan().to_string()).unwrap();
    let output = benchdog(folder.path(), &["simulate", "plans/a.json", "plans/task.json"]);
    let expected = "expected plans of one hold; give it to `benchdog simulate` alone";
    assert_refused(&output, &format!("plans/task.json: found a plan of a task, {expected}"));
    assert!(!folder.path().join("out").exists());
    let output = benchdog(folder.path(), &["simulate", "plans", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 ok"), "{}", String::from_utf8_lossy(&output.stdout));
}
