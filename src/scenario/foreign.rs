//! Files of another format where a plan or a scenario is expected.

use std::path::Path;

/// What to do with a text that is not a plan in JSON but TOML or YAML; `None` if it seems to be JSON, or nothing known.
pub fn other_format(path: &Path, text: &str) -> Option<&'static str> {
    const TOML: &str = "found TOML, expected a plan in JSON; a scenario is given to `benchdog run`";
    const YAML: &str = "found YAML, expected a plan in JSON; `benchdog import` makes a plan of grasps in YAML";
    // A plan is an object.
    if text.trim_start().starts_with('{') {
        return None;
    }
    if toml::from_str::<toml::Table>(text).is_ok_and(|table| !table.is_empty()) {
        return Some(TOML);
    }
    if is_yaml(text) {
        return Some(YAML);
    }
    match path.extension()?.to_str()? {
        "toml" => Some(TOML),
        "yaml" | "yml" => Some(YAML),
        _ => None,
    }
}

fn is_yaml(text: &str) -> bool {
    let is_collection = |documents: Vec<serde_json::Value>| {
        documents.first().is_some_and(|first| first.is_object() || first.is_array())
    };
    serde_saphyr::from_multiple(text).is_ok_and(is_collection)
}

/// What to do with a text that is not a scenario in TOML but JSON, YAML or XML; `None` if it seems to be broken TOML.
pub fn not_toml(path: &Path, text: &str) -> Option<String> {
    let file = path.display();
    let start = text.trim_start();
    if start.starts_with('{') {
        let is_plan = serde_json::from_str::<serde_json::Value>(text).is_ok_and(|value| value.get("object").is_some());
        let hint = if is_plan { "; a plan is given to `benchdog simulate`" } else { "" };
        let found = if is_plan { "a plan in JSON" } else { "JSON" };
        return Some(format!("found {found}, expected a scenario in TOML{hint}"));
    }
    if start.starts_with('<') {
        let found = if text.contains("xmlns:xacro") || text.contains("<xacro:") {
            let urdf = "`xacro FILE -o robot.urdf` makes a URDF of it";
            return Some(format!("found a xacro file, expected a scenario in TOML; {urdf}, and then {ROBOT_NEW}"));
        } else if text.contains("<robot") {
            return Some(format!(
                "found a URDF, expected a scenario in TOML; {}",
                ROBOT_NEW.replace("robot.urdf", &file.to_string())
            ));
        } else {
            "XML"
        };
        return Some(format!("found {found}, expected a scenario in TOML"));
    }
    let is_named = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    (is_named || is_yaml(text)).then(|| format!("found YAML, expected a scenario in TOML: {}", first_line(text)))
}

/// How a URDF becomes a robot and a scenario.
const ROBOT_NEW: &str =
    "`benchdog robot new robot.urdf -o robot.toml --scenario scenario.toml` writes a robot and a scenario";

/// The first line `key: value` of YAML, and how it is in TOML.
fn first_line(text: &str) -> String {
    let pair = |line: &str| {
        let (key, value) = line.split_once(": ")?;
        let value = value.split(" #").next().unwrap_or(value).trim();
        let is_bare = |text: &str| text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'));
        (is_bare(key) && !value.is_empty() && !value.contains(['[', '{', '&', '*', '|', '>'])).then(|| {
            let is_literal = value.parse::<f64>().is_ok() || matches!(value, "true" | "false");
            let is_quoted = value.len() > 1 && value.starts_with('"') && value.ends_with('"');
            let in_toml = if is_literal || is_quoted { value.to_owned() } else { toml::Value::from(value).to_string() };
            format!("`{key}: {value}` is `{key} = {in_toml}`")
        })
    };
    text.lines().find_map(pair).unwrap_or_else(|| "`format: 1` is `format = 1`".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_scenario_is_told_how_to_become_one() {
        let hint = |name: &str, text: &str| not_toml(Path::new(name), text).unwrap_or_default();
        assert_eq!(
            hint("s.yaml", "# a scenario\nname: drill\nformat: 1\n"),
            "found YAML, expected a scenario in TOML: `name: drill` is `name = \"drill\"`"
        );
        assert_eq!(hint("s.toml", "format: 1\nname: a\n").split(": ").nth(1).unwrap(), "`format");
        assert!(hint("p.json", "{\"format\": 1, \"object\": {}}").contains("given to `benchdog simulate`"));
        assert_eq!(hint("p.json", "{}"), "found JSON, expected a scenario in TOML");
        assert!(
            hint("a.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"a\"/>").contains("`benchdog robot new a.urdf -o")
        );
        assert!(hint("a.xacro", "<robot xmlns:xacro=\"x\"/>").contains("`xacro FILE -o robot.urdf`"));
        assert_eq!(hint("a.svg", "<svg/>"), "found XML, expected a scenario in TOML");
        assert_eq!(hint("s.toml", "format = 1\nname = \n"), "", "broken TOML");
    }

    #[test]
    fn formats_by_their_text_and_by_their_names() {
        let found = |name: &str, text: &str| {
            other_format(Path::new(name), text).map(|hint| hint.split([' ', ',']).nth(1).unwrap())
        };
        assert_eq!(found("x.json", "format = 1\n"), Some("TOML"));
        assert_eq!(found("x.json", "format: isaac_grasp\ngrasps: {}\n"), Some("YAML"));
        assert_eq!(found("x.json", "- id: a\n- id: b\n"), Some("YAML"));
        // Broken, but known by the name.
        assert_eq!(found("x.yaml", "a: [1\n"), Some("YAML"));
        assert_eq!(found("x.toml", "a = \n"), Some("TOML"));
        // JSON, broken JSON, nothing, prose.
        for text in ["{\"format\": 1}", "  {\"format\": ", "", "   \n", "hello"] {
            assert_eq!(found("x.json", text), None, "{text}");
        }
    }
}
