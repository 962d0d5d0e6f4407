//! Task files with bad paths and values: exit code 2, one message with file, line, key, the value found and the value expected,
//! and no file written.

use std::fmt::Write as _;

use crate::{
    bad_input::assert_refused,
    process::{benchdog, folder},
};

const CUT: &str = "format = 1
name = \"bad\"

[task]
kind = \"cut\"
force_n = 30.0
circle = { radius_m = 0.12 }
";

const DRILL: &str = "format = 1
name = \"bad\"

[task]
kind = \"drill\"
force_n = 30.0
holes_m = [[0.0, 0.0]]
";

const CIRCLE: &str = "circle = { radius_m = 0.12 }";
const HOLES: &str = "holes_m = [[0.0, 0.0]]";

/// Asserts that a task file, beside a file `path.csv`, is refused with this message.
#[track_caller]
fn assert_text_refused(text: &str, rows: &str, message: &str) {
    let folder = folder(&[("bad.toml", text), ("path.csv", rows)]);
    assert_refused(&benchdog(folder.path(), &["task", "bad.toml", "--out", "out"]), message);
    assert!(!folder.path().join("out").exists(), "files were written");
}

/// Asserts that a task file with one replacement is refused with this message.
#[track_caller]
fn assert_task_refused(task: &str, replace: &str, with: &str, message: &str) {
    assert!(task.contains(replace));
    assert_text_refused(&task.replacen(replace, with, 1), "", message);
}

/// Asserts that a cut along the lines of a file is refused with this message.
#[track_caller]
fn assert_rows_refused(task: &str, path: &str, rows: &str, message: &str) {
    assert!(task.contains(path));
    assert_text_refused(&task.replacen(path, "file = \"path.csv\"", 1), &format!("stroke,x_m,y_m\n{rows}"), message);
}

#[test]
fn neither_or_both_of_operation_and_task() {
    assert_text_refused(
        "format = 1\nname = \"bad\"\n",
        "",
        "bad.toml: operation: found nothing, expected [operation], or [task] of a task file",
    );
    assert_task_refused(
        CUT,
        "[task]",
        "[operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n\n[task]",
        "bad.toml:9: task: found [task] beside [operation], expected one of them",
    );
}

#[test]
fn sections_of_a_scenario_of_one_hold() {
    let of_holds = "found a value, expected none: it belongs to a scenario of one hold, with [operation]";
    for (section, place) in [
        ("[planner]\nplan = \"plan.json\"\n", "10: planner.plan"),
        ("[load]\nkind = \"path\"\nspeed_m_s = 0.1\n", "9: load"),
        ("[sweep]\nruns = 2\n", "9: sweep"),
    ] {
        assert_text_refused(&format!("{CUT}\n{section}"), "", &format!("bad.toml:{place}: {of_holds}"));
    }
}

#[test]
fn keys_of_the_other_kind() {
    let cut = "expected none: it belongs to kind = \"cut\"";
    let drill = "expected none: it belongs to kind = \"drill\"";
    assert_task_refused(CUT, CIRCLE, HOLES, &format!("bad.toml:7: task.holes_m: found a value, {drill}"));
    assert_task_refused(DRILL, HOLES, CIRCLE, &format!("bad.toml:7: task.circle: found a value, {cut}"));
    let lines = "lines_m = [[[0.0, 0.0], [0.1, 0.0]]]";
    assert_task_refused(DRILL, HOLES, lines, &format!("bad.toml:7: task.lines_m: found a value, {cut}"));
    assert_task_refused(
        DRILL,
        "force_n",
        "speed_m_s = 0.1\nforce_n",
        &format!("bad.toml:6: task.speed_m_s: found a value, {cut}"),
    );
    assert_task_refused(
        CUT,
        "\"cut\"",
        "\"wrench\"",
        "bad.toml:5: task.kind: found \"wrench\", expected \"cut\" or \"drill\"",
    );
}

#[test]
fn paths_that_are_not_exactly_one() {
    let one = "expected one of circle, lines_m, holes_m and file";
    assert_task_refused(CUT, CIRCLE, "", &format!("bad.toml:4: task: found 0 paths, {one}"));
    assert_task_refused(
        CUT,
        CIRCLE,
        "circle = { radius_m = 0.12 }\nfile = \"path.csv\"",
        &format!("bad.toml:8: task.file: found 2 paths, {one}"),
    );
}

#[test]
fn figures_out_of_range() {
    for (line, message) in [
        ("force_n = 0.0", "6: task.force_n: found 0, expected a positive number (N)"),
        ("force_n = -1.0", "6: task.force_n: found -1, expected a positive number (N)"),
        ("force_n = nan", "6: task.force_n: found NaN, expected a positive number (N)"),
        ("force_n = inf", "6: task.force_n: found inf, expected at most 10000 (N)"),
    ] {
        assert_task_refused(CUT, "force_n = 30.0", line, &format!("bad.toml:{message}"));
    }
    for (line, message) in [
        ("speed_m_s = 1.5", "task.speed_m_s: found 1.5, expected a number from 0.0001 to 1 (m/s)"),
        ("speed_m_s = nan", "task.speed_m_s: found NaN, expected a number from 0.0001 to 1 (m/s)"),
        ("piece_m = 0.001", "task.piece_m: found 0.001, expected a number from 0.005 to 0.5 (m)"),
        ("piece_m = 0.6", "task.piece_m: found 0.6, expected a number from 0.005 to 0.5 (m)"),
        (
            "least_comfort = 1.1",
            "task.least_comfort: found 1.1, expected a number from 0 to 1 (a share of the best comfort)",
        ),
        ("regrasp_cost = 101.0", "task.regrasp_cost: found 101, expected a number from 0 to 100 (pieces of the path)"),
        ("move_cost = -0.1", "task.move_cost: found -0.1, expected a number from 0 to 100 (pieces of the path)"),
        (
            "motion.speed_share = 0.0",
            "task.motion.speed_share: found 0, expected a number from 0.001 to 1 (a share of the robot's speed)",
        ),
        (
            "motion.acceleration_rad_s2 = inf",
            "task.motion.acceleration_rad_s2: found inf, expected a number from 0.01 to 100 (rad/s^2)",
        ),
    ] {
        assert_text_refused(&format!("{CUT}{line}\n"), "", &format!("bad.toml:8: {message}"));
    }
}

#[test]
fn circles_that_are_none() {
    for (circle, message) in [
        ("radius_m = 0.0", "task.circle.radius_m: found 0, expected a number from 0.005 to 10 (m)"),
        ("radius_m = nan", "task.circle.radius_m: found NaN, expected a number from 0.005 to 10 (m)"),
        (
            "radius_m = 0.12, start_deg = inf",
            "task.circle.start_deg: found inf, expected a number from -360 to 360 (degrees)",
        ),
        (
            "radius_m = 0.12, centre_m = [nan, 0.0]",
            "task.circle.centre_m: found [NaN, 0.0], expected numbers from -10 to 10 (m)",
        ),
    ] {
        assert_task_refused(CUT, "radius_m = 0.12", circle, &format!("bad.toml:7: {message}"));
    }
}

#[test]
fn lines_without_a_length() {
    for (lines, message) in [
        ("[]", "task.lines_m: found an empty path, expected at least one hole or line"),
        ("[[[0.0, 0.0]]]", "task.lines_m[0]: found 1 points, expected a line of at least two points"),
        (
            "[[[0.0, 0.0], [0.1, 0.0], [0.1, 0.0]]]",
            "task.lines_m[0][2]: found the point before, expected a point that differs from the one before",
        ),
        ("[[[0.0, 0.0], [inf, 0.0]]]", "task.lines_m[0][1]: found [inf, 0.0], expected numbers from -10 to 10 (m)"),
    ] {
        assert_task_refused(CUT, CIRCLE, &format!("lines_m = {lines}"), &format!("bad.toml:7: {message}"));
    }
}

/// The default board is 0.5 m by 0.4 m.
#[test]
fn points_beside_the_board() {
    let expected = "expected a point on the board: |x| <= 0.25 m, |y| <= 0.2 m";
    for (lines, message) in [
        ("[[[0.0, 0.0], [0.251, 0.0]]]", "task.lines_m[0]: found [0.251, 0]"),
        // Corners count, however short the segments that lead to them.
        ("[[[0.249, 0.0], [0.2505, 0.001], [0.249, 0.002]]]", "task.lines_m[0]: found [0.2505, 0.001]"),
        ("[[[0.0, 0.0], [0.1, 0.0]], [[0.0, 0.1], [0.0, 0.3]]]", "task.lines_m[1]: found [0, 0.3]"),
    ] {
        assert_task_refused(CUT, CIRCLE, &format!("lines_m = {lines}"), &format!("bad.toml:7: {message}, {expected}"));
    }
    assert_task_refused(
        DRILL,
        "[[0.0, 0.0]]",
        "[[0.0, 0.0], [0.0, -0.21]]",
        &format!("bad.toml:7: task.holes_m[1]: found [0, -0.21], {expected}"),
    );
}

#[test]
fn a_line_over_the_hole_of_a_plate() {
    let plate = "[object]
outline_m = [[0.2, -0.2], [0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2]]
thickness_m = 0.02
holes = [{ centre_m = [0.1, 0.0], radius_m = 0.03 }]
";
    // Both ends are on the material.
    let text = format!("{}\n{plate}", CUT.replace(CIRCLE, "lines_m = [[[0.0, 0.0], [0.19, 0.0]]]"));
    let folder = folder(&[("bad.toml", &text)]);
    let output = benchdog(folder.path(), &["task", "bad.toml"]);
    let said = crate::process::stderr(&output);
    assert!(said.contains("bad.toml:7: task.lines_m[0]: found [0.0"), "{said}");
    assert!(said.contains("mm off the material, expected a point of the plate"), "{said}");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn strokes_that_cross() {
    let expected = "expected strokes that do not cross, or task.may_cross = true";
    for (lines, found) in [
        ("[[[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]]]", "strokes 1 and 1 that meet at [0.0500, 0.0500]"),
        ("[[[-0.1, 0.0], [0.1, 0.0]], [[0.02, -0.1], [0.02, 0.1]]]", "strokes 1 and 2 that meet at [0.0200, 0.0000]"),
        ("[[[-0.1, 0.0], [0.1, 0.0]], [[0.1, 0.0], [0.1, 0.1]]]", "strokes 1 and 2 that meet at [0.1000, 0.0000]"),
        ("[[[0.0, 0.0], [0.1, 0.0], [0.05, 0.0]]]", "strokes 1 and 1 that meet at [0.0500, 0.0000]"),
    ] {
        let message = format!("bad.toml:7: task.lines_m: found {found}, {expected}");
        assert_task_refused(CUT, CIRCLE, &format!("lines_m = {lines}"), &message);
    }
}

#[test]
fn two_holes_at_one_point() {
    assert_task_refused(
        DRILL,
        "[[0.0, 0.0]]",
        "[[0.1, 0.1], [0.0, 0.0], [0.1, 0.1]]",
        "bad.toml:7: task.holes_m[2]: found [0.1, 0.1], hole 1 again, expected holes at different points",
    );
}

#[test]
fn more_strokes_and_points_than_are_checked() {
    let mut holes = String::new();
    for number in 0..1001 {
        write!(holes, "[{}, 0.0], ", f64::from(number) * 1e-4).unwrap();
    }
    assert_task_refused(
        DRILL,
        "[[0.0, 0.0]]",
        &format!("[{holes}]"),
        "bad.toml:7: task.holes_m: found 1001 strokes, expected at most 1000 strokes",
    );
    let mut points = String::new();
    let mut rows = String::new();
    for number in 0..20_001 {
        let x_m = f64::from(number) * 1e-5;
        write!(points, "[{x_m}, 0.0], ").unwrap();
        writeln!(rows, "1,{x_m},0.0").unwrap();
    }
    assert_task_refused(
        CUT,
        CIRCLE,
        &format!("lines_m = [[{points}]]"),
        "bad.toml:7: task.lines_m: found 20001 points, expected at most 20000 points",
    );
    assert_rows_refused(CUT, CIRCLE, &rows, "path.csv:20002: found more than 20000 points, expected at most as many");
}

#[test]
fn errors_of_a_path_from_a_file_name_its_line() {
    let beside = "expected a point on the board: |x| <= 0.25 m, |y| <= 0.2 m";
    for (rows, message) in [
        ("", "path.csv:1: found no row below the header, expected at least one hole or line"),
        ("1,0.0,nan\n", "path.csv:2: y_m: found \"nan\", expected a finite number"),
        (
            "1,0.0,0.0\n2,0.1,0.0\n2,0.2,0.0\n",
            "path.csv:2: stroke: found 1 points, expected a line of at least two points",
        ),
        (
            "1,0.0,0.0\n1,0.1,0.0\n1,0.1,0.0\n",
            "path.csv:4: x_m, y_m: found the point before, expected a point that differs from the one before",
        ),
        ("1,0.0,0.0\n1,0.1,0.0\n1,0.1,0.3\n", &format!("path.csv:4: x_m, y_m: found [0.1, 0.3], {beside}")),
        (
            "1,-0.1,0.0\n1,0.1,0.0\n2,0.0,-0.1\n2,0.0,0.1\n",
            "path.csv:5: x_m, y_m: found strokes 1 and 2 that meet at [0.0000, 0.0000], expected strokes that do not cross, or \
             task.may_cross = true",
        ),
    ] {
        assert_rows_refused(CUT, CIRCLE, rows, message);
    }
    for (rows, message) in [
        (
            "1,0.0,0.0\n2,0.1,0.1\n3,0.0,0.0\n",
            "path.csv:4: x_m, y_m: found [0.0, 0.0], hole 1 again, expected holes at different points",
        ),
        (
            "1,0.0,0.0\n1,0.1,0.1\n",
            "path.csv:3: stroke: found stroke 1 again, expected a stroke of its own for each hole",
        ),
        ("1,0.0,0.0\n2,0.3,0.0\n", &format!("path.csv:3: x_m, y_m: found [0.3, 0], {beside}")),
    ] {
        assert_rows_refused(DRILL, HOLES, rows, message);
    }
}

#[test]
fn unknown_keys() {
    for (replace, with, message) in [
        ("radius_m", "radius", "bad.toml:7: task.circle.radius: unknown field `radius`"),
        ("force_n", "force", "bad.toml:6: task.force: unknown field `force`"),
    ] {
        let folder = folder(&[("bad.toml", &CUT.replacen(replace, with, 1))]);
        let output = benchdog(folder.path(), &["task", "bad.toml"]);
        let said = crate::process::stderr(&output);
        assert!(said.contains(message), "{said}");
        assert_eq!(output.status.code(), Some(2));
    }
}

/// Every command that reads a scenario of one hold.
#[test]
fn other_commands_refuse_a_task_file() {
    let message =
        "bad.toml:4: task: found [task], expected [operation] with one operation; a task is run by `benchdog task`";
    for command in ["plan", "run", "curve", "front", "sweep"] {
        let folder = folder(&[("bad.toml", CUT)]);
        assert_refused(&benchdog(folder.path(), &[command, "bad.toml"]), message);
    }
}
