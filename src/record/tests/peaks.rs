//! The largest values that are read from a recording: those while a plan is judged.

use super::*;

#[test]
fn what_happens_after_the_load_is_no_peak() {
    let mut example = example();
    *example.measures.deflection_mm.last_mut().unwrap() = 99.0;
    assert_eq!(read(&encode(&example.input()).unwrap()).unwrap().peaks.deflection_mm, 6.0);
}

#[test]
fn what_happens_between_two_releases_is_a_peak() {
    let mut example = example();
    // As in a task: the load is released, and another one follows.
    for sample in &mut example.trace.samples[231..] {
        sample.phase = Phase::Hold;
    }
    example.measures.judged = example.measures.time_s.len();
    *example.measures.deflection_mm.last_mut().unwrap() = 99.0;
    assert_eq!(read(&encode(&example.input()).unwrap()).unwrap().peaks.deflection_mm, 99.0);
}
