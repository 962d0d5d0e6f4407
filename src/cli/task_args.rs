//! The command line of `task`.

use std::path::PathBuf;

use clap::Args;

use super::{
    cache::CacheArgs, format::Format, help, out_folder::OutFolder, search_args::SearchArgs, streams::input_file,
};

/// `benchdog task`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::TASK)]
pub struct TaskArgs {
    /// Task file: a scenario with [task] in place of [operation]; - is standard input
    #[arg(value_name = "TASK", value_parser = input_file())]
    pub task: PathBuf,
    /// Folder in which the task has one for the plan, the verdict, the tables and the report; or that folder itself with
    /// {name}, {kind} or {seed}, such as 'out/{name}-{seed}'
    #[arg(long, value_name = "DIR", default_value = "out", value_parser = OutFolder::parser())]
    pub out: OutFolder,
    /// Plan stage by stage while the robot carries out the ones before, and write each stage to `stages.jsonl` as soon as it is
    /// planned; the loads and regrasps of the next PIECES pieces of the path are known ahead [3 without a number]
    #[arg(long, value_name = "PIECES", num_args = 0..=1, require_equals = true, default_missing_value = "3", value_parser = clap::value_parser!(u16).range(1..))]
    pub stream: Option<u16>,
    /// Write no recording
    #[arg(long)]
    pub no_recording: bool,
    /// Also write the simulation as trace.mcap: ROS 2 messages for Foxglove and ROS tools
    #[arg(long)]
    pub mcap: bool,
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
