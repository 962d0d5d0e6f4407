//! Invalid input: exit code 2, one message with file, line, key, the value found and the value expected, and no file
//! written.

use std::{fs, process::Output};

use crate::process::{benchdog, folder, stderr, text_of_both};

pub const SCENARIO: &str = "format = 1
name = \"bad\"

[object]
size_m = [0.50, 0.40, 0.030]

[operation]
kind = \"drill\"
point_m = [0.0, 0.0]
force_n = 15.0

[grip]
force_n = 30.0
friction = 0.6
";

/// Runs benchdog in a folder with one input file; returns its output and the names of all files afterwards.
fn benchdog_on(file: &str, text: &str, arguments: &[&str]) -> (Output, Vec<String>) {
    let folder = folder(&[(file, text)]);
    let output = benchdog(folder.path(), arguments);
    let mut left: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    left.sort();
    (output, left)
}

/// Asserts that a scenario with one replacement is refused with this message.
#[track_caller]
pub fn assert_scenario_refused(replace: &str, with: &str, message: &str) {
    assert!(SCENARIO.contains(replace));
    let (output, left) =
        benchdog_on("bad.toml", &SCENARIO.replacen(replace, with, 1), &["run", "bad.toml", "--junit", "junit.xml"]);
    assert_refused(&output, message);
    assert_eq!(left, ["bad.toml"], "files were written");
}

#[track_caller]
pub fn assert_refused(output: &Output, message: &str) {
    assert_eq!(stderr(output), format!("error: {message}\n"));
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
}

#[test]
fn the_scenario_without_a_replacement_is_valid() {
    let (output, _) = benchdog_on("good.toml", SCENARIO, &["run", "good.toml", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_missing_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = benchdog(folder.path(), &["run", "nowhere.toml"]);
    let cause = fs::read(folder.path().join("nowhere.toml")).unwrap_err();
    assert_refused(&output, &format!("nowhere.toml: failed to read the file: {cause}"));
}

#[test]
fn broken_toml() {
    assert_scenario_refused(
        "force_n = 15.0",
        "force_n = ",
        "bad.toml:10: string values must be quoted, expected literal string",
    );
}

#[test]
fn an_unknown_key() {
    assert_scenario_refused(
        "friction",
        "frictoin",
        "bad.toml:14: grip.frictoin: unknown field `frictoin`, expected `force_n` or `friction`; did you mean \"friction\"?",
    );
}

#[test]
fn a_value_of_the_wrong_type() {
    assert_scenario_refused(
        "friction = 0.6",
        "friction = \"high\"",
        "bad.toml:14: grip.friction: invalid type: string \"high\", expected f64",
    );
}

#[test]
fn a_negative_number() {
    assert_scenario_refused(
        "force_n = 30.0",
        "force_n = -30.0",
        "bad.toml:13: grip.force_n: found -30, expected a positive number (N)",
    );
}

#[test]
fn not_a_number() {
    assert_scenario_refused(
        "force_n = 15.0",
        "force_n = nan",
        "bad.toml:10: operation.force_n: found NaN, expected a positive number (N)",
    );
}

#[test]
fn a_board_thicker_than_the_gripper_opens() {
    assert_scenario_refused(
        "0.030]",
        "0.050]",
        "bad.toml:5: object.size_m[2]: found 0.05, expected a thickness that the left gripper closes on: 0 to 0.038 m",
    );
}

#[test]
fn an_operation_point_off_the_board() {
    assert_scenario_refused(
        "point_m = [0.0, 0.0]",
        "point_m = [0.3, 0.0]",
        "bad.toml:9: operation.point_m: found [0.3, 0], expected a point on the board: |x| <= 0.25 m, |y| <= 0.2 m",
    );
}

#[test]
fn an_operation_without_its_force() {
    assert_scenario_refused(
        "force_n = 15.0\n",
        "",
        "bad.toml:7: operation.force_n: found nothing, expected a force in N",
    );
}

#[test]
fn an_unknown_robot() {
    assert_scenario_refused(
        "[grip]",
        "[robot]\ndescription = \"backster\"\n\n[grip]",
        "bad.toml:13: robot.description: found robot \"backster\", expected a built-in robot (baxter, dual-panda, dual-ur5) or the path of a description file; did you mean \"baxter\"?",
    );
}

#[test]
fn an_unknown_material() {
    assert_scenario_refused(
        "[operation]",
        "material = \"cheese\"\n\n[operation]",
        "bad.toml:7: object.material: found \"cheese\", expected one of acrylic, balsa, foam, mdf, plywood, softwood",
    );
}

#[test]
fn a_format_from_the_future() {
    assert_scenario_refused(
        "format = 1",
        "format = 2",
        "bad.toml:1: format: found 2, expected 1, the only format that benchdog 0.2.0 reads",
    );
}

pub const PLAN: &str = include_str!("../../scenarios/plans/cut-rim.json");

/// Asserts that a plan with one replacement is refused with this message.
#[track_caller]
pub fn assert_plan_refused(replace: &str, with: &str, message: &str) {
    assert!(PLAN.contains(replace), "the plan has no {replace}");
    let (output, left) =
        benchdog_on("bad.json", &PLAN.replacen(replace, with, 1), &["simulate", "bad.json", "--junit", "junit.xml"]);
    assert_refused(&output, message);
    assert_eq!(left, ["bad.json"], "files were written");
}

#[test]
fn the_plan_without_a_replacement_is_valid() {
    let (output, _) = benchdog_on("good.json", PLAN, &["simulate", "good.json", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_plan_that_is_not_json() {
    assert_plan_refused("\"arms\": [", "\"arms\": ", "bad.json:51: arms: invalid type: map, expected a sequence");
}

#[test]
fn an_unknown_key_in_a_plan() {
    assert_plan_refused(
        "\"grip_force_n\"",
        "\"grip\"",
        "bad.json:84: arms[0].grip: unknown field `grip`, expected one of `name`, `joints`, `q_rad`, `seed_rad`, \
         `x_og`, `grip_force_n`; did you mean \"grip_force_n\"?",
    );
}

#[test]
fn joints_that_are_not_the_robots() {
    assert_plan_refused(
        "\"left_s0\"",
        "\"left_x0\"",
        "bad.json:53: arms[0].joints: found left_x0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2, expected the joints \
         of the left arm: left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2",
    );
}

#[test]
fn an_arm_that_the_robot_does_not_have() {
    assert_plan_refused(
        "\"name\": \"left\"",
        "\"name\": \"middle\"",
        "bad.json:52: arms[0].name: found \"middle\", expected an arm of the robot: left, right",
    );
}

#[test]
fn an_angle_outside_its_limits() {
    assert_plan_refused(
        "-1.3336723066966067",
        "7.5",
        "bad.json:63: arms[0].q_rad[0]: found 7.5, expected -1.70167993878 to 1.70167993878 rad, the limits of left_s0",
    );
}

#[test]
fn a_hand_that_is_not_where_its_angles_put_it() {
    assert_plan_refused(
        "-0.22714630705690375",
        "-0.165",
        "bad.json:71: arms[0].x_og: found the gripper 62.15 mm and 0.00 degrees from where q_rad puts it, expected x_wo \
         x_og to equal the arm's forward kinematics within 1 mm and 0.1 degrees",
    );
}

#[test]
fn a_quaternion_not_of_unit_length() {
    assert_plan_refused(
        "0.6682085045902386",
        "0.7",
        "bad.json:49: object.x_wo: found a quaternion of length 1.0215172022013517, expected unit length",
    );
}

#[test]
fn a_grip_stronger_than_the_gripper() {
    assert_plan_refused(
        "\"grip_force_n\": 30.0",
        "\"grip_force_n\": 40.0",
        "bad.json:84: arms[0].grip_force_n: found 40, expected at most 35 N, what the left gripper gives",
    );
}

#[test]
fn a_plan_for_an_unknown_robot() {
    assert_plan_refused(
        "\"robot\": \"baxter\"",
        "\"robot\": \"backster\"",
        "bad.json:4: robot: found robot \"backster\", expected a built-in robot (baxter, dual-panda, dual-ur5) or the path of a description file; did you mean \"baxter\"?",
    );
}

#[test]
fn a_plan_of_a_format_from_the_future() {
    assert_plan_refused(
        "\"format\": 1,",
        "\"format\": 3, \"colour\": \"blue\",",
        "bad.json:2: format: found 3, expected 1, the only format that benchdog 0.2.0 reads",
    );
}

#[test]
fn a_plan_for_another_operation_than_the_scenarios() {
    let scenario = format!("{SCENARIO}\n[planner]\nplan = \"plan.json\"\n");
    let folder = folder(&[("plan.json", PLAN), ("bad.toml", &scenario)]);
    let output = benchdog(folder.path(), &["run", "bad.toml"]);
    assert_refused(
        &output,
        "bad.toml:17: planner.plan: found a plan for cut with [0.0, 30.0, 0.0, 0.0, 0.0, 0.0] at [0.12, 0.0, 0.015], turned by \
         [0.7071067811865475, 0.7071067811865476, 0.0, -0.0], expected drill with [0.0, 0.0, -15.0, 0.0, 0.0, 0.0] at [0.0, \
         0.0, 0.015], turned by [1.0, 0.0, 0.0, 0.0]",
    );
}

#[test]
fn a_plan_whose_name_is_a_path() {
    assert_plan_refused(
        "\"name\": \"cut-rim\"",
        "\"name\": \"../cut-rim\"",
        "bad.json:3: name: found \"../cut-rim\", expected letters, digits, `-`, `_` and `.`, since files are named after it",
    );
}

#[test]
fn a_plan_for_an_impossible_person() {
    assert_plan_refused(
        "\"height_m\": 1.75",
        "\"height_m\": 0.2",
        "bad.json:123: human.height_m: found 0.2, expected a number from 1.2 to 2.3 (m)",
    );
}

#[test]
fn a_time_step_that_is_too_long() {
    assert_scenario_refused(
        "[grip]",
        "[simulation]\ntimestep_s = 0.0045\n\n[grip]",
        "bad.toml:13: simulation.timestep_s: found 0.0045, expected a number from 0.00001 to 0.004 (s)",
    );
}

#[test]
fn a_hold_too_short_to_measure_creep() {
    assert_scenario_refused(
        "[grip]",
        "[simulation]\nhold_s = 0.01\n\n[grip]",
        "bad.toml:13: simulation.hold_s: found 0.01, expected at least 10 time steps, to measure creep",
    );
}

#[test]
fn a_tool_whose_rotation_is_not_a_unit_quaternion() {
    assert_scenario_refused(
        "[grip]",
        "[tool]\nmass_kg = 1.0\ntip_h_m = [0.0, 0.0, -0.2]\nrotation_xyzw = [1.0, 1.0, 0.0, 0.0]\n\n[grip]",
        "bad.toml:15: tool.rotation_xyzw: found a quaternion of length 1.4142135623730951, expected unit length",
    );
}

#[test]
fn an_invalid_scenario_inside_a_plan() {
    let spoilt = text_of_both("quickstart/plan.json").replace("\"friction\": 0.6", "\"friction\": -0.6");
    let (output, _) = benchdog_on("bad.json", &spoilt, &["simulate", "bad.json"]);
    let line = 1 + spoilt.lines().position(|line| line.contains("\"friction\": -0.6")).unwrap();
    let message = format!(
        "bad.json:{line}: scenario.grip.friction: found -0.6, expected a positive number (a Coulomb coefficient)"
    );
    assert_refused(&output, &message);
}

#[test]
fn a_trunk_that_leans_too_far() {
    assert_scenario_refused(
        "[grip]",
        "[human]\nlean_deg = 40.0\n\n[grip]",
        "bad.toml:13: human.lean_deg: found 40, expected a number from 0 to 15 (degrees)",
    );
}

/// A limit that is out of range, also in the scenario of a plan.
#[test]
fn invalid_limits_of_a_posture() {
    for (keys, message) in [
        ("facing_deg = -1.0", "bad.toml:13: human.facing_deg: found -1, expected a number from 0 to 180 (degrees)"),
        (
            "elbow_deg = [90.0, 60.0]",
            "bad.toml:13: human.elbow_deg[1]: found 60, expected a number from 90 to 180 (degrees)",
        ),
        (
            "reach = 0.3",
            "bad.toml:12: human: the person's elbow_deg, reach, upper_arm_deg, limit_margin_deg and deviation_margin_deg \
             leave a joint of the arm no range, expected wider limits",
        ),
    ] {
        assert_scenario_refused("[grip]", &format!("[human]\n{keys}\n\n[grip]"), message);
    }
    let spoilt = text_of_both("quickstart/plan.json").replace("\"facing_deg\": 30.0,", "\"facing_deg\": 300.0,");
    let (output, _) = benchdog_on("bad.json", &spoilt, &["simulate", "bad.json"]);
    let line = 1 + spoilt.lines().position(|line| line.contains("\"facing_deg\": 300.0")).unwrap();
    let message = format!(
        "bad.json:{line}: scenario.human.posture.facing_deg: found 300, expected a number from 0 to 180 (degrees)"
    );
    assert_refused(&output, &message);
}

#[test]
fn a_place_that_is_incomplete_or_not_asked_for() {
    for (keys, message) in [
        (
            "place = \"given\"\ny_m = 0.0\nheading_deg = 180.0",
            "bad.toml:12: human.x_m: found nothing, expected a position in m, since human.place = \"given\"",
        ),
        ("x_m = 1.0", "bad.toml:13: human.x_m: found a value, expected none: it belongs to human.place = \"given\""),
        (
            "place = \"given\"\nx_m = 1.0\ny_m = 0.0\nheading_deg = 180.0\nplace_tolerance_m = 0.0",
            "bad.toml:17: human.place_tolerance_m: found 0, expected a number from 0.001 to 10 (m)",
        ),
    ] {
        assert_scenario_refused("[grip]", &format!("[human]\n{keys}\n\n[grip]"), message);
    }
}

#[test]
fn a_tool_without_a_known_name_or_all_figures() {
    for (keys, message) in [
        (
            "name = \"saw\"",
            "bad.toml:13: tool.name: found \"saw\", expected \"drill\", \"knife\", \"knife-thumb-side\"",
        ),
        (
            "name = \"knife\"\nmass_kg = 0.2",
            "bad.toml:14: tool.mass_kg: found a value, expected none: it belongs to a tool without a name",
        ),
    ] {
        assert_scenario_refused("[grip]", &format!("[tool]\n{keys}\n\n[grip]"), message);
    }
}

#[test]
fn a_score_out_of_range() {
    assert_scenario_refused(
        "[grip]",
        "[limits]\nrula = 9\n\n[grip]",
        "bad.toml:13: limits.rula: found 9, expected a number from 1 to 7 (a score)",
    );
}

#[test]
fn a_saturation_at_no_distance() {
    assert_scenario_refused(
        "[grip]",
        "[comfort]\nsaturation_m = 0.0\n\n[grip]",
        "bad.toml:13: comfort.saturation_m: found 0, expected a positive number (m)",
    );
}

#[test]
fn an_invalid_normalised_objective() {
    for (keys, message) in [
        (
            "peripersonal_share = 1.5",
            "bad.toml:13: comfort.peripersonal_share: found 1.5, expected a number from 0 to 1 (a share)",
        ),
        (
            "optima = { muscular_regularised = 60.0, peripersonal_m = 1.2 }",
            "bad.toml:13: comfort.optima: found a value, expected none: it belongs to comfort.peripersonal_share",
        ),
        (
            "weight_muscular = 2.0\nperipersonal_share = 0.5",
            "bad.toml:13: comfort.weight_muscular: found a weight beside comfort.peripersonal_share, expected one or the other",
        ),
        (
            "peripersonal_share = 0.5\noptima = { muscular_regularised = 0.0, peripersonal_m = 1.2 }",
            "bad.toml:14: comfort.optima.muscular_regularised: found 0, expected a positive number (a comfort)",
        ),
    ] {
        assert_scenario_refused("[grip]", &format!("[comfort]\n{keys}\n\n[grip]"), message);
    }
}

/// Asserts that a scenario with this `[load]` or `[uncertainty]` is refused with this message; the section is at line 16.
#[track_caller]
fn assert_section_refused(section: &str, message: &str) {
    let (output, _) = benchdog_on("bad.toml", &format!("{SCENARIO}\n{section}"), &["run", "bad.toml"]);
    assert_refused(&output, message);
}

#[test]
fn a_load_that_does_not_fit_its_operation() {
    assert_section_refused(
        "[load]\nkind = \"path\"\nspeed_m_s = 0.1\n",
        "bad.toml:17: load.kind: found \"path\" for an operation that is to drill, expected an operation of the kind \"cut\"",
    );
    assert_section_refused(
        "[load]\nspindle_torque_nm = 0.1\n",
        "bad.toml:17: load.spindle_torque_nm: found a value, expected none: it belongs to kind = \"drill\"",
    );
    assert_section_refused(
        "[load]\nkind = \"drill\"\nvibration_n = 1.0\nvibration_hz = 200.0\n",
        "bad.toml:19: load.vibration_hz: found 200, expected a number from 0 to 125 (Hz, four time steps a period)",
    );
    assert_section_refused(
        "[uncertainty]\ncontact_stiffness_scale = 4.0\n",
        "bad.toml:17: uncertainty.contact_stiffness_scale: found 4, expected a number from 0.001 to 1.75 (a factor)",
    );
}

#[test]
fn a_file_of_forces_names_its_own_line() {
    let refused = |csv: &str, message: &str| {
        let scenario = format!("{SCENARIO}\n[load]\nkind = \"measured\"\nfile = \"forces.csv\"\n");
        let folder = folder(&[("forces.csv", csv), ("bad.toml", &scenario)]);
        assert_refused(&benchdog(folder.path(), &["run", "bad.toml"]), message);
    };
    let header = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n";
    refused(
        "t,fx\n",
        "forces.csv:1: found \"t, fx\", expected the columns time_s, fx_n, fy_n, fz_n, mx_nm, my_nm, mz_nm",
    );
    refused(
        &format!("{header}0,0,0,0,0,0,0\n0.1,0,0,-15,0,0\n"),
        "forces.csv:3: found 6 cells, expected 7, one a column",
    );
    refused(&format!("{header}0,0,0,hard,0,0,0\n"), "forces.csv:2: fz_n: found \"hard\", expected a finite number");
    refused(
        &format!("{header}0.2,0,0,-1,0,0,0\n0.1,0,0,-2,0,0,0\n"),
        "forces.csv:3: time_s: found 0.1, expected a time after 0.2, that of the row before",
    );
    refused(
        &format!("{header}0,0,0,0,0,0,0\n"),
        "forces.csv: found 1 rows without a load, expected forces that load the board",
    );
}
