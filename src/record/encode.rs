//! The recording as bytes.

use rerun::{EntityPath, StoreId, StoreKind};

use super::{
    blueprint, entity::APPLICATION, error::RecordError, input::RecordingInput, messages::Messages, muscles, plots, rrd,
    scene, stored, summary,
};
use crate::model::verdict::Verdict;

/// The bytes of a recording (`.rrd`) with the viewer's layout. Equal inputs give equal bytes.
///
/// # Errors
/// If the trace has an arm that the robot does not have.
pub fn encode(input: &RecordingInput) -> Result<Vec<u8>, RecordError> {
    let id = recording_id(input.verdict);
    let mut recording = Messages::new(StoreId::new(StoreKind::Recording, APPLICATION, id.as_str()));
    recording.log_static(&EntityPath::properties(), &rerun::RecordingInfo::new().with_name(&*input.verdict.name))?;
    scene::log(&mut recording, input)?;
    plots::log(&mut recording, input)?;
    summary::log(&mut recording, input)?;
    if let Some(work) = &input.verdict.muscles {
        muscles::log_chart(&mut recording, work)?;
    }
    stored::log(&mut recording, input)?;
    let layout = Messages::new(StoreId::new(StoreKind::Blueprint, APPLICATION, format!("{id}-blueprint")));
    let layout = blueprint::messages(layout, input)?;
    rrd::bytes(recording.into_messages().into_iter().chain(layout))
}

/// The id depends on the verdict only, so the viewer treats recordings of equal runs as one.
fn recording_id(verdict: &Verdict) -> String {
    let fingerprint = verdict.fingerprint.get(..16).unwrap_or(&verdict.fingerprint);
    format!("{}-{fingerprint}", verdict.name)
}
