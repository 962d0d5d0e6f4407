//! The checks: each finds its worst value and the first sample at which its limit is crossed.

use std::cmp::Ordering;

use nalgebra::Vector3;

use crate::model::{
    measures::{HandMeasures, JointMeasures, Measures},
    scenario::Limits,
    trace::{Phase, Sample, Trace},
    verdict::{Check, CheckKind},
};

/// A pad counts as open below this share of the grip force (docs/method.md#86-contact).
pub(super) const OPEN_SHARE: f64 = 0.05;

/// Limit of the time that a pad is open, ms (docs/method.md#86-contact).
pub(super) const OPEN_LIMIT_MS: f64 = 30.0;

/// Limit of the ratio of a measured gripper's wrench to its limits.
pub(super) const GRIP_WRENCH_LIMIT: f64 = 1.0;

/// Limit of the time without any contact, ms (docs/method.md#86-contact).
pub(super) const CONTACT_LOST_LIMIT_MS: f64 = 0.0;

/// Limit of the overlap of robot and board with the person, mm (docs/method.md#87-person-overlap).
pub(super) const PERSON_OVERLAP_LIMIT_MM: f64 = 0.0;

/// The least permitted distance of the robot from itself and from the board, mm (docs/method.md#811-clearance).
pub(super) const CLEARANCE_LIMIT_MM: f64 = 0.0;

/// Slip above which the board counts as dropped, mm (docs/method.md#86-contact).
pub(super) const DROP_MM: f64 = 50.0;

/// The order of checks that are crossed at the same sample; the first one determines the verdict: loss of the board,
/// then the contacts, then consequences.
pub(super) const PRECEDENCE: [CheckKind; 12] = [
    CheckKind::Drop,
    CheckKind::ContactLost,
    CheckKind::GripWrench,
    CheckKind::PadOpen,
    CheckKind::Slip,
    CheckKind::SlipRotation,
    CheckKind::Clearance,
    CheckKind::TorqueRatio,
    CheckKind::Sag,
    CheckKind::Deflection,
    CheckKind::PersonOverlap,
    CheckKind::Creep,
];

/// A check and its first crossing, if it failed.
pub(super) struct Finding {
    /// Value, limit and margin.
    pub check: Check,
    /// The first crossing of the limit.
    pub crossing: Option<Crossing>,
}

/// The first sample at which a limit is crossed.
pub(super) struct Crossing {
    /// Index into the judged samples.
    pub sample: usize,
    /// The hand, pad or joint that crossed it; empty for the board.
    pub what: String,
}

/// A measured series that a limit applies to.
struct Series {
    /// The hand, pad or joint; empty for the board.
    what: String,
    /// One value for each judged sample.
    values: Vec<f64>,
}

impl Series {
    fn new(what: String, values: &[f64]) -> Self {
        Self { what, values: values.to_vec() }
    }
}

/// Every check, in the order of tables. `judged` are the samples from the hand-over to the end of the load or the loss of
/// the board; `measures` starts at the same sample. Creep is left out if the hold phase is too short for a slope, if its load is not constant
/// (a hand that follows the load does not creep), or if `is_complete` is false (the second half of the hold phase is
/// not known).
pub(super) fn findings(
    trace: &Trace,
    judged: &[Sample],
    measures: &Measures,
    limits: &Limits,
    is_complete: bool,
) -> Vec<Finding> {
    let count = judged.len();
    let hand = |kind, limit, series: fn(&HandMeasures) -> &[f64]| {
        let series = |hand: &HandMeasures| Series::new(format!("{} hand", hand.name), &series(hand)[..count]);
        sampled(kind, limit, measures.hands.iter().map(series).collect())
    };
    let board = |kind, limit, values: &[f64]| sampled(kind, limit, vec![Series::new(String::new(), &values[..count])]);
    let joint = |joint: &JointMeasures| Series::new(joint.name.clone(), &joint.torque_ratio[..count]);
    let mut findings = vec![
        hand(CheckKind::Slip, limits.slip_mm, |hand| &hand.slip_mm),
        hand(CheckKind::SlipRotation, limits.slip_deg, |hand| &hand.slip_deg),
        board(CheckKind::Sag, limits.sag_mm, &measures.sag_mm),
        board(CheckKind::Deflection, limits.deflection_mm, &measures.deflection_mm),
    ];
    findings.extend(if is_complete { creep(trace, judged, limits.creep_mm_s) } else { None });
    findings.push(sampled(CheckKind::TorqueRatio, limits.torque_ratio, measures.joints.iter().map(joint).collect()));
    let measured = measures.hands.iter().filter(|hand| !hand.grip_ratio.is_empty());
    let grip = |hand: &HandMeasures| Series::new(format!("{} hand", hand.name), &hand.grip_ratio[..count]);
    // Neither of a hand with pads nor of a measured one is there what only the other has.
    findings.extend(some(measured.map(grip).collect(), CheckKind::GripWrench, GRIP_WRENCH_LIMIT));
    findings.extend(some(pad_open_series(trace, judged), CheckKind::PadOpen, OPEN_LIMIT_MS));
    findings.extend([
        sampled(CheckKind::ContactLost, CONTACT_LOST_LIMIT_MS, vec![contact_lost_series(judged)]),
        hand(CheckKind::Drop, DROP_MM, |hand| &hand.slip_mm),
    ]);
    findings.extend(person_overlap(trace, judged));
    findings.extend(clearance(trace, measures.clearance_mm.get(..count)));
    findings
}

/// The finding that determines the verdict: the earliest crossing; of two at the same sample, the first in
/// [`PRECEDENCE`].
pub(super) fn first_failure(findings: &[Finding]) -> Option<(&Finding, &Crossing)> {
    let rank = |kind| PRECEDENCE.iter().position(|&other| other == kind);
    findings
        .iter()
        .filter_map(|finding| finding.crossing.as_ref().map(|crossing| (finding, crossing)))
        .min_by_key(|(finding, crossing)| (crossing.sample, rank(finding.check.name)))
}

/// For each pad the time for which it has been open at each sample, ms.
fn pad_open_series(trace: &Trace, judged: &[Sample]) -> Vec<Series> {
    let pad_series = |arm: usize, pad: usize| {
        let least_force_n = OPEN_SHARE * trace.arms[arm].grip_force_n;
        Series {
            what: format!("{} {} pad", trace.arms[arm].name, trace.arms[arm].pads[pad]),
            values: duration_ms(judged, |sample| sample.arms[arm].pads[pad].normal_force_n < least_force_n),
        }
    };
    (0..trace.arms.len())
        .flat_map(|arm| (0..trace.arms[arm].pads.len()).map(move |pad| (arm, pad)))
        .map(|(arm, pad)| pad_series(arm, pad))
        .collect()
}

/// The time without contact of any hand at each sample, ms.
fn contact_lost_series(judged: &[Sample]) -> Series {
    Series { what: String::new(), values: duration_ms(judged, |sample| !sample.has_contact()) }
}

/// The overlap of robot or board with the person; `None` if the plan has no person.
fn person_overlap(trace: &Trace, judged: &[Sample]) -> Option<Finding> {
    let overlaps_mm: Vec<f64> = judged.iter().map(|s| s.person_distance_m.map(|m| -1e3 * m)).collect::<Option<_>>()?;
    let deepest = overlaps_mm.iter().copied().reduce(f64::max)?;
    let crossing = overlaps_mm
        .iter()
        .position(|&mm| is_crossed(CheckKind::PersonOverlap, mm, PERSON_OVERLAP_LIMIT_MM))
        .map(|sample| Crossing {
            sample,
            what: trace
                .person_touch
                .as_ref()
                .map_or(String::new(), |touch| format!("{} and {}", touch.body, touch.part)),
        });
    Some(Finding { check: check(CheckKind::PersonOverlap, deepest, PERSON_OVERLAP_LIMIT_MM), crossing })
}

/// The least distance of the robot from itself and from the board; `None` if it was not measured.
fn clearance(trace: &Trace, distances_mm: Option<&[f64]>) -> Option<Finding> {
    let (kind, limit_mm, distances_mm) = (CheckKind::Clearance, CLEARANCE_LIMIT_MM, distances_mm?);
    let least_mm = distances_mm.iter().copied().reduce(f64::min)?;
    let crossing = distances_mm.iter().position(|&mm| is_crossed(kind, mm, limit_mm)).map(|sample| Crossing {
        sample,
        what: trace.robot_touch.as_ref().map_or(String::new(), |bodies| bodies.join(" and ")),
    });
    Some(Finding { check: check(kind, least_mm, limit_mm), crossing })
}

/// The time for which a condition has been true at each sample, ms; 0 where it is false. A sample's forces are those of
/// the step before it, so that step counts. The step before the first sample is not judged; the length of the next one,
/// or a microsecond, is used, so that a condition that is true from the start counts.
fn duration_ms(judged: &[Sample], condition: impl Fn(&Sample) -> bool) -> Vec<f64> {
    let step_before_s = |index: usize| match index {
        0 => judged.get(1).map_or(1e-6, |next| next.time_s - judged[0].time_s),
        _ => judged[index].time_s - judged[index - 1].time_s,
    };
    let mut lasted_s = 0.0;
    let lasted = |(index, sample)| {
        lasted_s = if condition(sample) { lasted_s + step_before_s(index) } else { 0.0 };
        // Rounded to the microsecond, so that fifteen steps of 2 ms are exactly 30 ms.
        (lasted_s * 1e6_f64).round() / 1e3
    };
    judged.iter().enumerate().map(lasted).collect()
}

/// The check of a limit on the largest of several series; `None` without a series.
fn some(series: Vec<Series>, kind: CheckKind, limit: f64) -> Option<Finding> {
    (!series.is_empty()).then(|| sampled(kind, limit, series))
}

/// The check of a limit on the largest of several series.
fn sampled(kind: CheckKind, limit: f64, series: Vec<Series>) -> Finding {
    let worst = series.iter().flat_map(|series| &series.values).fold(0.0_f64, |worst, &value| worst.max(value));
    let crossing = series
        .into_iter()
        .filter_map(|series| {
            let sample = series.values.iter().position(|&value| is_crossed(kind, value, limit))?;
            Some(Crossing { sample, what: series.what })
        })
        .min_by_key(|crossing| crossing.sample);
    Finding { check: check(kind, worst, limit), crossing }
}

/// Creep (docs/method.md#84-creep): the least-squares slope of each hand's position on the board over the second half
/// of the hold phase, mm/s. It is known, and crosses its limit, at the last sample of the hold phase.
fn creep(trace: &Trace, judged: &[Sample], limit: f64) -> Option<Finding> {
    let hold_start = judged.iter().position(|sample| sample.phase == Phase::Hold)?;
    let middle_s = (judged[hold_start].time_s + judged[judged.len() - 1].time_s) / 2.0;
    let half = &judged[judged.partition_point(|sample| sample.time_s < middle_s)..];
    let steady = |sample: &Sample| sample.load_factor == half[0].load_factor && sample.p_ot_m == half[0].p_ot_m;
    if half.len() < 2 || !half.iter().all(steady) {
        return None;
    }
    let rates_mm_s = (0..trace.arms.len()).map(|arm| 1e3 * slope(half, |s| s.arms[arm].x_oc.translation.vector).norm());
    let (arm, worst) = rates_mm_s.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let crossing = is_crossed(CheckKind::Creep, worst, limit)
        .then(|| Crossing { sample: judged.len() - 1, what: format!("{} hand", trace.arms[arm].name) });
    Some(Finding { check: check(CheckKind::Creep, worst, limit), crossing })
}

/// Least-squares slope over time: `sum (t - mean t) v / sum (t - mean t)^2`.
fn slope(samples: &[Sample], value: impl Fn(&Sample) -> Vector3<f64>) -> Vector3<f64> {
    let mean_s = samples.iter().map(|sample| sample.time_s).sum::<f64>() / samples.len() as f64;
    // Relative to the first value: otherwise rounding of a position of decimetres hides a creep of nanometres.
    let start = value(&samples[0]);
    let (mut numerator, mut denominator) = (Vector3::zeros(), 0.0);
    for sample in samples {
        let t = sample.time_s - mean_s;
        numerator += (value(sample) - start) * t;
        denominator += t * t;
    }
    numerator / denominator
}

/// A value equal to its limit does not cross it; NaN does.
fn is_crossed(kind: CheckKind, value: f64, limit: f64) -> bool {
    kind.margin(value, limit).partial_cmp(&0.0).is_none_or(Ordering::is_lt)
}

pub(super) fn check(kind: CheckKind, value: f64, limit: f64) -> Check {
    Check {
        name: kind,
        value,
        limit,
        margin: kind.margin(value, limit),
        unit: kind.unit().to_owned(),
        passed: !is_crossed(kind, value, limit),
    }
}
