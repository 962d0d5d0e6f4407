//! `benchdog explain` and `docs/verdicts.md`: a section for every verdict and check, in one form, that names nothing unknown.

use std::{collections::BTreeSet, fs};

use benchdog::model::verdict::{CheckKind, VerdictKind};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::{
    common::root,
    process::{benchdog, json, slipping_scenario, stderr},
};

/// The parts of every section, in their order.
const PARTS: [&str; 4] = [
    "**What a pass guarantees, and what not.** ",
    "**How it is measured.** ",
    "**Likely causes of a failure.** ",
    "**How to fix it.** ",
];

fn page() -> String {
    fs::read_to_string(root().join("docs/verdicts.md")).unwrap().replace("\r\n", "\n")
}

fn is_picture(paragraph: &str) -> bool {
    paragraph.starts_with("![")
}

/// The sections of a chapter: name and text without its picture.
fn sections(page: &str, chapter: &str) -> Vec<(String, String)> {
    let (_, text) = page.split_once(&format!("\n## {chapter}\n")).unwrap_or_else(|| panic!("no chapter {chapter}"));
    let text = text.split("\n## ").next().unwrap();
    let section = |text: &str| {
        let (name, body) = text.split_once('\n').unwrap();
        let paragraphs = body.trim().split("\n\n").filter(|paragraph| !is_picture(paragraph));
        (name.to_owned(), paragraphs.collect::<Vec<_>>().join("\n\n"))
    };
    text.split("\n### ").skip(1).map(section).collect()
}

fn all_sections(page: &str) -> Vec<(String, String)> {
    ["Verdicts", "Checks", "Self-checks"].iter().flat_map(|chapter| sections(page, chapter)).collect()
}

/// The kinds of a type of verdict files, by the schema that is derived from it.
fn kinds<T: DeserializeOwned>(of: &str) -> Vec<T> {
    let schema = json(&root().join("schemas/verdict.schema.json"));
    let kinds = schema["$defs"][of]["oneOf"].as_array().unwrap();
    kinds.iter().map(|kind| serde_json::from_value(kind["const"].clone()).unwrap()).collect()
}

#[test]
fn every_verdict_check_and_self_check_has_its_section() {
    let page = page();
    let found = |chapter| sections(&page, chapter).into_iter().map(|(name, _)| name).collect::<BTreeSet<_>>();
    let verdicts: BTreeSet<_> =
        kinds::<VerdictKind>("VerdictKind").into_iter().map(|kind| kind.name().to_owned()).collect();
    assert_eq!(found("Verdicts"), verdicts);
    let (self_checks, checks): (Vec<_>, Vec<_>) =
        kinds::<CheckKind>("CheckKind").into_iter().partition(|kind| kind.verdict() == VerdictKind::NoVerdict);
    let names = |kinds: Vec<CheckKind>| kinds.into_iter().map(|kind| kind.name().to_owned()).collect::<BTreeSet<_>>();
    assert_eq!((found("Checks"), found("Self-checks")), (names(checks), names(self_checks)));
    let count = all_sections(&page).len();
    assert_eq!(count, verdicts.len() + kinds::<CheckKind>("CheckKind").len(), "a name has two sections");
    assert_eq!(page.matches("\n### ").count(), count, "a section is in another chapter");
}

#[test]
fn every_verdict_has_its_picture() {
    let page = page();
    for (name, _) in sections(&page, "Verdicts") {
        let file = format!("verdicts/{name}.svg");
        let pictures: Vec<_> = page.split("\n\n").filter(|text| is_picture(text) && text.contains(&file)).collect();
        assert_eq!(pictures.len(), 1, "{name}");
        assert!(root().join("docs").join(&file).is_file(), "{file}");
    }
}

#[test]
fn every_section_has_a_summary_and_the_four_parts_in_order() {
    for (name, text) in all_sections(&page()) {
        let paragraphs: Vec<_> = text.split("\n\n").collect();
        assert_eq!(paragraphs.len(), 1 + PARTS.len(), "{name}: {text}");
        assert!(!paragraphs[0].starts_with('*') && paragraphs[0].ends_with('.'), "{name}: {}", paragraphs[0]);
        for (part, paragraph) in PARTS.iter().zip(&paragraphs[1..]) {
            let after = paragraph.replace('\n', " ");
            let after =
                after.strip_prefix(part).unwrap_or_else(|| panic!("{name}: expected {part}, found {paragraph}"));
            assert!(after.len() > 20 && after.ends_with('.'), "{name}: {part}{after}");
        }
    }
}

/// True if the scenario's schema has this key, such as `grip.force_n`.
fn is_scenario_key(schema: &Value, key: &str) -> bool {
    key.split('.').try_fold(schema, |at, part| child(schema, at, part)).is_some()
}

/// A property of a schema, which may be a reference to a definition or a choice of such.
fn child<'s>(schema: &'s Value, at: &'s Value, part: &str) -> Option<&'s Value> {
    if let Some(found) = at.get("properties").and_then(|all| all.get(part)) {
        return Some(found);
    }
    if let Some(name) = at.get("$ref").and_then(Value::as_str) {
        return child(schema, &schema["$defs"][name.rsplit('/').next()?], part);
    }
    at.get("anyOf")?.as_array()?.iter().find_map(|choice| child(schema, choice, part))
}

/// What a section names in backticks that is neither a verdict, a check, a key of scenarios or robots, an option nor a command.
fn unknown_names(text: &str, names: &BTreeSet<String>, help: &str, robot: &str, schema: &Value) -> Vec<String> {
    let text = text.replace('\n', " ");
    let is_known = |token: &str| {
        let plain = token.split(" = ").next().unwrap();
        let words: Vec<_> = token.split(' ').collect();
        match words[..] {
            ["benchdog", command] => help.contains(&format!("Usage: benchdog {command} ")),
            [option, ..] if option.starts_with("--") => {
                help.split(|c: char| !c.is_alphanumeric() && c != '-').any(|word| word == option)
            }
            _ => {
                names.contains(plain)
                    || is_scenario_key(schema, plain)
                    || robot.contains(&format!("`{plain}`"))
                    || ["cut", "reason", "verdict.json"].contains(&plain)
            }
        }
    };
    text.split('`').skip(1).step_by(2).filter(|token| !is_known(token)).map(str::to_owned).collect()
}

#[test]
fn sections_name_only_what_exists() {
    let page = page();
    let names: BTreeSet<_> = all_sections(&page).into_iter().map(|(name, _)| name).collect();
    let of = |command: &str| String::from_utf8(benchdog(root(), &["help", command]).stdout).unwrap();
    let help = ["plan", "run", "inspect", "sweep", "margin", "doctor"].map(of).concat();
    let robot = fs::read_to_string(root().join("docs/robot.md")).unwrap();
    let schema = json(&root().join("schemas/scenario.schema.json"));
    for (name, text) in all_sections(&page) {
        let unknown = unknown_names(&text, &names, &help, &robot, &schema);
        assert!(unknown.is_empty(), "{name} names {unknown:?}");
    }
    let invented = "`slides`, `limits.slip_m`, `grip`, `--fast`, `benchdog fly`, `human.posture = \"free\"`, `slips`";
    let unknown = unknown_names(invented, &names, &help, &robot, &schema);
    assert_eq!(unknown, ["slides", "limits.slip_m", "--fast", "benchdog fly"]);
}

#[test]
fn the_command_prints_the_section_of_the_page() {
    for (name, text) in all_sections(&page()) {
        let output = benchdog(root(), &["explain", &name]);
        assert_eq!(String::from_utf8(output.stdout).unwrap(), format!("{name}\n\n{text}\n"));
        assert_eq!(output.status.code(), Some(0));
    }
}

#[test]
fn without_a_name_every_section_is_listed_with_its_first_sentence() {
    let list = String::from_utf8(benchdog(root(), &["explain"]).stdout).unwrap();
    for (name, text) in all_sections(&page()) {
        let summary = text.split("\n\n").next().unwrap().replace('\n', " ");
        let is_row = |line: &str| line.trim_start().strip_prefix(&name).is_some_and(|rest| rest.trim() == summary);
        assert_eq!(list.lines().filter(|line| is_row(line)).count(), 1, "{name} in {list}");
    }
}

#[test]
fn an_unknown_name_is_an_error_that_suggests_the_nearest() {
    let output = benchdog(root(), &["explain", "slip_rotatoin"]);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    let error = stderr(&output);
    assert!(error.contains("invalid value 'slip_rotatoin'"), "{error}");
    assert!(error.contains("similar value exists: 'slip_rotation'"), "{error}");
}

#[test]
fn a_hint_follows_what_was_not_expected_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let [met, not_met] =
        ["slips", "holds"].map(|expected| slipping_scenario(folder.path(), &format!("expects-{expected}"), expected));
    let printed = |arguments: &[&str]| {
        let arguments = [&["run", "--record", "never"], arguments].concat();
        String::from_utf8(benchdog(folder.path(), &arguments).stdout).unwrap()
    };
    let hint = "benchdog explain slips says what this means and what helps\n";
    assert!(printed(&[&not_met]).ends_with(hint));
    assert!(printed(&[&met, &not_met]).ends_with(hint));
    for arguments in [&[met.as_str()][..], &[&not_met, "--format", "json"]] {
        let printed = printed(arguments);
        assert!(!printed.contains("benchdog explain"), "{printed}");
    }
}

#[test]
fn a_verdict_states_its_criteria_and_one_without_them_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = slipping_scenario(folder.path(), "numbered", "slips");
    assert_eq!(benchdog(folder.path(), &["run", &scenario, "--record", "never"]).status.code(), Some(0));
    let path = folder.path().join("out/numbered/verdict.json");
    let mut verdict = json(&path);
    assert_eq!(verdict["criteria"], benchdog::judge::CRITERIA);
    verdict.as_object_mut().unwrap().remove("criteria");
    let old = folder.path().join("old");
    fs::create_dir(&old).unwrap();
    fs::write(old.join("verdict.json"), verdict.to_string()).unwrap();
    let output = benchdog(folder.path(), &["compare", "old", "out/numbered"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}
