//! Robots that are not built in, and descriptions that must be refused with a message that helps.

use std::path::Path;

use benchdog::{
    model::{
        wrench::Wrench,
        wrench_limits::{LimitShape, WrenchLimits},
    },
    robot::{Chain, MeasuredGrip, Robot, RobotError},
};
use nalgebra::Vector6;

use crate::common::baxter;

const DESCRIPTION: &str = include_str!("../../assets/baxter.toml");
const URDF: &str = include_str!("../../assets/baxter.urdf");

fn load(description: &str, urdf: &str) -> Result<Robot, RobotError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.toml"), description).unwrap();
    std::fs::write(folder.path().join("baxter.urdf"), urdf).unwrap();
    Robot::load("robot.toml", folder.path())
}

/// The message for a description or URDF in which one text was replaced.
fn message(in_urdf: bool, from: &str, to: &str) -> String {
    let source = if in_urdf { URDF } else { DESCRIPTION };
    assert!(source.contains(from), "{from}");
    let changed = source.replacen(from, to, 1);
    let result = if in_urdf { load(DESCRIPTION, &changed) } else { load(&changed, URDF) };
    result.expect_err(to).to_string()
}

/// The line of the first appearance of a text.
fn line_of(text: &str) -> String {
    let before = &DESCRIPTION[..DESCRIPTION.find(text).unwrap()];
    format!("robot.toml: line {}: ", before.lines().count() + usize::from(before.ends_with('\n')))
}

#[test]
fn a_file_is_as_good_as_the_built_in_one() {
    let (built_in, file) = (baxter(), load(DESCRIPTION, URDF).unwrap());
    let q_rad = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6, -0.7];
    assert_eq!(Chain::new(built_in, 1, 0.01).gripper_pose(&q_rad), Chain::new(&file, 1, 0.01).gripper_pose(&q_rad));
    assert_eq!(built_in.allowed_collisions, file.allowed_collisions);
}

#[test]
fn unknown_robots_and_missing_files_are_told_apart() {
    let unknown = Robot::load("no_such_robot", Path::new(".")).unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "found robot \"no_such_robot\", expected a built-in robot (baxter, dual-panda, dual-ur5) or the path of a description file"
    );
    let nowhere = Path::new("/nowhere");
    let missing = Robot::load("missing.toml", nowhere).unwrap_err();
    let expected = format!("failed to read {}: ", nowhere.join("missing.toml").display());
    assert!(missing.to_string().starts_with(&expected), "{missing}");
}

#[test]
fn messages_about_descriptions_name_line_key_found_and_expected() {
    let cases = [
        ("format = 1", "format = 2", "format: found 2, expected 1"),
        ("floor_z_m = -0.9242", "floor_z_m = nan", "floor_z_m: found NaN, expected a finite height in m"),
        ("\"torso\", \"head\"", "\"torso\", \"hat\"", "allowed_collisions: found \"hat\", expected the name of a link"),
        ("\"torso\", \"head\"", "\"torso\", \"torso\"", "allowed_collisions: found torso twice, expected two links"),
        ("link = \"head\", p_m", "link = \"hat\", p_m", "body_points: found \"hat\", expected the name of a link"),
        ("effort_nm = [50.0, ", "effort_nm = [", "effort_nm: found 6 numbers, expected 7, one a joint"),
        ("effort_nm = [50.0", "effort_nm = [-50.0", "effort_nm: found -50, expected finite numbers above 0"),
        ("stiffness_nm_rad = [843.0", "stiffness_nm_rad = [inf", "stiffness_nm_rad: found inf, expected finite"),
        ("joints = [\"left_s0\", ", "joints = [", "joints: found left_s1 left_e0"),
        (
            "joints = [\"left_s0\"",
            "joints = [\"torso_t0\"",
            "joints: found \"torso_t0\", expected the name of a revolute",
        ),
        ("base_link = \"left_arm_mount\"", "base_link = \"right_arm_mount\"", "base_link: found right_arm_mount"),
        (
            "palm_link = \"left_gripper_base_link\"",
            "palm_link = \"torso\"",
            "palm_link: found torso, expected a link fixed",
        ),
        ("opening_m = [0.0, 0.038]", "opening_m = [0.0, 0.05]", "opening_m: found 0 to 0.05, expected two gaps within"),
        ("max_force_n = 35.0", "max_force_n = 0.0", "max_force_n: found 0, expected finite numbers above 0"),
        (
            "max_force_n = 35.0",
            "pad_stiffness_n_m = 9e3\nmax_force_n = 35.0",
            "pad_stiffness_n_m: found 9000, expected 10000 to 1000000000 N/m, or no such key for rigid pads",
        ),
        ("max_force_n = 35.0", "pad_stiffness_n_m = nan\nmax_force_n = 35.0", "pad_stiffness_n_m: found NaN, expected"),
        (
            "pad_link = \"l_gripper_l_finger_tip\"",
            "pad_link = \"l_gripper_r_finger_tip\"",
            "pad_link: found l_gripper_r",
        ),
        ("name = \"right\"", "name = \"left\"", "name: found left, expected a name that no other arm has"),
        ("max_force_n = 35.0", "force_n = 35.0", "unknown field `force_n`, expected one of"),
    ];
    for (from, to, expected) in cases {
        let message = message(false, from, to);
        assert!(message.contains(expected), "{message}");
        assert!(message.contains(&line_of(from)), "{message}, expected {}", line_of(from));
    }
}

#[test]
fn messages_about_urdfs_name_the_link_or_joint() {
    let cases = [
        ("<mass value=\"35.3365\"/>", "<mass value=\"-1\"/>", "link torso: found a mass of -1 kg"),
        (
            "<collision name=\"neck\"><origin xyz=\"-0.0911 0 0.6696\"/><geometry><box size=\"0.1471 0.08 0.068\"/>",
            "<collision name=\"neck\"><geometry><mesh filename=\"neck.stl\"/>",
            "link torso: mesh: found no file",
        ),
        ("lower=\"-2.147\"", "lower=\"2.147\"", "joint left_s1: found limits 2.147 to 1.047"),
        ("<parent link=\"torso\"/>", "<parent link=\"trunk\"/>", "joint pedestal_fixed: found link \"trunk\""),
        ("<child link=\"pedestal\"/>", "<child link=\"torso\"/>", "link torso: found two joints that carry it"),
        ("<link name=\"display\"/>", "<link name=\"screen\"/>", "link screen: found this name twice"),
        (
            "name=\"head_pan\" type=\"revolute\"",
            "name=\"head_pan\" type=\"planar\"",
            "joint head_pan: found type Planar",
        ),
        ("</robot>", "", "found malformed urdf"),
    ];
    for (from, to, expected) in cases {
        let message = message(true, from, to);
        assert!(message.contains(&format!("baxter.urdf: {expected}")), "{message}");
    }
}

#[test]
fn fingers_must_close_along_the_grippers_y() {
    let message = message(true, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"1 0 0\"/>");
    let expected =
        "found l_gripper_l_finger_joint along (1.0000, 0.0000, 0.0000) of the gripper's frame, expected an axis along";
    assert!(message.contains(expected), "{message}");
}

/// Measured limits in place of the force of the fingers of the left gripper.
const MEASURED: &str =
    "wrench_limits = { shape = \"ellipsoid\", force_n = [200, 200.0, [-60.0, 300]], moment_nm = [20.0, 15.0, 10.0] }";

#[test]
fn measured_limits_take_the_place_of_force_and_friction() {
    let with = |lines: &str| load(&DESCRIPTION.replacen("max_force_n = 35.0", lines, 1), URDF);
    let robot = with(MEASURED).unwrap();
    let mut limits =
        WrenchLimits::symmetric(LimitShape::Ellipsoid, Wrench::from([200.0, 200.0, 300.0, 20.0, 15.0, 10.0]));
    limits.low.force_n.z = -60.0;
    assert_eq!(robot.arms[0].gripper.holding.measured(), Some(&MeasuredGrip { limits, stiffness: None }));
    assert!(robot.arms[1].gripper.holding.pads().is_some());
    let elastic = "hold_stiffness_n_m = [1e5, 2e5, 3e5]\nhold_stiffness_nm_rad = [100.0, 200.0, 300.0]";
    let robot = with(&format!("{MEASURED}\n{elastic}")).unwrap();
    let stiffness = Some(Vector6::new(1e5, 2e5, 3e5, 100.0, 200.0, 300.0));
    assert_eq!(robot.arms[0].gripper.holding.measured(), Some(&MeasuredGrip { limits, stiffness }));
}

#[test]
fn messages_about_measured_limits_name_line_key_found_and_expected() {
    let beside = "expected no such key beside wrench_limits, which say what the gripper holds";
    let limits = "expected a number above 0 and up to 10000 N, or [low, high] with low below and high above 0";
    let changed = |from: &str, to: &str| {
        assert!(MEASURED.contains(from), "{from}");
        MEASURED.replace(from, to)
    };
    let cases = [
        (format!("{MEASURED}\nmax_force_n = 35.0"), 1, format!("max_force_n: found 35, {beside}")),
        (format!("{MEASURED}\ngrip_force_n = 30.0"), 1, format!("grip_force_n: found 30, {beside}")),
        (format!("{MEASURED}\nfriction = 0.6"), 1, format!("friction: found 0.6, {beside}")),
        (format!("{MEASURED}\npad_stiffness_n_m = 8e5"), 1, format!("pad_stiffness_n_m: found 800000, {beside}")),
        (changed("200.0", "0.0"), 0, format!("wrench_limits.force_n: found 0, {limits}")),
        (changed("200.0", "2e4"), 0, format!("wrench_limits.force_n: found 20000, {limits}")),
        (changed("-60.0", "60.0"), 0, format!("wrench_limits.force_n: found [60, 300], {limits}")),
        (changed("-60.0, 300", "-60.0, inf"), 0, format!("wrench_limits.force_n: found [-60, inf], {limits}")),
        (
            changed("15.0", "nan"),
            0,
            "wrench_limits.moment_nm: found NaN, expected a number above 0 and up to 1000 N m".into(),
        ),
        (changed("ellipsoid", "ball"), 0, "unknown variant `ball`, expected `box` or `ellipsoid`".into()),
        (changed("-60.0, 300", "-60.0, 10, 300"), 0, "invalid length 3, expected an array of length 2".into()),
        (
            changed("[-60.0, 300]", "\"much\""),
            0,
            "invalid type: string \"much\", expected a number for both directions, or [low, high]".into(),
        ),
        (changed(", 10.0]", "]"), 0, "invalid length 2, expected an array of length 3".into()),
        (
            format!("{MEASURED}\nhold_stiffness_n_m = [1e5, 1e5, 1e5]"),
            1,
            "hold_stiffness: found one of two keys, expected both hold_stiffness_n_m and hold_stiffness_nm_rad".into(),
        ),
        (
            format!("{MEASURED}\nhold_stiffness_n_m = [1e5, 1.0, 1e5]\nhold_stiffness_nm_rad = [1.0, 1.0, 1.0]"),
            1,
            "hold_stiffness_n_m: found 1, expected three numbers from 100 to 1000000000 N/m".into(),
        ),
        (
            "max_force_n = 35.0\nhold_stiffness_n_m = [1e5, 1e5, 1e5]".into(),
            1,
            "hold_stiffness_n_m: found a stiffness, expected no such key without wrench_limits".into(),
        ),
        (
            "friction = 0.6".into(),
            -3,
            "max_force_n: found none, expected the force of each finger, N, or wrench".into(),
        ),
    ];
    let first = 1 + DESCRIPTION.lines().position(|line| line == "max_force_n = 35.0").unwrap();
    for (lines, further, expected) in cases {
        let message = message(false, "max_force_n = 35.0", &lines);
        let line = format!("robot.toml: line {}: ", first as i64 + further);
        assert!(message.contains(&format!("{line}{expected}")), "{message}, expected {line}{expected}");
    }
}
