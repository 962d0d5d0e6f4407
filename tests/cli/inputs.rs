//! No command overwrites or removes one of its input files, and those from a pipe are read once.

use std::fs;

use crate::process::{benchdog, contents, folder, json, stderr};

const CUT: &str = include_str!("../../scenarios/cut-rim.toml");
const PLAN: &str = include_str!("../../scenarios/plans/cut-rim.json");

/// Asserts that a command with these files in its folder refuses to write to `file` and writes nothing.
#[track_caller]
fn assert_refused(files: &[(&str, &str)], arguments: &[&str], file: &str) {
    let folder = folder(files);
    let before = contents(folder.path());
    let output = benchdog(folder.path(), arguments);
    let message = format!("error: failed to write {file}: it is an input file of this command\n");
    // On Windows the folder is followed by a backslash.
    assert_eq!(stderr(&output).replace('\\', "/"), message);
    assert_eq!(output.status.code(), Some(2));
    assert!(contents(folder.path()) == before, "{arguments:?} changed files");
}

#[test]
fn plan_does_not_overwrite_its_scenario() {
    assert_refused(&[("cut.toml", CUT)], &["plan", "cut.toml", "-o", "cut.toml"], "cut.toml");
    assert_refused(&[("a/cut.toml", CUT)], &["plan", "a/cut.toml", "-o", "a/../a/cut.toml"], "a/../a/cut.toml");
    assert_refused(&[("plan-2.json", CUT)], &["plan", "plan-2.json", "--top", "3", "-o", "."], "./plan-2.json");
}

#[cfg(unix)]
#[test]
fn plan_does_not_overwrite_its_scenario_through_a_link() {
    let folder = folder(&[("cut.toml", CUT)]);
    std::os::unix::fs::symlink("cut.toml", folder.path().join("link.toml")).unwrap();
    for (scenario, output) in [("cut.toml", "link.toml"), ("link.toml", "cut.toml"), ("link.toml", "link.toml")] {
        let output = benchdog(folder.path(), &["plan", scenario, "-o", output]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    }
    assert!(folder.path().join("link.toml").is_symlink());
    assert_eq!(fs::read_to_string(folder.path().join("cut.toml")).unwrap(), CUT);
}

#[test]
fn front_and_curve_do_not_overwrite_their_scenario() {
    for name in ["front-1.json", "front.csv", "front.svg", "own-weights.json"] {
        assert_refused(&[(name, CUT)], &["front", name, "--out", "."], &format!("./{name}"));
    }
    for name in ["muscular_curve.csv", "muscular_curve.svg"] {
        assert_refused(&[(name, CUT)], &["curve", name, "--out", "."], &format!("./{name}"));
    }
}

#[test]
fn run_does_not_overwrite_its_inputs() {
    assert_refused(&[("cut.toml", CUT)], &["run", "cut.toml", "--junit", "cut.toml"], "cut.toml");
    for name in ["report.html", "summary.csv", "summary.json", "junit.xml"] {
        assert_refused(&[(name, CUT)], &["run", name, "--out", "."], &format!("./{name}"));
    }
    let measured = format!("{CUT}\n[load]\nkind = \"measured\"\nfile = \"forces.csv\"\n");
    let forces = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,0,0,0,0,0\n1,0,30,0,0,0,0\n";
    assert_refused(
        &[("cut.toml", &measured), ("forces.csv", forces)],
        &["run", "cut.toml", "--junit", "forces.csv"],
        "forces.csv",
    );
    // The scenario `other` judges the plan that `cut-rim` would replace.
    let other = CUT.replace("cut-rim", "other");
    assert_refused(
        &[
            ("cut.toml", CUT),
            ("other.toml", &format!("{other}\n[planner]\nplan = \"out/cut-rim/plan.json\"\n")),
            ("out/cut-rim/plan.json", PLAN),
        ],
        &["run", "cut.toml", "other.toml"],
        "out/cut-rim/plan.json",
    );
}

#[test]
fn the_files_of_a_robot_are_inputs() {
    let robot = include_str!("../../assets/baxter.toml");
    let urdf = include_str!("../../assets/baxter.urdf");
    let scenario = format!("{CUT}\n[robot]\ndescription = \"my-robot.toml\"\n");
    let files = [("cut.toml", &*scenario), ("my-robot.toml", robot), ("baxter.urdf", urdf)];
    assert_refused(&files, &["run", "cut.toml", "--junit", "my-robot.toml"], "my-robot.toml");
    assert_refused(&files, &["plan", "cut.toml", "-o", "baxter.urdf"], "baxter.urdf");
    let plan = PLAN.replace("\"robot\": \"baxter\"", "\"robot\": \"my-robot.toml\"");
    let files = [("plan.json", &*plan), ("my-robot.toml", robot), ("baxter.urdf", urdf)];
    assert_refused(&files, &["export", "plan.json", "--mjcf", "baxter.urdf"], "baxter.urdf");
}

#[test]
fn simulate_and_export_do_not_overwrite_their_inputs() {
    let files = [("plan.json", PLAN), ("cut.toml", CUT)];
    assert_refused(&files, &["simulate", "plan.json", "--junit", "plan.json"], "plan.json");
    assert_refused(&files, &["simulate", "plan.json", "--scenario", "cut.toml", "--junit", "cut.toml"], "cut.toml");
    assert_refused(&files, &["export", "plan.json", "--mjcf", "plan.json"], "plan.json");
    assert_refused(&files, &["export", "plan.json", "--scenario", "cut.toml", "--mjcf", "cut.toml"], "cut.toml");
    let in_place = [("out/cut-rim/verdict.json", PLAN)];
    assert_refused(&in_place, &["simulate", "out/cut-rim/verdict.json"], "out/cut-rim/verdict.json");
}

#[test]
fn a_plan_in_the_output_folder_is_simulated_and_left_as_it_is() {
    // Not as benchdog would write it.
    let plan = PLAN.replacen('{', "{\n\n", 1);
    let folder = folder(&[("out/cut-rim/plan.json", &plan)]);
    let output = benchdog(folder.path(), &["simulate", "out/cut-rim/plan.json", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let scenario = format!("{CUT}\n[planner]\nplan = \"out/cut-rim/plan.json\"\n");
    fs::write(folder.path().join("cut.toml"), scenario).unwrap();
    let output = benchdog(folder.path(), &["run", "cut.toml", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(folder.path().join("out/cut-rim/plan.json")).unwrap(), plan);
    assert!(folder.path().join("out/cut-rim/verdict.json").exists());
}

#[test]
fn an_edited_plan_does_not_replace_the_original_of_the_same_name() {
    // As Benchdog's planner writes it.
    let planned = PLAN.replacen('{', r#"{"planner": {"kind": "comfort", "seed": 1, "evaluations": 9},"#, 1);
    let folder = folder(&[("plan.json", &planned), ("edited.json", &planned.replace("30.0", "29.0"))]);
    let simulate = |plan: &str, out: &str| {
        let output = benchdog(folder.path(), &["simulate", plan, "--record", "never", "--out", out]);
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(simulate("plan.json", "out").0, Some(0));
    let original = contents(&folder.path().join("out"));
    let message = "error: failed to write out/cut-rim/plan.json: it is another plan of this name; change the name of the \
                   simulated plan, or choose another --out\n";
    assert_eq!(simulate("edited.json", "out"), (Some(2), message.to_owned()));
    assert!(contents(&folder.path().join("out")) == original);
    // The same plan again, and the other one elsewhere.
    assert_eq!(simulate("plan.json", "out").0, Some(0));
    assert_eq!(simulate("edited.json", "elsewhere").0, Some(0));
}

/// The copy of a plan from elsewhere is no original: the edited plan can be simulated again and again.
#[test]
fn a_plan_from_elsewhere_can_be_edited_and_simulated_again() {
    let folder = folder(&[("plan.json", PLAN)]);
    let simulate = || benchdog(folder.path(), &["simulate", "plan.json", "--record", "never", "--out", "out"]);
    assert_eq!(simulate().status.code(), Some(0));
    let edited = PLAN.replace("30.0", "29.0");
    fs::write(folder.path().join("plan.json"), &edited).unwrap();
    let output = simulate();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::read_to_string(folder.path().join("out/cut-rim/plan.json")).unwrap().contains("29"));
}

/// Runs a command whose input file `/dev/stdin` is a pipe with this text: `benchdog run <(generate)` in a shell.
#[cfg(unix)]
fn piped(arguments: &[&str], text: &str) -> std::process::Output {
    use std::{io::Write as _, process::Stdio};
    let mut command = crate::process::command(crate::common::root(), arguments);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary runs");
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn a_scenario_and_a_plan_from_a_pipe_are_read_once() {
    let out = tempfile::tempdir().unwrap();
    let out = crate::process::argument(out.path());
    let output = piped(&["simulate", "/dev/stdin", "--record", "never", "--out", out], PLAN);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let scenario = include_str!("../../scenarios/fails-out-of-reach.toml");
    let output = piped(&["run", "/dev/stdin", "--record", "never", "--out", out], scenario);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// In the place of an earlier plan is a pipe to which nobody writes: it is no plan, and it is not waited for.
#[cfg(unix)]
#[test]
fn a_pipe_in_the_output_folder_is_not_read() {
    let folder = folder(&[("plan.json", PLAN)]);
    let name = json(&folder.path().join("plan.json"))["name"].as_str().unwrap().to_owned();
    let place = folder.path().join("out").join(name);
    fs::create_dir_all(&place).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(place.join("plan.json")).status().unwrap().success());
    let output = benchdog(folder.path(), &["simulate", "plan.json", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
