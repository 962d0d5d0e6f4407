//! Makes the recording of a run. The shape of the person is computed here, because `record` does not depend on `human`.

use super::{Run, RunError, task_recording::TaskRecording, task_series::TaskSeries};
use crate::{
    check::{CheckedPerson, CheckedPlan},
    human::BodyPart,
    model::{muscle_work::MuscleBelly, operation::OperationKind, scenario::Scenario, staged_plan::PersonDuring},
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

/// The bytes of a task's recording, with a sample each 10 ms; `None` without a piece or a step.
///
/// # Errors
/// If the recording cannot be made.
pub fn encode_task(task: &TaskRecording<'_>) -> Result<Option<Vec<u8>>, RunError> {
    let TaskRecording { scenario, robot, pieces, .. } = task;
    let (Some(first), Some(series)) = (pieces.first(), TaskSeries::of(task)) else { return Ok(None) };
    let people = people(task)?;
    let input = RecordingInput {
        robot,
        scenario,
        plan: &first.plan,
        trace: &series.trace,
        measures: &series.measures,
        events: &series.events,
        verdict: &series.verdict,
        person: people.first().map(|(_, person)| person),
        people: &people,
    };
    Ok(Some(record::encode(&input)?))
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
