//! The recording of a run: what the recorder needs of the person is computed here, since it knows no bodies.

use std::path::{Path, PathBuf};

use super::{exit::CliError, pipeline::Run};
use crate::{
    human::{BodyPart, Human},
    model::scenario::Scenario,
    record::{self, Capsule, PersonShape, RecordingInput},
    report::file::write_whole,
    robot::Robot,
};

/// Writes the recording of a run into its folder; nothing when nothing was simulated.
///
/// # Errors
/// When the recording cannot be made or written.
pub fn write(run: &Run, scenario: &Scenario, robot: &Robot, folder: &Path) -> Result<Option<PathBuf>, CliError> {
    let (Some(plan), Some((trace, judgement))) = (&run.plan, &run.simulated) else { return Ok(None) };
    let person = match &plan.human {
        Some(posture) => {
            let human = Human::new(&posture.person(), &scenario.tool)?;
            Some(person_shape(&human.capsules_w(&posture.x_wb, &posture.q_rad)))
        }
        None => None,
    };
    let input = RecordingInput {
        robot,
        plan,
        trace,
        measures: &judgement.measures,
        events: &judgement.events,
        verdict: &run.verdict,
        person: person.as_ref(),
    };
    let path = folder.join("recording.rrd");
    write_whole(&path, &record::encode(&input)?)?;
    Ok(Some(path))
}

/// The person without the tool, which the recorder draws from the palm to the board.
fn person_shape(capsules: &[crate::human::Capsule]) -> PersonShape {
    let (tool, body): (Vec<&crate::human::Capsule>, Vec<_>) =
        capsules.iter().partition(|capsule| capsule.name == BodyPart::Tool);
    PersonShape {
        palm_w: tool.first().map_or_else(nalgebra::Point3::origin, |tool| tool.p0_w),
        capsules: body
            .iter()
            .map(|capsule| Capsule { ends_w: [capsule.p0_w, capsule.p1_w], radius_m: capsule.radius_m })
            .collect(),
    }
}
