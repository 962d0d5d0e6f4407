//! The stages of a task in a row, in the form of one hold, for recordings and MCAP files.

use std::collections::BTreeMap;

use super::task_recording::TaskRecording;
use crate::{
    judge::{Judgement, StageJudgement, fingerprint},
    model::{
        FORMAT,
        measures::{Event, EventKind, HandMeasures, JointMeasures, Measures},
        staged_verdict::StagedVerdict,
        trace::Trace,
        verdict::{Check, Verdict},
    },
};

/// Time between two samples of a task's recording, s.
const TASK_SAMPLE_S: f64 = 0.01;

/// The stages of a task in a row: a sample each 10 ms, the first one of each stage, and that at which the task fails.
pub struct TaskSeries {
    /// The thinned trace.
    pub trace: Trace,
    /// The judge's series, at the same samples up to the end of the last stage that was judged.
    pub measures: Measures,
    /// The beginning of each stage, and the limits that are crossed.
    pub events: Vec<Event>,
    /// The verdict in the form of that of one hold.
    pub verdict: Verdict,
}

impl TaskSeries {
    /// Those of a task; `None` without a step.
    #[must_use]
    pub fn of(task: &TaskRecording<'_>) -> Option<Self> {
        let kept = kept_samples(task)?;
        let samples = kept.iter().map(|&sample| task.trace.trace.samples[sample].clone()).collect();
        let trace = Trace { samples, ..task.trace.trace.clone() };
        let verdict = verdict_of_task(task, fingerprint(&trace));
        Some(Self {
            measures: measures_of_stages(task.judgements, &kept),
            events: events_of_stages(task),
            verdict,
            trace,
        })
    }
}

/// The numbers of the samples that are kept, ascending; `None` without a step.
fn kept_samples(task: &TaskRecording<'_>) -> Option<Vec<usize>> {
    let samples = &task.trace.trace.samples;
    let [start, second, ..] = &samples[..] else { return None };
    // That of the simulation that decides, which may be shorter than the scenario's.
    let timestep_s = second.time_s - start.time_s;
    let every = ((TASK_SAMPLE_S / timestep_s).round() as usize).max(1);
    let failure_s = task.verdict.failed.as_ref().and_then(|failed| Some(failed.first_failure.as_ref()?.time_s));
    let begins = |sample: usize| task.trace.spans.iter().any(|span| span.first == sample);
    let is_kept = |&sample: &usize| {
        sample.is_multiple_of(every)
            || begins(sample)
            || failure_s.is_some_and(|time_s| samples[sample].time_s == time_s)
    };
    Some((0..samples.len()).filter(is_kept).collect())
}

/// The measures of all stages in a row, at the samples of the task that are kept.
fn measures_of_stages(judgements: &[StageJudgement], kept: &[usize]) -> Measures {
    let mut all = Measures::default();
    for StageJudgement { span, judgement: Judgement { measures, .. } } in judgements {
        let own: Vec<usize> = kept
            .iter()
            .filter(|&&sample| (span.first..=span.last).contains(&sample))
            .map(|sample| sample - span.first)
            .collect();
        let thin = |values: &[f64]| own.iter().filter_map(|&sample| values.get(sample)).copied().collect::<Vec<_>>();
        if all.hands.is_empty() {
            let empty = |hand: &HandMeasures| HandMeasures { name: hand.name.clone(), ..HandMeasures::default() };
            all.hands = measures.hands.iter().map(empty).collect();
            let empty = |joint: &JointMeasures| JointMeasures { name: joint.name.clone(), torque_ratio: Vec::new() };
            all.joints = measures.joints.iter().map(empty).collect();
        }
        all.time_s.extend(thin(&measures.time_s));
        all.load_factor.extend(thin(&measures.load_factor));
        all.sag_mm.extend(thin(&measures.sag_mm));
        all.deflection_mm.extend(thin(&measures.deflection_mm));
        all.clearance_mm.extend(thin(&measures.clearance_mm));
        for (hand, own) in all.hands.iter_mut().zip(&measures.hands) {
            hand.slip_mm.extend(thin(&own.slip_mm));
            hand.slip_deg.extend(thin(&own.slip_deg));
            hand.grip_ratio.extend(thin(&own.grip_ratio));
        }
        for (joint, own) in all.joints.iter_mut().zip(&measures.joints) {
            joint.torque_ratio.extend(thin(&own.torque_ratio));
        }
    }
    all.judged = all.time_s.len();
    all
}

/// The beginning of each stage, and the limits that are crossed.
fn events_of_stages(task: &TaskRecording<'_>) -> Vec<Event> {
    let samples = &task.trace.trace.samples;
    let of_stage = |StageJudgement { span, judgement }: &StageJudgement| {
        let kind = task.plan.stages[span.stage].name();
        let text = format!("stage {}: {kind}", span.stage + 1);
        let begin = Event { time_s: samples[span.first].time_s, kind: EventKind::Phase, text, what: String::new() };
        let crossed = judgement.events.iter().filter(|event| event.kind != EventKind::Phase).cloned();
        std::iter::once(begin).chain(crossed).collect::<Vec<_>>()
    };
    task.judgements.iter().flat_map(of_stage).collect()
}

/// The verdict of a task in the form of a plan of one hold: of each check that with the least margin.
fn verdict_of_task(task: &TaskRecording<'_>, fingerprint: String) -> Verdict {
    let StagedVerdict { criteria, name, verdict, expected, met, failed, confirmation, stages, versions, seed, .. } =
        task.verdict.clone();
    let mut checks: Vec<Check> = Vec::new();
    for check in stages.iter().flat_map(|stage| &stage.checks) {
        match checks.iter_mut().find(|other| other.name == check.name) {
            Some(other) if check.margin < other.margin => *other = check.clone(),
            Some(_) => {}
            None => checks.push(check.clone()),
        }
    }
    Verdict {
        format: FORMAT,
        criteria,
        name,
        verdict,
        expected,
        met,
        checks,
        self_checks: Vec::new(),
        first_failure: failed.as_ref().and_then(|failed| failed.first_failure.clone()),
        peak_torque_ratio: BTreeMap::new(),
        confirmation,
        reason: failed.map(|failed| format!("stage {} ({}): {}", failed.stage, failed.kind, failed.reason)),
        notes: vec!["the recording of a task has a sample each 10 ms".into()],
        muscles: None,
        versions,
        seed,
        fingerprint,
    }
}
