//! Decodes what may be damaged: a panic of a decoder of another crate becomes an error.

use std::{
    cell::Cell,
    panic::{AssertUnwindSafe, catch_unwind},
};

thread_local! {
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// True while this thread decodes a file. A panic is then an error of the file, so that a hook need not print it.
#[must_use]
pub fn is_decoding() -> bool {
    DECODING.get()
}

/// The outcome of `decode`, or an error if it panics. Decoders should not, but those of other crates trust indexes in a file.
///
/// # Errors
/// That of `decode`, or "found damaged data" with the text of the panic.
pub fn guarded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let before = DECODING.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(before);
    outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(format!("found damaged data: {text}"))
    })
}
