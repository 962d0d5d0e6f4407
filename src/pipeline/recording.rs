//! Makes the recording of a run. The shape of the person is computed here, because `record` does not depend on `human`.

use std::collections::BTreeMap;

use super::{Run, RunError, task_recording::TaskRecording};
use crate::{
    check::{CheckedPerson, CheckedPlan},
    human::BodyPart,
    judge::{Judgement, StageJudgement, fingerprint},
    model::{
        FORMAT,
        measures::{Event, EventKind, HandMeasures, JointMeasures, Measures},
        muscle_work::MuscleBelly,
        operation::OperationKind,
        scenario::Scenario,
        staged_plan::PersonDuring,
        staged_verdict::StagedVerdict,
        trace::Trace,
        verdict::{Check, Verdict},
    },
    record::{self, Capsule, PersonShape, RecordingInput},
    robot::Robot,
    sim::step_back_w,
};

/// The bytes of a run's recording; `None` if nothing was simulated.
///
/// # Errors
/// If the recording cannot be made.
pub fn encode(run: &Run, scenario: &Scenario, robot: &Robot) -> Result<Option<Vec<u8>>, RunError> {
    let (Some(plan), Some((trace, judgement))) = (&run.plan, &run.simulated) else { return Ok(None) };
    let checked = CheckedPlan::new(robot, plan, &scenario.human, &scenario.tool)?;
    let person = checked.person().map(|person| person_shape(person, plan.operation.kind, checked.muscle_bellies_w()));
    let input = RecordingInput {
        robot,
        scenario,
        plan,
        trace,
        measures: &judgement.measures,
        events: &judgement.events,
        verdict: &run.verdict,
        person: person.as_ref(),
        people: &[],
    };
    Ok(Some(record::encode(&input)?))
}

/// Time between two samples of a task's recording, s.
const TASK_SAMPLE_S: f64 = 0.01;

/// The bytes of a task's recording, with a sample each 10 ms; `None` without a piece or a step.
///
/// # Errors
/// If the recording cannot be made.
pub fn encode_task(task: &TaskRecording<'_>) -> Result<Option<Vec<u8>>, RunError> {
    let TaskRecording { scenario, robot, pieces, trace, judgements, .. } = task;
    let (Some(first), [start, second, ..]) = (pieces.first(), &trace.trace.samples[..]) else { return Ok(None) };
    // That of the simulation that decides, which may be shorter than the scenario's.
    let timestep_s = second.time_s - start.time_s;
    let every = ((TASK_SAMPLE_S / timestep_s).round() as usize).max(1);
    let samples = trace.trace.samples.iter().step_by(every).cloned().collect();
    let thinned = Trace { samples, ..trace.trace.clone() };
    let measures = measures_of_stages(judgements, every);
    let events = events_of_stages(task);
    let people = people(task)?;
    let verdict = verdict_of_task(task, fingerprint(&thinned));
    let input = RecordingInput {
        robot,
        scenario,
        plan: &first.plan,
        trace: &thinned,
        measures: &measures,
        events: &events,
        verdict: &verdict,
        person: people.first().map(|(_, person)| person),
        people: &people,
    };
    Ok(Some(record::encode(&input)?))
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

/// The person from each time on at which they work on another piece, step back or come forward.
fn people(task: &TaskRecording<'_>) -> Result<Vec<(f64, PersonShape)>, RunError> {
    let TaskRecording { scenario, robot, plan, pieces, trace, .. } = task;
    let mut people = Vec::new();
    let mut now = None;
    for span in &trace.spans {
        let during = plan.stages[span.stage].person();
        for sample in span.first..=span.last {
            let next = Some((trace.pieces[sample], during));
            if now == next {
                continue;
            }
            now = next;
            let Some(piece) = pieces.get(trace.pieces[sample]) else { continue };
            let checked = CheckedPlan::new(robot, &piece.plan, &scenario.human, &scenario.tool)?;
            let Some(person) = checked.person() else { continue };
            let mut posture = *person.posture;
            let muscles = match during {
                PersonDuring::Stays => checked.muscle_bellies_w(),
                PersonDuring::StepsBack => {
                    posture.x_wb.translation.vector += step_back_w(&checked.person_parts());
                    Vec::new()
                }
            };
            let moved = CheckedPerson { posture: &posture, human: person.human.clone() };
            let shape = person_shape(&moved, piece.plan.operation.kind, muscles);
            people.push((trace.trace.samples[sample].time_s, shape));
        }
    }
    Ok(people)
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

/// The person and the tool as they are drawn.
fn person_shape(
    CheckedPerson { posture, human }: &CheckedPerson,
    kind: OperationKind,
    muscles: Vec<MuscleBelly>,
) -> PersonShape {
    let (x_wb, q_rad) = (&posture.x_wb, &posture.q_rad);
    let body = human.capsules_w(x_wb, q_rad).into_iter().filter(|capsule| capsule.name != BodyPart::Tool);
    PersonShape {
        capsules: body
            .map(|capsule| Capsule { ends_w: [capsule.p0_w, capsule.p1_w], radius_m: capsule.radius_m })
            .collect(),
        eyes_w: human.eyes_w(x_wb),
        line_of_sight_w: human.line_of_sight_w(x_wb, q_rad),
        sector_w: human.sector_w(x_wb),
        tool: human.tool_parts_w(x_wb, q_rad, kind),
        muscles,
        points_w: human.body_points_w(x_wb, q_rad).to_vec(),
    }
}
