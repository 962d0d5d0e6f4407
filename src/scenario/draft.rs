//! A file whose faults are all found: what is wrong is taken out, and the rest is read again.
//!
//! Only independent faults are listed. What follows from another fault is not one: a required key whose misspelt form was found, or a
//! point that is on the board that the user meant but not on the usual one.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::{Deserialize as _, de::DeserializeOwned};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    InputError, InputErrorKind,
    arrays::{TooLong, too_long},
    check::Checker,
    locate::{self, KeyPart, key_parts},
};
use crate::input::meant;

/// The most faults that are looked for in one file.
const MOST_FAULTS: usize = 100;

/// The values of a file, of which some can be taken out.
pub trait Document {
    /// The values as a type.
    ///
    /// # Errors
    /// If a key is unknown or missing, or a value has the wrong type.
    fn read<T: DeserializeOwned>(&self) -> Result<T, InputError>;

    /// Takes out a key with its value. False if there is no such key.
    fn remove(&mut self, parts: &[KeyPart<'_>]) -> bool;

    /// Gives a required key of the outermost table an accepted value, so that the rest can be read. False if it has none to give.
    fn supply(&mut self, key: &str) -> bool;
}

/// What was wrong in a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrong {
    /// A key or a type.
    Form,
    /// A value.
    Value,
}

/// A document, and the faults that were found in it so far.
pub struct Draft<D> {
    file: PathBuf,
    document: D,
    faults: Vec<InputError>,
    /// The keys that were taken out.
    removed: Vec<String>,
    /// The keys that were supplied.
    supplied: Vec<String>,
    sections: BTreeMap<String, Wrong>,
}

impl<D: Document> Draft<D> {
    /// A document of a file.
    pub fn new(file: &Path, document: D) -> Self {
        Self {
            file: file.to_owned(),
            document,
            faults: Vec::new(),
            removed: Vec::new(),
            supplied: Vec::new(),
            sections: BTreeMap::new(),
        }
    }

    /// True if no fault was found.
    pub fn is_whole(&self) -> bool {
        self.faults.is_empty()
    }

    /// The values without those that are wrong, which become faults; `None` if what is left cannot be read.
    pub fn read<T: DeserializeOwned>(&mut self) -> Option<T> {
        while self.faults.len() < MOST_FAULTS {
            let error = match self.document.read::<T>() {
                Ok(values) => return Some(values),
                Err(error) => error,
            };
            let key = error.key.clone().unwrap_or_default();
            let missing = match &error.kind {
                InputErrorKind::Syntax(message) => missing_field(message).map(str::to_owned),
                _ => None,
            };
            // The user wrote it in another way.
            let follows = missing.is_some() && self.removed.iter().any(|removed| parent(removed) == key);
            if !follows {
                self.sections.insert(section(meant_section(&key, &error)).to_owned(), Wrong::Form);
                self.faults.push(error);
            }
            let goes_on = match missing {
                Some(field) if key.is_empty() => self.supply(&field),
                _ => self.take_out(&key),
            };
            if !goes_on {
                return None;
            }
        }
        None
    }

    /// Adds the fault of a value, unless it follows from another fault, and takes the value out. False if nothing more can be found.
    pub fn refuse(&mut self, error: InputError) -> bool {
        let Some(key) = error.key.clone().filter(|_| error.file == self.file) else {
            self.faults.push(error);
            return false;
        };
        let section = section(&key);
        if !self.follows(&error, &key, section) {
            self.sections.entry(section.to_owned()).or_insert(Wrong::Value);
            self.faults.push(error);
        }
        self.faults.len() < MOST_FAULTS && (self.take_out(&key) || self.supply(section))
    }

    /// True if the fault of a value may be there only because of one before.
    fn follows(&self, error: &InputError, key: &str, section: &str) -> bool {
        // Keys that are missing, that belong to other values, and values that do not fit together.
        let of_several_keys = match &error.kind {
            InputErrorKind::Value { found, expected } => found == "nothing" || expected.starts_with("none: "),
            kind => matches!(kind, InputErrorKind::Syntax(_)),
        };
        let of_section = match self.sections.get(section) {
            Some(Wrong::Form) => true,
            Some(Wrong::Value) => of_several_keys,
            None => false,
        };
        of_section
            || self.removed.iter().any(|removed| is_at_or_below(removed, key) || is_at_or_below(key, removed))
            || self.sections.keys().any(|wrong| depends(section, wrong))
    }

    fn take_out(&mut self, key: &str) -> bool {
        let mut parts: Vec<KeyPart<'_>> = key_parts(key).collect();
        while !parts.is_empty() {
            // Of an array without one of its values the others would have other numbers.
            parts.truncate(parts.iter().rposition(|part| matches!(part, KeyPart::Key(_))).map_or(0, |last| last + 1));
            if !parts.is_empty() && self.document.remove(&parts) {
                self.removed.push(path_of(&parts));
                return true;
            }
            parts.pop();
        }
        false
    }

    fn supply(&mut self, key: &str) -> bool {
        if self.supplied.iter().any(|supplied| supplied == key) {
            return false;
        }
        self.supplied.push(key.to_owned());
        self.document.supply(key)
    }

    /// All faults as one error.
    pub fn into_error(self) -> InputError {
        InputError::several(&self.file, self.faults)
    }
}

/// The sections whose values are checked against those of other sections.
const DEPENDENCES: [(&str, &[&str]); 9] = [
    ("object", &["robot"]),
    ("grip", &["robot"]),
    ("planner", &["robot"]),
    ("operation", &["object"]),
    ("load", &["operation", "simulation"]),
    ("limits", &["operation"]),
    ("uncertainty", &["object"]),
    ("human", &["tool"]),
    ("sweep", &["operation", "load", "grip", "uncertainty", "human", "simulation", "expect"]),
];

/// True if a section is checked against another one, directly or through others.
fn depends(section: &str, other: &str) -> bool {
    let on = DEPENDENCES.iter().find(|(name, _)| *name == section).map_or(&[][..], |(_, on)| on);
    on.iter().any(|on| *on == other || depends(on, other))
}

/// The section of a key. The path of a task is the operation of its scenario.
fn section(key: &str) -> &str {
    match key.split(['.', '[']).next() {
        Some("task") => "operation",
        section => section.unwrap_or_default(),
    }
}

/// The section that the user meant by an unknown one, or the key as it is.
fn meant_section<'a>(key: &'a str, error: &'a InputError) -> &'a str {
    match &error.kind {
        InputErrorKind::Syntax(message) if parent(key).is_empty() => meant(message).unwrap_or(key),
        _ => key,
    }
}

/// The key of the table that has a key; that of the outermost one is empty.
fn parent(key: &str) -> &str {
    key.rsplit_once('.').map_or("", |(parent, _)| parent)
}

fn is_at_or_below(key: &str, other: &str) -> bool {
    key.strip_prefix(other).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// The key that a reader of a file misses.
fn missing_field(message: &str) -> Option<&str> {
    message.strip_prefix("missing field `")?.split('`').next()
}

fn path_of(parts: &[KeyPart<'_>]) -> String {
    let mut path = String::new();
    for part in parts {
        match part {
            KeyPart::Key(key) if path.is_empty() => path.push_str(key),
            KeyPart::Key(key) => path.push_str(&format!(".{key}")),
            KeyPart::Index(index) => path.push_str(&format!("[{index}]")),
        }
    }
    path
}

/// The text of a scenario file as TOML.
pub struct TomlDocument<'a> {
    path: &'a Path,
    text: &'a str,
    root: Spanned<DeTable<'a>>,
}

/// What is supplied for the required keys of a scenario.
const REQUIRED: &str = "format = 1\nname = \"x\"\n\
                        [operation]\nkind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 1.0\n";

impl<'a> TomlDocument<'a> {
    /// Parses a text.
    ///
    /// # Errors
    /// If it is not TOML.
    pub fn parse(path: &'a Path, text: &'a str) -> Result<Self, InputError> {
        match DeTable::parse(text) {
            Ok(root) => Ok(Self { path, text, root }),
            Err(error) => Err(of_toml(path, text, &error)),
        }
    }

    fn deserializer(&self) -> toml::Deserializer<'a> {
        toml::Deserializer::from(self.root.clone())
    }
}

fn of_toml(path: &Path, text: &str, error: &toml::de::Error) -> InputError {
    let span = error.span();
    InputError {
        file: path.to_owned(),
        line: span.as_ref().map(|span| locate::line_at(text, span.start)),
        key: span.as_ref().and_then(|span| locate::toml_key_at(text, span)),
        kind: InputErrorKind::Syntax(error.message().replace('\n', "; ")),
    }
}

impl Document for TomlDocument<'_> {
    fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        let values = T::deserialize(self.deserializer()).map_err(|error| of_toml(self.path, self.text, &error))?;
        let of_arrays = serde_json::Value::deserialize(self.deserializer()).ok();
        match of_arrays.and_then(|values| too_long::<T>(&values)) {
            Some(TooLong { key, found, expected }) => {
                Err(Checker::toml(self.path, self.text).value(&key, found, expected))
            }
            None => Ok(values),
        }
    }

    fn remove(&mut self, parts: &[KeyPart<'_>]) -> bool {
        remove_from_table(self.root.get_mut(), parts)
    }

    fn supply(&mut self, key: &str) -> bool {
        let entry = DeTable::parse(REQUIRED).ok().and_then(|mut table| table.get_mut().remove_entry(key));
        entry.is_some_and(|(key, value)| self.root.get_mut().insert(key, value).is_none())
    }
}

fn remove_from_table(table: &mut DeTable<'_>, parts: &[KeyPart<'_>]) -> bool {
    match parts {
        [KeyPart::Key(key)] => table.remove(*key).is_some(),
        [KeyPart::Key(key), below @ ..] => {
            table.get_mut(*key).is_some_and(|value| remove_from_value(value.get_mut(), below))
        }
        _ => false,
    }
}

fn remove_from_value(value: &mut DeValue<'_>, parts: &[KeyPart<'_>]) -> bool {
    match (value, parts) {
        (DeValue::Table(table), _) => remove_from_table(table, parts),
        (DeValue::Array(array), [KeyPart::Index(index), below @ ..]) => {
            array.get_mut(*index).is_some_and(|value| remove_from_value(value.get_mut(), below))
        }
        _ => false,
    }
}

/// The text of a plan as JSON.
pub struct JsonDocument<'a> {
    path: &'a Path,
    text: &'a str,
    root: serde_json::Value,
}

impl<'a> JsonDocument<'a> {
    /// Parses a text; `None` if it is not JSON.
    pub fn parse(path: &'a Path, text: &'a str) -> Option<Self> {
        let root = serde_json::from_str(text).ok()?;
        Some(Self { path, text, root })
    }
}

impl Document for JsonDocument<'_> {
    fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        serde_path_to_error::deserialize(&self.root).map_err(|error| {
            let key = Some(error.path().to_string()).filter(|key| key != ".");
            let kind = InputErrorKind::Syntax(error.inner().to_string());
            let line = key.as_ref().and_then(|key| locate::json_line(self.text, key));
            InputError { file: self.path.to_owned(), line, key, kind }
        })
    }

    fn remove(&mut self, parts: &[KeyPart<'_>]) -> bool {
        let Some((KeyPart::Key(last), above)) = parts.split_last() else { return false };
        let mut value = &mut self.root;
        for part in above {
            let next = match part {
                KeyPart::Key(key) => value.get_mut(*key),
                KeyPart::Index(index) => value.get_mut(*index),
            };
            let Some(next) = next else { return false };
            value = next;
        }
        value.as_object_mut().is_some_and(|object| object.remove(*last).is_some())
    }

    fn supply(&mut self, _: &str) -> bool {
        false
    }
}
