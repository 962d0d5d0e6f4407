//! Damaged recordings.

use std::path::Path;

use benchdog::record::{RecordError, Recording};
use rand::RngExt as _;
use rand_pcg::Pcg64;
use rerun::{
    external::re_log_encoding::{
        Decodable as _, Encodable as _, MessageHeader, StreamFooter, StreamHeader, ToTransport, external::lz4_flex,
    },
    log::LogMsg,
};

use crate::{
    commands::recording,
    driver::{Target, check},
    mutate::mutate_bytes,
    targets::read_or_refused,
};

/// Length of the header of a message.
const HEADER: usize = MessageHeader::ENCODED_SIZE_BYTES;

/// The messages of a recording; `None` if it is damaged already.
fn messages(bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
    let end = bytes.len().checked_sub(StreamFooter::ENCODED_SIZE_BYTES)?;
    let (mut start, mut messages) = (StreamHeader::ENCODED_SIZE_BYTES, Vec::new());
    while start < end {
        let header = MessageHeader::from_rrd_bytes(bytes.get(start..start + HEADER)?).ok()?;
        let next = (start + HEADER).checked_add(usize::try_from(header.len).ok()?)?;
        messages.push(bytes.get(start..next)?.to_vec());
        start = next;
    }
    Some(messages)
}

/// A message whose data are damaged before they are compressed, so that only what decodes them can find it.
fn damaged_inside(message: &[u8], rng: &mut Pcg64) -> Option<Vec<u8>> {
    type Message = <LogMsg as ToTransport>::Output;
    let Ok(Some(Message::ArrowMsg(mut data))) = Option::<Message>::from_rrd_bytes(message) else { return None };
    let length = usize::try_from(data.uncompressed_size).ok().filter(|length| *length < 1 << 28)?;
    let mut inside = lz4_flex::block::decompress(&data.payload, length).ok()?;
    mutate_bytes(&mut inside, rng);
    data.uncompressed_size = inside.len() as u64;
    data.payload = lz4_flex::block::compress(&inside).into();
    let mut bytes = Vec::new();
    Message::ArrowMsg(data).to_rrd_bytes(&mut bytes).ok()?;
    Some(bytes)
}

/// Damages one message of a recording, leaves it out, repeats it, or moves it, and writes the footer again.
fn damage_message(bytes: &mut Vec<u8>, rng: &mut Pcg64) -> bool {
    let Some(mut parts) = messages(bytes).filter(|parts| parts.len() > 1 && rng.random_bool(0.8)) else { return false };
    let (place, other) = (rng.random_range(0..parts.len() - 1), rng.random_range(0..parts.len() - 1));
    match rng.random_range(0..8) {
        0 => drop(parts.remove(place)),
        1 => parts.insert(other, parts[place].clone()),
        2 => parts.swap(place, other),
        3 => {
            let mut header = parts[place][..HEADER].to_vec();
            mutate_bytes(&mut header, rng);
            parts[place].splice(..HEADER, header);
        }
        _ => match damaged_inside(&parts[place], rng) {
            Some(part) => parts[place] = part,
            None => return false,
        },
    }
    let all = [&bytes[..StreamHeader::ENCODED_SIZE_BYTES], &parts.concat()].concat();
    let index = parts.last().map_or(0, |part| part.len() - HEADER);
    let start = all.len() - index;
    let footer = StreamFooter::from_rrd_footer_bytes(start as u64, &all[start..]);
    *bytes = all;
    footer.to_rrd_bytes(bytes).is_ok()
}

fn read(path: &Path) -> Result<(), RecordError> {
    let recording = Recording::read(path)?;
    recording.summary()?;
    recording.run().map(drop)
}

#[test]
fn any_recording_is_read_or_refused() {
    fn run(folder: &Path, name: &str) -> Result<(), String> {
        read_or_refused(read(&folder.join(name)), folder)
    }
    let valid = vec![vec![("a.rrd".to_owned(), recording().to_vec())]];
    check(&Target { name: "recording", valid, cases: 150, mutate: damage_message, run });
}
