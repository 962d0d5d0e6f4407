//! Equal inputs and seeds give equal bytes: in two runs, with one and two threads, and in every build.

use std::{fs, path::Path, process::Command};

use benchdog::{
    check::CheckedPlan,
    human::default_tool,
    judge::fingerprint,
    model::scenario::SimulationSettings,
    scenario::read_plan,
    sim::{Conditions, simulate},
};
use serde_json::Value;

/// Fingerprint of a simulation of a tenth of a second, which must be the same in all builds and on all machines. The tests
/// run in release; this checks a build without optimisation:
///
/// ```sh
/// cargo test --no-default-features --features cli --test cli a_short_hold
/// ```
///
/// After an intended change of the simulation, copy the new value from the failing test.
const SHORT_HOLD: &str = "d41bbe0c888ac6747dd2f6ffa7f3b64c0ec6044c8697c663aa41db015fa0a7c4";

const SCENARIOS: [&str; 2] = ["scenarios/quickstart.toml", "scenarios/cut-rim.toml"];

fn run(out: &Path, jobs: &str) {
    let status = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["run", "--jobs", jobs, "--out"])
        .arg(out)
        .args(SCENARIOS)
        .output()
        .unwrap()
        .status;
    assert!(status.success());
}

/// A plan without the durations, which differ between runs.
fn plan_without_clock(path: &Path) -> Value {
    let mut plan: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    for duration in ["map_ms", "wall_ms"] {
        assert!(plan["planner"].as_object_mut().unwrap().remove(duration).is_some(), "no {duration}");
    }
    plan
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    run(folders[0].path(), "1");
    run(folders[1].path(), "2");
    for name in ["quickstart", "cut-rim"] {
        let [one, two] = folders.each_ref().map(|folder| folder.path().join(name));
        assert_eq!(plan_without_clock(&one.join("plan.json")), plan_without_clock(&two.join("plan.json")));
        // The verdict holds the fingerprint of the trace.
        let [one, two] = [one, two].map(|folder| fs::read_to_string(folder.join("verdict.json")).unwrap());
        assert!(one.contains("\"fingerprint\""));
        assert_eq!(one, two);
        #[cfg(feature = "recording")]
        {
            let [one, two] = folders.each_ref().map(|folder| folder.path().join(name).join("recording.rrd"));
            assert!(fs::read(one).unwrap() == fs::read(two).unwrap(), "{name}: the recordings differ");
        }
    }
}

#[test]
fn a_plan_that_went_through_a_file_gives_the_same_simulation() {
    let out = tempfile::tempdir().unwrap();
    run(out.path(), "2");
    let folder = out.path().join("quickstart");
    let output = Command::new(env!("CARGO_BIN_EXE_benchdog"))
        .args(["simulate", "--record", "never", "--format", "json", "--out"])
        .arg(out.path().join("again"))
        .arg(folder.join("plan.json"))
        .output()
        .unwrap();
    let again: Value = serde_json::from_slice::<Vec<Value>>(&output.stdout).unwrap().remove(0);
    let first: Value = serde_json::from_slice(&fs::read(folder.join("verdict.json")).unwrap()).unwrap();
    assert_eq!(again["fingerprint"], first["fingerprint"]);
}

#[test]
fn a_short_hold_is_the_same_bit_by_bit_in_every_build() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    let (plan, robot) = read_plan(&path, None).unwrap();
    let checked = CheckedPlan::new(&robot, &plan, &default_tool(plan.operation.kind)).unwrap();
    // All phases, and a person.
    let settings =
        SimulationSettings { settle_s: 0.03, ramp_s: 0.04, hold_s: 0.02, release_s: 0.01, timestep_s: 0.002 };
    let trace = simulate(&checked, &Conditions::new(0.6, settings)).unwrap();
    assert!(trace.samples.len() == 51 && trace.samples[50].person_distance_m.is_some());
    assert_eq!(fingerprint(&trace), SHORT_HOLD);
}

#[test]
fn another_seed_gives_another_plan() {
    let plans = ["1", "2"].map(|seed| {
        let output = Command::new(env!("CARGO_BIN_EXE_benchdog"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["plan", "scenarios/quickstart.toml", "--seed", seed])
            .output()
            .unwrap();
        let plan: Value = serde_json::from_slice(&output.stdout).unwrap();
        plan["arms"].clone()
    });
    assert_ne!(plans[0], plans[1]);
}
