//! Damaged recordings are refused with an error that names the file, whatever is damaged.

use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use rerun::{
    external::re_log_encoding::{
        Compression, Decodable as _, Encodable as _, MessageHeader, StreamFooter, StreamHeader, ToTransport,
        external::lz4_flex,
    },
    log::LogMsg,
};

use super::*;
use crate::input::{guarded, is_decoding};

type Message = <LogMsg as ToTransport>::Output;

/// How many damaged recordings are read.
const RECORDINGS: u64 = 600;

/// The messages of a recording, each with its header; the last one is the index.
fn messages(bytes: &[u8]) -> Vec<Vec<u8>> {
    let (mut start, end) = (StreamHeader::ENCODED_SIZE_BYTES, bytes.len() - StreamFooter::ENCODED_SIZE_BYTES);
    let mut messages = Vec::new();
    while start < end {
        let header = MessageHeader::from_rrd_bytes(&bytes[start..start + 16]).unwrap();
        let next = start + 16 + header.len as usize;
        messages.push(bytes[start..next].to_vec());
        start = next;
    }
    messages
}

/// The recording of these messages, with the footer of its index.
fn recording(header: &[u8], messages: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = [header, &messages.concat()].concat();
    let index = &messages.last().unwrap()[16..];
    let start = (bytes.len() - index.len()) as u64;
    StreamFooter::from_rrd_footer_bytes(start, index).to_rrd_bytes(&mut bytes).unwrap();
    bytes
}

/// A message whose data are changed after decompression, so that only what decodes them can find it.
fn changed_inside(message: &[u8], rng: &mut Pcg64) -> Vec<u8> {
    let Some(Message::ArrowMsg(mut data)) = Option::<Message>::from_rrd_bytes(message).unwrap() else {
        return message.to_vec();
    };
    let mut inside = lz4_flex::block::decompress(&data.payload, data.uncompressed_size as usize).unwrap();
    let lz4 = data.compression;
    damage(&mut inside, rng);
    data.uncompressed_size = inside.len() as u64;
    data.payload = match rng.random_bool(0.5) {
        true => lz4_flex::block::compress(&inside).into(),
        false => inside.into(),
    };
    data.compression = lz4;
    if rng.random_bool(0.1) {
        data.uncompressed_size = rng.random();
    }
    let mut bytes = Vec::new();
    Message::ArrowMsg(data).to_rrd_bytes(&mut bytes).unwrap();
    bytes
}

/// Damages bytes in one of several ways.
fn damage(bytes: &mut Vec<u8>, rng: &mut Pcg64) {
    let place = rng.random_range(0..bytes.len());
    let length = rng.random_range(1..=bytes.len().min(64));
    let range = place..(place + length).min(bytes.len());
    match rng.random_range(0..6) {
        0 => bytes.truncate(place),
        1 => bytes[place] ^= 1 << rng.random_range(0..8),
        2 => bytes[range].fill_with(|| rng.random()),
        3 => drop(bytes.drain(range)),
        4 => {
            let copy = bytes[range].to_vec();
            bytes.splice(place..place, copy);
        }
        _ => {
            // A length of 4 or 8 bytes, at a place where lengths are.
            let number =
                [u64::MAX, 1 << 62, 1 << 40, u64::from(u32::MAX), 1 << 31, rng.random()][rng.random_range(0..6)];
            let place = place / 4 * 4;
            let width = if rng.random_bool(0.5) { 4 } else { 8 };
            for (byte, of_number) in bytes[place..].iter_mut().zip(&number.to_le_bytes()[..width]) {
                *byte = *of_number;
            }
        }
    }
}

/// A recording with one damage.
fn damaged(whole: &[u8], rng: &mut Pcg64) -> Vec<u8> {
    let (header, mut parts) = (&whole[..StreamHeader::ENCODED_SIZE_BYTES], messages(whole));
    let place = rng.random_range(0..parts.len());
    match rng.random_range(0..4) {
        0 => {
            let mut bytes = whole.to_vec();
            damage(&mut bytes, rng);
            return bytes;
        }
        // The last bytes are the footer, whose counts and positions are few.
        1 => {
            let mut bytes = whole.to_vec();
            let mut footer = bytes.split_off(whole.len() - StreamFooter::ENCODED_SIZE_BYTES);
            damage(&mut footer, rng);
            return [bytes, footer].concat();
        }
        2 => {
            let mut header = parts[place][..16].to_vec();
            damage(&mut header, rng);
            parts[place].splice(..16, header);
        }
        _ => parts[place] = changed_inside(&parts[place], rng),
    }
    recording(header, &parts)
}

/// Reads all of a file.
fn read_all(path: &Path) -> Result<(), RecordError> {
    let recording = Recording::read(path)?;
    recording.summary()?;
    recording.run().map(drop)
}

#[test]
fn a_damaged_recording_is_an_error_that_names_the_file() {
    let whole = encode(&example().input()).unwrap();
    let parts = messages(&whole);
    assert!(parts.len() > 20 && recording(&whole[..12], &parts) == whole, "the parts are not those of the file");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.rrd");
    let mut refused = 0;
    for seed in 0..RECORDINGS {
        let mut rng = Pcg64::seed_from_u64(seed);
        fs::write(&path, damaged(&whole, &mut rng)).unwrap();
        if let Err(error) = read_all(&path) {
            let message = error.to_string();
            assert!(message.contains("damaged.rrd") && !message.contains('\n'), "seed {seed}: {message}");
            assert!(error.is_about_a_file(), "seed {seed}: {message}");
            refused += 1;
        }
    }
    assert!(refused > RECORDINGS / 2, "{refused} of {RECORDINGS} were refused");
}

#[test]
fn a_panic_of_a_decoder_is_an_error() {
    assert!(!is_decoding());
    let outcome = guarded(|| {
        assert!(is_decoding());
        let columns: [u8; 0] = [];
        Ok(columns[std::hint::black_box(3)])
    });
    assert!(outcome.unwrap_err().starts_with("found damaged data: index out of bounds"));
    assert!(!is_decoding());
}

/// Each of these asks a decoder for more memory than there is.
#[test]
fn lengths_that_the_file_does_not_have_are_told() {
    let whole = encode(&example().input()).unwrap();
    let (header, parts) = (&whole[..12], messages(&whole));
    let problem = |bytes: Vec<u8>| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rrd");
        fs::write(&path, bytes).unwrap();
        read_all(&path).unwrap_err().to_string()
    };
    let footer = [&[0; 20][..], b"RRF2FOOT", &u32::MAX.to_le_bytes()].concat();
    let text = problem([header, &footer].concat());
    assert!(text.ends_with("found a footer with 4294967295 indexes, expected 1"), "{text}");
    let one = [&[0; 20][..], b"RRF2FOOT", &1_u32.to_le_bytes()].concat();
    let message = [2_u64.to_le_bytes(), (1_u64 << 62).to_le_bytes()].concat();
    let text = problem([header, &message, &one].concat());
    assert!(
        text.ends_with(
            "found a message of 4611686018427387904 bytes at byte 12, expected at most 0, as many as follow"
        ),
        "{text}"
    );
    let place = parts.iter().position(|part| part[0] == 2).unwrap();
    let Some(Message::ArrowMsg(mut data)) = Option::<Message>::from_rrd_bytes(&parts[place]).unwrap() else { panic!() };
    assert!(Compression::from(data.compression()) == Compression::LZ4);
    data.uncompressed_size = 4 << 30;
    let mut bytes = Vec::new();
    Message::ArrowMsg(data).to_rrd_bytes(&mut bytes).unwrap();
    let text = problem(recording(header, &[bytes, parts.last().unwrap().clone()]));
    assert!(text.contains("bytes that should decompress to 4294967296, expected at most "), "{text}");
}
