//! Planner's maps that are kept between runs: in a folder, and those that come with the program.
//!
//! A map is found again by its key: a hash of everything that it is made from. What is read is compared with its own hash, so it is
//! what was written or nothing. So a plan on kept maps is the plan on fresh ones, bit for bit.

mod builtin;
mod folder;
mod key;
mod record;

use std::sync::Arc;

pub use builtin::{Builtin, BuiltinWriter};
pub use folder::{Cleared, Folder, Host, KeptMap, MOST_BYTES};
pub use key::hash_of;

use crate::planner::{MapSource, MapStore};

/// Several stores as one: the first that has a map gives it, all of them are given what is new.
pub struct Stores(pub Vec<Arc<dyn MapStore>>);

impl MapStore for Stores {
    fn read(&self, source: &MapSource<'_>) -> Option<Vec<u8>> {
        self.0.iter().find_map(|store| store.read(source))
    }

    fn write(&self, source: &MapSource<'_>, bytes: &[u8]) {
        self.0.iter().for_each(|store| store.write(source, bytes));
    }
}
