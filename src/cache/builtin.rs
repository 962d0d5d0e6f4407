//! Maps that come with the program, so that even the first command finds some.
//!
//! Their keys leave out the program: else every change of a source would ask for new ones. A test makes them again and compares them.

use std::sync::{LazyLock, Mutex, PoisonError};

use super::{
    key::{TARGET, key},
    record::Record,
};
use crate::planner::{MapKind, MapSource, MapStore};

/// The records of [`BuiltinWriter`].
const FILE: &[u8] = include_bytes!("../../assets/maps/builtin.maps");

/// The maps in the program. They are those of one target, because the mathematical functions of another one may round otherwise.
pub struct Builtin;

impl MapStore for Builtin {
    fn read(&self, source: &MapSource<'_>) -> Option<Vec<u8>> {
        static RECORDS: LazyLock<Vec<Record>> = LazyLock::new(|| records(FILE).unwrap_or_default());
        let key = key(TARGET, source);
        RECORDS.iter().find_map(|record| record.map(&key))
    }

    fn write(&self, _: &MapSource<'_>, _: &[u8]) {}
}

/// A store that has nothing and collects what is written to it, for the file that comes with the program: the warm starts alone, which
/// are all that a plan with the default budget needs.
#[derive(Default)]
pub struct BuiltinWriter(Mutex<Vec<Vec<u8>>>);

impl BuiltinWriter {
    /// The file of the maps in the program.
    #[must_use]
    pub fn file(&self) -> Vec<u8> {
        let records = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // Serialisation fails only for types whose length is not known.
        postcard::to_stdvec(&*records).unwrap_or_default()
    }

    /// The file that is in this program.
    #[must_use]
    pub fn present() -> &'static [u8] {
        FILE
    }
}

impl MapStore for BuiltinWriter {
    fn read(&self, _: &MapSource<'_>) -> Option<Vec<u8>> {
        None
    }

    fn write(&self, source: &MapSource<'_>, bytes: &[u8]) {
        if source.kind == MapKind::WarmStarts {
            let record = Record::new(key(TARGET, source), TARGET, source.label(), bytes);
            let bytes = record.and_then(|record| record.to_bytes());
            self.0.lock().unwrap_or_else(PoisonError::into_inner).extend(bytes);
        }
    }
}

/// The records of a file; `None` if it is not one of these.
fn records(file: &[u8]) -> Option<Vec<Record>> {
    let records: Vec<Vec<u8>> = postcard::from_bytes(file).ok()?;
    records.iter().map(|bytes| Record::from_bytes(bytes)).collect()
}
