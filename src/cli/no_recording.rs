//! What stands in for recordings in a build without the feature `recording`.

use super::{exit::CliError, pipeline::Run};
use crate::{model::scenario::Scenario, robot::Robot};

/// None: there is nothing to make a recording with.
pub fn encode(_: &Run, _: &Scenario, _: &Robot) -> Result<Option<Vec<u8>>, CliError> {
    Ok(None)
}
