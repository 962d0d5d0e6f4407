//! A measured wrench over time from a file of MCAP: `geometry_msgs/WrenchStamped` or `geometry_msgs/Wrench`, of ROS 2 (CDR) or of
//! ROS 1.

use std::{borrow::Cow, collections::BTreeMap, io::Read};

use ::mcap::{
    McapError,
    read::LinearReader,
    records::{Channel, ChunkHeader, Record},
};

use super::cdr::Reader;
use crate::input;

/// The first bytes of every MCAP file.
pub const MAGIC: &[u8] = b"\x89MCAP";

/// The most messages of a topic. A plan carries them all.
const MOST_MESSAGES: usize = 1_000_000;

/// The most bytes of a chunk, and of all chunks of a file together, once they are unpacked.
const MOST_CHUNK: usize = 256 << 20;
const MOST_TOTAL: usize = 1 << 30;

/// The encodings of messages.
const CDR: &str = "cdr";
const ROS1: &str = "ros1";

/// Why no wrenches were read.
#[derive(Debug, thiserror::Error)]
pub enum WrenchError {
    /// The file is damaged or cut short.
    #[error("found a damaged MCAP file: {0}")]
    Damaged(String),
    /// No topic, or not the one that was asked for, has wrenches.
    #[error("found {found}, expected {expected}")]
    Topic {
        /// The topics that the file has.
        found: String,
        /// What was looked for.
        expected: String,
    },
    /// A message cannot be decoded.
    #[error("topic \"{topic}\": found {found} in message {number}, expected {expected}")]
    Message {
        /// The topic.
        topic: String,
        /// Number of the message on the topic, from 1.
        number: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
}

/// A topic with what is read of it.
struct Topic {
    /// Type and encoding of its messages.
    kind: String,
    encoding: String,
    rows: Vec<[f64; 7]>,
    /// The first message that cannot be read.
    fault: Option<(usize, String, &'static str)>,
}

/// The rows of a topic: s since its first message, then force, N, and moment, N m, in the axes of the messages. Without a topic
/// there must be one with wrenches. The time is the stamp of the message, or that of its recording if the stamp is 0.
///
/// # Errors
/// If the file is damaged, has no such topic, several topics with wrenches and none is chosen, or if a message is cut short, has a
/// number that is not finite or is not later than the one before.
pub fn series(bytes: &[u8], topic: Option<&str>) -> Result<Vec<[f64; 7]>, WrenchError> {
    let mut topics = Topics::default();
    read(bytes, &mut topics)?;
    let mut topics = topics.by_name;
    let (name, Topic { mut rows, fault, .. }) = choose(&mut topics, topic)?;
    if let Some((number, found, expected)) = fault {
        return Err(WrenchError::Message { topic: name, number, found, expected });
    }
    let start_s = rows.first().map_or(0.0, |row| row[0]);
    rows.iter_mut().for_each(|row| row[0] -= start_s);
    Ok(rows)
}

/// Feeds the records of a file to `topics`. Chunks are unpacked here and not by the library, whose reader does not end if a damaged
/// chunk has less data than it says.
fn read(bytes: &[u8], topics: &mut Topics) -> Result<(), WrenchError> {
    let damaged = |error: McapError| WrenchError::Damaged(error.to_string());
    let mut total = 0_usize;
    // Its records are no longer than the file.
    for record in LinearReader::new(bytes).map_err(damaged)? {
        match record.map_err(damaged)? {
            Record::Chunk { header, data } => {
                let records = unpacked(&header, &data)?;
                total = total.saturating_add(records.len());
                if total > MOST_TOTAL {
                    return Err(WrenchError::Damaged("more than 1 GiB of records".to_owned()));
                }
                for record in LinearReader::sans_magic(&records) {
                    topics.add(record.map_err(damaged)?);
                }
            }
            record => topics.add(record),
        }
    }
    Ok(())
}

/// The records of a chunk.
fn unpacked<'a>(header: &ChunkHeader, data: &'a [u8]) -> Result<Cow<'a, [u8]>, WrenchError> {
    let damaged = |why: String| WrenchError::Damaged(format!("a chunk: {why}"));
    let failed = |error: std::io::Error| damaged(error.to_string());
    let size = usize::try_from(header.uncompressed_size).ok().filter(|size| *size <= MOST_CHUNK);
    let size = size.ok_or_else(|| damaged(format!("found {} bytes", header.uncompressed_size)))?;
    // One byte more tells a chunk that is too long.
    let all = |reader: &mut dyn Read| {
        let mut records = Vec::new();
        reader.take(size as u64 + 1).read_to_end(&mut records).map_err(failed)?;
        Ok(Cow::Owned(records))
    };
    let records = match header.compression.as_str() {
        "" => Cow::Borrowed(data),
        "zstd" => all(&mut zstd::Decoder::new(data).map_err(failed)?)?,
        "lz4" => all(&mut lz4::Decoder::new(data).map_err(failed)?)?,
        other => return Err(damaged(format!("found the compression \"{}\"", input::shown(other)))),
    };
    if records.len() != size {
        return Err(damaged(format!("found {} bytes, expected {size}", records.len())));
    }
    if header.uncompressed_crc != 0 && crc32fast::hash(&records) != header.uncompressed_crc {
        return Err(damaged("found another checksum than the one that it states".to_owned()));
    }
    Ok(records)
}

/// The topics of a file.
#[derive(Default)]
struct Topics {
    /// Names of the types of messages, by the number of their schema.
    kinds: BTreeMap<u16, String>,
    /// Names of the topics, by the number of their channel.
    names: BTreeMap<u16, String>,
    by_name: BTreeMap<String, Topic>,
}

impl Topics {
    fn add(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header, .. } => {
                self.kinds.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let kind = self.kinds.get(&channel.schema_id).map_or("no type", String::as_str);
                self.by_name.entry(channel.topic.clone()).or_insert_with(|| Topic::new(kind, &channel));
                self.names.insert(channel.id, channel.topic);
            }
            // A message of an unknown channel cannot be of the topic.
            Record::Message { header, data } => {
                let topic = self.names.get(&header.channel_id).and_then(|name| self.by_name.get_mut(name));
                if let Some(topic) = topic {
                    topic.add(&data, header.log_time);
                }
            }
            _ => {}
        }
    }
}

/// Takes the topic that was asked for, or the only one with wrenches.
fn choose(topics: &mut BTreeMap<String, Topic>, topic: Option<&str>) -> Result<(String, Topic), WrenchError> {
    let with_wrenches: Vec<String> =
        topics.iter().filter(|(_, topic)| topic.has_wrenches()).map(|(name, _)| name.clone()).collect();
    let (name, expected) = match (topic, &with_wrenches[..]) {
        (Some(name), _) => {
            (Some(name.to_owned()), format!("the topic \"{name}\" with messages geometry_msgs/WrenchStamped"))
        }
        (None, [only]) => (Some(only.clone()), String::new()),
        (None, []) => (None, "a topic with messages geometry_msgs/WrenchStamped".to_owned()),
        (None, _) => (None, "one topic with wrenches, or load.topic, which says which".to_owned()),
    };
    let found = || {
        let named = |(name, topic): (&String, &Topic)| format!("\"{name}\" ({}, {})", topic.kind, topic.encoding);
        let names: Vec<_> = topics.iter().map(named).collect();
        if names.is_empty() { "no topic".to_owned() } else { format!("the topics {}", names.join(", ")) }
    };
    let found = found();
    let chosen = name.filter(|name| topics.get(name).is_some_and(Topic::has_wrenches));
    let taken = chosen.and_then(|name| topics.remove_entry(&name));
    taken.ok_or(WrenchError::Topic { found, expected })
}

impl Topic {
    fn new(kind: &str, channel: &Channel) -> Self {
        Self { kind: kind.to_owned(), encoding: channel.message_encoding.clone(), rows: Vec::new(), fault: None }
    }

    /// True if messages have a header before the wrench; `None` if they have no wrench.
    fn has_header(&self) -> Option<bool> {
        match self.kind.as_str() {
            "geometry_msgs/msg/WrenchStamped" | "geometry_msgs/WrenchStamped" => Some(true),
            "geometry_msgs/msg/Wrench" | "geometry_msgs/Wrench" => Some(false),
            _ => None,
        }
    }

    fn has_wrenches(&self) -> bool {
        self.has_header().is_some() && [CDR, ROS1].contains(&self.encoding.as_str())
    }

    /// Reads a message unless one before it cannot be read.
    fn add(&mut self, data: &[u8], log_time_ns: u64) {
        let Some(has_header) = self.has_header().filter(|_| self.has_wrenches() && self.fault.is_none()) else {
            return;
        };
        let number = self.rows.len() + 1;
        let mut fail = |found: String, expected| self.fault = Some((number, found, expected));
        let decoded = if self.encoding == CDR { of_cdr(data, has_header) } else { of_ros1(data, has_header) };
        let Some((stamp_s, wrench)) = decoded else {
            return fail(format!("{} bytes that are no wrench", data.len()), "a whole geometry_msgs/Wrench");
        };
        let time_s = if stamp_s > 0.0 { stamp_s } else { log_time_ns as f64 * 1e-9 };
        if !wrench.iter().all(|value| value.is_finite()) {
            return fail("a number that is not finite".to_owned(), "finite numbers");
        }
        if self.rows.last().is_some_and(|row| row[0] >= time_s) {
            return fail(format!("the time {time_s} s"), "a time after that of the message before");
        }
        if number > MOST_MESSAGES {
            return fail("a million messages before it".to_owned(), "at most a million messages");
        }
        let [fx, fy, fz, mx, my, mz] = wrench;
        self.rows.push([time_s, fx, fy, fz, mx, my, mz]);
    }
}

/// Stamp, s, and wrench of a message of ROS 2; `None` if it is cut short.
fn of_cdr(data: &[u8], has_header: bool) -> Option<(f64, [f64; 6])> {
    let mut reader = Reader::new(data)?;
    let mut stamp_s = 0.0;
    if has_header {
        stamp_s = f64::from(reader.i32()?) + 1e-9 * f64::from(reader.u32()?);
        reader.text()?;
    }
    let mut wrench = [0.0; 6];
    for value in &mut wrench {
        *value = reader.f64()?;
    }
    Some((stamp_s, wrench))
}

/// Stamp, s, and wrench of a message of ROS 1, whose values are in little endian one after the other; `None` if it is cut short.
fn of_ros1(data: &[u8], has_header: bool) -> Option<(f64, [f64; 6])> {
    let mut at = 0;
    let mut stamp_s = 0.0;
    if has_header {
        // The number of the message, seconds and nanoseconds, the length of the frame's name.
        let word = |from: usize| Some(u32::from_le_bytes(data.get(from..from + 4)?.try_into().ok()?));
        stamp_s = f64::from(word(4)?) + 1e-9 * f64::from(word(8)?);
        at = usize::try_from(word(12)?).ok()?.checked_add(16)?;
    }
    let mut wrench = [0.0; 6];
    for value in &mut wrench {
        let end = at.checked_add(8)?;
        *value = f64::from_le_bytes(data.get(at..end)?.try_into().ok()?);
        at = end;
    }
    Some((stamp_s, wrench))
}
