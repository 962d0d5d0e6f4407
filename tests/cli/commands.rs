//! Exit codes, files and JUnit reports of the commands.

use std::{fs, path::Path, process::Output};

use serde_json::Value;

use crate::{
    common::root,
    process::{argument, benchdog, command, printed_json, slipping_scenario, stderr},
};

/// Runs benchdog in the repository with this output folder.
fn benchdog_to(out: &Path, arguments: &[&str]) -> Output {
    benchdog(root(), &[arguments, &["--out", argument(out)]].concat())
}

#[test]
fn an_expectation_that_is_not_met_is_exit_code_1_and_a_junit_failure() {
    let folder = tempfile::tempdir().unwrap();
    let met = slipping_scenario(folder.path(), "as-expected", "slips");
    let not_met = slipping_scenario(folder.path(), "not-as-expected", "holds");
    let junit = folder.path().join("junit.xml");
    let output = benchdog_to(
        &folder.path().join("out"),
        &["run", &met, &not_met, "--record", "never", "--junit", junit.to_str().unwrap()],
    );
    assert_eq!(output.status.code(), Some(1));
    let junit = fs::read_to_string(junit).unwrap();
    assert!(junit.contains("tests=\"2\"") && junit.contains("failures=\"1\"") && junit.contains("errors=\"0\""));
    assert!(junit.contains("expected holds, found slips: slip"), "{junit}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("2 scenarios: 1 ok, 1 failed"), "{table}");
}

#[test]
fn no_plan_where_one_was_expected_is_exit_code_3_and_outweighs_1() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(root().join("scenarios/fails-out-of-reach.toml")).unwrap();
    let infeasible = folder.path().join("infeasible.toml");
    fs::write(&infeasible, text.replace("\"infeasible\"", "\"holds\"")).unwrap();
    let not_met = slipping_scenario(folder.path(), "not-as-expected", "holds");
    let out = folder.path().join("out");
    let output = benchdog_to(&out, &["run", infeasible.to_str().unwrap(), &not_met, "--record", "never"]);
    assert_eq!(output.status.code(), Some(3));
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.contains("the left arm does not bring the board in front"),
        "the reason names the constraint: {table}"
    );
    assert!(!out.join("fails-out-of-reach/plan.json").exists());
}

#[test]
fn two_scenarios_of_one_name_are_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let one = slipping_scenario(folder.path(), "same", "slips");
    let out = folder.path().join("out");
    let output = benchdog_to(&out, &["run", &one, &one]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("found \"same\", which is also the name of"));
    assert!(!out.exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "unwritable", "slips");
    let file = folder.path().join("a-file");
    fs::write(&file, "").unwrap();
    let output = benchdog_to(&file, &["run", &scenario]);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.starts_with("error: failed to write") && message.lines().count() == 1, "{message}");
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let mut child = command(root(), &["schema", "plan"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Closed long before the process prints.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
}

const CUT: &str = include_str!("../../scenarios/plans/cut-rim.json");
const LEVER: &str = include_str!("../../scenarios/plans/long-lever.json");

/// The verdict on a changed plan, and the exit code of `simulate`.
fn verdict_on_changed_plan(plan: &str, change: impl FnOnce(&mut Value)) -> (Value, Option<i32>) {
    let folder = tempfile::tempdir().unwrap();
    let mut plan: Value = serde_json::from_str(plan).unwrap();
    change(&mut plan);
    let path = folder.path().join("plan.json");
    fs::write(&path, plan.to_string()).unwrap();
    let output = benchdog_to(folder.path(), &["simulate", path.to_str().unwrap(), "--format", "json"]);
    (printed_json(&output)[0].clone(), output.status.code())
}

#[test]
fn a_plan_with_a_person_in_the_robot_touches() {
    let (verdict, exit) = verdict_on_changed_plan(CUT, |plan| {
        plan["human"]["x_wb"]["translation_m"] = serde_json::json!([0.0, 0.0, -0.9242])
    });
    assert_eq!((verdict["verdict"].as_str(), exit), (Some("touches"), Some(1)));
    assert!(verdict["reason"].as_str().unwrap().contains("expected more than"), "{verdict:#}");
}

#[test]
fn a_board_too_heavy_for_its_grip_is_lost_before_the_load() {
    // Four pads of 0.1 N with a friction of 0.6 hold 0.24 N; the plank weighs 38 N.
    let (verdict, exit) = verdict_on_changed_plan(LEVER, |plan| {
        for arm in plan["arms"].as_array_mut().unwrap() {
            arm["grip_force_n"] = 0.1.into();
        }
    });
    assert_eq!((verdict["verdict"].as_str(), exit), (Some("opens"), Some(1)), "{verdict:#}");
    assert_eq!(verdict["first_failure"]["load_factor"], 0.0);
    // It falls, but nothing is judged once it is lost.
    let slip_mm = verdict["checks"][0]["value"].as_f64().unwrap();
    assert!((50.0..60.0).contains(&slip_mm), "{slip_mm}");
}

#[test]
fn files_of_an_earlier_run_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "again", "slips");
    let recording = folder.path().join("again/recording.rrd");
    benchdog_to(folder.path(), &["run", &scenario]);
    assert_eq!(recording.exists(), cfg!(feature = "recording"));
    benchdog_to(folder.path(), &["run", &scenario, "--record", "never"]);
    assert!(!recording.exists() && folder.path().join("again/verdict.json").exists());
}

#[cfg(feature = "recording")]
#[test]
fn a_recording_contains_the_verdict() {
    use benchdog::model::verdict::{CheckKind, Verdict};

    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "recorded", "slips");
    let output = benchdog_to(folder.path(), &["run", &scenario]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let folder = folder.path().join("recorded");
    let written: Verdict = serde_json::from_slice(&fs::read(folder.join("verdict.json")).unwrap()).unwrap();
    let recorded = benchdog::record::read_summary(&folder.join("recording.rrd")).unwrap();
    assert_eq!(recorded.verdict, written);
    let judged = |kind| written.check(kind).unwrap().value;
    let worst = |peaks: &std::collections::BTreeMap<String, f64>| peaks.values().copied().fold(0.0, f64::max);
    // Plots are stored as 64-bit numbers; their peaks are the judged values.
    assert_eq!(worst(&recorded.peaks.slip_mm), judged(CheckKind::Slip));
    assert_eq!(worst(&recorded.peaks.rotation_deg), judged(CheckKind::SlipRotation));
    assert_eq!(recorded.peaks.deflection_mm, judged(CheckKind::Deflection));
}

#[test]
fn only_failed_runs_are_recorded_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let met = slipping_scenario(folder.path(), "as-expected", "slips");
    let output = benchdog_to(folder.path(), &["run", &met, "--record", "failed", "--format", "json"]);
    assert_eq!(printed_json(&output)[0]["verdict"], "slips");
    assert!(!folder.path().join("as-expected/recording.rrd").exists());
}

/// Runs benchdog and returns its exit code and the largest number of threads that it had.
#[cfg(target_os = "linux")]
fn most_threads(arguments: &[&str], folder: &Path) -> (Option<i32>, usize) {
    let mut child = command(folder, arguments)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let tasks = format!("/proc/{}/task", child.id());
    let mut most = 0;
    loop {
        most = most.max(fs::read_dir(&tasks).map_or(0, Iterator::count));
        if let Some(status) = child.try_wait().unwrap() {
            return (status.code(), most);
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn jobs_bounds_the_threads_of_maps_plans_and_simulations() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(root().join("scenarios/quickstart.toml")).unwrap();
    // Four scenarios that share their maps: with more threads than one, several ask for the same map.
    for place in 1..=4 {
        let text = text.replace("quickstart", &format!("hole-{place}"));
        let text = text.replace("[0.0, 0.0]", &format!("[0.0, 0.0{place}]"));
        fs::write(folder.path().join(format!("hole-{place}.toml")), text).unwrap();
    }
    for jobs in [1, 3] {
        let (code, threads) =
            most_threads(&["run", ".", "--no-cache", "--record", "never", "--jobs", &jobs.to_string()], folder.path());
        assert_eq!(code, Some(0));
        // The main thread and that of the signal handler do no work of their own.
        assert_eq!(threads, jobs + 2, "--jobs {jobs}");
    }
}
