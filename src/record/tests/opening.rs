//! What a viewer shows when it opens a recording: the moment and the camera.

use nalgebra::Vector3;
use rerun::{
    StoreId, StoreKind,
    external::re_sdk_types::blueprint::components::AbsoluteTimeRange,
    log::{Chunk, LogMsg},
};

use super::{super::blueprint, *};

/// The chunks of the layout of a recording.
fn layout(input: &RecordingInput<'_>) -> Vec<Chunk> {
    let messages = Messages::new(StoreId::new(StoreKind::Blueprint, APPLICATION, "layout"));
    let messages = blueprint::messages(messages, input).unwrap().into_iter();
    let chunk = |message| match message {
        LogMsg::ArrowMsg(_, arrow) => Some(Chunk::from_arrow_msg(&arrow).unwrap()),
        _ => None,
    };
    messages.filter_map(chunk).collect()
}

/// The range that the time panel repeats, ns.
fn repeated_ns(input: &RecordingInput<'_>) -> Option<[i64; 2]> {
    let ranges = layout(input).into_iter().flat_map(|chunk| {
        let component = "TimePanelBlueprint:time_selection".into();
        chunk.iter_component::<AbsoluteTimeRange>(component).flat_map(|row| row.as_slice().to_vec()).collect::<Vec<_>>()
    });
    ranges.map(|range| [range.0.min.0, range.0.max.0]).last()
}

#[test]
fn a_recording_opens_at_the_first_crossing_or_at_the_end_of_what_is_judged() {
    let mut example = example();
    assert_eq!(repeated_ns(&example.input()), Some([276_000_000; 2]));
    example.verdict.first_failure = None;
    example.measures.judged = 151;
    let end_ns = (example.measures.time_s[150] * 1e9).round() as i64;
    assert_eq!(repeated_ns(&example.input()), Some([end_ns; 2]));
    // A task is played to its end.
    let people = [(0.0, example.person.clone())];
    let task = RecordingInput { people: &people, ..example.input() };
    assert_eq!(repeated_ns(&task), None);
}

/// The position of the camera in W, m.
fn eye_w(input: &RecordingInput<'_>) -> Vector3<f64> {
    let eyes = layout(input).into_iter().flat_map(|chunk| {
        chunk.iter_slices::<[f32; 3]>("EyeControls3D:position".into()).flatten().copied().collect::<Vec<_>>()
    });
    Vector3::from(eyes.last().unwrap().map(f64::from))
}

#[test]
fn the_camera_goes_where_the_person_hides_neither_hands_nor_tool() {
    let mut example = example();
    let before = eye_w(&example.input());
    // A wall of a body between the camera and the board.
    let board_w = example.plan.object.x_wo.translation.vector;
    let middle_w = Point3::from(board_w + (before - board_w) * 0.4);
    let wall = Capsule { ends_w: [middle_w, middle_w + Vector3::z() * 0.1], radius_m: 0.5 };
    example.person.capsules.push(wall);
    let after = eye_w(&example.input());
    assert!((after - before).norm() > 0.5, "{before} {after}");
}
