//! Files that are no input: endless, huge, binary, missing, or with names that the output cannot have.

use std::fs;

use crate::process::{benchdog, contents, folder, slipping_scenario, stderr};

const CUT: &str = include_str!("../../scenarios/cut-rim.toml");
const PLAN: &str = include_str!("../../scenarios/plans/cut-rim.json");

/// Asserts that a command refuses its input with this message, writes nothing, and that the terminal sees printable lines alone.
#[track_caller]
fn assert_refused(files: &[(&str, &str)], arguments: &[&str], message: &str) {
    let folder = folder(files);
    let before = contents(folder.path());
    let output = benchdog(folder.path(), arguments);
    let text = stderr(&output);
    assert_eq!(text, format!("error: {message}\n"));
    assert_eq!(output.status.code(), Some(2));
    assert!(contents(folder.path()) == before, "{arguments:?} changed files");
}

#[test]
#[cfg(unix)]
fn an_endless_file_is_refused_at_its_limit() {
    let zero = "failed to read the file: found more, expected at most";
    assert_refused(&[], &["run", "/dev/zero"], &format!("/dev/zero: {zero} 16 MiB"));
    assert_refused(&[], &["simulate", "/dev/zero"], &format!("/dev/zero: {zero} 64 MiB"));
    let scenario = CUT.to_owned() + "[robot]\ndescription = \"endless.toml\"\n";
    let files = folder(&[("cut.toml", &scenario), ("plan.json", PLAN)]);
    std::os::unix::fs::symlink("/dev/zero", files.path().join("endless.toml")).unwrap();
    let text = stderr(&benchdog(files.path(), &["run", "cut.toml"]));
    let read = "robot.description: failed to read endless.toml: found more, expected at most 16 MiB\n";
    assert!(text.starts_with("error: cut.toml:") && text.ends_with(read), "{text}");
    let output = benchdog(files.path(), &["compare", "/dev/zero", "/dev/zero"]);
    assert_eq!(stderr(&output), "error: /dev/zero: failed to read: found more, expected at most 64 MiB\n");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
#[cfg(unix)]
fn files_that_a_scenario_names_have_a_limit() {
    for (section, key) in [
        ("[load]\nkind = \"measured\"\nfile = \"/dev/zero\"", "load.file"),
        ("[planner]\nplan = \"/dev/zero\"", "planner.plan"),
        ("[sweep.friction_factor]\nkind = \"csv\"\nfile = \"/dev/zero\"", "sweep.friction_factor.file"),
    ] {
        let scenario = format!("{CUT}\n{section}\n");
        let line = scenario.lines().position(|line| line.contains("/dev/zero")).unwrap() + 1;
        let message = format!("cut.toml:{line}: {key}: failed to read /dev/zero: found more, expected at most 64 MiB");
        assert_refused(&[("cut.toml", &scenario)], &["run", "cut.toml"], &message);
    }
}

#[test]
fn files_that_a_scenario_names_are_missed_at_their_line() {
    let missing = if cfg!(windows) { return } else { "No such file or directory (os error 2)" };
    for (section, key) in [
        ("[load]\nkind = \"measured\"\nfile = \"none\"", "load.file"),
        ("[planner]\nplan = \"none\"", "planner.plan"),
        ("[sweep.friction_factor]\nkind = \"csv\"\nfile = \"none\"", "sweep.friction_factor.file"),
    ] {
        let scenario = format!("{CUT}\n{section}\n");
        let line = scenario.lines().position(|line| line.contains("\"none\"")).unwrap() + 1;
        let message = format!("a/cut.toml:{line}: {key}: failed to read a/none: {missing}");
        assert_refused(&[("a/cut.toml", &scenario)], &["run", "a/cut.toml"], &message);
    }
    let task = "format = 1\nname = \"t\"\n[task]\nkind = \"cut\"\nforce_n = 10.0\nfile = \"none\"\n";
    let message = format!("t.toml:6: task.file: failed to read none: {missing}");
    assert_refused(&[("t.toml", task)], &["task", "t.toml"], &message);
    let robot = include_str!("../../assets/baxter.toml");
    let scenario = format!("{CUT}\n[robot]\ndescription = \"my.toml\"\n");
    let line = scenario.lines().position(|line| line.contains("my.toml")).unwrap() + 1;
    let of_robot = robot.lines().position(|line| line.starts_with("urdf")).unwrap() + 1;
    let message = format!(
        "cut.toml:{line}: robot.description: my.toml: line {of_robot}: urdf: failed to read baxter.urdf: {missing}"
    );
    assert_refused(&[("cut.toml", &scenario), ("my.toml", robot)], &["run", "cut.toml"], &message);
}

#[test]
fn binary_files_are_told_with_the_line() {
    let nul = format!("{CUT}\n\0\0");
    let line = CUT.lines().count() + 2 - usize::from(!CUT.ends_with('\n'));
    let message = format!("a.toml: failed to read the file: found a NUL byte in line {line}, expected text in UTF-8");
    assert_refused(&[("a.toml", &nul)], &["run", "a.toml"], &message);
}

#[test]
fn names_of_the_reports_are_no_names_of_scenarios_and_plans() {
    for name in ["report.html", "junit.xml", "summary.csv", "Summary.JSON"] {
        let expected =
            "a name other than report.html, summary.csv, summary.json, junit.xml, which a run writes beside its folder";
        let scenario = CUT.replacen("\"cut-rim\"", &format!("\"{name}\""), 1);
        let line = scenario.lines().position(|line| line.starts_with("name")).unwrap() + 1;
        let message = format!("cut.toml:{line}: name: found \"{name}\", expected {expected}");
        assert_refused(&[("cut.toml", &scenario)], &["run", "cut.toml"], &message);
        let plan = PLAN.replacen("\"cut-rim\"", &format!("\"{name}\""), 1);
        let line = plan.lines().position(|line| line.contains("\"name\"")).unwrap() + 1;
        let message = format!("plan.json:{line}: name: found \"{name}\", expected {expected}");
        assert_refused(&[("plan.json", &plan)], &["simulate", "plan.json"], &message);
    }
}

#[test]
fn long_names_are_refused_before_anything_is_computed() {
    let scenario = CUT.replacen("\"cut-rim\"", &format!("\"{}\"", "n".repeat(300)), 1);
    let line = scenario.lines().position(|line| line.starts_with("name")).unwrap() + 1;
    let expected = "at most 200, since files are named after it";
    let message = format!("cut.toml:{line}: name: found a name of 300 characters, expected {expected}");
    assert_refused(&[("cut.toml", &scenario)], &["run", "cut.toml"], &message);
    let long = format!("{}.json", "n".repeat(300));
    let message = format!("failed to write {long}: found a name of 305 bytes, expected at most 255");
    assert_refused(&[("cut.toml", CUT)], &["plan", "cut.toml", "-o", &long], &message);
}

#[test]
fn outputs_that_cannot_be_files_are_refused_before_anything_is_computed() {
    let files = [("cut.toml", CUT), ("folder/file", "")];
    let plan = |output: &'static str| ["plan", "cut.toml", "-o", output];
    let folder = "failed to write folder: found a folder, expected a file";
    assert_refused(&files, &plan("folder"), folder);
    let below = "failed to write folder/file: found a file, expected a folder";
    assert_refused(&files, &plan("folder/file/plan.json"), below);
    let junit = "out/cut-rim/verdict.json";
    let twice = format!("failed to write {junit}: this command writes another file there");
    assert_refused(&files, &["run", "cut.toml", "--junit", junit], &twice);
}

#[test]
fn control_characters_are_escaped_and_long_values_cut() {
    let named = |name: &str| CUT.replacen("\"cut-rim\"", &format!("\"{name}\""), 1);
    let scenario = named("a\\u001b[31mb\\nerror: c\\u009b");
    let folder = folder(&[("cut.toml", &scenario), ("long.toml", &named(&"ü".repeat(100_000)))]);
    let output = benchdog(folder.path(), &["run", "cut.toml"]);
    let text = stderr(&output);
    assert!(text.contains("found \"a\\u001b[31mb\\u000aerror: c\\u009b\", expected letters"), "{text}");
    let text = stderr(&benchdog(folder.path(), &["run", "long.toml"]));
    assert!(text.len() < 1000 && text.contains("[... 99702 characters ...]"), "{text}");
    fs::write(folder.path().join("key.toml"), format!("{CUT}\n\"k\\u001b{}\" = 1\n", "y".repeat(50_000))).unwrap();
    let text = stderr(&benchdog(folder.path(), &["run", "key.toml"]));
    assert!(text.len() < 5000 && text.starts_with("error: key.toml:") && !text.contains('\x1b'), "{text}");
}

#[test]
#[cfg(unix)]
fn control_characters_of_a_file_name_are_escaped() {
    let folder = folder(&[("a\x1b[2J.toml", "format = 1\n")]);
    let output = benchdog(folder.path(), &["run", "a\x1b[2J.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(text.starts_with("error: a\\u001b[2J.toml") && !text.contains('\x1b'), "{text}");
}

/// What is printed on standard output comes from files, too: here from the plan of a recording.
#[test]
#[cfg(unix)]
fn control_characters_are_escaped_on_standard_output() {
    let folder = folder(&[]);
    let scenario = slipping_scenario(folder.path(), "slips", "slips");
    let plan = folder.path().join("plans/cut-rim-weak-grip.json");
    let output = benchdog(folder.path(), &["run", &scenario, "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let verdict = fs::read_to_string(folder.path().join("out/slips/verdict.json")).unwrap();
    let forged = verdict.replacen("\"slips\"", "\"slips\\u001b[31m\"", 1);
    fs::write(folder.path().join("forged.json"), forged).unwrap();
    let output = benchdog(folder.path(), &["compare", "forged.json", "out/slips/verdict.json"]);
    assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("slips\\u001b[31m"), "{}", stderr(&output));
    assert!(plan.exists());
}
