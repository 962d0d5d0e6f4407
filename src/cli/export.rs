//! `benchdog export`: writes a plan's scene for another simulator.

use super::{
    args::ExportArgs,
    exit::{CliError, Exit},
    inputs, output,
};
use crate::{
    check::CheckedPlan,
    report, scenario,
    sim::{self, Conditions},
};

/// Writes the scene as MJCF.
pub fn export(args: &ExportArgs) -> Result<Exit, CliError> {
    let loaded = scenario::load_plan(&args.plan, args.scenario.as_deref())?;
    inputs::protect(&loaded.inputs, [args.mjcf.clone()])?;
    output::notes(&loaded.filled_in);
    let checked = CheckedPlan::new(&loaded.robot, &loaded.plan, &loaded.scenario.human, &loaded.scenario.tool)?;
    let conditions = Conditions::of(&loaded.scenario);
    let text = sim::mjcf(&checked, &conditions, &loaded.scenario.limits).map_err(CliError::Simulation)?;
    report::file::write_whole(&args.mjcf, text.as_bytes())?;
    Ok(Exit::Met)
}
