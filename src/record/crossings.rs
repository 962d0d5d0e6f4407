//! Marks in the scene where limits were first crossed, at the time of the event: the colour of the board or the pads, and a
//! labelled point for the first crossing of all.

use nalgebra::{Point3, Vector3};
use rerun::{Boxes3D, Color, EntityPath, Points3D};

use super::{
    entity::entity,
    error::RecordError,
    frames::{Frames, vec3},
    input::RecordingInput,
    messages::Messages,
    palette,
};
use crate::model::{
    measures::{Event, EventKind},
    trace::{ArmPart, Sample},
    verdict::CheckKind,
};

/// The entity of the labelled point.
pub(super) const MARK: &str = "first crossing";

/// The events at which a limit was crossed, with their checks.
fn crossings<'a>(input: &RecordingInput<'a>) -> impl Iterator<Item = (&'a Event, CheckKind)> {
    input.events.iter().filter_map(|event| match event.kind {
        EventKind::LimitCrossed(check) => Some((event, check)),
        EventKind::Phase | EventKind::BrokeDown => None,
    })
}

/// The time at which a pad or its hand first crossed a limit, s.
pub(super) fn pad_crossed_s(input: &RecordingInput, arm: &str, pad: &str) -> Option<f64> {
    let names = [format!("{arm} hand"), format!("{arm} {pad} pad")];
    crossings(input).find(|(event, _)| names.contains(&event.what)).map(|(event, _)| event.time_s)
}

/// The time at which the board first crossed a limit, s.
pub(super) fn board_crossed_s(input: &RecordingInput) -> Option<f64> {
    let first = |&(event, check): &(&Event, CheckKind)| match check {
        CheckKind::Drop => true,
        CheckKind::PersonOverlap => event.what.starts_with("the board"),
        CheckKind::Clearance => event.what.ends_with("the board"),
        _ => event.what.is_empty(),
    };
    crossings(input).find(first).map(|(event, _)| event.time_s)
}

/// The times and colours of a body: `own` from the start, the colour of limits from the time `crossed_s`; `None` without frames.
pub(super) fn colours_over_time(frames: &Frames, own: Color, crossed_s: Option<f64>) -> Option<(Vec<f64>, Vec<Color>)> {
    let start_s = *frames.times_s.first()?;
    // Static data hides data over time, so the first colour is logged over time too.
    let changes = std::iter::once((start_s, own)).chain(crossed_s.map(|time_s| (time_s, palette::limit())));
    Some(changes.unzip())
}

/// Logs the colour of boxes: `own` from the start, the colour of limits from the time `crossed_s`.
pub(super) fn log_box_colour(
    messages: &mut Messages,
    path: &EntityPath,
    frames: &Frames,
    own: Color,
    crossed_s: Option<f64>,
) -> Result<(), RecordError> {
    let Some((times_s, colours)) = colours_over_time(frames, own, crossed_s) else {
        return messages.log_static(path, &Boxes3D::update_fields().with_colors([own]));
    };
    let colours = Boxes3D::update_fields().with_colors(colours);
    messages.log_columns(path, &times_s, colours.columns_of_unit_batches().map_err(RecordError::encode)?)
}

/// Logs a labelled point at the first crossing of all, from its time on.
pub(super) fn log_mark(messages: &mut Messages, input: &RecordingInput, arms: &[usize]) -> Result<(), RecordError> {
    let Some(failure) = &input.verdict.first_failure else { return Ok(()) };
    let Some((event, _)) = crossings(input).find(|&(_, check)| check == failure.check) else { return Ok(()) };
    let Some(sample) = input.trace.samples.iter().find(|sample| sample.time_s == event.time_s) else { return Ok(()) };
    let p_w_m = position_w(input, sample, &event.what, arms);
    let mark = Points3D::new([vec3(&p_w_m)])
        .with_radii([0.02])
        .with_colors([palette::limit()])
        .with_labels([event.text.as_str()]);
    let path = entity(&["scene", MARK]);
    messages.log_columns(&path, &[event.time_s], mark.columns_of_unit_batches().map_err(RecordError::encode)?)
}

/// The position of a hand, pad, joint or link in a sample, in W, m; for other names the tool point.
fn position_w(input: &RecordingInput, sample: &Sample, what: &str, arms: &[usize]) -> Vector3<f64> {
    for ((arm, state), &robot_arm) in input.trace.arms.iter().zip(&sample.arms).zip(arms) {
        match arm.part(what) {
            Some(ArmPart::Hand) => return (sample.x_wo * Point3::from(state.x_oc.translation.vector)).coords,
            // In a regrasp a hand has no pads.
            Some(ArmPart::Pad(pad)) if pad < state.pads.len() => return state.pads[pad].p_wp_m,
            Some(ArmPart::Joint(joint)) => {
                let robot = input.robot;
                let link = robot.joints[robot.arms[robot_arm].joints[joint]].child_link;
                let state = crate::robot::ArmState { arm: robot_arm, q_rad: &state.q_rad, finger_travel_m: [0.0; 2] };
                return robot.link_poses(&robot.positions(&[state]))[link].translation.vector;
            }
            Some(ArmPart::Pad(_)) | None => {}
        }
    }
    let of_person = input.trace.person_touch.iter().map(|touch| &touch.body);
    let of_robot = input.trace.robot_touch.iter().map(|[body, _]| body);
    let mut links = of_person.chain(of_robot).filter_map(|body| input.robot.link_index(body));
    if let Some(link) = links.find(|&link| what.starts_with(&input.robot.links[link].name)) {
        let states = arms.iter().zip(&sample.arms);
        let states =
            states.map(|(&arm, state)| crate::robot::ArmState { arm, q_rad: &state.q_rad, finger_travel_m: [0.0; 2] });
        let positions = input.robot.positions(&states.collect::<Vec<_>>());
        return input.robot.link_poses(&positions)[link].translation.vector;
    }
    (sample.x_wo * Point3::from(input.trace.p_ot_m)).coords
}
