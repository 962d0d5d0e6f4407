//! `benchdog robot new` and `benchdog doctor` of a description.

use std::fs;

use crate::{
    common::root,
    process::{argument, benchdog, folder, json, stderr},
};

#[test]
fn a_urdf_becomes_a_verdict_without_an_edit() {
    let place = folder(&[("baxter.urdf", include_str!("../../assets/baxter.urdf"))]);
    let new = ["robot", "new", "baxter.urdf", "-o", "my-robot.toml", "--scenario", "my-drill.toml"];
    let made = benchdog(place.path(), &new);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let text = fs::read_to_string(place.path().join("my-robot.toml")).unwrap();
    for assumed in ["stiffness_nm_rad", "damping_nm_s_rad", "max_force_n", "friction"] {
        let line = text.lines().find(|line| line.starts_with(assumed)).unwrap();
        assert!(line.contains("# ASSUMED"), "{line}");
    }
    let doctor = benchdog(place.path(), &["doctor", "my-robot.toml"]);
    assert_eq!(doctor.status.code(), Some(0), "{}", stderr(&doctor));
    let run = benchdog(place.path(), &["run", "my-drill.toml", "--record", "never"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let verdict = json(&place.path().join("out/my-drill/verdict.json"));
    assert_eq!(verdict["verdict"], "holds");
    // The grip is that of the description.
    let plan = json(&place.path().join("out/my-drill/plan.json"));
    assert_eq!(plan["arms"][0]["grip_force_n"], 45.0);
}

#[test]
fn files_are_replaced_only_if_asked_for() {
    let place = folder(&[("baxter.urdf", include_str!("../../assets/baxter.urdf")), ("robot.toml", "mine")]);
    let new = ["robot", "new", "baxter.urdf", "-o", "robot.toml"];
    let refused = benchdog(place.path(), &new);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("failed to write robot.toml: it exists; --force replaces it"));
    assert_eq!(fs::read_to_string(place.path().join("robot.toml")).unwrap(), "mine");
    let replaced = benchdog(place.path(), &[&new[..], &["--force"]].concat());
    assert_eq!(replaced.status.code(), Some(0), "{}", stderr(&replaced));
    // Not even then the URDF itself.
    let itself = benchdog(place.path(), &["robot", "new", "baxter.urdf", "-o", "baxter.urdf", "--force"]);
    assert_eq!(itself.status.code(), Some(2));
    assert!(stderr(&itself).contains("it is an input file of this command"), "{}", stderr(&itself));
}

#[cfg(feature = "recording")]
#[test]
fn doctor_records_the_robot() {
    let place = tempfile::tempdir().unwrap();
    let description = root().join("assets/baxter.toml");
    let doctor = |file: &str| benchdog(place.path(), &["doctor", argument(&description), "--record", file]);
    for file in ["one.rrd", "two.rrd"] {
        let output = doctor(file);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let bytes = |file: &str| fs::read(place.path().join(file)).unwrap();
    assert!(bytes("one.rrd").starts_with(b"RRF2"));
    assert_eq!(bytes("one.rrd"), bytes("two.rrd"));
}
