//! `benchdog export`: writes a plan's scene for another simulator.

use super::{
    args::ExportArgs,
    exit::{CliError, Exit},
};
use crate::{
    report, scenario,
    sim::{self, Conditions},
};

/// Writes the scene as MJCF.
pub fn export(args: &ExportArgs) -> Result<Exit, CliError> {
    let (plan, robot, scenario) = scenario::load_plan_and_scenario(&args.plan, args.scenario.as_deref())?;
    let text = sim::mjcf(&robot, &plan, &Conditions::of(&scenario)).map_err(CliError::Simulation)?;
    report::file::write_whole(&args.mjcf, text.as_bytes())?;
    Ok(Exit::Met)
}
