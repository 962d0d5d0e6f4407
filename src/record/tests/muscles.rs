//! The muscles in a recording.

use std::fs;

use super::*;
use crate::model::{activation_colour::activation_rgb, muscle_work::MuscleWork};

/// What these muscles do.
fn work() -> MuscleWork {
    let busiest: Vec<_> = bellies().into_iter().rev().map(|belly| belly.busiest).collect();
    MuscleWork { effort: 0.0144, largest_activation: 0.12, endurance_s: None, missing_nm: None, busiest }
}

/// The values of a component of an entity.
fn components<T: rerun::Component>(bytes: &[u8], path: &[&str], component: &'static str) -> Vec<T> {
    let chunks = decode::chunks(bytes).unwrap();
    let of_entity = chunks.iter().filter(|chunk| *chunk.entity_path() == entity(path));
    of_entity
        .flat_map(|chunk| {
            chunk.iter_component::<T>(component.into()).flat_map(|row| row.as_slice().to_vec()).collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn muscles_are_spindles_along_the_arm_in_the_colour_of_their_activation() {
    let example = example();
    let bytes = encode(&example.input()).unwrap();
    for belly in &example.person.muscles {
        let path = ["scene", "person", "muscles", &belly.region];
        let [from_w, to_w] = &belly.ends_w;
        let centre_w = nalgebra::center(from_w, to_w);
        assert_eq!(vectors(&bytes, &path, "Ellipsoids3D:centers"), [single(&centre_w)]);
        // Both spindles are vertical, 0.2 m long and 0.03 m thick.
        assert_eq!(vectors(&bytes, &path, "Ellipsoids3D:half_sizes"), [[0.03, 0.03, 0.1_f32]]);
        let [r, g, b] = activation_rgb(belly.busiest.activation);
        let colours: Vec<rerun::components::Color> = components(&bytes, &path, "Ellipsoids3D:colors");
        assert_eq!(colours, [rerun::Color::from_rgb(r, g, b)]);
        // Only the busiest muscle is named at first sight.
        let shown: Vec<rerun::components::ShowLabels> = components(&bytes, &path, "Ellipsoids3D:show_labels");
        assert_eq!(shown, [(belly.busiest.name == "brachialis").into()]);
        let labels: Vec<rerun::components::Text> = components(&bytes, &path, "Ellipsoids3D:labels");
        assert_eq!(labels, [belly.busiest.to_string().into()]);
    }
}

#[test]
fn a_verdict_with_muscles_has_a_chart_of_them_and_an_older_one_has_not() {
    let mut example = example();
    let without = encode(&example.input()).unwrap();
    type Strip = rerun::components::LineStrip2D;
    let bars = |bytes: &[u8]| components::<Strip>(bytes, &["muscles", "bars"], "LineStrips2D:strips");
    assert!(bars(&without).is_empty());
    assert!(!summary::markdown(&example.plan, &example.verdict).contains("**Muscles"));

    example.verdict.muscles = Some(work());
    let with = encode(&example.input()).unwrap();
    // On an axis of 100 up to an activation of 50 %.
    let ends: Vec<_> = bars(&with).iter().map(|strip| strip.0[1].0[0]).collect();
    assert_eq!(ends, [24.0, 0.0]);
    let names: Vec<rerun::components::Text> = components(&with, &["muscles", "names"], "Points2D:labels");
    assert_eq!(names, ["brachialis 12 %".into(), "anconeus 0 %".into()]);
    let text = summary::markdown(&example.plan, &example.verdict);
    assert!(text.contains("effort 0.014, largest activation 12 %; can be held for hours (estimate)"), "{text}");
    assert!(text.contains("| brachialis | 12.0 % | front of the upper arm |"), "{text}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("muscles.rrd");
    for (bytes, muscles) in [(with, Some(work())), (without, None)] {
        fs::write(&path, bytes).unwrap();
        assert_eq!(read_summary(&path).unwrap().verdict.muscles, muscles);
    }
}
