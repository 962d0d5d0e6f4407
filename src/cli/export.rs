//! `benchdog export`: writes a plan's scene for another simulator.

use std::path::Path;

use super::{
    args::ExportArgs,
    exit::{CliError, Exit},
    inputs, output, streams,
};
use crate::{
    check::CheckedPlan,
    scenario,
    sim::{self, Conditions},
};

/// Writes the scene as MJCF.
pub fn export(args: &ExportArgs) -> Result<Exit, CliError> {
    let loaded = scenario::load_plan(&args.plan, args.scenario.as_deref())?;
    inputs::protect(&loaded.inputs, streams::file(&args.mjcf).map(Path::to_owned))?;
    output::notes(&loaded.filled_in);
    let checked = CheckedPlan::new(&loaded.robot, &loaded.plan, &loaded.scenario.human, &loaded.scenario.tool)?;
    let conditions = Conditions::of(&loaded.scenario);
    let text = sim::mjcf(&checked, &conditions, &loaded.scenario.limits).map_err(CliError::Simulation)?;
    streams::write(&text, &args.mjcf)?;
    Ok(Exit::Met)
}
