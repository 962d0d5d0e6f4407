//! `benchdog compare`: kinds of results, exit codes, baselines and refusals.

use std::{fs, path::Path};

use serde_json::Value;

use crate::{
    common::root,
    process::{argument, benchdog, json, printed_json, stderr},
};

/// The exit code, standard output and standard error.
fn compare(arguments: &[&str]) -> (i32, String, String) {
    let output = benchdog(root(), &[&["compare"], arguments].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code().unwrap(), text, stderr(&output))
}

/// Two runs of plans that need no planning.
fn run(out: &Path) {
    let scenarios = ["scenarios/plan-from-elsewhere.toml", "scenarios/suction-cups.toml"];
    let output = benchdog(root(), &[&["run", "--record", "never", "--out", argument(out)], &scenarios[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

fn edit(path: &Path, change: impl Fn(&mut Value)) {
    let mut value = json(path);
    change(&mut value);
    fs::write(path, serde_json::to_string_pretty(&value).unwrap()).unwrap();
}

#[test]
fn runs_are_compared_with_each_other_and_with_a_baseline() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (before, after, baseline, page) = (path("before"), path("after"), path("baseline.json"), path("page.html"));
    run(&before);
    run(&after);
    let both = [argument(&before), argument(&after)];
    let (code, text, said) = compare(&both);
    assert_eq!((code, text.as_str()), (0, "2 compared: 0 regressions, 0 improvements, 0 moved, 0 new\n"), "{said}");

    assert_eq!(compare(&[argument(&before), "--write-baseline", argument(&baseline)]).0, 0);
    let (code, text, said) = compare(&[argument(&baseline), argument(&after)]);
    assert_eq!(code, 0, "{text} {said}");
    // The same baseline from a baseline.
    let again = path("again.json");
    assert_eq!(compare(&[argument(&baseline), "--write-baseline", argument(&again)]).0, 0);
    assert_eq!(fs::read(&baseline).unwrap(), fs::read(&again).unwrap());

    // A larger deflection, another version, and a verdict that is no longer expected.
    edit(&after.join("plan-from-elsewhere/verdict.json"), |verdict| {
        let checks = verdict["checks"].as_array_mut().unwrap();
        let deflection = checks.iter_mut().find(|check| check["name"] == "deflection").unwrap();
        let (value, limit) = (deflection["value"].as_f64().unwrap() + 1.0, deflection["limit"].as_f64().unwrap());
        (deflection["value"], deflection["margin"]) = (value.into(), (limit - value).into());
        verdict["versions"]["benchdog"] = "9.9.9".into();
        verdict["criteria"] = 7.into();
    });
    edit(&after.join("suction-cups/verdict.json"), |verdict| {
        (verdict["verdict"], verdict["met"]) = ("detaches".into(), false.into());
        verdict["versions"]["benchdog"] = "9.9.9".into();
        verdict["criteria"] = 7.into();
    });
    let (code, text, _) = compare(&[&both[..], &["--html", argument(&page)]].concat());
    assert_eq!(code, 1, "{text}");
    for expected in [
        "REGRESSION",
        "deflection",
        "margin -6.7 % of the limit",
        "detaches",
        "was expected, is not",
        "now 9.9.9",
        "criteria: 1, now 7: verdicts by other criteria are not comparable",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    assert!(text.ends_with("2 compared: 2 regressions, 0 improvements, 0 moved, 0 new\n"), "{text}");
    assert!(fs::read_to_string(&page).unwrap().contains("2 regressions"));
    assert_eq!(compare(&[argument(&after), argument(&before)]).0, 0, "the reverse is an improvement");
    assert_eq!(
        compare(&[&both[..], &["--tolerance", "0.1"]].concat()).0,
        1,
        "the verdict counts whatever the tolerance"
    );
    let output = benchdog(root(), &[&["compare"], &both[..], &["--format", "json"]].concat());
    assert_eq!(printed_json(&output)["changes"].as_array().unwrap().len(), 2);

    // One scenario less.
    fs::remove_dir_all(after.join("suction-cups")).unwrap();
    let (code, text, _) = compare(&both);
    assert!(code == 1 && text.contains("gone"), "{text}");
}

#[test]
fn sweeps_are_compared_beyond_chance() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = |name: &str, seed: &str| {
        let out = folder.path().join(name);
        let plan = "scenarios/plans/cut-rim.json";
        let arguments = ["sweep", plan, "--runs", "24", "--worst", "0", "--seed", seed, "--out", argument(&out)];
        assert_eq!(benchdog(root(), &arguments).status.code(), Some(0));
        out
    };
    let (first, second) = (sweep("first", "1"), sweep("second", "2"));
    let (code, text, said) = compare(&[argument(&first), argument(&second)]);
    assert_eq!(code, 0, "{text} {said}");
    // Half of 24 runs is not chance.
    edit(&second.join("sweep.json"), |summary| {
        let estimate = &mut summary["estimate"];
        (estimate["probability"], estimate["low"], estimate["high"]) = (0.5.into(), 0.31.into(), 0.69.into());
    });
    let (code, text, _) = compare(&[argument(&first), argument(&second.join("sweep.json"))]);
    assert!(code == 1 && text.contains("probability") && text.contains("REGRESSION"), "{text}");
}

#[test]
fn what_is_no_result_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("other.json"), "{\"a\": 1}").unwrap();
    fs::write(path("cut.json"), "{\n\"verdict\": \"holds\",\n").unwrap();
    fs::write(path("key.json"), "{\"format\": 1,\n \"versions\": {},\n \"scenarios\": {}, \"more\": 1}").unwrap();
    fs::create_dir(path("empty")).unwrap();
    for (file, expected) in [
        ("other.json", "other.json: found another JSON file, expected a verdict"),
        ("cut.json", "cut.json:3: "),
        ("key.json", "key.json:3: unknown field `more`"),
        ("empty", "empty: found no results, expected a folder of `benchdog run`"),
        ("nowhere.json", "nowhere.json: failed to read"),
    ] {
        let (code, text, said) = compare(&[argument(&path(file)), argument(&path(file))]);
        assert_eq!((code, text.as_str()), (2, ""), "{said}");
        assert!(said.contains(expected), "{said}");
    }
    let (code, _, said) = compare(&[argument(&path("empty"))]);
    assert!(code == 2 && said.contains("<AFTER>"), "{said}");
    let (code, _, said) = compare(&["a", "b", "--tolerance", "2"]);
    assert!(code == 2 && said.contains("--tolerance: found 2, expected a number from 0 to 1"), "{said}");
}
