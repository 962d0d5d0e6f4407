//! What a player of the file needs beside the model, as `<custom>` fields: numbers and texts.
//!
//! | field | content |
//! |---|---|
//! | `tool_timestep_s` | time between samples, s: a whole multiple of the time step |
//! | `tool_wrench_o 0`, ... | six a sample: N, and N m about the tool point, O axes |
//! | `tool_point_o 0`, ... | three a sample: the tool point in O, m |
//! | `tool_frame` | `board` if the wrench turns with the board, `world` if it keeps the direction that it has at the planned pose |
//! | `phase_samples` | samples in which the grippers close, of settling, ramp, hold and release |
//! | `hand_over_samples` | samples after those of closing in which the arms take over the board's weight |
//! | `board_control 0`, ... | one an actuator: what the board's weight adds to its control in the key frames |
//! | `limit_*` | the scenario's limits |
//! | `hands`, `pads` | names of the hands, and of their pads, two a hand, separated by `; ` |
//! | `joints` | the joints of each hand's arm; hands are separated by `; ` |
//! | `grip_force_n` | one a hand |
//!
//! While the grippers close, `s` samples after the start, the controls of the fingers are the share `s / n` of those of
//! the key frame `planned`, with `n` the samples of closing, and the board is supported from outside. In the hand-over
//! that follows the arms carry the share `c`, which increases linearly from 0 to 1: the support is `1 - c` times the
//! board's weight at its centre, and the controls are those of the key frame less `1 - c` times `board_control`.
//!
//! Sample 0 is the initial state; the wrench of a sample acts in the steps before it. Long tables are in several numbered
//! fields, one after the other.

use std::io;

use super::{
    super::{conditions::Conditions, hand_over::HandOver, tool_load::ToolLoad},
    actuators::board_controls,
    exported_arm::ExportedArm,
    xml::{Xml, empty, numbers},
};
use crate::model::{load::ForceFrame, scenario::Limits, trace::Phase, wrench::Wrench};

/// The most numbers in a field: whole samples, below the 500 that MuJoCo 3 can read.
const FIELD_LEN: usize = 480;

/// Writes the element `custom`.
pub(super) fn custom(
    xml: &mut Xml,
    conditions: &Conditions,
    limits: &Limits,
    tool: &ToolLoad<'_>,
    arms: &[ExportedArm<'_>],
) -> io::Result<()> {
    let (phases, states): (Vec<_>, Vec<_>) = (0..=tool.steps()).map(|step| tool.at(step)).unzip();
    // The initial state is not a step.
    let samples = |phase| phases[1..].iter().filter(|&&of| of == phase).count() as f64;
    let texts = [
        ("tool_frame", frame_name(conditions.load.frame).to_owned()),
        ("hands", join("; ", arms.iter().map(|arm| arm.hold.name.clone()))),
        ("pads", join("; ", arms.iter().flat_map(|arm| [arm.pad_name(0), arm.pad_name(1)]))),
        ("joints", join("; ", arms.iter().map(|arm| arm.hold.joints.join(" ")))),
    ];
    let numeric = [
        ("tool_timestep_s", vec![conditions.settings.timestep_s]),
        ("phase_samples", [Phase::Grip, Phase::Settle, Phase::Ramp, Phase::Hold, Phase::Release].map(samples).to_vec()),
        ("hand_over_samples", vec![HandOver::new(&conditions.settings).steps()[1] as f64]),
        ("grip_force_n", arms.iter().map(|arm| arm.grip_force_n).collect()),
        ("limit_slip_mm", vec![limits.slip_mm]),
        ("limit_slip_deg", vec![limits.slip_deg]),
        ("limit_sag_mm", vec![limits.sag_mm]),
        ("limit_deflection_mm", vec![limits.deflection_mm]),
        ("limit_creep_mm_s", vec![limits.creep_mm_s]),
        ("limit_torque_ratio", vec![limits.torque_ratio]),
    ];
    let tables: [(&str, Vec<f64>); 3] = [
        ("board_control", board_controls(arms, conditions)),
        ("tool_wrench_o", states.iter().flat_map(|state| <[f64; 6]>::from(state.wrench_o)).collect()),
        ("tool_point_o", states.iter().flat_map(|state| <[f64; 3]>::from(state.p_ot_m)).collect()),
    ];
    xml.create_element("custom").write_inner_content(|xml| {
        for (name, data) in &numeric {
            numeric_field(xml, (*name).to_owned(), data)?;
        }
        for (name, data) in &tables {
            for (number, part) in data.chunks(FIELD_LEN).enumerate() {
                numeric_field(xml, format!("{name} {number}"), part)?;
            }
        }
        texts
            .iter()
            .try_for_each(|(name, data)| empty(xml, "text", &[("name", (*name).into()), ("data", data.clone())]))
    })?;
    Ok(())
}

fn numeric_field(xml: &mut Xml, name: String, data: &[f64]) -> io::Result<()> {
    empty(xml, "numeric", &[("name", name), ("size", data.len().to_string()), ("data", numbers(data))])
}

fn frame_name(frame: ForceFrame) -> &'static str {
    match frame {
        ForceFrame::Board => "board",
        ForceFrame::World => "world",
    }
}

fn join(separator: &str, names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(separator)
}

/// The wrench of the sample with the largest load factor, about the tool point at the start, O axes.
pub(super) fn largest_wrench_o(tool: &ToolLoad<'_>) -> Wrench {
    let start_m = tool.at(0).1.p_ot_m;
    let states = (1..=tool.steps()).map(|step| tool.at(step).1);
    let largest = states.reduce(|best, state| if state.load_factor > best.load_factor { state } else { best });
    largest.map_or(Wrench::default(), |state| state.wrench_o.about(&(state.p_ot_m - start_m)))
}
