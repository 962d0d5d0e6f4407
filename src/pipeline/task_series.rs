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

/// The stages of a task in a row, with a sample each 10 ms.
pub struct TaskSeries {
    /// The thinned trace.
    pub trace: Trace,
    /// The judge's series, at the same samples.
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
        let [start, second, ..] = &task.trace.trace.samples[..] else { return None };
        // That of the simulation that decides, which may be shorter than the scenario's.
        let timestep_s = second.time_s - start.time_s;
        let every = ((TASK_SAMPLE_S / timestep_s).round() as usize).max(1);
        let samples = task.trace.trace.samples.iter().step_by(every).cloned().collect();
        let trace = Trace { samples, ..task.trace.trace.clone() };
        let verdict = verdict_of_task(task, fingerprint(&trace));
        Some(Self {
            measures: measures_of_stages(task.judgements, every),
            events: events_of_stages(task),
            verdict,
            trace,
        })
    }
}

/// The measures of all stages in a row, each n-th sample.
fn measures_of_stages(judgements: &[StageJudgement], every: usize) -> Measures {
    let mut all = Measures::default();
    for StageJudgement { judgement: Judgement { measures, .. }, .. } in judgements {
        let thin = |values: &[f64]| values.iter().step_by(every).copied().collect::<Vec<_>>();
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
