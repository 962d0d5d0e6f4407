//! Equal inputs and seeds give equal bytes: in two runs, with one and two threads, and in every build.

use std::path::Path;

use benchdog::{
    judge::fingerprint,
    model::scenario::SimulationSettings,
    scenario::read_plan,
    sim::{Conditions, simulate},
};
use serde_json::Value;

use crate::{
    common::{checked, root},
    process::{benchdog, both, folder, printed_json, run_both, text_of_both},
};

/// Fingerprint of a simulation of a tenth of a second, which must be the same in all builds and on all machines. The tests
/// run in release; this checks a build without optimisation:
///
/// ```sh
/// cargo test --no-default-features --features cli --test cli a_short_hold
/// ```
///
/// After an intended change of the simulation, copy the new value from the failing test.
const SHORT_HOLD: &str = "307e9b8edf3b47bb25d59271089b4de30e9d7dfdcc915f1355f270a076a9938b";

/// A plan without the durations, which differ between runs.
fn plan_without_clock(plan: &[u8]) -> Value {
    let mut plan: Value = serde_json::from_slice(plan).unwrap();
    for duration in ["map_ms", "wall_ms"] {
        assert!(plan["planner"].as_object_mut().unwrap().remove(duration).is_some(), "no {duration}");
    }
    plan
}

#[test]
fn one_thread_and_two_give_the_same_bytes() {
    let (one, two) = (run_both("1"), both());
    for name in ["quickstart", "cut-rim"].map(Path::new) {
        let [plan, verdict] = ["plan.json", "verdict.json"].map(|file| name.join(file));
        assert_eq!(plan_without_clock(&one[&plan]), plan_without_clock(&two[&plan]));
        // The verdict holds the fingerprint of the trace.
        let [one_verdict, two_verdict] = [&one, two].map(|files| std::str::from_utf8(&files[&verdict]).unwrap());
        assert!(one_verdict.contains("\"fingerprint\""));
        assert_eq!(one_verdict, two_verdict);
        #[cfg(feature = "recording")]
        {
            let recording = name.join("recording.rrd");
            assert!(one[&recording] == two[&recording], "{}: the recordings differ", name.display());
        }
    }
}

#[test]
fn a_plan_that_went_through_a_file_gives_the_same_simulation() {
    let folder = folder(&[("plan.json", text_of_both("quickstart/plan.json"))]);
    let output = benchdog(folder.path(), &["simulate", "--record", "never", "--format", "json", "plan.json"]);
    let first: Value = serde_json::from_str(text_of_both("quickstart/verdict.json")).unwrap();
    assert_eq!(printed_json(&output)[0]["fingerprint"], first["fingerprint"]);
}

#[test]
fn a_short_hold_is_the_same_bit_by_bit_in_every_build() {
    let (plan, robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();
    // All phases, and a person.
    let settings =
        SimulationSettings { settle_s: 0.03, ramp_s: 0.04, hold_s: 0.02, release_s: 0.01, timestep_s: 0.002 };
    let trace = simulate(&checked(&robot, &plan), &Conditions::new(0.6, settings)).unwrap();
    assert!(trace.samples.len() == 51 && trace.samples[50].person_distance_m.is_some());
    assert_eq!(fingerprint(&trace), SHORT_HOLD);
}

#[test]
fn another_seed_gives_another_plan() {
    let first: Value = serde_json::from_str(text_of_both("quickstart/plan.json")).unwrap();
    assert_eq!(first["planner"]["seed"], 1);
    let other = printed_json(&benchdog(root(), &["plan", "scenarios/quickstart.toml", "--seed", "2"]));
    assert_eq!(other["planner"]["seed"], 2);
    assert_ne!(first["arms"], other["arms"]);
}
