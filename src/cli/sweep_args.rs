//! The command line of `sweep`, `merge` and `compare`.

use std::{num::NonZero, path::PathBuf};

use clap::Args;

use super::{cache::CacheArgs, format::Format, help, out_folder::OutFolder, streams::input_file};
use crate::sweep::{info::Shard, screen::Screen};

/// `benchdog sweep`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::SWEEP)]
pub struct SweepArgs {
    /// Scenario file (.toml) or plan file (.json); - is standard input, either of them
    #[arg(value_name = "SCENARIO|PLAN", value_parser = input_file())]
    pub input: PathBuf,
    /// Of a plan: scenario that applies instead of the one in the plan
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// Number of runs; overrides the scenario's
    #[arg(long, value_name = "N")]
    pub runs: Option<NonZero<u64>>,
    /// Seed of the draws; overrides the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// End once the interval of the probability is at most this wide
    #[arg(long, value_name = "WIDTH", conflicts_with = "shard")]
    pub until: Option<f64>,
    /// Simulate every run, also those that the statics would decide
    #[arg(long)]
    pub all: bool,
    /// Share of the runs that is simulated as a check though the statics would decide them
    #[arg(long, value_name = "SHARE", default_value_t = Screen::AUDIT_SHARE, conflicts_with = "all")]
    pub audit: f64,
    /// Do only part M of N of the runs, for `benchdog merge`
    #[arg(long, value_name = "M/N")]
    pub shard: Option<Shard>,
    /// Number of the worst runs that are recorded
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub worst: usize,
    /// Number of threads; by default one per core. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZero<usize>>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Folder of the sweep; {name}, {kind} and {seed} in it are filled in
    #[arg(long, value_name = "DIR", default_value = "out/sweep", value_parser = OutFolder::parser())]
    pub out: OutFolder,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// `benchdog merge`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::MERGE)]
pub struct MergeArgs {
    /// Folders of all parts of a sweep
    #[arg(required = true, value_name = "DIR")]
    pub parts: Vec<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Folder for the sweep
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// `benchdog compare`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::COMPARE)]
pub struct CompareArgs {
    /// What was: a folder of `run` or `sweep`, or of several of them; a verdict.json, a sweep.json or a baseline
    #[arg(value_name = "BEFORE")]
    pub before: PathBuf,
    /// What is, likewise
    #[arg(value_name = "AFTER", required_unless_present = "write_baseline")]
    pub after: Option<PathBuf>,
    /// Changes up to this are none: of a margin as a share of its limit, of a probability, of a quantile as a share of it
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    pub tolerance: f64,
    /// Also write the comparison as a page to this file
    #[arg(long, value_name = "FILE", requires = "after")]
    pub html: Option<PathBuf>,
    /// Write the last of the results as a baseline to this file
    #[arg(long, value_name = "FILE")]
    pub write_baseline: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}
