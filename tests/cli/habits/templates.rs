//! Templates of `--out`.

use std::{fs, path::Path};

use super::plan;
use crate::process::{benchdog, slipping_scenario, stderr};

fn has(folder: &Path, file: &str) -> bool {
    folder.join(file).is_file()
}

#[test]
fn placeholders_are_filled_in() {
    let place = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        slipping_scenario(place.path(), name, "slips");
    }
    let run = |arguments: &[&str]| {
        let output = benchdog(place.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    run(&["run", ".", "--record", "never", "--out", "results/{kind}-{name}-{seed}"]);
    for file in ["cut-a-1/verdict.json", "cut-b-1/verdict.json", "report.html", "summary.csv", "junit.xml"] {
        assert!(has(&place.path().join("results"), file), "{file}");
    }
    plan(place.path(), "cut-rim.json", "p.json", "p");
    run(&["simulate", "p.json", "--record", "never", "--out", "{name}/{{x}}"]);
    assert!(has(place.path(), "p/{x}/verdict.json"));
    run(&["sweep", "p.json", "--runs", "4", "--worst", "0", "--out", "sweeps/{name}-{seed}", "--seed", "3"]);
    assert!(has(place.path(), "sweeps/p-3/sweep.json"));
}

#[test]
fn a_template_that_is_wrong_is_refused_before_anything_is_written() {
    let place = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        slipping_scenario(place.path(), name, "slips");
    }
    for (template, message) in [
        (
            "out/{nam}",
            "found {nam}, expected one of {name}, {kind}, {seed}; a brace itself is written twice; did you mean \"name\"?",
        ),
        ("out/{date}", "found {date}, expected one of {name}, {kind}, {seed}; a brace itself is written twice"),
        ("out/{name", "found a brace alone at \"{name\""),
        (
            "out/{kind}",
            "--out: found the folder out/cut for a and b, expected another folder for each, such as with {name}",
        ),
    ] {
        let output = benchdog(place.path(), &["run", ".", "--out", template]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
    let left: Vec<_> = fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 3, "{left:?}");
}
