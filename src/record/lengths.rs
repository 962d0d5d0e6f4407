//! Compares the lengths and counts that a recording states with the bytes that it has, before a decoder allocates what they ask for.
//!
//! A file is a header, messages and a footer. A message is its kind and its length, 8 bytes each, and a payload. That of a message
//! with data is a protobuf record with an Arrow stream, compressed by LZ4. The last message is the index. The footer is the
//! position, the length and the checksum of the index, and the number of indexes.

use rerun::{
    external::{
        arrow::ipc::{self, Message as IpcMessage, MessageHeader as IpcHeader, RecordBatch},
        re_log_encoding::external::lz4_flex,
        re_log_encoding::{Compression, Decodable, MessageHeader, StreamFooter, StreamHeader, ToTransport},
    },
    log::LogMsg,
};

/// A message as it is encoded.
type Message = <LogMsg as ToTransport>::Output;

/// Kinds of messages: the index, which is the last one, and messages with data.
const INDEX: u64 = 0;
const DATA: u64 = 2;
const LAST_KIND: u64 = 3;

/// How many times as long as its compressed form LZ4 data are at most.
const MOST_COMPRESSION: usize = 255;

/// The most values in a byte: those of a column of booleans.
const VALUES_PER_BYTE: i64 = 8;

/// How a stream of Arrow messages marks the length of the next one.
const CONTINUATION: u32 = u32::MAX;

/// Requires that the file is whole: that it ends with a footer.
///
/// # Errors
/// If it does not, or states another number of indexes than the one that every recording has.
pub(super) fn check_footer(bytes: &[u8]) -> Result<(), String> {
    let whole = bytes.len() >= StreamHeader::ENCODED_SIZE_BYTES + StreamFooter::ENCODED_SIZE_BYTES;
    let footer = bytes.last_chunk::<12>().filter(|_| whole);
    let Some([b'R', b'R', b'F', b'2', b'F', b'O', b'O', b'T', count @ ..]) = footer else {
        return Err("the recording was cut short".to_owned());
    };
    match u32::from_le_bytes(*count) {
        1 => Ok(()),
        count => Err(format!("found a footer with {count} indexes, expected 1")),
    }
}

/// Compares all lengths and counts of a file whose footer is there.
///
/// # Errors
/// The first one that does not fit.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    let end = bytes.len() - StreamFooter::ENCODED_SIZE_BYTES;
    let mut start = StreamHeader::ENCODED_SIZE_BYTES;
    loop {
        let payload = start + MessageHeader::ENCODED_SIZE_BYTES;
        if payload > end {
            return Err(format!("found no message at byte {start}, expected the index of the recording"));
        }
        let [kind, length] = [start, start + 8].map(|place| number_at(bytes, place));
        let room = (end - payload) as u64;
        if kind > LAST_KIND {
            return Err(format!("found a message of kind {kind} at byte {start}, expected 0 to {LAST_KIND}"));
        }
        if length > room {
            return Err(format!(
                "found a message of {length} bytes at byte {start}, expected at most {room}, as many as follow"
            ));
        }
        let next = payload + length as usize;
        match kind {
            INDEX => return check_index(bytes, payload, next),
            DATA => check_data(&bytes[start..next])
                .map_err(|problem| format!("{problem} in the message at byte {start}"))?,
            _ => {}
        }
        start = next;
    }
}

/// The number in the eight bytes at `place`.
fn number_at(bytes: &[u8], place: usize) -> u64 {
    bytes[place..].first_chunk::<8>().map_or(0, |number| u64::from_le_bytes(*number))
}

/// Requires that the index is between these bytes and that the footer describes it.
fn check_index(bytes: &[u8], start: usize, end: usize) -> Result<(), String> {
    let footer = bytes.len() - StreamFooter::ENCODED_SIZE_BYTES;
    if end != footer {
        return Err(format!("found {} bytes between index and footer, expected none", footer - end));
    }
    let [found_start, found_length] = [footer, footer + 8].map(|place| number_at(bytes, place));
    if [found_start, found_length] != [start as u64, (end - start) as u64] {
        return Err(format!(
            "found a footer whose index is {found_length} bytes at byte {found_start}, expected {} bytes at byte {start}",
            end - start
        ));
    }
    let sum = bytes[footer + 16..].first_chunk::<4>().map(|sum| u32::from_le_bytes(*sum));
    match sum == Some(StreamFooter::compute_crc(&bytes[start..end])) {
        true => Ok(()),
        false => Err("found an index that differs from its checksum".to_owned()),
    }
}

/// Compares the lengths in a message with data, which begins with its kind and length.
fn check_data(message: &[u8]) -> Result<(), String> {
    let decoded = Option::<Message>::from_rrd_bytes(message).map_err(|error| format!("found damaged data: {error}"))?;
    let Some(Message::ArrowMsg(data)) = decoded else { return Ok(()) };
    if Compression::from(data.compression()) == Compression::Off {
        return check_stream(&data.payload);
    }
    let (found, most) = (data.uncompressed_size, data.payload.len().saturating_mul(MOST_COMPRESSION));
    let length = usize::try_from(found).ok().filter(|length| *length <= most);
    let length = length.ok_or_else(|| {
        format!("found {} bytes that should decompress to {found}, expected at most {most}", data.payload.len())
    })?;
    let stream =
        lz4_flex::block::decompress(&data.payload, length).map_err(|error| format!("found damaged data: {error}"))?;
    check_stream(&stream)
}

/// Compares the lengths in a stream of Arrow messages.
fn check_stream(mut stream: &[u8]) -> Result<(), String> {
    while let Some((length, rest)) = next_length(stream)? {
        let (header, rest) = rest.split_at(length);
        let message = ipc::root_as_message(header).map_err(|error| format!("found damaged data: {error}"))?;
        let found = message.bodyLength();
        let body = usize::try_from(found).ok().filter(|body| *body <= rest.len());
        let body = body.ok_or_else(|| format!("found data of {found} bytes, expected at most {}", rest.len()))?;
        if let Some(batch) = batch_of(&message) {
            check_batch(&batch, body as i64)?;
        }
        stream = &rest[body..];
    }
    Ok(())
}

/// The length of the next message's header and what follows this length; `None` at the end of a stream.
fn next_length(stream: &[u8]) -> Result<Option<(usize, &[u8])>, String> {
    let number = |stream: &[u8]| stream.first_chunk::<4>().map(|number| u32::from_le_bytes(*number));
    let rest = if number(stream) == Some(CONTINUATION) { &stream[4..] } else { stream };
    let Some(length) = number(rest).filter(|length| *length > 0) else { return Ok(None) };
    let rest = &rest[4..];
    match length as usize <= rest.len() {
        true => Ok(Some((length as usize, rest))),
        false => Err(format!("found a header of {length} bytes, expected at most {}", rest.len())),
    }
}

/// The rows or the dictionary of a message.
fn batch_of<'a>(message: &IpcMessage<'a>) -> Option<RecordBatch<'a>> {
    match message.header_type() {
        IpcHeader::RecordBatch => message.header_as_record_batch(),
        IpcHeader::DictionaryBatch => message.header_as_dictionary_batch().and_then(|dictionary| dictionary.data()),
        _ => None,
    }
}

/// Compares the lengths of columns with the bytes of a batch.
fn check_batch(batch: &RecordBatch<'_>, body: i64) -> Result<(), String> {
    if batch.compression().is_some() {
        return Err("found compressed columns, expected columns as they are".to_owned());
    }
    let most = body.saturating_mul(VALUES_PER_BYTE);
    let nodes = batch.nodes().into_iter().flatten().flat_map(|node| [node.length(), node.null_count()]);
    if let Some(found) = nodes.chain([batch.length()]).find(|count| !(0..=most).contains(count)) {
        return Err(format!("found a column of {found} values, expected 0 to {most}, as many as {body} bytes have"));
    }
    let is_inside = |offset: i64, length: i64| offset >= 0 && length >= 0 && offset.saturating_add(length) <= body;
    let wrong = batch.buffers().into_iter().flatten().find(|buffer| !is_inside(buffer.offset(), buffer.length()));
    match wrong {
        None => Ok(()),
        Some(buffer) => {
            let (offset, length) = (buffer.offset(), buffer.length());
            Err(format!("found a column of {length} bytes at byte {offset}, expected one in {body} bytes"))
        }
    }
}
