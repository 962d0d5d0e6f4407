//! The bytes of a kept map.
//!
//! `benchmap`, then the SHA-256 of the rest, then the rest: a [`Record`] in postcard, whose map is compressed with zstd. So a record
//! that is truncated or changed anywhere is refused.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::key::Key;
use crate::planner::MapLabel;

/// The first bytes of every record.
const MAGIC: &[u8; 8] = b"benchmap";

/// The format of a record. A program reads its own only.
const FORMAT: u32 = 1;

/// Length of a SHA-256, bytes.
const HASH: usize = 32;

/// The longest map that is read, bytes: ten times the largest.
const LONGEST: u64 = 64 << 20;

/// The level of zstd: most bits of a map are the last ones of numbers, so a higher one gains nothing.
const LEVEL: i32 = 3;

/// A kept map.
#[derive(Serialize, Deserialize)]
pub struct Record {
    format: u32,
    /// Its key.
    pub key: Key,
    /// The program that wrote it, see [`super::key::PROGRAM`].
    pub program: String,
    /// The map in words.
    pub label: MapLabel,
    length: u64,
    packed: Vec<u8>,
}

impl Record {
    /// The record of a map of this program; `None` if it cannot be compressed.
    pub fn new(key: Key, program: &str, label: MapLabel, map: &[u8]) -> Option<Self> {
        Some(Self {
            format: FORMAT,
            key,
            program: program.to_owned(),
            label,
            length: map.len() as u64,
            packed: zstd::bulk::compress(map, LEVEL).ok()?,
        })
    }

    /// Its bytes; `None` if it cannot be written as bytes.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        let body = postcard::to_stdvec(self).ok()?;
        Some([&MAGIC[..], &Sha256::digest(&body)[..], &body].concat())
    }

    /// The record of bytes; `None` if they are not those of a record, or not as it was written.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (hash, body) = bytes.strip_prefix(MAGIC)?.split_at_checked(HASH)?;
        if Sha256::digest(body)[..] != *hash {
            return None;
        }
        postcard::from_bytes(body).ok().filter(|record: &Self| record.format == FORMAT)
    }

    /// The map; `None` if this is not the record of this key.
    pub fn map(&self, key: &Key) -> Option<Vec<u8>> {
        if self.key != *key || self.length > LONGEST {
            return None;
        }
        let map = zstd::bulk::decompress(&self.packed, self.length as usize).ok()?;
        (map.len() as u64 == self.length).then_some(map)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Record {
        let label = MapLabel { map: "grasps".into(), ..MapLabel::default() };
        Record::new([7; 32], "a program", label, b"a map of a robot, of a robot, of a robot").unwrap()
    }

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let read = Record::from_bytes(&record().to_bytes().unwrap()).unwrap();
        assert_eq!(read.map(&[7; 32]).unwrap(), b"a map of a robot, of a robot, of a robot");
        assert_eq!(read.map(&[8; 32]), None);
        assert_eq!(read.label, record().label);
    }

    /// Every byte counts: each bit flipped, and every length but the whole, is no record.
    #[test]
    fn a_changed_or_truncated_record_is_refused() {
        let bytes = record().to_bytes().unwrap();
        for length in 0..bytes.len() {
            assert!(Record::from_bytes(&bytes[..length]).is_none(), "{length} bytes");
        }
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(Record::from_bytes(&changed).is_none(), "bit {bit}");
        }
        assert!(Record::from_bytes(&[&bytes[..], &[0]].concat()).is_none());
    }

    #[test]
    fn another_format_is_refused_though_its_hash_is_right() {
        let other = Record { format: FORMAT + 1, ..record() };
        assert!(Record::from_bytes(&other.to_bytes().unwrap()).is_none());
        // A length that is wrong is found out when the map is unpacked.
        for length in [0, 1, u64::MAX] {
            assert_eq!(Record { length, ..record() }.map(&[7; 32]), None, "{length}");
        }
    }
}
