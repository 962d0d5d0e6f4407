//! Reads the chunks of a recording file, and documents and texts from chunks.

use std::io::Cursor;

use rerun::{
    ComponentDescriptor,
    external::re_log_encoding::{DecoderApp, StreamHeader},
    log::{Chunk, LogMsg},
};
use serde::de::DeserializeOwned;

use super::{
    entity::{APPLICATION, TIMELINE, entity},
    lengths,
};

/// The first bytes of every rerun recording that this version reads.
const MAGIC: &[u8] = b"RRF2";

/// The minor version of rerun whose files are read. Other versions have other columns.
const RERUN_MINOR: u8 = 36;

/// The same, for messages.
const RERUN: &str = "0.36";

/// The chunks of the recording itself, without those of its blueprint.
pub(super) fn chunks(bytes: &[u8]) -> Result<Vec<Chunk>, String> {
    check_header(bytes)?;
    lengths::check_footer(bytes)?;
    lengths::check(bytes)?;
    let (mut chunks, mut is_benchdog) = (Vec::new(), false);
    for message in DecoderApp::decode_lazy(Cursor::new(bytes)) {
        match message.map_err(|error| format!("found a damaged recording: {error}"))? {
            LogMsg::SetStoreInfo(info) => is_benchdog |= info.info.application_id().as_str() == APPLICATION,
            LogMsg::ArrowMsg(store, arrow) if store.is_recording() => {
                chunks.push(Chunk::from_arrow_msg(&arrow).map_err(|error| format!("found damaged data: {error}"))?);
            }
            LogMsg::ArrowMsg(..) | LogMsg::BlueprintActivationCommand(_) => {}
        }
    }
    if is_benchdog { Ok(chunks) } else { Err("found no recording of benchdog, expected one".to_owned()) }
}

/// The bytes at the beginning of a file that say what it is.
pub(super) const HEADER: usize = StreamHeader::ENCODED_SIZE_BYTES;

/// Checks by the header that this is a rerun recording of a supported version.
pub(super) fn check_header(bytes: &[u8]) -> Result<(), String> {
    let no_recording = "found no rerun recording, expected a file that starts with \"RRF2\"";
    let header = bytes.get(..HEADER).ok_or(no_recording)?;
    let (magic, [major, minor, patch, _]) = (&header[..4], [header[4], header[5], header[6], header[7]]);
    let found = || format!("found a recording of rerun {major}.{minor}.{patch}, expected one of {RERUN}");
    match magic {
        MAGIC if (major, minor) == (0, RERUN_MINOR) => Ok(()),
        MAGIC => Err(found()),
        // RRF0, RRF1: files of rerun before 0.23.
        [b'R', b'R', b'F', _] => Err(found()),
        _ => Err(no_recording.to_owned()),
    }
}

pub(super) fn of_entity<'a>(chunks: &'a [Chunk], path: &str) -> impl Iterator<Item = &'a Chunk> {
    let path = entity(&[path]);
    chunks.iter().filter(move |chunk| *chunk.entity_path() == path)
}

/// The text of a document.
pub(super) fn document(chunks: &[Chunk], path: &str) -> Option<String> {
    let component = rerun::TextDocument::descriptor_text().component;
    let batch = |chunk: &Chunk| chunk.component_batch::<rerun::Text>(component, 0)?.ok()?.pop();
    of_entity(chunks, path).find_map(batch).map(|text| text.to_string())
}

/// Times, s, and texts of a component.
pub(super) fn texts(
    chunks: &[Chunk],
    path: &str,
    descriptor: &ComponentDescriptor,
) -> impl Iterator<Item = (f64, String)> {
    let component = descriptor.component;
    of_entity(chunks, path).flat_map(move |chunk| {
        let row = move |(index, time_s): (usize, f64)| {
            let text = chunk.component_batch::<rerun::Text>(component, index)?.ok()?.pop()?;
            Some((time_s, text.to_string()))
        };
        times_s(chunk).into_iter().enumerate().filter_map(row)
    })
}

/// A JSON document, deserialised.
pub(super) fn json<T: DeserializeOwned>(chunks: &[Chunk], path: &str) -> Result<T, String> {
    let text = document(chunks, path).ok_or_else(|| format!("found no {path}, expected one"))?;
    serde_json::from_str(&text).map_err(|error| format!("found a malformed {path}: {error}"))
}

/// The times of a chunk's rows, s.
pub(super) fn times_s(chunk: &Chunk) -> Vec<f64> {
    let column = chunk.timelines().get(&TIMELINE.into());
    column.map_or(Vec::new(), |column| column.times_raw().iter().map(|&nanos| nanos as f64 / 1e9).collect())
}
