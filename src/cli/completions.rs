//! `benchdog completions`: completion scripts of shells.

use clap::CommandFactory;

use super::{
    args::{Cli, CompletionsArgs},
    exit::{CliError, Exit},
    output,
};

/// Prints a completion script.
pub fn completions(args: &CompletionsArgs) -> Result<Exit, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "benchdog", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Met)
}
