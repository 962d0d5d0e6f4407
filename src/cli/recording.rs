//! Makes the recording of a run. The shape of the person is computed here, because `record` does not depend on `human`.

use nalgebra::Point3;

use super::{exit::CliError, pipeline::Run};
use crate::{
    check::{CheckedPerson, CheckedPlan},
    human::BodyPart,
    model::scenario::Scenario,
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
    let person = checked.person().map(|CheckedPerson { posture, human }| {
        let points_w = human.body_points_w(&posture.x_wb, &posture.q_rad).to_vec();
        person_shape(&human.capsules_w(&posture.x_wb, &posture.q_rad), points_w)
    });
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

/// The shape of the person without the tool, which the recorder draws from the palm to the board.
fn person_shape(capsules: &[crate::human::Capsule], points_w: Vec<Point3<f64>>) -> PersonShape {
    let (tool, body): (Vec<&crate::human::Capsule>, Vec<_>) =
        capsules.iter().partition(|capsule| capsule.name == BodyPart::Tool);
    PersonShape {
        points_w,
        palm_w: tool.first().map_or_else(Point3::origin, |tool| tool.p0_w),
        capsules: body
            .iter()
            .map(|capsule| Capsule { ends_w: [capsule.p0_w, capsule.p1_w], radius_m: capsule.radius_m })
            .collect(),
    }
}
