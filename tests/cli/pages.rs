//! What the guides under docs/ show: files that are accepted and do what the text says.

use std::fs;

use crate::{
    common::root,
    process::{benchdog, json, stderr},
};

fn page(name: &str) -> String {
    fs::read_to_string(root().join("docs").join(name)).unwrap().replace("\r\n", "\n")
}

/// The fenced blocks of a language in a page.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).map(|text| text.split("```").next().unwrap().to_owned()).collect()
}

#[test]
fn the_plan_of_the_guide_for_planners_holds() {
    let folder = tempfile::tempdir().unwrap();
    let plans = blocks(&page("planner.md"), "json");
    assert_eq!(plans.len(), 1);
    fs::write(folder.path().join("panel.json"), &plans[0]).unwrap();
    let output = benchdog(folder.path(), &["simulate", "panel.json", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let verdict = json(&folder.path().join("out/panel/verdict.json"));
    assert_eq!(verdict["verdict"], "holds");
}

#[test]
fn the_task_of_the_guide_for_tasks_is_the_scenario_and_its_other_paths_are_keys() {
    let blocks = blocks(&page("tasks.md"), "toml");
    let scenario = fs::read_to_string(root().join("scenarios/whole-circle.toml")).unwrap().replace("\r\n", "\n");
    let (_, scenario) = scenario.split_once('\n').unwrap();
    assert_eq!(blocks[0], scenario);
    let schema = json(&root().join("schemas/scenario.schema.json"));
    let keys: Vec<_> = blocks[1].lines().map(|line| line.split(" = ").next().unwrap()).collect();
    assert_eq!(keys.len(), 3);
    for key in keys {
        assert!(schema["$defs"]["TaskSection"]["properties"].get(key).is_some(), "{key}");
    }
}
