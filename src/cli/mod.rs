//! The commands. They compose the parts of the crate, own the clock, the threads, the terminal and the files that are
//! written, and turn what happened into an exit code. Nothing below this module knows any of these.

mod args;
mod circle;
mod completions;
mod curve;
mod doctor;
mod exit;
mod export;
mod finish;
mod front;
mod help;
#[cfg(feature = "recording")]
mod inspect;
mod interrupt;
mod maps;
mod margin;
mod output;
mod pipeline;
mod plan;
mod predicted;
mod progress;
#[cfg(feature = "recording")]
mod recording;
#[cfg(not(feature = "recording"))]
#[path = "no_recording.rs"]
mod recording;
mod reproduce;
mod run;
mod schema;
mod select;
mod simulate;
mod versions;
#[cfg(feature = "recording")]
mod view;

use std::process::ExitCode;

use clap::Parser;

pub use args::{Cli, Command};
pub use exit::Exit;

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // clap knows which of help, version and usage errors goes to which stream; a closed one is no error.
            let _ = error.print();
            return if error.use_stderr() { Exit::Input.into() } else { Exit::Met.into() };
        }
    };
    let outcome = std::panic::catch_unwind(|| match &cli.command {
        Command::Run(args) => run::run(args),
        Command::Plan(args) => plan::plan(args),
        Command::Front(args) => front::front(args),
        Command::Circle(args) => circle::circle(args),
        Command::Simulate(args) => simulate::simulate(args),
        Command::Curve(args) => curve::curve(args),
        Command::Reproduce(args) => reproduce::reproduce(args),
        Command::Schema(args) => schema::schema(args),
        Command::Margin(args) => margin::margin(args),
        Command::Export(args) => export::export(args),
        #[cfg(feature = "recording")]
        Command::Inspect(args) => inspect::inspect(args),
        #[cfg(feature = "recording")]
        Command::View(args) => view::view(args),
        Command::Doctor => doctor::doctor(),
        Command::Completions(args) => completions::completions(args),
    });
    match outcome {
        Ok(Ok(exit)) => exit.into(),
        Ok(Err(error)) => {
            output::complain(&format!("error: {error}"));
            error.exit().into()
        }
        // The panic's own message has been printed by the default hook.
        Err(_) => {
            output::complain("error: this is a bug in benchdog; please report it with the message above");
            Exit::Bug.into()
        }
    }
}
