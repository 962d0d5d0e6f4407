//! Files of another format where a plan is expected.

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
    let is_mapping = |documents: Vec<serde_json::Value>| {
        documents.first().is_some_and(|first| first.is_object() || first.is_array())
    };
    if serde_saphyr::from_multiple(text).is_ok_and(is_mapping) {
        return Some(YAML);
    }
    match path.extension()?.to_str()? {
        "toml" => Some(TOML),
        "yaml" | "yml" => Some(YAML),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
