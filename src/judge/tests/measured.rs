//! Measured grippers: their limits, and what of the other checks is left of them.

use super::*;
use crate::model::wrench_limits::{LimitShape, WrenchLimits};

/// 100 N and 10 N m in every direction, half of it in the direction of pulling.
fn measured_limits() -> WrenchLimits {
    let mut limits = WrenchLimits::symmetric(LimitShape::Box, Wrench::from([100.0, 100.0, 100.0, 10.0, 10.0, 10.0]));
    limits.low.force_n.z = -50.0;
    limits
}

/// A still hold in which these arms have measured grippers with a wrench of 0.6 of the limits.
fn measured(arms: &[usize]) -> Trace {
    let mut trace = still();
    for &arm in arms {
        trace.arms[arm].pads.clear();
        trace.arms[arm].grip_force_n = 0.0;
        trace.arms[arm].wrench_limits = Some(measured_limits());
        for sample in &mut trace.samples {
            sample.arms[arm].pads.clear();
            sample.arms[arm].grip_wrench_g = Some(Wrench::from([20.0, 0.0, -30.0, 1.0, 0.0, 0.0]));
        }
    }
    trace
}

/// The hold in which an arm's gripper pulls with this force at a sample and lets go after it.
fn letting_go(mut trace: Trace, arm: usize, at: usize, pull_n: f64) -> Trace {
    trace.samples[at].arms[arm].grip_wrench_g = Some(Wrench::from_force(Vector3::new(0.0, 0.0, -pull_n)));
    trace.samples[at + 1..].iter_mut().for_each(|sample| sample.arms[arm].grip_wrench_g = None);
    trace
}

#[test]
fn each_kind_of_gripper_has_its_own_checks() {
    let names = |arms: &[usize]| {
        let judgement = judge(&measured(arms), &limits());
        assert_eq!(judgement.verdict, VerdictKind::Holds, "{:?}", judgement.reason);
        let has = |kind| judgement.checks.iter().any(|check| check.name == kind);
        [has(CheckKind::GripWrench), has(CheckKind::PadOpen), has(CheckKind::ContactLost), has(CheckKind::Slip)]
    };
    assert_eq!(names(&[]), [false, true, true, true]);
    assert_eq!(names(&[1]), [true, true, true, true]);
    assert_eq!(names(&[0, 1]), [true, false, true, true]);
    let judgement = judge(&measured(&[1]), &limits());
    let check = judgement.checks.iter().find(|check| check.name == CheckKind::GripWrench).unwrap();
    assert_eq!((check.value, check.limit, check.unit.as_str()), (0.6, 1.0, "1"));
}

#[test]
fn a_gripper_beyond_its_limits_detaches() {
    let at = SETTLE + 40;
    // One hand lets go, the other one still holds.
    let trace = letting_go(measured(&[0, 1]), 0, at, 50.1);
    assert_eq!(outcome(&trace), (VerdictKind::Detaches, Some(at)));
    let event = judge(&trace, &limits()).events.into_iter().find(|event| event.text.contains("lets go")).unwrap();
    assert!(
        event.text.starts_with("left hand lets go: its wrench exceeds the measured limits times 1 at"),
        "{}",
        event.text
    );
    // At its limit it holds; that it lets go all the same, at the next sample, is not the judge's business.
    assert_eq!(outcome(&letting_go(measured(&[0, 1]), 0, at, 50.0)).0, VerdictKind::Holds);
    // Both let go, one after the other: the first decides, and the board is lost.
    let both = letting_go(letting_go(measured(&[0, 1]), 0, at, 60.0), 1, at + 5, 70.0);
    let judgement = judge(&both, &limits());
    assert_eq!(judgement.verdict, VerdictKind::Detaches);
    assert_eq!(judgement.measures.judged, at + 5 + 2 - HAND_OVER);
    // A hand that has let go and slides away does not change what came first.
    let mut slid = letting_go(measured(&[0]), 0, at, 60.0);
    slid.samples[at + 3..].iter_mut().for_each(|sample| slide(sample, 0, 5.0));
    assert_eq!(outcome(&slid), (VerdictKind::Detaches, Some(at)));
}

#[test]
fn a_ringing_wrench_is_chatter() {
    let mut trace = measured(&[1]);
    for (index, sample) in trace.samples.iter_mut().enumerate() {
        let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
        sample.arms[1].grip_wrench_g = Some(Wrench::from([60.0 + 15.0 * sign, 0.0, 0.0, 0.0, 0.0, 0.0]));
    }
    let judgement = judge(&trace, &limits());
    assert!(judgement.reason.unwrap().starts_with("the simulation is not valid: chatter 0.150 1, at most 0.1"));
}

#[test]
fn odd_traces_of_measured_grippers_have_no_verdict() {
    let reason = |trace: &Trace| judge(trace, &limits()).reason.unwrap();
    let mut unlimited = measured(&[1]);
    unlimited.arms[1].wrench_limits.as_mut().unwrap().high.moment_nm.y = 0.0;
    assert_eq!(reason(&unlimited), "found wrench limits of the right gripper that do not enclose 0");
    let mut of_pads = still();
    of_pads.samples[60].arms[0].grip_wrench_g = Some(Wrench::default());
    assert!(reason(&of_pads).contains("does not have one entry an arm, joint and pad"), "{}", reason(&of_pads));
    let mut broken = measured(&[1]);
    broken.samples[60].arms[1].grip_wrench_g = Some(Wrench::from([f64::NAN; 6]));
    assert!(reason(&broken).starts_with("found a number that is not finite in the sample at"), "{}", reason(&broken));
}

#[test]
fn the_fingerprint_has_limits_and_wrenches() {
    let print = |change: &dyn Fn(&mut Trace)| {
        let mut trace = measured(&[1]);
        change(&mut trace);
        fingerprint(&trace)
    };
    let same = print(&|_| {});
    assert_ne!(print(&|trace| trace.arms[1].wrench_limits.as_mut().unwrap().low.force_n.x -= 1.0), same);
    assert_ne!(print(&|trace| trace.samples[9].arms[1].grip_wrench_g.as_mut().unwrap().force_n.x += 1e-9), same);
    assert_ne!(print(&|trace| trace.samples[9].arms[1].grip_wrench_g = None), same);
}
