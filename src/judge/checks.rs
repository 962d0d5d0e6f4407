//! The checks: each finds its worst value and the first moment at which its limit was crossed.

use std::cmp::Ordering;

use nalgebra::Vector3;

use crate::model::{
    measures::{HandMeasures, JointMeasures, Measures},
    scenario::Limits,
    trace::{Phase, Sample, Trace},
    verdict::{Check, CheckKind},
};

/// Below this share of the grip force a pad counts as open (METHOD section 8).
const OPEN_SHARE: f64 = 0.05;

/// How long a pad may be open, ms (METHOD section 8).
const OPEN_LIMIT_MS: f64 = 30.0;

/// How long the board may be without any contact, ms: not at all (METHOD section 8).
const CONTACT_LOST_LIMIT_MS: f64 = 0.0;

/// How far robot and board may reach into the person, mm: not at all.
const PERSON_OVERLAP_LIMIT_MM: f64 = 0.0;

/// Slip at which the board counts as dropped, mm (METHOD section 8).
const DROP_MM: f64 = 50.0;

/// Which check names the verdict when two cross at the same sample: the loss of the board first, then what happens at
/// the contacts, then what follows from it.
const PRECEDENCE: [CheckKind; 9] = [
    CheckKind::Drop,
    CheckKind::ContactLost,
    CheckKind::PadOpen,
    CheckKind::Slip,
    CheckKind::SlipRotation,
    CheckKind::TorqueRatio,
    CheckKind::Deflection,
    CheckKind::PersonOverlap,
    CheckKind::Creep,
];

/// A check and, when it failed, its first crossing.
pub(super) struct Finding {
    /// Value, limit and margin.
    pub check: Check,
    /// When the limit was crossed first.
    pub crossing: Option<Crossing>,
}

/// The first moment at which a limit was crossed.
pub(super) struct Crossing {
    /// Index into the judged samples.
    pub sample: usize,
    /// What crossed it: a hand, a pad or a joint; empty for the board.
    pub what: String,
}

/// One measured series under a limit.
struct Series {
    /// The hand, pad or joint; empty for the board.
    what: String,
    /// One entry a judged sample.
    values: Vec<f64>,
}

impl Series {
    fn new(what: String, values: &[f64]) -> Self {
        Self { what, values: values.to_vec() }
    }
}

/// Every check, in the order of tables. `judged` are the samples from the reference to the end of the load, and
/// `measures` begins at the same sample. Creep is left out when the hold is too short to have a
/// slope, or its load does not stay the same: a hand that follows the load does not creep. So it is where the hold was cut
/// short, `to_the_end` being false: the second half of it is not known.
pub(super) fn findings(
    trace: &Trace,
    judged: &[Sample],
    measures: &Measures,
    limits: &Limits,
    to_the_end: bool,
) -> Vec<Finding> {
    let count = judged.len();
    let hand = |kind, limit, series: fn(&HandMeasures) -> &[f64]| {
        let series = |hand: &HandMeasures| Series::new(format!("{} hand", hand.name), &series(hand)[..count]);
        sampled(kind, limit, measures.hands.iter().map(series).collect())
    };
    let deflection = Series::new(String::new(), &measures.deflection_mm[..count]);
    let joint = |joint: &JointMeasures| Series::new(joint.name.clone(), &joint.torque_ratio[..count]);
    let mut findings = vec![
        hand(CheckKind::Slip, limits.slip_mm, |hand| &hand.slip_mm),
        hand(CheckKind::SlipRotation, limits.slip_deg, |hand| &hand.slip_deg),
        sampled(CheckKind::Deflection, limits.deflection_mm, vec![deflection]),
    ];
    findings.extend(if to_the_end { creep(trace, judged, limits.creep_mm_s) } else { None });
    findings.extend([
        sampled(CheckKind::TorqueRatio, limits.torque_ratio, measures.joints.iter().map(joint).collect()),
        sampled(CheckKind::PadOpen, OPEN_LIMIT_MS, pad_open_series(trace, judged)),
        sampled(CheckKind::ContactLost, CONTACT_LOST_LIMIT_MS, vec![contact_lost_series(judged)]),
        hand(CheckKind::Drop, DROP_MM, |hand| &hand.slip_mm),
    ]);
    findings.extend(person_overlap(trace, judged));
    findings
}

/// The finding that names the verdict: the earliest crossing; of two at the same sample, the first in [`PRECEDENCE`].
pub(super) fn first_failure(findings: &[Finding]) -> Option<(&Finding, &Crossing)> {
    let rank = |kind| PRECEDENCE.iter().position(|&other| other == kind);
    findings
        .iter()
        .filter_map(|finding| finding.crossing.as_ref().map(|crossing| (finding, crossing)))
        .min_by_key(|(finding, crossing)| (crossing.sample, rank(finding.check.name)))
}

/// For each pad, how long it has been open at each sample, ms.
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

/// How long no pad of any hand has touched the board at each sample, ms.
fn contact_lost_series(judged: &[Sample]) -> Series {
    Series { what: String::new(), values: duration_ms(judged, |sample| !sample.has_contact()) }
}

/// How deep robot or board reach into the person; none when nobody stands there.
fn person_overlap(trace: &Trace, judged: &[Sample]) -> Option<Finding> {
    let overlaps_mm: Vec<f64> = judged.iter().map(|s| s.person_distance_m.map(|m| -1e3 * m)).collect::<Option<_>>()?;
    let deepest = overlaps_mm.iter().copied().reduce(f64::max)?;
    let crossing = overlaps_mm.iter().position(|&mm| is_crossed(mm, PERSON_OVERLAP_LIMIT_MM)).map(|sample| Crossing {
        sample,
        what: trace.person_touch.as_ref().map_or(String::new(), |touch| format!("{} and {}", touch.body, touch.part)),
    });
    Some(Finding { check: check(CheckKind::PersonOverlap, deepest, PERSON_OVERLAP_LIMIT_MM), crossing })
}

/// How long a condition has lasted at each sample, ms: 0 where it does not hold. A sample's forces are those of the
/// step that led to it, so its own step counts; the first sample's step lies before the judged span, yet a hold that
/// begins in the condition must not count as free of it, so the step after it stands in.
fn duration_ms(judged: &[Sample], condition: impl Fn(&Sample) -> bool) -> Vec<f64> {
    let step_before_s = |index: usize| match index {
        0 => judged.get(1).map_or(0.0, |next| next.time_s - judged[0].time_s),
        _ => judged[index].time_s - judged[index - 1].time_s,
    };
    let mut lasted_s = 0.0;
    let lasted = |(index, sample)| {
        lasted_s = if condition(sample) { lasted_s + step_before_s(index) } else { 0.0 };
        // To the microsecond, so that fifteen steps of 2 ms are 30 ms and not one rounding more.
        (lasted_s * 1e6_f64).round() / 1e3
    };
    judged.iter().enumerate().map(lasted).collect()
}

/// The check of a limit on the largest of several series.
fn sampled(kind: CheckKind, limit: f64, series: Vec<Series>) -> Finding {
    let worst = series.iter().flat_map(|series| &series.values).fold(0.0_f64, |worst, &value| worst.max(value));
    let crossing = series
        .into_iter()
        .filter_map(|series| {
            let sample = series.values.iter().position(|&value| is_crossed(value, limit))?;
            Some(Crossing { sample, what: series.what })
        })
        .min_by_key(|crossing| crossing.sample);
    Finding { check: check(kind, worst, limit), crossing }
}

/// Creep: the least-squares slope of each hand's position on the board over the second half of the hold, mm/s. It is
/// known, and so crosses its limit, at the hold's last sample.
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
    let crossing = is_crossed(worst, limit)
        .then(|| Crossing { sample: judged.len() - 1, what: format!("{} hand", trace.arms[arm].name) });
    Some(Finding { check: check(CheckKind::Creep, worst, limit), crossing })
}

/// Least-squares slope over time: `sum (t - mean t) v / sum (t - mean t)^2`.
fn slope(samples: &[Sample], value: impl Fn(&Sample) -> Vector3<f64>) -> Vector3<f64> {
    let mean_s = samples.iter().map(|sample| sample.time_s).sum::<f64>() / samples.len() as f64;
    // Measured from the first value: a position of decimetres would drown a creep of nanometres in rounding.
    let start = value(&samples[0]);
    let (mut numerator, mut denominator) = (Vector3::zeros(), 0.0);
    for sample in samples {
        let t = sample.time_s - mean_s;
        numerator += (value(sample) - start) * t;
        denominator += t * t;
    }
    numerator / denominator
}

/// A value at its limit keeps it; one that cannot be compared does not.
fn is_crossed(value: f64, limit: f64) -> bool {
    value.partial_cmp(&limit).is_none_or(Ordering::is_gt)
}

pub(super) fn check(kind: CheckKind, value: f64, limit: f64) -> Check {
    Check {
        name: kind,
        value,
        limit,
        margin: limit - value,
        unit: kind.unit().to_owned(),
        passed: !is_crossed(value, limit),
    }
}
