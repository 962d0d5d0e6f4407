//! Finds the line of a key in TOML and JSON text, and the key at a position in TOML text.

use std::{collections::BTreeMap, ops::Range};

use serde_json::value::RawValue;
use toml::de::{DeTable, DeValue};

/// One part of a key path such as `arms[0].q_rad[3]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyPart<'a> {
    /// The key of a table.
    Key(&'a str),
    /// The number of a value of an array, from 0.
    Index(usize),
}

/// The parts of a key path.
pub fn key_parts(path: &str) -> impl Iterator<Item = KeyPart<'_>> {
    path.split(['.', '[']).filter(|part| !part.is_empty()).map(|part| match part.strip_suffix(']').map(str::parse) {
        Some(Ok(index)) => KeyPart::Index(index),
        _ => KeyPart::Key(part),
    })
}

/// The line, from 1, of the byte at `offset`.
pub fn line_at(text: &str, offset: usize) -> usize {
    text.as_bytes()[..offset.min(text.len())].iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// The line of a key in TOML text; if the key is missing, that of the innermost table on its path.
pub fn toml_line(text: &str, path: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut place: Option<usize> = None;
    let mut table: Option<&DeTable<'_>> = Some(document.get_ref());
    let mut value: Option<&DeValue<'_>> = None;
    for part in key_parts(path) {
        let next = match part {
            KeyPart::Key(key) => {
                table.and_then(|table| table.get_key_value(key)).map(|(key, value)| (key.span().start, value.get_ref()))
            }
            KeyPart::Index(index) => value
                .and_then(DeValue::as_array)
                .and_then(|array| array.get(index))
                .map(|element| (element.span().start, element.get_ref())),
        };
        let Some((start, found)) = next else { break };
        place = Some(start);
        value = Some(found);
        table = found.as_table();
    }
    place.map(|offset| line_at(text, offset))
}

/// The path of the value or key at `span` in TOML text.
pub fn toml_key_at(text: &str, span: &Range<usize>) -> Option<String> {
    let document = DeTable::parse(text).ok()?;
    key_in_table(document.get_ref(), span, "")
}

fn key_in_table(table: &DeTable<'_>, span: &Range<usize>, prefix: &str) -> Option<String> {
    table.iter().find_map(|(key, value)| {
        let path = if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
        if key.span() == *span {
            return Some(path);
        }
        key_in_value(value, span, path)
    })
}

fn key_in_value(value: &toml::Spanned<DeValue<'_>>, span: &Range<usize>, path: String) -> Option<String> {
    let inner = match value.get_ref() {
        DeValue::Table(table) => key_in_table(table, span, &path),
        DeValue::Array(array) => array
            .iter()
            .enumerate()
            .find_map(|(index, element)| key_in_value(element, span, format!("{path}[{index}]"))),
        _ => None,
    };
    inner.or_else(|| (value.span() == *span).then_some(path))
}

/// The line of a key in JSON text; if the key is missing, that of the innermost value on its path.
pub fn json_line(text: &str, path: &str) -> Option<usize> {
    let mut here: &RawValue = serde_json::from_str(text).ok()?;
    for part in key_parts(path) {
        let next = match part {
            KeyPart::Key(key) => serde_json::from_str::<BTreeMap<String, &RawValue>>(here.get())
                .ok()
                .and_then(|object| object.get(key).copied()),
            KeyPart::Index(index) => {
                serde_json::from_str::<Vec<&RawValue>>(here.get()).ok().and_then(|array| array.get(index).copied())
            }
        };
        let Some(found) = next else { break };
        here = found;
    }
    // The raw values borrow from `text`, so the distance of the pointers is the value's offset.
    let offset = (here.get().as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    Some(line_at(text, offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOML: &str = "format = 1\n\n[grip]\nforce_n = 30.0\n\n[object]\nsize_m = [\n  0.5,\n  0.4,\n]\n";

    #[test]
    fn a_toml_key_is_found_on_its_line() {
        assert_eq!(toml_line(TOML, "format"), Some(1));
        assert_eq!(toml_line(TOML, "grip.force_n"), Some(4));
        assert_eq!(toml_line(TOML, "object.size_m[1]"), Some(9));
    }

    #[test]
    fn a_missing_toml_key_points_at_its_table() {
        assert_eq!(toml_line(TOML, "grip.friction"), Some(3));
        assert_eq!(toml_line(TOML, "limits.slip_mm"), None);
    }

    #[test]
    fn a_span_gives_its_key() {
        let start = TOML.find("30.0").unwrap();
        assert_eq!(toml_key_at(TOML, &(start..start + 4)).as_deref(), Some("grip.force_n"));
        let start = TOML.find("0.4").unwrap();
        assert_eq!(toml_key_at(TOML, &(start..start + 3)).as_deref(), Some("object.size_m[1]"));
    }

    #[test]
    fn a_json_key_is_found_on_its_line() {
        let text = "{\n \"arms\": [\n  {\"q_rad\": [\n   0.1,\n   0.2]}]}";
        assert_eq!(json_line(text, "arms[0].q_rad[1]"), Some(5));
        assert_eq!(json_line(text, "arms[0].name"), Some(3));
        assert_eq!(json_line(text, "object"), Some(1));
    }
}
