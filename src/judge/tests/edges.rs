//! Values at the edges of the rules: limits met exactly, shortest holds, and numbers that are not finite.

use sha2::{Digest, Sha256};

use super::*;

/// A trace in which every frame is W, so that displacements are exact numbers.
fn aligned() -> Trace {
    let mut trace = still();
    for sample in &mut trace.samples {
        sample.x_wo = Pose::identity();
        sample.arms.iter_mut().for_each(|arm| arm.x_oc = Pose::identity());
    }
    trace
}

#[test]
fn a_board_that_slid_by_the_drop_limit_is_not_lost() {
    let mut trace = aligned();
    for sample in &mut trace.samples[SETTLE + 20..] {
        sample.arms[1].x_oc.translation.vector.x = 1e-3 * checks::DROP_MM;
    }
    let judgement = judge(&trace, &Limits { slip_mm: 2.0 * checks::DROP_MM, ..limits() });
    assert_eq!((judgement.verdict, value(&judgement, CheckKind::Drop)), (VerdictKind::Holds, checks::DROP_MM));
    assert_eq!(judgement.measures.judged, LAST_JUDGED + 1 - HAND_OVER);
    // Creep is known only of a board that is held to the end.
    assert!(judgement.checks.iter().any(|check| check.name == CheckKind::Creep));
}

#[test]
fn a_pad_that_is_open_at_the_hand_over_has_been_open_for_one_step() {
    let open = changed(0, |s| s.arms[1].pads[0].normal_force_n = 0.0);
    // The sample of the hand-over counts as the first of the sixteen steps that are too many.
    assert_eq!(outcome(&open), (VerdictKind::Opens, Some(HAND_OVER + 15)));
    let mut shut = open;
    shut.samples[HAND_OVER + 1..].iter_mut().for_each(|s| s.arms[1].pads[0].normal_force_n = GRIP_N);
    assert_eq!(value(&judge(&shut, &limits()), CheckKind::PadOpen), 1e3 * STEP_S);
}

#[test]
fn creep_needs_two_samples_in_the_second_half_of_the_hold() {
    let creep_of = |samples: usize| {
        let mut trace = still();
        trace.samples.truncate(SETTLE + RAMP + samples);
        for (index, sample) in trace.samples.iter_mut().enumerate().skip(SETTLE + RAMP) {
            slide(sample, 0, 0.1 * (index - SETTLE - RAMP) as f64 * STEP_S);
        }
        let judgement = judge(&trace, &limits());
        assert_eq!(judgement.verdict, VerdictKind::Holds, "{samples}");
        judgement.checks.iter().find(|check| check.name == CheckKind::Creep).map(|check| check.value)
    };
    // From the middle of two samples on there is one, of three there are two.
    assert_eq!((creep_of(1), creep_of(2)), (None, None));
    // Positions of half a metre are accurate to 1e-16 m; over 2 ms the rate is accurate to 1e-10 mm/s.
    assert!((creep_of(3).unwrap() - 0.1).abs() < 1e-9);
}

#[test]
fn constants_that_are_not_finite_give_no_verdict() {
    let spoils: [fn(&mut Trace); 3] = [
        |trace| trace.arms[0].grip_force_n = f64::NAN,
        |trace| trace.arms[1].effort_nm[1] = f64::INFINITY,
        |trace| trace.p_ot_m.y = f64::NAN,
    ];
    for spoil in spoils {
        let mut trace = still();
        spoil(&mut trace);
        let judgement = judge(&trace, &limits());
        assert_eq!(judgement.verdict, VerdictKind::NoVerdict);
        assert_eq!(judgement.reason.unwrap(), "found a limit or a tool point that is not finite");
    }
}

#[test]
fn a_sample_lacks_an_entry_whichever_it_is() {
    let spoils: [fn(&mut Sample); 3] = [
        |sample| _ = sample.arms[1].torque_demanded_nm.pop(),
        |sample| _ = sample.arms[0].pads.pop(),
        |sample| _ = sample.arms.pop(),
    ];
    let expected = "the sample at 0.1 s does not have one entry an arm, joint and pad";
    for spoil in spoils {
        assert_eq!(judge(&changed(SETTLE, spoil), &limits()).reason.unwrap(), expected);
    }
    let mut short = still();
    short.arms[1].effort_nm.pop();
    assert!(judge(&short, &limits()).reason.unwrap().ends_with("one entry an arm, joint and pad"));
}

/// The board accelerates within a phase, so the momentum balance is judged only where the forces have become steady.
#[test]
fn the_momentum_balance_counts_at_the_ends_of_settling_and_hold() {
    let verdict_with_residual_at = |at: usize| {
        let mut trace = still();
        trace.samples[at].self_check.force_residual_n = 2.0 * self_checks::FORCE_LIMIT_N;
        judge(&trace, &limits()).verdict
    };
    for steady in [SETTLE - 1, LAST_JUDGED] {
        assert_eq!(verdict_with_residual_at(steady), VerdictKind::NoVerdict, "{steady}");
    }
    for moving in [GRIP, SETTLE - 2, SETTLE, SETTLE + RAMP - 1, SETTLE + RAMP, LAST_JUDGED - 1, LAST_JUDGED + 1] {
        assert_eq!(verdict_with_residual_at(moving), VerdictKind::Holds, "{moving}");
    }
    // A trace may end with the hold: whether the forces have become steady is not known then.
    let mut unreleased = still();
    unreleased.samples.truncate(LAST_JUDGED + 1);
    unreleased.samples[LAST_JUDGED].self_check.force_residual_n = 2.0 * self_checks::FORCE_LIMIT_N;
    assert_eq!(judge(&unreleased, &limits()).verdict, VerdictKind::Holds);
}

#[test]
fn an_expectation_is_met_by_its_verdict_and_never_without_one() {
    let met = |trace: &Trace, expected| {
        let judgement = judge(trace, &limits());
        judgement.to_verdict("trace", expected, 1, BTreeMap::new()).met
    };
    let slid = changed(SETTLE + 60, |s| slide(s, 1, 1.1));
    assert!(met(&still(), VerdictKind::Holds) && met(&slid, VerdictKind::Slips));
    assert!(!met(&still(), VerdictKind::Slips) && !met(&slid, VerdictKind::Holds));
    let empty = Trace { samples: Vec::new(), ..still() };
    assert!(!met(&empty, VerdictKind::NoVerdict) && !met(&empty, VerdictKind::Holds));
}

/// SHA-256 of numbers, in the form of a fingerprint.
fn hash_of(numbers: &[f64]) -> String {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn a_fingerprint_is_the_hash_of_the_numbers_in_their_order() {
    let sample = |p_ot_m: Vector3<f64>| Sample {
        time_s: 0.25,
        phase: Phase::Hold,
        load_factor: 0.5,
        tool_wrench_w: Wrench::from([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        x_wo: Isometry3::translation(7.0, 8.0, 9.0),
        p_ot_m,
        self_check: StepCheck::default(),
        arms: Vec::new(),
        person_distance_m: Some(10.0),
        robot_clearance_m: Some(11.0),
    };
    let p_ot_m = Vector3::new(0.1, 0.2, 0.3);
    let trace = |samples: Vec<Sample>| Trace {
        arms: Vec::new(),
        p_ot_m,
        samples,
        broke_down: None,
        person_touch: None,
        robot_touch: None,
    };
    let phase = f64::from(Phase::Hold as u8);
    // Time, phase, load factor, wrench, position, quaternion (the real part last), distances.
    let numbers = [0.25, phase, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 0.0, 0.0, 0.0, 1.0, 10.0, 11.0];
    let mut expected = p_ot_m.as_slice().to_vec();
    expected.extend(numbers);
    assert_eq!(fingerprint(&trace(vec![sample(p_ot_m)])), hash_of(&expected));
    // A tool point that has moved is added.
    let moved_m = Vector3::new(0.1, 0.2, 0.4);
    expected.extend(moved_m.as_slice());
    assert_eq!(fingerprint(&trace(vec![sample(moved_m)])), hash_of(&expected));
}

#[test]
fn the_ramps_event_tells_how_far_the_tool_point_sank() {
    let sunk = changed(SETTLE - 10, |s| s.x_wo.translation.vector.z -= 3e-3);
    let events = judge(&sunk, &limits()).events;
    let ramp = events.iter().find(|event| event.text.starts_with("ramp: ")).unwrap();
    assert_eq!(ramp.text, "ramp: the load increases; the tool tip sagged 3.00 mm");
}

/// Up to the sample that decides the simulation must be valid, that one included.
#[test]
fn a_violation_at_the_deciding_sample_takes_the_verdict() {
    let at = SETTLE + 60;
    let verdict_with_violation_at = |sample: usize| {
        let mut trace = changed(at, |s| slide(s, 1, 1.1));
        trace.samples[sample].self_check.penetration_m = 2e-3 * self_checks::PENETRATION_LIMIT_MM;
        judge(&trace, &limits()).verdict
    };
    assert_eq!(verdict_with_violation_at(at - 1), VerdictKind::NoVerdict);
    assert_eq!(verdict_with_violation_at(at), VerdictKind::NoVerdict);
    assert_eq!(verdict_with_violation_at(at + 1), VerdictKind::Slips);
}
