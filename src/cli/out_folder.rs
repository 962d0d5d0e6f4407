//! `--out`: a folder, or a template such as `out/{name}-{seed}`.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

use crate::{
    input::did_you_mean,
    model::{plan::Plan, scenario::Scenario},
};

/// What can be in braces.
const PLACEHOLDERS: [&str; 3] = ["name", "kind", "seed"];

/// The folder of results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutFolder {
    parts: Vec<Part>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    /// A part of a path as it is.
    Text(PathBuf),
    Name,
    Kind,
    Seed,
}

/// The values of a scenario or plan.
pub struct Values {
    name: String,
    kind: String,
    seed: u64,
}

impl Values {
    /// The values of a scenario and, if there is one already, its plan.
    pub fn of(scenario: &Scenario, plan: Option<&Plan>) -> Self {
        let planned = plan.and_then(|plan| plan.planner);
        Self {
            name: plan.map_or(&scenario.name, |plan| &plan.name).clone(),
            kind: scenario.operation.kind.to_string(),
            seed: planned.map_or(scenario.planner.seed, |planner| planner.seed),
        }
    }

    /// These values with another name or seed.
    pub fn with(self, name: &str, seed: u64) -> Self {
        Self { name: name.to_owned(), seed, ..self }
    }
}

impl OutFolder {
    /// The parser of the option.
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().try_map(Self::parse)
    }

    /// A path that is not text has no placeholders.
    fn parse(path: PathBuf) -> Result<Self, String> {
        let Some(text) = path.to_str() else { return Ok(Self { parts: vec![Part::Text(path)] }) };
        let mut parts = Vec::new();
        let mut written = String::new();
        let mut rest = text;
        while let Some(place) = rest.find(['{', '}']) {
            let (before, from) = rest.split_at(place);
            written.push_str(before);
            if let Some(after) = from.strip_prefix("{{").or_else(|| from.strip_prefix("}}")) {
                written.push_str(&from[..1]);
                rest = after;
                continue;
            }
            let name = from.strip_prefix('{').and_then(|from| from.split_once('}'));
            let Some((name, after)) = name else {
                return Err(format!("found a brace alone at \"{from}\", expected {}", in_words()));
            };
            let part = match name {
                "name" => Part::Name,
                "kind" => Part::Kind,
                "seed" => Part::Seed,
                _ => {
                    let meant = did_you_mean(name, PLACEHOLDERS);
                    return Err(format!("found {{{name}}}, expected {}{meant}", in_words()));
                }
            };
            parts.push(Part::Text(std::mem::take(&mut written).into()));
            parts.push(part);
            rest = after;
        }
        written.push_str(rest);
        parts.push(Part::Text(written.into()));
        Ok(Self { parts })
    }

    fn is_template(&self) -> bool {
        self.parts.len() > 1
    }

    /// The folder of what is about all scenarios: that of a template ends before the first placeholder.
    pub fn of_all(&self) -> PathBuf {
        let text = match self.parts.first() {
            Some(Part::Text(text)) => text.as_path(),
            _ => Path::new(""),
        };
        if !self.is_template() {
            return text.to_owned();
        }
        let is_whole = text.to_string_lossy().ends_with(std::path::is_separator);
        let folder = if is_whole { text } else { text.parent().unwrap_or(Path::new("")) };
        if folder.as_os_str().is_empty() { ".".into() } else { folder.to_owned() }
    }

    /// The folder of one scenario or plan: that of a template, or one of its name in the folder.
    pub fn of_one(&self, values: &Values) -> PathBuf {
        if self.is_template() { self.filled(values) } else { self.filled(values).join(&values.name) }
    }

    /// The folder of a command about one scenario or plan.
    pub fn filled(&self, values: &Values) -> PathBuf {
        let mut path = std::ffi::OsString::new();
        for part in &self.parts {
            match part {
                Part::Text(text) => path.push(text),
                Part::Name => path.push(&values.name),
                Part::Kind => path.push(&values.kind),
                Part::Seed => path.push(values.seed.to_string()),
            }
        }
        path.into()
    }
}

fn in_words() -> String {
    let known = PLACEHOLDERS.map(|name| format!("{{{name}}}")).join(", ");
    format!("one of {known}; a brace itself is written twice")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(text: &str) -> OutFolder {
        OutFolder::parse(text.into()).unwrap()
    }

    fn values() -> Values {
        Values { name: "rim".into(), kind: "cut".into(), seed: 7 }
    }

    #[test]
    fn a_folder_has_one_for_each_name() {
        let out = folder("out");
        assert_eq!(
            [out.of_all(), out.of_one(&values()), out.filled(&values())],
            ["out", "out/rim", "out"].map(PathBuf::from)
        );
    }

    #[test]
    fn a_template_is_filled_and_reports_are_above_its_first_placeholder() {
        for (template, one, all) in [
            ("out/{name}-{seed}", "out/rim-7", "out"),
            ("out/a-{kind}/{name}", "out/a-cut/rim", "out"),
            ("{name}", "rim", "."),
            ("/tmp/x/{seed}/{name}", "/tmp/x/7/rim", "/tmp/x/"),
            ("a{{b}}/{name}{name}", "a{b}/rimrim", "a{b}"),
        ] {
            let out = folder(template);
            assert_eq!((out.of_one(&values()), out.of_all()), (one.into(), all.into()), "{template}");
        }
        assert_eq!(folder("a{{b}}").of_all(), Path::new("a{b}"));
    }

    #[test]
    fn an_unknown_placeholder_is_an_error_with_those_that_are_known() {
        let error = |text: &str| OutFolder::parse(text.into()).unwrap_err();
        assert_eq!(
            error("out/{nmae}"),
            "found {nmae}, expected one of {name}, {kind}, {seed}; a brace itself is written twice; did you mean \"name\"?"
        );
        assert!(error("out/{date}").starts_with("found {date}, expected one of {name}, {kind}, {seed};"));
        assert!(error("out/{name").starts_with("found a brace alone at \"{name\""));
        assert!(error("out}").starts_with("found a brace alone at \"}\""));
    }
}
