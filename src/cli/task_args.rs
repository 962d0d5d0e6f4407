//! The command line of `task`.

use std::path::PathBuf;

use clap::Args;

use super::{cache::CacheArgs, format::Format, help, search_args::SearchArgs};

/// `benchdog task`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::TASK)]
pub struct TaskArgs {
    /// Task file: a scenario with [task] in place of [operation]
    #[arg(value_name = "TASK")]
    pub task: PathBuf,
    /// Folder for the plan, the verdict, the tables and the report
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Write no recording
    #[arg(long)]
    pub no_recording: bool,
    /// Plan only
    #[arg(long)]
    pub plan_only: bool,
    /// Also compare with one fixed hold, the best hold for each piece, and random holds
    #[arg(long)]
    pub compare: bool,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Budget and seed of the search.
    #[command(flatten)]
    pub search: SearchArgs,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}
