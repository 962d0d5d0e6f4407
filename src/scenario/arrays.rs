//! Arrays of the wrong length.
//!
//! The readers of TOML and JSON say little about an array that is too long, or nothing: TOML drops the rest. From values instead
//! of text, serde counts what is left over.

use serde::de::DeserializeOwned;

/// The key of the first array of a file that is longer than its key has values, with what was found and expected. Values of another
/// kind are left to the reader of the text.
pub fn too_long<T: DeserializeOwned>(file: &serde_json::Value) -> Option<TooLong> {
    let (key, message) = first_error::<T>(file)?;
    if !message.contains("expected fewer elements in array") {
        return None;
    }
    let pointer = format!("/{}", key.replace(['.', '['], "/").replace(']', ""));
    let mut file = file.clone();
    let array = file.pointer_mut(&pointer)?;
    let found = format!("an array of length {}", array.as_array()?.len());
    // Of an empty array serde says what it expects.
    *array = serde_json::Value::Array(Vec::new());
    let expected = match first_error::<T>(&file) {
        Some((other, message)) if other == key => {
            message.split_once("expected ").map(|(_, expected)| expected.to_owned())
        }
        _ => None,
    };
    Some(TooLong { key, found, expected: expected.unwrap_or_else(|| "a shorter one".to_owned()) })
}

/// An array that is too long.
pub struct TooLong {
    pub key: String,
    pub found: String,
    pub expected: String,
}

/// The key and the message of the first error in a file's values.
fn first_error<T: DeserializeOwned>(file: &serde_json::Value) -> Option<(String, String)> {
    let error = serde_path_to_error::deserialize::<_, T>(file).err()?;
    Some((error.path().to_string(), error.inner().to_string()))
}
