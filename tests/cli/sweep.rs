//! `benchdog sweep` and `benchdog merge`: parts, resumption, threads and refusals, with sweeps of some runs.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::LazyLock,
};

use tempfile::TempDir;

use crate::{
    common::root,
    process::{Files, argument, benchdog, contents, json, stderr},
};

const PLAN: &str = "scenarios/plans/cut-rim.json";

/// Sweeps the plan into a folder; returns the exit code and standard error.
fn sweep(out: &Path, options: &[&str]) -> (i32, String) {
    let output = benchdog(root(), &[&["sweep", PLAN, "--worst", "1", "--out", argument(out)], options].concat());
    (output.status.code().unwrap(), stderr(&output))
}

#[track_caller]
fn swept(out: &Path, options: &[&str]) -> Files {
    let (code, said) = sweep(out, options);
    assert_eq!(code, 0, "{said}");
    contents(out)
}

/// A finished sweep of 14 runs, and its folder.
static WHOLE: LazyLock<(TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("whole");
    swept(&out, &["--runs", "14"]);
    (folder, out)
});

fn merge(parts: &[PathBuf], out: &Path) -> (i32, String) {
    let parts: Vec<&str> = parts.iter().map(|part| argument(part)).collect();
    let output = benchdog(root(), &[&["merge"], parts.as_slice(), &["--out", argument(out)]].concat());
    (output.status.code().unwrap(), stderr(&output))
}

fn parts(folder: &Path, of: usize, options: &[&str]) -> Vec<PathBuf> {
    let part = |number: usize| {
        let out = folder.join(format!("part-{number}-of-{of}"));
        swept(&out, &[&["--runs", "14", "--shard", &format!("{number}/{of}")], options].concat());
        out
    };
    (1..=of).map(part).collect()
}

#[test]
fn merged_parts_are_the_sweep_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let whole = contents(&WHOLE.1);
    let names: Vec<_> = whole.keys().map(|path| path.to_str().unwrap()).collect();
    for name in ["junit.xml", "plan.json", "report.html", "runs.arrow", "runs.csv", "sweep.json"] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert_eq!(
        names.iter().filter(|name| name.starts_with("recordings")).count(),
        usize::from(cfg!(feature = "recording"))
    );
    for of in [3, 7] {
        let mut parts = parts(folder.path(), of, &[]);
        // In any order.
        parts.reverse();
        let out = folder.path().join(format!("merged-{of}"));
        assert_eq!(merge(&parts, &out), (0, String::new()));
        assert_eq!(contents(&out), whole, "{of} parts");
    }
}

#[test]
fn a_sweep_goes_on_where_it_was_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let whole = contents(&WHOLE.1);
    // The journal of a sweep that was killed while it wrote a line: made of a journal's first line and the table.
    let out = folder.path().join("cut");
    let (code, said) = sweep(&out, &["--runs", "6"]);
    assert_eq!(code, 0, "{said}");
    // With more runs the finished ones are kept.
    assert_eq!(swept(&out, &["--runs", "14"]), whole);
    let table = String::from_utf8(whole[Path::new("runs.csv")].clone()).unwrap();
    let key = key(&out);
    for cut in [table.len() - 7, table.len() / 2, table.lines().next().unwrap().len() + 1] {
        fs::remove_file(out.join("sweep.json")).unwrap();
        fs::remove_file(out.join("runs.csv")).unwrap();
        fs::write(out.join("runs.part"), format!("{key}\n{}", &table[..cut])).unwrap();
        assert_eq!(swept(&out, &["--runs", "14"]), whole, "cut at {cut}");
        // The journal of another sweep does not count.
        fs::write(out.join("runs.part"), format!("other {key}\n{table}")).unwrap();
        assert_eq!(swept(&out, &["--runs", "14"]), whole);
    }
}

/// The first line of the journal of a sweep, read while one runs.
fn key(out: &Path) -> String {
    use benchdog::sweep::summary::SweepSummary;
    let summary: SweepSummary = serde_json::from_slice(&fs::read(out.join("sweep.json")).unwrap()).unwrap();
    summary.info.key()
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for jobs in ["1", "2"] {
        let out = folder.path().join(jobs);
        assert_eq!(swept(&out, &["--runs", "14", "--jobs", jobs]), contents(&WHOLE.1));
    }
}

#[test]
fn what_does_not_belong_together_is_not_merged() {
    let folder = tempfile::tempdir().unwrap();
    let two = parts(folder.path(), 2, &[]);
    let other = |name: &str, options: &[&str]| {
        let out = folder.path().join(name);
        swept(&out, &[&["--shard", "2/2"], options].concat());
        out
    };
    let merged = folder.path().join("merged");
    let refused = |parts: &[PathBuf], expected: &str| {
        let (code, said) = merge(parts, &merged);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains(expected), "{said}");
        assert!(!merged.exists());
    };
    let first = two[0].clone();
    let seed = other("seed", &["--runs", "14", "--seed", "2"]);
    refused(&[first.clone(), seed], "sweep.json: seed: found 2, expected 1 as in ");
    let runs = other("runs", &["--runs", "12"]);
    refused(&[first.clone(), runs], "sweep.json: runs: found 12, expected 14 as in ");
    let all = other("all", &["--runs", "14", "--all"]);
    refused(
        &[first.clone(), all],
        "sweep.json: settings: found other variables, sampling, screen or expectation, expected those of the first part",
    );
    refused(std::slice::from_ref(&first), "found 1 of 2 parts, expected also 2");
    refused(&[first.clone(), first.clone()], "found part 1/2, which ");
    refused(std::slice::from_ref(&WHOLE.1), "shard: found none, expected a part (benchdog sweep --shard M/N)");
    refused(&[first.clone(), folder.path().join("nowhere")], "a part without it is not finished");

    let table = fs::read_to_string(two[1].join("runs.csv")).unwrap();
    fs::write(two[1].join("runs.csv"), table.replacen(",holds,", ",stands,", 2)).unwrap();
    refused(&two, "runs.csv:2: ");
    let shorter: Vec<&str> = table.lines().collect();
    fs::write(two[1].join("runs.csv"), shorter[..shorter.len() - 1].join("\n") + "\n").unwrap();
    refused(&two, "runs.csv: found 6 runs, expected all runs of part 2/2 of 14");
}

#[test]
fn an_expected_probability_decides_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let with = |probability: f64| {
        let file = folder.path().join("s.toml");
        let plan = root().join(PLAN);
        fs::write(
            &file,
            format!(
                "format = 1\nname = \"s\"\n\n[operation]\nkind = \"cut\"\npoint_m = [0.12, 0.0]\ndirection_o = [0.0, 1.0, 0.0]\n\
                 force_n = 30.0\n\n[planner]\nplan = \"{}\"\n\n[expect]\nprobability = {probability}\n\n[sweep]\nruns = 10\n\n\
                 [sweep.force_factor]\nkind = \"uniform\"\nlow = 0.5\nhigh = 0.6\n",
                plan.display()
            ),
        )
        .unwrap();
        let out = folder.path().join("out");
        let output = benchdog(root(), &["sweep", argument(&file), "--worst", "0", "--out", argument(&out)]);
        let junit = fs::read_to_string(out.join("junit.xml")).unwrap_or_default();
        (output.status.code().unwrap(), stderr(&output), junit)
    };
    // Ten of ten: the interval is from 0.72 to 1.
    let (code, said, junit) = with(0.6);
    assert_eq!((code, junit.contains("<failure")), (0, false), "{said}");
    let (code, said, junit) = with(0.9);
    assert_eq!((code, junit.contains("<failure")), (1, true), "{said}");
    assert!(junit.contains("expected at least 0.9"), "{junit}");
}

#[test]
fn a_narrow_interval_ends_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    swept(folder.path(), &["--runs", "2000", "--until", "0.05"]);
    let summary = json(&folder.path().join("sweep.json"));
    let estimate = &summary["estimate"];
    assert!(estimate["high"].as_f64().unwrap() - estimate["low"].as_f64().unwrap() <= 0.05);
    assert!(summary["done"].as_u64().unwrap() < 2000);
    // The interval is looked at after every hundredth run.
    assert_eq!(summary["done"].as_u64().unwrap() % 100, 0);
}

#[test]
fn wrong_arguments_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for (options, expected) in [
        (&["--shard", "8/7"][..], "expected M/N with M from 1 to N"),
        (&["--shard", "1/2", "--until", "0.1"], "cannot be used with"),
        (&["--until", "0"], "--until: found 0, expected a number from 0.0001 to 1"),
        (&["--audit", "1.5"], "--audit: found 1.5, expected a number from 0 to 1"),
        (&["--runs", "0"], "invalid value '0'"),
        (&["--runs", "4000000000"], "--runs: found 4000000000, expected at most 2147483648"),
        (&["--scenario", "nowhere.toml"], "nowhere.toml"),
    ] {
        let (code, said) = sweep(&out, options);
        assert_eq!(code, 2, "{options:?}: {said}");
        assert!(said.contains(expected), "{options:?}: {said}");
        assert!(!out.exists(), "{options:?}");
    }
    // The plan of the folder itself.
    let (_, whole) = &*WHOLE;
    let own = whole.join("plan.json");
    let output = benchdog(root(), &["sweep", argument(&own), "--out", argument(whole)]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("it is an input file of this command"), "{}", stderr(&output));
}
