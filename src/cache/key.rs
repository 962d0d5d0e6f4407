//! The key of a map: a hash of everything that it is made from.

use std::fmt;

use sha2::{Digest, Sha256};

use crate::planner::MapSource;

/// A hash of the sources of this program that maps depend on, of the target and of the version; see build.rs.
pub const PROGRAM: &str = env!("BENCHDOG_MAPS");

/// The target that this program is compiled for, such as `x86_64-unknown-linux-gnu`.
pub const TARGET: &str = env!("BENCHDOG_TARGET");

/// The key of a map.
pub type Key = [u8; 32];

/// The key of a map of a program.
pub fn key(program: &str, source: &MapSource<'_>) -> Key {
    hash_of(|text| {
        writeln!(text, "{program}")?;
        source.write_inputs(text)
    })
}

/// The SHA-256 of a text, which is not kept.
pub fn hash_of(write: impl FnOnce(&mut dyn fmt::Write) -> fmt::Result) -> [u8; 32] {
    let mut text = Hashed(Sha256::new());
    // A hash takes any text.
    let _ = write(&mut text);
    text.0.finalize().into()
}

/// Text that is hashed as it is written.
struct Hashed(Sha256);

impl fmt::Write for Hashed {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}
