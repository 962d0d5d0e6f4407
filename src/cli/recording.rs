//! Makes the recording of a run. The shape of the person is computed here, because `record` does not depend on `human`.

use super::{exit::CliError, pipeline::Run};
use crate::{
    check::{CheckedPerson, CheckedPlan},
    human::BodyPart,
    model::{muscle_work::MuscleBelly, operation::OperationKind, scenario::Scenario},
    record::{self, Capsule, PersonShape, RecordingInput},
    robot::Robot,
};

/// The bytes of a run's recording; `None` if nothing was simulated.
///
/// # Errors
/// If the recording cannot be made.
pub fn encode(run: &Run, scenario: &Scenario, robot: &Robot) -> Result<Option<Vec<u8>>, CliError> {
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
    };
    Ok(Some(record::encode(&input)?))
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
