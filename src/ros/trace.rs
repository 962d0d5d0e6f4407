//! A trace as an MCAP file.
//!
//! | topic | type | what |
//! |---|---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` | angles, rad, and applied torques, N m, of all arms |
//! | `/board/pose` | `geometry_msgs/msg/PoseStamped` | the board in W |
//! | `/tool/wrench` | `geometry_msgs/msg/WrenchStamped` | the tool's wrench on the board about the tool point, W axes |
//! | `/hands/ARM/wrench` | `geometry_msgs/msg/WrenchStamped` | a hand's wrench on the board about the grasp point, W axes |
//! | `/checks/NAME` | `std_msgs/msg/Float64` | the largest value of a check's series, of a least distance the smallest |
//! | `/load_factor` | `std_msgs/msg/Float64` | the applied multiple of the load |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | the board and the robot's links in W, every 20 ms |
//! | `/rosout` | `rcl_interfaces/msg/Log` | phases and limits that are crossed |

use std::{collections::BTreeMap, io::Cursor};

use ::mcap::{Compression, WriteOptions, Writer, records::MessageHeader, records::Metadata};

use super::{
    EncodeError,
    messages::{self, time_ns},
    schemas::{FLOAT64, JOINT_STATE, LOG, POSE_STAMPED, Schema, TF_MESSAGE, WRENCH_STAMPED},
    summary_order,
};
use crate::{
    model::{
        measures::{Event, EventKind, Measures},
        trace::{ArmSample, Sample, Trace},
        verdict::{CheckKind, Verdict},
        wrench::Wrench,
    },
    robot::{ArmState, Robot},
};

/// Time between two poses of the links, s.
const FRAME_S: f64 = 0.02;

/// The checks with a series.
const CHECKS: [CheckKind; 7] = [
    CheckKind::Slip,
    CheckKind::SlipRotation,
    CheckKind::Sag,
    CheckKind::Deflection,
    CheckKind::TorqueRatio,
    CheckKind::GripWrench,
    CheckKind::Clearance,
];

/// What a file is made from.
#[derive(Clone, Copy, Debug)]
pub struct McapInput<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// The trace.
    pub trace: &'a Trace,
    /// The judge's series.
    pub measures: &'a Measures,
    /// The judge's events.
    pub events: &'a [Event],
    /// The verdict.
    pub verdict: &'a Verdict,
}

/// A message that waits for its turn: time, ns, topic, type and bytes.
struct Message {
    time_ns: u64,
    topic: String,
    schema: Schema,
    data: Vec<u8>,
}

/// The bytes of the file. The same trace gives the same bytes.
///
/// # Errors
/// If the library cannot encode it.
pub fn encode(input: &McapInput<'_>) -> Result<Vec<u8>, EncodeError> {
    // One thread: the bytes must not depend on the machine.
    let options = WriteOptions::new()
        .profile("ros2")
        .library("benchdog")
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .calculate_summary_section_crc(false);
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    writer.write_metadata(&about(input.verdict))?;
    let mut channels = BTreeMap::new();
    for (sequence, message) in (0_u32..).zip(messages(input)) {
        let channel_id = match channels.get(&message.topic) {
            Some(id) => *id,
            None => {
                let id = channel(&mut writer, &message)?;
                channels.insert(message.topic.clone(), id);
                id
            }
        };
        let time = message.time_ns;
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &message.data)?;
    }
    writer.finish()?;
    let mut bytes = writer.into_inner().into_inner();
    // Without its form, which the library always gives it, the file is valid as it is.
    let _ = summary_order::sort(&mut bytes);
    Ok(bytes)
}

/// Name, verdict and fingerprint, as metadata of the file.
fn about(verdict: &Verdict) -> Metadata {
    let values = [
        ("name", verdict.name.clone()),
        ("verdict", verdict.verdict.to_string()),
        ("expected", verdict.expected.to_string()),
        ("fingerprint", verdict.fingerprint.clone()),
    ];
    let metadata = values.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    Metadata { name: "benchdog".to_owned(), metadata }
}

fn channel(writer: &mut Writer<Cursor<Vec<u8>>>, message: &Message) -> Result<u16, EncodeError> {
    let schema = writer.add_schema(message.schema.name, "ros2msg", message.schema.text().as_bytes())?;
    Ok(writer.add_channel(schema, &message.topic, "cdr", &BTreeMap::new())?)
}

/// All messages in the order of time.
fn messages(input: &McapInput<'_>) -> Vec<Message> {
    let mut messages = Vec::new();
    let mut framed_s = f64::NEG_INFINITY;
    for sample in &input.trace.samples {
        state(&mut messages, input, sample);
        // The tolerance of 0.5 ms allows for rounding in sums of steps.
        if sample.time_s - framed_s > FRAME_S - 5e-4 {
            framed_s = sample.time_s;
            messages.push(frames(input, sample));
        }
    }
    figures(&mut messages, input.measures);
    messages.extend(input.events.iter().map(|event| {
        let level = match event.kind {
            EventKind::Phase => 20,
            EventKind::LimitCrossed(_) => 30,
            EventKind::BrokeDown => 40,
        };
        let time_ns = time_ns(event.time_s);
        let data = messages::log(time_ns, level, &event.text);
        Message { time_ns, topic: "/rosout".to_owned(), schema: LOG, data }
    }));
    // A stable sort keeps the order of messages of one time.
    messages.sort_by_key(|message| message.time_ns);
    messages
}

/// Joints, board and wrenches of a sample.
fn state(messages: &mut Vec<Message>, input: &McapInput<'_>, sample: &Sample) {
    let time_ns = time_ns(sample.time_s);
    let mut push = |topic: String, schema, data| messages.push(Message { time_ns, topic, schema, data });
    let names: Vec<&str> = input.trace.arms.iter().flat_map(|arm| &arm.joints).map(String::as_str).collect();
    let all = |of: fn(&ArmSample) -> &Vec<f64>| sample.arms.iter().flat_map(of).copied().collect::<Vec<_>>();
    let joints = messages::joint_state(time_ns, &names, &all(|arm| &arm.q_rad), &all(|arm| &arm.torque_applied_nm));
    push("/joint_states".to_owned(), JOINT_STATE, joints);
    push("/board/pose".to_owned(), POSE_STAMPED, messages::pose(time_ns, &sample.x_wo));
    push("/tool/wrench".to_owned(), WRENCH_STAMPED, messages::wrench(time_ns, &sample.tool_wrench_w));
    for (arm, state) in input.trace.arms.iter().zip(&sample.arms) {
        let topic = format!("/hands/{}/wrench", topic_part(&arm.name));
        push(topic, WRENCH_STAMPED, messages::wrench(time_ns, &hand_wrench_w(sample, state)));
    }
}

/// The wrench of a hand on the board about its grasp point, W axes.
fn hand_wrench_w(sample: &Sample, state: &ArmSample) -> Wrench {
    let x_wc = sample.x_wo * state.x_oc;
    if let Some(wrench_g) = &state.grip_wrench_g {
        let [force_n, moment_nm] = [wrench_g.force_n, wrench_g.moment_nm].map(|vector| x_wc.rotation * vector);
        return Wrench { force_n, moment_nm };
    }
    state.pads.iter().fold(Wrench::default(), |sum, pad| {
        let Wrench { force_n, moment_nm } = pad.wrench_w;
        let arm_m = pad.p_wp_m - x_wc.translation.vector;
        sum + Wrench { force_n, moment_nm: moment_nm + arm_m.cross(&force_n) }
    })
}

/// The poses of board and links. Arms that the robot does not have are left out.
fn frames(input: &McapInput<'_>, sample: &Sample) -> Message {
    let states = input.trace.arms.iter().zip(&sample.arms).filter_map(|(arm, state)| {
        let travel_m = |finger| state.finger_m.get(finger).copied().unwrap_or(0.0);
        let finger_travel_m = [travel_m(0), travel_m(1)];
        Some(ArmState { arm: input.robot.arm_index(&arm.name)?, q_rad: &state.q_rad, finger_travel_m })
    });
    let x_wl = input.robot.link_poses(&input.robot.positions(&states.collect::<Vec<_>>()));
    let links = input.robot.links.iter().map(|link| link.name.as_str()).zip(&x_wl);
    let frames: Vec<_> = std::iter::once(("board", &sample.x_wo)).chain(links).collect();
    let time_ns = time_ns(sample.time_s);
    Message { time_ns, topic: "/tf".to_owned(), schema: TF_MESSAGE, data: messages::transforms(time_ns, &frames) }
}

/// The judge's series.
fn figures(messages: &mut Vec<Message>, measures: &Measures) {
    for (index, &time_s) in measures.time_s.iter().enumerate() {
        let mut push = |topic: String, value: f64| {
            let data = messages::number(value);
            messages.push(Message { time_ns: time_ns(time_s), topic, schema: FLOAT64, data });
        };
        for kind in CHECKS {
            let series = measures.series(kind);
            let values = series.iter().filter_map(|values| values.get(index)).copied();
            let value = if kind.is_least() { values.reduce(f64::min) } else { values.reduce(f64::max) };
            if let Some(value) = value {
                push(format!("/checks/{}", kind.name()), value);
            }
        }
        if let Some(factor) = measures.load_factor.get(index) {
            push("/load_factor".to_owned(), *factor);
        }
    }
}

/// A name as a part of a topic: letters, digits and underscores.
fn topic_part(name: &str) -> String {
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect()
}
