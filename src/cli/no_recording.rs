//! What stands in for recordings in a build without the feature `recording`.

use std::path::{Path, PathBuf};

use super::{exit::CliError, pipeline::Run};
use crate::{model::scenario::Scenario, robot::Robot};

/// Writes nothing: there is nothing to write a recording with.
pub fn write(_: &Run, _: &Scenario, _: &Robot, _: &Path) -> Result<Option<PathBuf>, CliError> {
    Ok(None)
}
