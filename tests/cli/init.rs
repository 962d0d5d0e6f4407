//! `benchdog init`: what it writes can be used at once, and nothing that exists is lost.

use std::{fs, path::Path, process::Output};

use serde_json::Value;
use tempfile::TempDir;

use crate::process::{argument, benchdog, contents, folder, json, stderr};

const EXAMPLES: [&str; 4] = ["drill", "cut", "task", "your-plan"];

/// A folder with the files of an example.
fn initialised(example: &str) -> TempDir {
    let folder = folder(&[]);
    let output = benchdog(folder.path(), &["init", "--example", example]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    folder
}

/// The files of a subfolder with this extension, by name without it.
fn stems(folder: &Path, extension: &str) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = files.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == extension));
    let mut stems: Vec<_> = paths.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    stems.sort();
    stems
}

fn assert_met(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}{}", String::from_utf8_lossy(&output.stdout), stderr(output));
}

#[test]
fn the_command_that_init_names_meets_every_expectation() {
    for example in EXAMPLES {
        let folder = folder(&[]);
        let place = folder.path().join("my boards");
        let output = benchdog(folder.path(), &["init", "my boards", "--example", example]);
        let printed = String::from_utf8(output.stdout).unwrap();
        assert!(printed.contains("\nnext: cd \"my boards\"\n"), "{printed}");
        let (_, next) = printed.trim_end().rsplit_once("then: benchdog ").unwrap();
        let arguments: Vec<_> = next.split(' ').collect();
        assert_met(&benchdog(&place, &arguments));
        let wrote: Vec<_> = printed.lines().filter_map(|line| line.strip_prefix("wrote ")).collect();
        assert!(wrote.len() > 9 && wrote.iter().all(|path| folder.path().join(path).is_file()), "{printed}");
    }
}

#[test]
fn every_example_has_a_plan_of_each_scenario_and_they_hold() {
    for example in EXAMPLES {
        let folder = initialised(example);
        let sources = if example == "task" { "tasks" } else { "scenarios" };
        let plans = stems(&folder.path().join("plans"), "json");
        assert_eq!(plans, stems(&folder.path().join(sources), "toml"), "{example}");
        assert_eq!(plans.len(), 3, "{example}");
        for plan in plans {
            let file = format!("plans/{plan}.json");
            let scenario = format!("{sources}/{plan}.toml");
            let mut arguments = vec!["simulate", &file, "--record", "never"];
            // With a scenario of the same robot, board and operation, or else the command refuses the two.
            if example != "task" {
                arguments.extend(["--scenario", &scenario]);
            }
            assert_met(&benchdog(folder.path(), &arguments));
            assert_eq!(json(&folder.path().join("out").join(&plan).join("verdict.json"))["verdict"], "holds");
        }
    }
}

#[test]
fn plans_of_another_planner_have_grasps_only() {
    let folder = initialised("your-plan");
    let plan = json(&folder.path().join("plans/panel.json"));
    for arm in plan["arms"].as_array().unwrap() {
        let keys: Vec<_> = arm.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["name", "x_og"]);
    }
}

#[test]
fn workflows_are_yaml_whose_commands_exist() {
    for example in EXAMPLES {
        let folder = initialised(example);
        let text = fs::read_to_string(folder.path().join(".github/workflows/benchdog.yml")).unwrap();
        let workflow: Value = serde_saphyr::from_str(&text).unwrap();
        let steps = workflow["jobs"]["holds"]["steps"].as_array().unwrap();
        let runs: Vec<_> = steps.iter().filter_map(|step| step["run"].as_str()).collect();
        assert!(runs.iter().any(|run| run.starts_with("pip install benchdog pytest")), "{text}");
        let command =
            if example == "task" { "benchdog task \"$task\"" } else { "benchdog run scenarios --record failed" };
        assert!(runs.iter().any(|run| run.contains(command)), "{text}");
    }
}

#[test]
fn a_folder_that_has_one_of_the_files_is_refused_before_anything_is_written() {
    let folder = folder(&[("plans/drill.json", "mine"), ("notes.txt", "mine too")]);
    let before = contents(folder.path());
    let output = benchdog(folder.path(), &["init"]);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    let place = Path::new("plans/drill.json").display().to_string();
    assert!(
        message.contains(&format!("failed to write {place}: it exists")) && message.contains("--force"),
        "{message}"
    );
    assert_eq!(contents(folder.path()), before);

    assert_met(&benchdog(folder.path(), &["init", "--force"]));
    assert_eq!(json(&folder.path().join("plans/drill.json"))["name"], "drill");
    assert_eq!(fs::read_to_string(folder.path().join("notes.txt")).unwrap(), "mine too");
}

#[test]
fn a_file_in_place_of_the_folder_is_refused() {
    let folder = folder(&[("taken", "mine")]);
    let output = benchdog(folder.path(), &["init", argument(&folder.path().join("taken"))]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("found a file, expected a folder"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(folder.path().join("taken")).unwrap(), "mine");
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_nowhere_is_not_replaced() {
    let folder = folder(&[]);
    let link = folder.path().join("README.md");
    std::os::unix::fs::symlink("elsewhere", &link).unwrap();
    let output = benchdog(folder.path(), &["init"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(link.symlink_metadata().unwrap().is_symlink());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
