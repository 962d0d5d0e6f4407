//! Values as the bytes of messages.

use nalgebra::{UnitQuaternion, Vector3};

use super::cdr::Writer;
use crate::model::{frames::Pose, wrench::Wrench};

/// The frame that all poses and axes are in: W.
pub const WORLD: &str = "world";

const NS_PER_S: u64 = 1_000_000_000;

/// The time of a sample, ns.
pub fn time_ns(time_s: f64) -> u64 {
    // Times of a simulation are not negative; a cast of a number that does not fit gives the nearest one that does.
    (time_s * 1e9).round() as u64
}

fn stamp(writer: &mut Writer, time_ns: u64) {
    writer.i32(i32::try_from(time_ns / NS_PER_S).unwrap_or(i32::MAX));
    writer.u32(u32::try_from(time_ns % NS_PER_S).unwrap_or_default());
}

fn header(writer: &mut Writer, time_ns: u64, frame: &str) {
    stamp(writer, time_ns);
    writer.text(frame);
}

fn vector(writer: &mut Writer, vector: &Vector3<f64>) {
    vector.iter().for_each(|value| writer.f64(*value));
}

fn quaternion(writer: &mut Writer, rotation: &UnitQuaternion<f64>) {
    // x, y, z, w.
    rotation.coords.iter().for_each(|value| writer.f64(*value));
}

/// A `JointState` without velocities.
pub fn joint_state(time_ns: u64, names: &[&str], q_rad: &[f64], torque_nm: &[f64]) -> Vec<u8> {
    let mut writer = Writer::default();
    header(&mut writer, time_ns, "");
    writer.length(names.len());
    names.iter().for_each(|name| writer.text(name));
    writer.numbers(q_rad);
    writer.numbers(&[]);
    writer.numbers(torque_nm);
    writer.into_bytes()
}

/// A `WrenchStamped` in W axes.
pub fn wrench(time_ns: u64, wrench_w: &Wrench) -> Vec<u8> {
    let mut writer = Writer::default();
    header(&mut writer, time_ns, WORLD);
    vector(&mut writer, &wrench_w.force_n);
    vector(&mut writer, &wrench_w.moment_nm);
    writer.into_bytes()
}

/// A `PoseStamped` in W.
pub fn pose(time_ns: u64, pose_w: &Pose) -> Vec<u8> {
    let mut writer = Writer::default();
    header(&mut writer, time_ns, WORLD);
    vector(&mut writer, &pose_w.translation.vector);
    quaternion(&mut writer, &pose_w.rotation);
    writer.into_bytes()
}

/// A `TFMessage`: frames with their poses in W.
pub fn transforms<'a>(time_ns: u64, frames: &[(&'a str, &'a Pose)]) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.length(frames.len());
    for (name, x_wf) in frames {
        header(&mut writer, time_ns, WORLD);
        writer.text(name);
        vector(&mut writer, &x_wf.translation.vector);
        quaternion(&mut writer, &x_wf.rotation);
    }
    writer.into_bytes()
}

/// A `Float64`.
pub fn number(value: f64) -> Vec<u8> {
    let mut writer = Writer::default();
    writer.f64(value);
    writer.into_bytes()
}

/// A `Log` of this level: 20 for information, 30 for a warning, 40 for an error.
pub fn log(time_ns: u64, level: u8, text: &str) -> Vec<u8> {
    let mut writer = Writer::default();
    stamp(&mut writer, time_ns);
    writer.u8(level);
    writer.text("benchdog");
    writer.text(text);
    writer.text("");
    writer.text("");
    writer.u32(0);
    writer.into_bytes()
}
