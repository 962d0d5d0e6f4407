//! The text of every message. The expected texts are in `tests/snapshots`; after an intended change,
//! `INSTA_UPDATE=always cargo test --release --test cli messages` updates them.

// The messages of Windows have other paths and other texts of the system.
#![cfg(all(feature = "recording", unix))]

use std::{fs, path::Path, process::Output};

use tempfile::TempDir;

use crate::process::{command, slipping_scenario};

/// A folder with scenarios of these names and expectations, and with the plan that they name.
fn folder(names: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, expected) in names {
        slipping_scenario(folder.path(), name, expected);
    }
    folder
}

fn benchdog(folder: &Path, arguments: &[&str]) -> Output {
    // So that a viewer installed on this machine is not found.
    command(folder, arguments)
        .env("PATH", folder.join("bin"))
        .env("BENCHDOG_CACHE", folder.join("maps"))
        .output()
        .unwrap()
}

/// Output and exit code, without paths and times.
fn seen(folder: &Path, arguments: &[&str]) -> String {
    let output = benchdog(folder, arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap().replace(folder.to_str().unwrap(), "FOLDER");
    let (stdout, stderr) = (without_times(&text(&output.stdout)), without_times(&text(&output.stderr)));
    let part = |title: &str, text: &str| if text.is_empty() { String::new() } else { format!("--- {title}\n{text}") };
    format!(
        "$ benchdog {}\n{}{}--- exit code {}\n",
        arguments.join(" "),
        part("standard output", &stdout),
        part("standard error", &stderr),
        output.status.code().unwrap()
    )
}

/// Replaces durations by `T`: in the last column of the table, and at the end of progress lines.
fn without_times(text: &str) -> String {
    let mut in_table = false;
    let line = |line: &str| {
        if line.starts_with("scenario ") {
            in_table = true;
            return format!("{}  T", line.trim_end_matches("time s").trim_end());
        }
        in_table &= line.contains("  ");
        match line.rsplit_once(' ') {
            Some((before, time)) if in_table && (time == "-" || time.parse::<f64>().is_ok()) => {
                format!("{}  T", before.trim_end())
            }
            _ if line.ends_with(" s)") => format!("{}(T s)", &line[..line.rfind('(').unwrap()]),
            _ => line.to_owned(),
        }
    };
    let lines: Vec<String> = text.lines().map(line).collect();
    if lines.is_empty() { String::new() } else { format!("{}\n", lines.join("\n")) }
}

fn assert_seen(name: &str, folder: &Path, arguments: &[&str]) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_snapshot_path("../snapshots");
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, seen(folder, arguments)));
}

#[test]
fn the_help_of_every_command() {
    let folder = folder(&[]);
    assert_seen("help", folder.path(), &["--help"]);
    for command in [
        "init",
        "run",
        "plan",
        "replan",
        "front",
        "task",
        "simulate",
        "sweep",
        "merge",
        "compare",
        "margin",
        "export",
        "import",
        "curve",
        "reproduce",
        "inspect",
        "view",
        "cache",
        "doctor",
        "explain",
        "schema",
        "completions",
        "man",
    ] {
        assert_seen(&format!("help-{command}"), folder.path(), &["help", command]);
    }
}

#[test]
fn every_command_has_an_example() {
    let folder = folder(&[]);
    let help = String::from_utf8(benchdog(folder.path(), &["--help"]).stdout).unwrap();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    for command in commands
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|command| !["help", ""].contains(command))
    {
        let help = String::from_utf8(benchdog(folder.path(), &["help", command]).stdout).unwrap();
        assert!(help.contains("Example") && help.contains(&format!("  benchdog {command}")), "{help}");
    }
}

#[test]
fn versions_and_the_doctor() {
    let folder = folder(&[]);
    assert_seen("version", folder.path(), &["--version"]);
    assert_seen("doctor", folder.path(), &["doctor"]);
}

#[test]
fn usage_errors() {
    let folder = folder(&[("a", "slips")]);
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert_seen("error-no-command", folder.path(), &[]);
    assert_seen("error-unknown-command", folder.path(), &["fly"]);
    assert_seen("error-no-scenario", folder.path(), &["run"]);
    assert_seen("error-unknown-option", folder.path(), &["run", "a.toml", "--fast"]);
    assert_seen("error-no-jobs", folder.path(), &["run", "a.toml", "--jobs", "0"]);
    assert_seen("error-missing-file", folder.path(), &["run", "b.toml"]);
    assert_seen("error-empty-folder", folder.path(), &["run", "empty"]);
    assert_seen("error-pattern-without-match", folder.path(), &["run", "b*.toml"]);
    assert_seen("error-broken-pattern", folder.path(), &["run", "b[.toml"]);
    assert_seen("error-filter-without-match", folder.path(), &["run", "a.toml", "--filter", "b"]);
    assert_seen("error-one-name-twice", folder.path(), &["run", "a.toml", "."]);
    assert_seen("error-output-is-a-file", folder.path(), &["run", "a.toml", "--out", "a.toml"]);
    assert_seen("error-nothing-to-plan", folder.path(), &["plan", "a.toml"]);
    assert_seen("error-no-circle", folder.path(), &["curve", "no-such.toml"]);
    assert_seen("error-limit", folder.path(), &["inspect", "a.rrd", "--slip-mm", "-1"]);
}

#[test]
fn messages_of_a_run() {
    let folder = folder(&[("a", "slips"), ("b", "holds"), ("c", "slips")]);
    let run = |name, more: &[&str]| {
        let arguments = [&["run", ".", "--jobs", "1", "--record", "never"], more].concat();
        assert_seen(name, folder.path(), &arguments);
    };
    run("run-all", &[]);
    run("run-filter", &["--filter", "a", "--filter", "[c]"]);
    run("run-fail-fast", &["--fail-fast"]);
    assert_seen("run-one", folder.path(), &["run", "b.toml"]);
    assert_seen("simulate", folder.path(), &["simulate", "plans/cut-rim-weak-grip.json", "--record", "never"]);
}

#[test]
fn messages_about_a_recording() {
    let folder = folder(&[("a", "slips")]);
    assert_eq!(benchdog(folder.path(), &["run", "a.toml"]).status.code(), Some(0));
    let recording = "out/a/recording.rrd";
    assert_seen("inspect", folder.path(), &["inspect", recording]);
    let limits = ["--slip-mm", "9999", "--slip-deg", "360"];
    assert_seen("inspect-other-limits", folder.path(), &[&["inspect", recording], &limits[..]].concat());

    let bytes = fs::read(folder.path().join(recording)).unwrap();
    let spoilt = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    spoilt("cut-short.rrd", &bytes[..bytes.len() / 2]);
    spoilt("other-version.rrd", &[b"RRF2\x00\x28\x01\x00", &bytes[8..]].concat());
    spoilt("no-recording.rrd", b"a text");
    for name in ["cut-short", "other-version", "no-recording", "missing"] {
        assert_seen(&format!("inspect-{name}"), folder.path(), &["inspect", &format!("{name}.rrd")]);
    }
    assert_seen("view-cut-short", folder.path(), &["view", "cut-short.rrd"]);
    assert_seen("view-without-viewer", folder.path(), &["view", recording]);
}

#[test]
fn the_viewer_is_started_with_the_file() {
    use std::os::unix::fs::PermissionsExt as _;

    let folder = folder(&[("a", "slips")]);
    assert_eq!(benchdog(folder.path(), &["run", "a.toml"]).status.code(), Some(0));
    let bin = folder.path().join("bin");
    fs::create_dir(&bin).unwrap();
    let viewer = |version: &str| {
        let script = format!(
            "#!/bin/sh\nif [ \"$1\" = --version ]; then echo rerun-cli {version} more; else echo shows \"$@\"; fi\n"
        );
        fs::write(bin.join("rerun"), script).unwrap();
        fs::set_permissions(bin.join("rerun"), fs::Permissions::from_mode(0o755)).unwrap();
    };
    viewer("0.36.3");
    assert_seen("view", folder.path(), &["view", "out/a/recording.rrd"]);
    viewer("0.35.0");
    assert_seen("view-other-version", folder.path(), &["view", "out/a/recording.rrd"]);
}

#[test]
fn completions_know_the_commands() {
    let folder = folder(&[]);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = benchdog(folder.path(), &["completions", shell]);
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(["inspect", "fail-fast"].iter().all(|word| script.contains(word)), "{shell}");
    }
}

/// A robot of two links with one arm, and its description; each fault replaces a text of one of them.
fn robot(faults: &[(&str, &str)]) -> TempDir {
    let place = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("baxter.urdf", include_str!("../../assets/baxter.urdf")),
        ("robot.toml", include_str!("../../assets/baxter.toml")),
    ] {
        let changed = faults.iter().fold(text.to_owned(), |text, (from, to)| text.replacen(from, to, 1));
        fs::write(place.path().join(name), changed).unwrap();
    }
    place
}

#[test]
fn all_faults_of_a_description() {
    let several = robot(&[
        ("floor_z_m = -0.9242", "floor_z_m = nan"),
        ("[\"torso\", \"head\"]", "[\"torso\", \"hat\"]"),
        ("effort_nm = [50.0, 100.0, ", "effort_nm = [50.0, "),
        ("opening_m = [0.0, 0.038]", "opening_m = [0.0, 0.38]"),
        ("pad_link = \"l_gripper_l_finger_tip\"", "pad_link = \"l_gripper_tip\""),
    ]);
    assert_seen("doctor-faults", several.path(), &["doctor", "robot.toml"]);
    let meshes = robot(&[
        (
            "<collision name=\"neck\"><origin xyz=\"-0.0911 0 0.6696\"/><geometry><box size=\"0.1471 0.08 0.068\"/>",
            "<collision name=\"neck\"><geometry><mesh filename=\"package://baxter_description/neck.stl\"/>",
        ),
        (
            "<collision name=\"base plate\"><origin xyz=\"0 0 -0.0361\"/><geometry><box size=\"0.3599 0.3599 0.0507\"/>",
            "<collision name=\"base plate\"><geometry><mesh filename=\"${meshes}/base.stl\"/>",
        ),
    ]);
    assert_seen("doctor-meshes", meshes.path(), &["doctor", "robot.toml"]);
}

#[test]
fn all_links_that_overlap() {
    let fat = robot(&[
        ("    [\"{arm}_upper_elbow\", \"{arm}_lower_elbow\"],\n", ""),
        ("    [\"{arm}_lower_forearm\", \"{arm}_wrist\"],\n", ""),
    ]);
    assert_seen("doctor-overlaps", fat.path(), &["doctor", "robot.toml"]);
}

#[test]
fn urdfs_that_are_something_else() {
    let place = tempfile::tempdir().unwrap();
    let xacro = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" name=\"arm\">\n<xacro:include filename=\"arm.xacro\"/>\n\
                 <link name=\"base\"/>\n<link name=\"tip\"/>\n</robot>\n";
    fs::write(place.path().join("arm.urdf.xacro"), xacro).unwrap();
    assert_seen("robot-new-xacro", place.path(), &["robot", "new", "arm.urdf.xacro", "-o", "arm.toml"]);
    fs::write(place.path().join("table.urdf"), "<robot name=\"table\"><link name=\"top\"/></robot>").unwrap();
    assert_seen("robot-new-no-arm", place.path(), &["robot", "new", "table.urdf", "-o", "table.toml"]);
    assert_seen("robot-new-missing", place.path(), &["robot", "new", "nowhere.urdf", "-o", "arm.toml"]);
}

#[test]
fn a_robot_that_is_found() {
    let place = robot(&[]);
    assert_seen(
        "robot-new",
        place.path(),
        &["robot", "new", "baxter.urdf", "-o", "new.toml", "--scenario", "drill.toml"],
    );
}
