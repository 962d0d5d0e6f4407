//! The commands. They combine the other modules and are the only code that uses the clock, the terminal, signals and exit
//! codes, decides about threads, and writes files.

mod args;
mod batch;
mod cache;
mod compare;
mod completions;
mod curve;
mod doctor;
mod exit;
mod explain;
mod export;
mod finish;
mod format;
mod front;
mod help;
mod import;
mod init;
mod inputs;
#[cfg(feature = "recording")]
mod inspect;
mod interrupt;
mod log;
mod man;
mod margin;
mod merge;
mod out_folder;
mod output;
mod paint;
mod plan;
mod planners;
mod predicted;
mod progress;
mod replan;
mod reproduce;
mod robot;
mod robot_check;
mod robust;
mod run;
mod schema;
mod search_args;
mod select;
mod simulate;
mod streams;
mod sweep;
mod sweep_args;
mod task;
mod task_args;
mod threads;
#[cfg(feature = "recording")]
mod view;

use std::{ffi::OsString, process::ExitCode, sync::Arc};

use clap::{CommandFactory as _, FromArgMatches as _};

use crate::planner::MapStore;
use args::RobotCommand;
pub use args::{Cli, Command};
use cache::CacheArgs;
pub use exit::Exit;
use output::ColorWhen;
pub use replan::MotionAnswer;

/// Prints no message of a panic that means that a file is damaged: it becomes an error.
fn leave_damage_to_decoders() {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !crate::input::is_decoding() {
            print(panic);
        }
    }));
}

/// Parses this process's arguments and runs the command.
pub fn main() -> ExitCode {
    run_command(std::env::args_os()).into()
}

/// The maps that commands keep: those in the program, then those in the user's folder. `None` if `BENCHDOG_CACHE` is empty.
#[must_use]
pub fn kept_maps() -> Option<Arc<dyn MapStore>> {
    cache::store(CacheArgs::default())
}

/// Runs the command that these arguments say, of which the first is the program's name. Once in a process: it handles Ctrl-C.
pub fn run_command(arguments: impl IntoIterator<Item = OsString>) -> Exit {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let color = ColorWhen::of(&arguments);
    color.apply();
    let parsed = Cli::command().color(color.of_parser()).try_get_matches_from(arguments);
    let cli = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            // clap chooses the stream for help, version and usage errors; a closed stream is not an error.
            let _ = error.print();
            return if error.use_stderr() { Exit::Input } else { Exit::Met };
        }
    };
    log::begin(cli.verbose);
    leave_damage_to_decoders();
    let outcome = std::panic::catch_unwind(|| match &cli.command {
        Command::Init(args) => init::init(args),
        Command::Run(args) => run::run(args),
        Command::Plan(args) => plan::plan(args),
        Command::Replan(args) => replan::replan(args),
        Command::Front(args) => front::front(args),
        Command::Task(args) => task::task(args),
        Command::Simulate(args) => simulate::simulate(args),
        Command::Curve(args) => curve::curve(args),
        Command::Reproduce(args) => reproduce::reproduce(args),
        Command::Explain(args) => explain::explain(args),
        Command::Schema(args) => schema::schema(args),
        Command::Sweep(args) => sweep::sweep(args),
        Command::Merge(args) => merge::merge(args),
        Command::Compare(args) => compare::compare(args),
        Command::Margin(args) => margin::margin(args),
        Command::Export(args) => export::export(args),
        Command::Import(args) => import::import(args),
        #[cfg(feature = "recording")]
        Command::Inspect(args) => inspect::inspect(args),
        #[cfg(feature = "recording")]
        Command::View(args) => view::view(args),
        Command::Robot(RobotCommand::New(args)) => robot::new(args),
        Command::Cache(command) => cache::cache(command),
        Command::Doctor(args) => doctor::doctor(args),
        Command::Completions(args) => completions::completions(args),
        Command::Man(args) => man::man(args),
    });
    match outcome {
        Ok(Ok(exit)) => exit,
        Ok(Err(error)) if error.is_stop() => {
            interrupt::explain();
            error.exit()
        }
        Ok(Err(error)) => {
            output::message(&format!("error: {error}"));
            error.exit()
        }
        // The default hook has printed the panic's message.
        Err(_) => {
            output::message("error: this is a bug in benchdog; please report it with the message above");
            Exit::Bug
        }
    }
}
