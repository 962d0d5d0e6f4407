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

/// A scenario of a drill with this robot of `scenarios/robots` and further lines.
fn drill_with(robot: &str, lines: &str) -> String {
    let description = root().join("scenarios/robots").join(robot);
    format!(
        "format = 1\nname = \"drill\"\n{lines}[robot]\ndescription = \"{}\"\n\
         [operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n",
        description.display()
    )
}

#[test]
fn what_measured_grippers_do_not_have_is_refused() {
    let cases = [
        (
            "dual-ur5-suction.toml",
            "",
            "planner.plan: found none for a robot whose left arm has a suction cup, expected the path of a plan: planners \
             know grasps of edges alone",
        ),
        (
            "dual-ur5-measured.toml",
            "[grip]\nfriction = 0.5\n",
            "grip.friction: found a value, expected none: it belongs to pads, and every gripper of this robot has measured \
             wrench limits",
        ),
    ];
    for (robot, lines, expected) in cases {
        let place = folder(&[("drill.toml", &drill_with(robot, lines))]);
        let run = benchdog(place.path(), &["run", "drill.toml"]);
        assert_eq!(run.status.code(), Some(2), "{}", stderr(&run));
        assert!(stderr(&run).contains(expected), "{}", stderr(&run));
        assert!(!place.path().join("out").exists());
    }
}

#[test]
fn measured_grippers_are_not_exported() {
    let place = tempfile::tempdir().unwrap();
    let plan = root().join("scenarios/plans/suction-cups.json");
    let export = benchdog(place.path(), &["export", argument(&plan), "--mjcf", "scene.xml"]);
    assert_eq!(export.status.code(), Some(2));
    let expected =
        "found measured wrench limits of the left gripper, expected grippers with pads: the MJCF export has no other";
    assert!(stderr(&export).contains(expected), "{}", stderr(&export));
    assert!(!place.path().join("scene.xml").exists());
}

#[test]
fn doctor_tells_what_measured_grippers_hold() {
    let place = tempfile::tempdir().unwrap();
    let doctor = |robot: &str| {
        let description = root().join("scenarios/robots").join(robot);
        let output = benchdog(place.path(), &["doctor", argument(&description)]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let measured = doctor("dual-ur5-measured.toml");
    let expected = "pads 18.0 x 18.0 mm, rigid within a measured ellipsoid: force 150, 150, 150 N; moment 8, 6, 8 N m";
    assert!(measured.contains(expected), "{measured}");
    let suction = doctor("dual-ur5-suction.toml");
    let expected = "suction cup of 80.0 mm, elastic within a measured ellipsoid: force 60, 60, -100 to 300 N";
    assert!(suction.contains(expected), "{suction}");
}
