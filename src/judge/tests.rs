//! Synthetic traces: each limit crossed alone, met exactly, and together with others.

mod edges;
mod measured;
mod mechanics;
mod page;
mod stages;

use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::model::{
    frames::Pose,
    measures::EventKind,
    trace::{ArmSample, ArmTrace, PadSample, PersonTouch, StepCheck},
    verdict::CheckKind,
    wrench::Wrench,
};

const STEP_S: f64 = 0.002;
const GRIP: usize = 10;
/// Index of the first sample of the ramp: the closing of the grippers counts.
const SETTLE: usize = 50;
const RAMP: usize = 100;
const HOLD: usize = 100;
const RELEASE: usize = 50;
const GRIP_N: f64 = 30.0;

/// A general pose, so that no test depends on aligned frames.
fn crooked() -> Pose {
    Isometry3::new(Vector3::new(0.5, -0.1, 0.3), Vector3::new(0.3, -0.7, 1.1))
}

fn limits() -> Limits {
    Limits::USUAL
}

fn phase(index: usize) -> Phase {
    match index {
        0..GRIP => Phase::Grip,
        i if i < SETTLE => Phase::Settle,
        i if i < SETTLE + RAMP => Phase::Ramp,
        i if i < SETTLE + RAMP + HOLD => Phase::Hold,
        _ => Phase::Release,
    }
}

/// Index of the hand-over in [`still`].
const HAND_OVER: usize = GRIP - 1;
/// Index of the last judged sample in [`still`].
const LAST_JUDGED: usize = SETTLE + RAMP + HOLD - 1;

/// A trace without motion: two arms of two joints and two pads.
fn still() -> Trace {
    let arm = |name: &str| ArmTrace {
        name: name.into(),
        joints: vec![format!("{name}_s0"), format!("{name}_w1")],
        effort_nm: vec![50.0, 15.0],
        pads: vec!["upper".into(), "lower".into()],
        grip_force_n: GRIP_N,
        wrench_limits: None,
    };
    let pad = PadSample { normal_force_n: GRIP_N, wrench_w: Wrench::default(), p_wp_m: Vector3::zeros() };
    let arm_sample = ArmSample {
        q_rad: vec![0.1, -0.2],
        finger_m: vec![0.01, 0.01],
        torque_demanded_nm: vec![10.0, -6.0],
        torque_applied_nm: vec![10.0, -6.0],
        x_oc: crooked(),
        pads: vec![pad; 2],
        grip_wrench_g: None,
    };
    let sample = |index: usize| Sample {
        time_s: index as f64 * STEP_S,
        phase: phase(index),
        load_factor: match phase(index) {
            Phase::Ramp => (index + 1 - SETTLE) as f64 / RAMP as f64,
            Phase::Hold => 1.0,
            _ => 0.0,
        },
        tool_wrench_w: Wrench::default(),
        x_wo: crooked(),
        p_ot_m: Vector3::new(0.1, 0.05, 0.015),
        self_check: StepCheck::default(),
        arms: vec![arm_sample.clone(); 2],
        person_distance_m: None,
        robot_clearance_m: None,
    };
    Trace {
        arms: vec![arm("left"), arm("right")],
        p_ot_m: Vector3::new(0.1, 0.05, 0.015),
        samples: (0..SETTLE + RAMP + HOLD + RELEASE).map(sample).collect(),
        broke_down: None,
        person_touch: None,
        robot_touch: None,
    }
}

/// A trace without motion, with `change` applied to every sample from `from` on.
fn changed(from: usize, change: impl Fn(&mut Sample)) -> Trace {
    let mut trace = still();
    trace.samples[from..].iter_mut().for_each(change);
    trace
}

fn slide(sample: &mut Sample, arm: usize, by_mm: f64) {
    sample.arms[arm].x_oc.translation.vector += Vector3::new(0.6, -0.8, 0.0) * (by_mm * 1e-3);
}

fn turn(sample: &mut Sample, arm: usize, by_deg: f64) {
    let x_oc = &mut sample.arms[arm].x_oc;
    x_oc.rotation = nalgebra::UnitQuaternion::new(Vector3::z() * by_deg.to_radians()) * x_oc.rotation;
}

fn value(judgement: &Judgement, kind: CheckKind) -> f64 {
    judgement.checks.iter().find(|check| check.name == kind).unwrap().value
}

/// The verdict and the sample that decided it.
fn outcome(trace: &Trace) -> (VerdictKind, Option<usize>) {
    let judgement = judge(trace, &limits());
    let failure = judgement.first_failure;
    (judgement.verdict, failure.map(|failure| (failure.time_s / STEP_S).round() as usize))
}

#[test]
fn a_still_hold_holds_with_every_check_made() {
    let judgement = judge(&still(), &limits());
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert_eq!(judgement.first_failure, None);
    assert_eq!(judgement.checks.len(), 9);
    assert!(judgement.checks.iter().all(|check| check.passed && check.margin == check.limit - check.value));
    assert_eq!(judgement.peak_torque_ratio["left_w1"], 6.0 / 15.0);
    assert_eq!(judgement.measures.time_s[0], HAND_OVER as f64 * STEP_S);
    assert_eq!(judgement.measures.judged, LAST_JUDGED + 1 - HAND_OVER);
}

#[test]
fn each_failure_is_named_after_its_own_limit() {
    let at = SETTLE + 60;
    assert_eq!(outcome(&changed(at, |s| slide(s, 1, 1.1))), (VerdictKind::Slips, Some(at)));
    assert_eq!(outcome(&changed(at, |s| turn(s, 0, 2.1))), (VerdictKind::Pivots, Some(at)));
    assert_eq!(outcome(&changed(at, |s| s.x_wo.translation.vector.z -= 5.1e-3)), (VerdictKind::Deflects, Some(at)));
    assert_eq!(outcome(&changed(at, |s| s.arms[1].torque_demanded_nm[1] = -15.1)), (VerdictKind::Saturates, Some(at)));
    assert_eq!(outcome(&changed(at, |s| slide(s, 0, 50.1))), (VerdictKind::Drops, Some(at)));
    // Fifteen steps of 2 ms are allowed; the sixteenth is not.
    assert_eq!(outcome(&changed(at, |s| s.arms[0].pads[1].normal_force_n = 1.4)), (VerdictKind::Opens, Some(at + 15)));
}

/// A trace without motion beside a person, with this distance from a sample on.
fn beside_a_person(from: usize, distance_m: f64) -> Trace {
    let mut trace = still();
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        sample.person_distance_m = Some(if index < from { 0.05 } else { distance_m });
    }
    let touch = PersonTouch { body: "the board".into(), part: "the person's Head".into() };
    Trace { person_touch: (distance_m < 0.0).then_some(touch), ..trace }
}

#[test]
fn a_person_who_is_reached_is_touched() {
    let at = SETTLE + 60;
    let touched = judge(&beside_a_person(at, -0.002), &limits());
    assert_eq!(touched.verdict, VerdictKind::Touches);
    assert_eq!(touched.first_failure.unwrap().time_s, at as f64 * STEP_S);
    let check = touched.checks.iter().find(|check| check.name == CheckKind::PersonOverlap).unwrap();
    assert_eq!((check.value, check.limit, check.margin), (2.0, 0.0, -2.0));
    let expected = "the board and the person's Head overlap by more than 0 mm at load factor 0.61";
    assert!(touched.events.iter().any(|event| event.text == expected), "{:?}", touched.events);

    // Contact without penetration is no overlap. A plan without a person has no such check.
    let apart = judge(&beside_a_person(at, 0.0), &limits());
    assert_eq!((apart.verdict, value(&apart, CheckKind::PersonOverlap)), (VerdictKind::Holds, 0.0));
    let clear = judge(&beside_a_person(at, 0.032), &limits());
    assert_eq!((clear.verdict, value(&clear, CheckKind::PersonOverlap)), (VerdictKind::Holds, -32.0));
    assert!(judge(&still(), &limits()).checks.iter().all(|check| check.name != CheckKind::PersonOverlap));
}

/// A trace without motion whose robot has this distance from itself from a sample on.
fn near_itself(from: usize, distance_m: f64) -> Trace {
    let mut trace = still();
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        sample.robot_clearance_m = Some(if index < from { 0.005 } else { distance_m });
    }
    let touch = ["left_wrist".to_owned(), "the board".to_owned()];
    Trace { robot_touch: (distance_m < 0.0).then_some(touch), ..trace }
}

#[test]
fn a_robot_that_meets_itself_collides() {
    let at = SETTLE + 60;
    let collided = judge(&near_itself(at, -0.002), &limits());
    assert_eq!(collided.verdict, VerdictKind::Collides);
    assert_eq!(collided.first_failure.unwrap().time_s, at as f64 * STEP_S);
    let check = collided.checks.iter().find(|check| check.name == CheckKind::Clearance).unwrap();
    assert_eq!((check.value, check.limit, check.margin, check.passed), (-2.0, 0.0, -2.0, false));
    assert_eq!(check.limit_text(), ">= 0.000");
    let expected = "left_wrist and the board are closer to each other than 0 mm at load factor 0.61";
    assert!(collided.events.iter().any(|event| event.text == expected), "{:?}", collided.events);

    // Of two distances the smaller one counts, and contact without penetration passes.
    for (distance_m, value_mm) in [(0.0, 0.0), (0.003, 3.0), (0.032, 5.0)] {
        let apart = judge(&near_itself(at, distance_m), &limits());
        assert_eq!((apart.verdict, value(&apart, CheckKind::Clearance)), (VerdictKind::Holds, value_mm));
        let check = apart.checks.iter().find(|check| check.name == CheckKind::Clearance).unwrap();
        assert_eq!((check.margin, check.passed), (value_mm, true));
    }
    // It comes after the contacts and before torque.
    let mut both = near_itself(at, -0.002);
    both.samples[at].arms[1].torque_demanded_nm[1] = -15.1;
    assert_eq!(outcome(&both), (VerdictKind::Collides, Some(at)));
    slide(&mut both.samples[at], 1, 1.1);
    assert_eq!(outcome(&both), (VerdictKind::Slips, Some(at)));
}

#[test]
fn without_any_contact_the_board_drops_at_once() {
    let at = SETTLE + 10;
    let release = |pad: &mut PadSample| pad.normal_force_n = 0.0;
    let all_pads = changed(at, |s| s.arms.iter_mut().flat_map(|arm| &mut arm.pads).for_each(release));
    assert_eq!(outcome(&all_pads), (VerdictKind::Drops, Some(at)));
    let one_hand = changed(at, |s| s.arms[0].pads.iter_mut().for_each(release));
    assert_eq!(outcome(&one_hand), (VerdictKind::Opens, Some(at + 15)));
}

#[test]
fn a_board_that_was_never_held_drops_at_the_hand_over() {
    let none = changed(0, |s| s.arms.iter_mut().flat_map(|arm| &mut arm.pads).for_each(|pad| pad.normal_force_n = 0.0));
    assert_eq!(outcome(&none), (VerdictKind::Drops, Some(HAND_OVER)));
}

#[test]
fn without_a_grip_phase_the_first_forces_are_the_hand_over() {
    let mut trace = still();
    // There are no forces before the first step.
    trace.samples[0].arms.iter_mut().flat_map(|arm| &mut arm.pads).for_each(|pad| pad.normal_force_n = 0.0);
    trace.samples.iter_mut().filter(|sample| sample.phase == Phase::Grip).for_each(|s| s.phase = Phase::Settle);
    let judgement = judge(&trace, &limits());
    assert_eq!((judgement.verdict, judgement.measures.time_s[0]), (VerdictKind::Holds, STEP_S));
}

#[test]
fn a_board_lost_while_settling_drops_though_the_load_never_acted() {
    let lost_at = SETTLE - 20;
    let mut trace =
        changed(lost_at, |s| s.arms.iter_mut().flat_map(|arm| &mut arm.pads).for_each(|pad| pad.normal_force_n = 0.0));
    // The simulation ends soon after a loss.
    trace.samples.truncate(SETTLE - 5);
    assert_eq!(outcome(&trace), (VerdictKind::Drops, Some(lost_at)));
    // Nothing is judged after the first sample without contact.
    assert_eq!(value(&judge(&trace, &limits()), CheckKind::ContactLost), 2.0);
}

#[test]
fn a_trace_that_ends_while_settling_with_the_board_held_gives_no_verdict() {
    let mut trace = still();
    trace.samples.truncate(SETTLE - 5);
    assert_eq!(judge(&trace, &limits()).verdict, VerdictKind::NoVerdict);
}

#[test]
fn a_value_at_its_limit_passes() {
    let limits = Limits { slip_mm: 0.25, deflection_mm: 4.0, torque_ratio: 0.5, ..limits() };
    let mut trace = still();
    // Powers of two are exact in binary, so the value equals the limit.
    for sample in &mut trace.samples {
        sample.x_wo = Pose::identity();
        sample.p_ot_m = Vector3::zeros();
        sample.arms.iter_mut().for_each(|arm| arm.x_oc = Pose::identity());
    }
    trace.p_ot_m = Vector3::zeros();
    for sample in &mut trace.samples[SETTLE + 20..] {
        sample.arms[0].x_oc.translation.vector.x = 0.25e-3;
        sample.x_wo.translation.vector.y = 4.0e-3;
        sample.arms[0].torque_demanded_nm[0] = 25.0;
        sample.arms[0].pads[0].normal_force_n = 0.05 * GRIP_N;
    }
    let judgement = judge(&trace, &limits);
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert_eq!(value(&judgement, CheckKind::Slip), 0.25);
    assert_eq!(value(&judgement, CheckKind::Deflection), 4.0);
    assert_eq!(value(&judgement, CheckKind::TorqueRatio), 0.5);
    assert_eq!(value(&judgement, CheckKind::PadOpen), 0.0);
}

#[test]
fn a_pad_may_open_for_thirty_milliseconds() {
    let open_for = |steps: usize| {
        let mut trace = still();
        for sample in &mut trace.samples[SETTLE + 20..SETTLE + 20 + steps] {
            sample.arms[1].pads[0].normal_force_n = 0.0;
        }
        judge(&trace, &limits())
    };
    assert_eq!(open_for(15).verdict, VerdictKind::Holds);
    assert_eq!(value(&open_for(15), CheckKind::PadOpen), 30.0);
    assert_eq!(open_for(16).verdict, VerdictKind::Opens);
}

#[test]
fn the_first_crossing_names_the_verdict_and_ties_go_to_the_contacts() {
    let mut trace = changed(SETTLE + 50, |s| slide(s, 0, 3.0));
    trace.samples[SETTLE + 40..].iter_mut().for_each(|s| turn(s, 1, 3.0));
    assert_eq!(outcome(&trace), (VerdictKind::Pivots, Some(SETTLE + 40)));
    let judgement = judge(&trace, &limits());
    assert!(judgement.checks.iter().any(|check| check.name == CheckKind::Slip && !check.passed));

    let tie = changed(SETTLE + 40, |s| {
        slide(s, 0, 3.0);
        turn(s, 0, 3.0);
        s.arms[0].torque_demanded_nm[0] = 60.0;
    });
    assert_eq!(outcome(&tie), (VerdictKind::Slips, Some(SETTLE + 40)));
}

#[test]
fn a_failure_tells_the_load_that_acted() {
    let failure = judge(&changed(SETTLE + 59, |s| slide(s, 0, 1.5)), &limits()).first_failure.unwrap();
    assert_eq!((failure.check, failure.load_factor), (CheckKind::Slip, 0.6));
    assert_eq!(failure.time_s, (SETTLE + 59) as f64 * STEP_S);
}

#[test]
fn the_board_is_judged_from_the_hand_over_on() {
    let at = GRIP + 20;
    assert_eq!(outcome(&changed(at, |s| slide(s, 1, 1.1))), (VerdictKind::Slips, Some(at)));
    assert_eq!(outcome(&changed(at, |s| turn(s, 0, 2.1))), (VerdictKind::Pivots, Some(at)));
    assert_eq!(outcome(&changed(at, |s| s.arms[1].torque_demanded_nm[1] = -15.1)), (VerdictKind::Saturates, Some(at)));
    // Before the ramp the tool point sags, after it it deflects: each has its own limit.
    let sunk = |from: usize, by_mm: f64| changed(from, move |s| s.x_wo.translation.vector.z -= by_mm * 1e-3);
    assert_eq!(outcome(&sunk(at, 10.1)), (VerdictKind::Sags, Some(at)));
    let sagged = judge(&sunk(at, 9.0), &limits());
    assert_eq!(sagged.verdict, VerdictKind::Holds);
    assert!((value(&sagged, CheckKind::Sag) - 9.0).abs() < 1e-11 && value(&sagged, CheckKind::Deflection) == 0.0);
    let deflected = judge(&sunk(SETTLE + 20, 4.0), &limits());
    assert!(value(&deflected, CheckKind::Sag) == 0.0 && (value(&deflected, CheckKind::Deflection) - 4.0).abs() < 1e-11);
    // Slip under the weight and slip under the load add up.
    let mut twice = changed(at, |s| slide(s, 0, 0.6));
    twice.samples[SETTLE + 30..].iter_mut().for_each(|s| slide(s, 0, 0.6));
    assert_eq!(outcome(&twice), (VerdictKind::Slips, Some(SETTLE + 30)));
}

#[test]
fn nothing_is_judged_after_the_board_is_lost() {
    let at = SETTLE + 60;
    let mut trace = changed(at, |s| slide(s, 0, 60.0));
    for (index, sample) in trace.samples.iter_mut().enumerate().skip(at + 1) {
        // It falls.
        slide(sample, 0, (index - at) as f64);
        sample.x_wo.translation.vector.z -= 1e-3 * (index - at) as f64;
    }
    let judgement = judge(&trace, &limits());
    assert_eq!((judgement.verdict, judgement.measures.judged), (VerdictKind::Drops, at + 1 - HAND_OVER));
    assert!((value(&judgement, CheckKind::Slip) - 60.0).abs() < 1e-9);
    assert_eq!(value(&judgement, CheckKind::Deflection), 0.0);
    assert!(judgement.checks.iter().all(|check| check.name != CheckKind::Creep));
}

#[test]
fn the_closing_of_the_grippers_and_the_release_are_not_judged() {
    let mut trace = changed(LAST_JUDGED + 1, |s| {
        slide(s, 0, 80.0);
        s.arms[0].torque_demanded_nm[0] = 500.0;
    });
    trace.samples[..HAND_OVER].iter_mut().for_each(|s| {
        slide(s, 0, 80.0);
        s.arms[1].torque_demanded_nm[0] = 500.0;
    });
    let judgement = judge(&trace, &limits());
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert_eq!(judgement.peak_torque_ratio["left_s0"], 0.2);
}

/// A slide at constant rate from the middle of the hold phase on.
fn creeping(rate_mm_s: f64) -> Trace {
    let mut trace = still();
    let middle = SETTLE + RAMP + HOLD / 2;
    for (index, sample) in trace.samples.iter_mut().enumerate().skip(middle) {
        slide(sample, 1, rate_mm_s * (index - middle) as f64 * STEP_S);
    }
    trace
}

#[test]
fn creep_is_the_rate_in_the_second_half_of_the_hold() {
    let judgement = judge(&creeping(0.25), &limits());
    assert_eq!(judgement.verdict, VerdictKind::Creeps);
    // Positions of half a metre are accurate to 1e-16 m; over a tenth of a second the rate is accurate to 1e-12 mm/s.
    assert!((value(&judgement, CheckKind::Creep) - 0.25).abs() < 1e-11);
    assert_eq!(outcome(&creeping(0.25)).1, Some(LAST_JUDGED));

    // A hand that slides early and then stops does not creep.
    let early = changed(SETTLE + RAMP + 5, |s| slide(s, 0, 0.9));
    assert_eq!(value(&judge(&early, &limits()), CheckKind::Creep), 0.0);
    assert_eq!(judge(&early, &limits()).verdict, VerdictKind::Holds);
}

#[test]
fn without_a_hold_there_is_no_creep_to_check() {
    let mut trace = still();
    trace.samples.truncate(SETTLE + RAMP);
    let judgement = judge(&trace, &limits());
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert!(judgement.checks.iter().all(|check| check.name != CheckKind::Creep));
}

#[test]
fn peaks_are_the_largest_demands_whatever_their_sign() {
    let mut trace = still();
    trace.samples[SETTLE + 30].arms[1].torque_demanded_nm[0] = -45.0;
    let judgement = judge(&trace, &limits());
    assert_eq!(judgement.peak_torque_ratio["right_s0"], 0.9);
    assert_eq!(judgement.peak_torque_ratio["left_s0"], 0.2);
    assert_eq!(value(&judgement, CheckKind::TorqueRatio), 0.9);
}

#[test]
fn broken_traces_give_no_verdict_and_a_reason() {
    let reason = |trace: &Trace| {
        let judgement = judge(trace, &limits());
        assert_eq!(judgement.verdict, VerdictKind::NoVerdict);
        assert!(judgement.checks.is_empty());
        assert_eq!(judgement.events.last().unwrap().kind, EventKind::BrokeDown);
        judgement.reason.unwrap()
    };
    let stopped = Trace { broke_down: Some("a pose was lost at 0.31 s".into()), ..still() };
    assert_eq!(reason(&stopped), "a pose was lost at 0.31 s");
    let nan = changed(SETTLE + RAMP, |s| s.arms[0].finger_m[1] = f64::NAN);
    assert_eq!(reason(&nan), "found a number that is not finite in the sample at 0.3 s");
    let odd = changed(SETTLE, |s| s.arms.truncate(1));
    assert_eq!(reason(&odd), "the sample at 0.1 s does not have one entry an arm, joint and pad");
    assert_eq!(reason(&Trace { samples: Vec::new(), ..still() }), "the trace is empty");
    let mut unloaded = still();
    unloaded.samples.truncate(SETTLE);
    assert_eq!(reason(&unloaded), "the load never acted");
    let mut weak = still();
    weak.arms[1].effort_nm[0] = 0.0;
    assert_eq!(reason(&weak), "found a joint of the right arm without torque, expected positive limits");
}

/// A trace with too much slip in the ramp that breaks down in the hold phase.
fn broken_after_a_slip() -> Trace {
    let mut trace = changed(SETTLE + 59, |s| slide(s, 1, 1.5));
    trace.samples.truncate(SETTLE + RAMP + 20);
    Trace { broke_down: Some("the joint speeds have blown up".into()), ..trace }
}

#[test]
fn a_limit_crossed_before_the_breakdown_names_the_verdict() {
    let judgement = judge(&broken_after_a_slip(), &limits());
    assert_eq!((judgement.verdict, judgement.reason), (VerdictKind::Slips, None));
    assert_eq!(judgement.first_failure.unwrap().time_s, (SETTLE + 59) as f64 * STEP_S);
    // The second half of the hold phase is unknown.
    assert!(judgement.checks.iter().all(|check| check.name != CheckKind::Creep));
    let last = judgement.events.last().unwrap();
    assert_eq!(last.kind, EventKind::BrokeDown);
    assert_eq!(last.text, "the simulation ends here: the joint speeds have blown up");
}

#[test]
fn a_breakdown_without_a_crossing_has_no_verdict() {
    let trace = broken_after_a_slip();
    // The same trace under a limit that it keeps until it breaks down.
    let judgement = judge(&trace, &Limits { slip_mm: 2.0, ..limits() });
    assert_eq!(judgement.verdict, VerdictKind::NoVerdict);
    assert_eq!(judgement.reason.unwrap(), "the joint speeds have blown up");
    assert!(judgement.checks.is_empty());
}

#[test]
fn a_crossing_with_failed_self_checks_has_no_verdict() {
    let mut trace = broken_after_a_slip();
    trace.samples[SETTLE + 40].self_check.contact_energy_j = 0.6;
    let judgement = judge(&trace, &limits());
    assert_eq!(judgement.verdict, VerdictKind::NoVerdict);
    assert!(judgement.reason.unwrap().starts_with("the simulation is not valid: energy_created"));
}

#[test]
fn a_number_that_is_not_finite_ends_the_valid_part() {
    let mut slid = changed(SETTLE + 59, |s| slide(s, 1, 1.5));
    slid.samples[SETTLE + RAMP].arms[0].x_oc.translation.vector.x = f64::NAN;
    let judgement = judge(&slid, &limits());
    assert_eq!(judgement.verdict, VerdictKind::Slips);
    assert!(judgement.checks.iter().all(|check| check.value.is_finite()));
    slid.samples[0].time_s = f64::NAN;
    assert_eq!(judge(&slid, &limits()).verdict, VerdictKind::NoVerdict);
}

#[test]
fn a_breakdown_while_settling_has_no_verdict_but_a_loss_then_drops() {
    let broken = |mut trace: Trace| {
        trace.samples.truncate(SETTLE - 5);
        judge(&Trace { broke_down: Some("it is gone".into()), ..trace }, &limits())
    };
    assert_eq!(broken(still()).reason.unwrap(), "it is gone");
    let lost =
        |s: &mut Sample| s.arms.iter_mut().flat_map(|arm| &mut arm.pads).for_each(|pad| pad.normal_force_n = 0.0);
    assert_eq!(broken(changed(SETTLE - 20, lost)).verdict, VerdictKind::Drops);
}

#[test]
fn events_are_the_phases_and_the_first_crossings_in_order() {
    let trace = changed(SETTLE + 59, |s| slide(s, 1, 1.5));
    let texts: Vec<_> = judge(&trace, &limits()).events.into_iter().map(|event| event.text).collect();
    assert_eq!(
        texts,
        [
            "grip: the grippers close on the supported board",
            "settle: the arms carry the board",
            "ramp: the load increases; the tool tip sagged 0.00 mm",
            "right hand slides by more than 1 mm at load factor 0.60",
            "hold: the full load, factor 1.00",
            "release: no load",
        ]
    );
}

#[test]
fn only_equal_traces_have_equal_fingerprints() {
    assert_eq!(fingerprint(&still()), fingerprint(&still()));
    assert_eq!(fingerprint(&still()).len(), 64);
    let one_bit = changed(LAST_JUDGED, |s| s.load_factor = 1.0 + f64::EPSILON);
    assert_ne!(fingerprint(&still()), fingerprint(&one_bit));
    let other_phase = changed(LAST_JUDGED, |s| s.phase = Phase::Hold);
    assert_ne!(fingerprint(&still()), fingerprint(&other_phase));
}

proptest! {
    /// The choice of the world frame must not change any value.
    #[test]
    fn figures_do_not_depend_on_the_world_frame(
        shift in prop::array::uniform3(-2.0..2.0_f64), turn_by in prop::array::uniform3(-3.0..3.0_f64),
        sag_mm in 0.0..4.0_f64, slip_mm in 0.0..0.9_f64, slip_deg in 0.0..1.9_f64,
    ) {
        let trace = changed(SETTLE + 60, |s| {
            slide(s, 0, slip_mm);
            turn(s, 0, slip_deg);
            s.x_wo.translation.vector.z -= sag_mm * 1e-3;
        });
        let x_vw = Isometry3::new(Vector3::from(shift), Vector3::from(turn_by));
        let mut moved = trace.clone();
        moved.samples.iter_mut().for_each(|s| s.x_wo = x_vw * s.x_wo);
        let (here, there) = (judge(&trace, &limits()), judge(&moved, &limits()));
        for (a, b) in here.checks.iter().zip(&there.checks) {
            // Positions of metres, rounded to 1e-15 m, are subtracted: 1e-11 mm leaves a factor of ten.
            prop_assert!((a.value - b.value).abs() < 1e-11);
        }
        prop_assert!((value(&here, CheckKind::Deflection) - sag_mm).abs() < 1e-11);
        prop_assert!((value(&here, CheckKind::Slip) - slip_mm).abs() < 1e-11);
        // The angle is twice an arc tangent of numbers near 1: accurate to 1e-15 rad, or 1e-13 degrees.
        prop_assert!((value(&here, CheckKind::SlipRotation) - slip_deg).abs() < 1e-12);
    }
}

#[test]
fn a_hand_that_follows_a_changing_load_does_not_creep() {
    let mut trace = still();
    for (index, sample) in trace.samples.iter_mut().enumerate().skip(SETTLE + RAMP) {
        slide(sample, 0, 0.01 * (index - SETTLE - RAMP) as f64);
        sample.load_factor = 1.0 - 1e-3 * index as f64;
    }
    let judgement = judge(&trace, &limits());
    assert!(judgement.checks.iter().all(|check| check.name != CheckKind::Creep));
}
