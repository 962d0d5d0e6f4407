//! Files that are written are read back, and damaged ones are refused.

use std::{collections::BTreeMap, io::Cursor};

use ::mcap::{Compression, MessageStream, WriteOptions, records::MessageHeader};

use super::{
    cdr::{Reader, Writer},
    messages,
    schemas::{FLOAT64, JOINT_STATE, LOG, POSE_STAMPED, Schema, TF_MESSAGE, WRENCH_STAMPED},
    wrench::{WrenchError, series},
};
use crate::model::wrench::Wrench;

/// Messages with their times, ns.
type Messages = Vec<(u64, Vec<u8>)>;

/// A channel of a file: topic, type, encoding, and messages with their times, ns.
type Channel<'a> = (&'a str, &'a str, &'a str, Messages);

/// A file with these channels.
fn file(channels: &[Channel<'_>], compression: Option<Compression>) -> Vec<u8> {
    let mut writer = WriteOptions::new().compression(compression).create(Cursor::new(Vec::new())).unwrap();
    for (topic, kind, encoding, data) in channels {
        let schema = writer.add_schema(kind, "ros2msg", b"float64 data").unwrap();
        let channel_id = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
        for (log_time, data) in data {
            let header = MessageHeader { channel_id, sequence: 0, log_time: *log_time, publish_time: *log_time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

const STAMPED: &str = "geometry_msgs/msg/WrenchStamped";

/// Wrenches whose force along x is 1, 2, 3 N, 10 ms apart, from 5 s on.
fn wrenches() -> Messages {
    let message = |number: u32| {
        let time_ns = 5_000_000_000 + 10_000_000 * u64::from(number);
        let wrench = Wrench::from([f64::from(number) + 1.0, 0.5, 0.0, 0.0, 0.0, 0.25]);
        (time_ns, messages::wrench(time_ns, &wrench))
    };
    (0..3).map(message).collect()
}

#[test]
fn wrenches_are_read_back_with_times_from_the_first_one() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let bytes = file(&[("/wrench", STAMPED, "cdr", wrenches())], compression);
        let rows = series(&bytes, None).unwrap();
        assert_eq!(rows.iter().map(|row| row[1]).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
        assert_eq!((rows[0][0], rows[0][2], rows[0][6]), (0.0, 0.5, 0.25));
        // Times of about 5 s in double precision.
        assert!((rows[2][0] - 0.02).abs() < 1e-12, "{rows:?}");
    }
}

#[test]
fn a_message_of_ros_1_and_one_without_a_stamp_are_read_too() {
    let mut ros1 = [7_u32, 3, 500_000_000, 4].iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
    ros1.extend(b"tool");
    ros1.extend([1.0_f64, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|value| value.to_le_bytes()));
    let bytes = file(&[("/wrench", "geometry_msgs/WrenchStamped", "ros1", vec![(9, ros1)])], None);
    assert_eq!(series(&bytes, Some("/wrench")).unwrap(), [[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]]);

    // A stamp of 0: the time of the recording counts.
    let without = (0..2).map(|number| (20_000_000 * number, messages::wrench(0, &Wrench::from([1.0; 6])))).collect();
    let rows = series(&file(&[("/wrench", STAMPED, "cdr", without)], None), None).unwrap();
    assert_eq!(rows[1][0], 0.02);
}

#[test]
fn the_topic_is_chosen_or_asked_for() {
    let number = vec![(1, messages::number(1.0))];
    let channels =
        [("/a", STAMPED, "cdr", wrenches()), ("/b", STAMPED, "cdr", wrenches()), ("/c", FLOAT64.name, "cdr", number)];
    let message = |bytes: &[u8], topic| series(bytes, topic).unwrap_err().to_string();
    let bytes = file(&channels, None);
    assert_eq!(series(&bytes, Some("/b")).unwrap().len(), 3);
    let both = message(&bytes, None);
    assert!(both.contains("\"/a\" (geometry_msgs/msg/WrenchStamped, cdr)") && both.contains("load.topic"), "{both}");
    let unlike = message(&bytes, Some("/c"));
    assert!(unlike.contains("expected the topic \"/c\" with messages geometry_msgs/WrenchStamped"), "{unlike}");
    let only = message(&file(&channels[2..], None), None);
    assert!(only.contains("\"/c\" (std_msgs/msg/Float64, cdr)") && only.contains("expected a topic with"), "{only}");
    assert!(message(&file(&[], None), None).starts_with("found no topic"));
}

#[test]
fn messages_that_are_no_wrench_are_refused_with_their_number() {
    let with = |change: &dyn Fn(&mut Messages)| {
        let mut data = wrenches();
        change(&mut data);
        series(&file(&[("/wrench", STAMPED, "cdr", data)], None), None).unwrap_err().to_string()
    };
    let short = with(&|data| data[1].1.truncate(30));
    assert_eq!(
        short,
        "topic \"/wrench\": found 30 bytes that are no wrench in message 2, expected a whole geometry_msgs/Wrench"
    );
    let infinite = with(&|data| data[2].1 = messages::wrench(6_000_000_000, &Wrench::from([f64::INFINITY; 6])));
    assert!(infinite.contains("a number that is not finite in message 3"), "{infinite}");
    let twice = with(&|data| data[2] = data[1].clone());
    assert!(twice.contains("in message 3, expected a time after that of the message before"), "{twice}");
}

#[test]
fn no_damage_makes_the_reader_panic_and_a_cut_file_is_refused() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let bytes = file(&[("/wrench", STAMPED, "cdr", wrenches())], compression);
        for kept in 0..bytes.len() {
            let error = series(&bytes[..kept], None).unwrap_err();
            assert!(matches!(error, WrenchError::Damaged(_) | WrenchError::Topic { .. }), "{kept}: {error}");
        }
        // A flipped bit may leave a file that is read, such as one in the name of the program.
        for index in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[index] ^= 1 << bit;
                let _ = series(&damaged, None);
            }
        }
    }
}

#[test]
fn a_length_of_more_than_the_file_asks_for_no_memory() {
    let mut bytes = file(&[("/wrench", STAMPED, "cdr", wrenches())], None);
    // The length of the first record follows the magic bytes and the kind.
    bytes[9..17].copy_from_slice(&(1_u64 << 60).to_le_bytes());
    assert!(matches!(series(&bytes, None), Err(WrenchError::Damaged(_))));
}

#[test]
fn values_are_aligned_as_cdr_wants_it() {
    let mut writer = Writer::default();
    writer.u8(1);
    writer.f64(2.0);
    writer.text("ab");
    writer.u32(3);
    let bytes = writer.into_bytes();
    // Header, a byte and seven of padding, a number, length and three bytes of text and one of padding, a number.
    assert_eq!(bytes.len(), 4 + 8 + 8 + 4 + 4 + 4);
    assert_eq!(bytes[4..12], [1, 0, 0, 0, 0, 0, 0, 0]);
    let mut reader = Reader::new(&bytes[..]).unwrap();
    assert_eq!(reader.u32(), Some(1));
    assert_eq!(reader.f64(), Some(2.0));
    assert_eq!(reader.text(), Some(&b"ab"[..]));
    assert_eq!(reader.u32(), Some(3));
    assert_eq!(reader.u32(), None);
}

#[test]
fn every_type_is_defined_with_the_types_in_it() {
    for schema in [JOINT_STATE, WRENCH_STAMPED, POSE_STAMPED, TF_MESSAGE, FLOAT64, LOG] {
        let Schema { name, .. } = schema;
        let text = schema.text();
        let defined: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
        let used = text.lines().filter_map(|line| line.split(' ').next()).filter(|kind| kind.contains('/'));
        for kind in used.map(|kind| kind.trim_end_matches("[]")) {
            assert!(defined.contains(&kind), "{name}: {kind} of {defined:?}");
        }
    }
}

/// A file of this crate is read by the crate's own reader with its checksums.
#[test]
fn a_file_has_its_messages_in_the_order_of_time() {
    let bytes = file(&[("/wrench", STAMPED, "cdr", wrenches())], Some(Compression::Zstd));
    let times: Vec<u64> = MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().log_time).collect();
    assert_eq!(times, [5_000_000_000, 5_010_000_000, 5_020_000_000]);
}
