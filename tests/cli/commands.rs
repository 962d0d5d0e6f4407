//! Exit codes, files and JUnit reports of the commands.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;

fn benchdog(arguments: &[&str], out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap()
}

/// Writes the weak-grip scenario with another name and expectation, and its plan; returns the scenario's path.
fn slipping_scenario(folder: &Path, name: &str, expected: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let plans = folder.join("plans");
    fs::create_dir_all(&plans).unwrap();
    fs::copy(root.join("plans/cut-rim-weak-grip.json"), plans.join("cut-rim-weak-grip.json")).unwrap();
    let text = fs::read_to_string(root.join("fails-weak-grip.toml")).unwrap();
    let text = text.replace("fails-weak-grip", name).replace("\"slips\"", &format!("\"{expected}\""));
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn an_expectation_that_is_not_met_is_exit_code_1_and_a_junit_failure() {
    let folder = tempfile::tempdir().unwrap();
    let met = slipping_scenario(folder.path(), "as-expected", "slips");
    let not_met = slipping_scenario(folder.path(), "not-as-expected", "holds");
    let junit = folder.path().join("junit.xml");
    let output = benchdog(
        &["run", &met, &not_met, "--record", "never", "--junit", junit.to_str().unwrap()],
        &folder.path().join("out"),
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = fs::read_to_string(root.join("fails-out-of-reach.toml")).unwrap();
    let infeasible = folder.path().join("infeasible.toml");
    fs::write(&infeasible, text.replace("\"infeasible\"", "\"holds\"")).unwrap();
    let not_met = slipping_scenario(folder.path(), "not-as-expected", "holds");
    let out = folder.path().join("out");
    let output = benchdog(&["run", infeasible.to_str().unwrap(), &not_met, "--record", "never"], &out);
    assert_eq!(output.status.code(), Some(3));
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("robot reach"), "the reason names the constraint: {table}");
    assert!(!out.join("fails-out-of-reach/plan.json").exists());
}

#[test]
fn two_scenarios_of_one_name_are_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let one = slipping_scenario(folder.path(), "same", "slips");
    let out = folder.path().join("out");
    let output = benchdog(&["run", &one, &one], &out);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("found \"same\", which is also the name of"));
    assert!(!out.exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "unwritable", "slips");
    let file = folder.path().join("a-file");
    fs::write(&file, "").unwrap();
    let output = benchdog(&["run", &scenario], &file);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.starts_with("error: failed to write") && message.lines().count() == 1, "{message}");
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .args(["schema", "plan"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Closed long before the process prints.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
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
    let output = benchdog(&["simulate", path.to_str().unwrap(), "--format", "json"], folder.path());
    let verdicts: Vec<Value> = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    (verdicts[0].clone(), output.status.code())
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
fn a_board_too_heavy_for_its_grip_drops_before_the_load() {
    // Four pads of 0.1 N with a friction of 0.6 hold 0.24 N; the plank weighs 38 N.
    let (verdict, exit) = verdict_on_changed_plan(LEVER, |plan| {
        for arm in plan["arms"].as_array_mut().unwrap() {
            arm["grip_force_n"] = 0.1.into();
        }
    });
    assert_eq!((verdict["verdict"].as_str(), exit), (Some("drops"), Some(1)), "{verdict:#}");
    assert_eq!(verdict["first_failure"]["load_factor"], 0.0);
}

#[test]
fn files_of_an_earlier_run_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "again", "slips");
    let recording = folder.path().join("again/recording.rrd");
    benchdog(&["run", &scenario], folder.path());
    assert_eq!(recording.exists(), cfg!(feature = "recording"));
    benchdog(&["run", &scenario, "--record", "never"], folder.path());
    assert!(!recording.exists() && folder.path().join("again/verdict.json").exists());
}

#[cfg(feature = "recording")]
#[test]
fn a_recording_contains_the_verdict() {
    use benchdog::model::verdict::{CheckKind, Verdict};

    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "recorded", "slips");
    let output = benchdog(&["run", &scenario], folder.path());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
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
    let output = benchdog(&["run", &met, "--record", "failed", "--format", "json"], folder.path());
    let verdicts: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(verdicts[0]["verdict"], "slips");
    assert!(!folder.path().join("as-expected/recording.rrd").exists());
}

/// Runs benchdog and returns its exit code and the largest number of threads that it had.
#[cfg(target_os = "linux")]
fn most_threads(arguments: &[&str], folder: &Path) -> (Option<i32>, usize) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .current_dir(folder)
        .args(arguments)
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = fs::read_to_string(root.join("quickstart.toml")).unwrap();
    // Four scenarios that share their maps: with more threads than one, several ask for the same map.
    for place in 1..=4 {
        let text = text.replace("quickstart", &format!("hole-{place}"));
        let text = text.replace("[0.0, 0.0]", &format!("[0.0, 0.0{place}]"));
        fs::write(folder.path().join(format!("hole-{place}.toml")), text).unwrap();
    }
    for jobs in [1, 3] {
        let (code, threads) =
            most_threads(&["run", ".", "--record", "never", "--jobs", &jobs.to_string()], folder.path());
        assert_eq!(code, Some(0));
        // The main thread and that of the signal handler do no work of their own.
        assert_eq!(threads, jobs + 2, "--jobs {jobs}");
    }
}
