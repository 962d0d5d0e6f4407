//! The library writes schemas and channels of a summary in the order of a hash map, which differs from run to run. Here they are
//! sorted, so that equal traces give equal files.

use ::mcap::records::op;

/// Bytes of the magic at the end, and of the body of the footer before it: starts of summary and of its offsets, checksum.
const MAGIC: usize = 8;
const FOOTER: usize = 20;

/// Bytes before the body of a record: its kind and the length of the body.
const HEAD: usize = 9;

/// Sorts the schemas and the channels in the summary of a file without a checksum of the summary. All records keep their lengths, so
/// all offsets stay valid. `None` if the file has no such form; it is then left as it is.
pub fn sort(bytes: &mut [u8]) -> Option<()> {
    let footer = bytes.len().checked_sub(MAGIC + FOOTER)?;
    let start = offset(bytes, footer)?;
    let end = match offset(bytes, footer + 8)? {
        0 => footer.checked_sub(HEAD)?,
        offsets => offsets,
    };
    let mut records: Vec<&[u8]> = Vec::new();
    let mut rest = bytes.get(start..end)?;
    while !rest.is_empty() {
        let length = HEAD.checked_add(offset(rest, 1)?)?;
        let (record, later) = rest.split_at_checked(length)?;
        records.push(record);
        rest = later;
    }
    let is_listed = |record: &[u8]| matches!(record.first(), Some(&(op::SCHEMA | op::CHANNEL)));
    for group in records.chunk_by_mut(|a, b| a.first() == b.first()) {
        if group.first().is_some_and(|record| is_listed(record)) {
            group.sort_unstable();
        }
    }
    let sorted = records.concat();
    bytes.get_mut(start..end)?.copy_from_slice(&sorted);
    Some(())
}

/// The offset or length that stands at a place.
fn offset(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes: [u8; 8] = bytes.get(at..at.checked_add(8)?)?.try_into().ok()?;
    usize::try_from(u64::from_le_bytes(bytes)).ok()
}
