//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Plans how a two-armed robot holds a board that a person drills or cuts, and proves by simulation that the hold
/// stands.
#[derive(Debug, Parser)]
#[command(name = "benchdog", version, about, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Exit codes:
  0   all expectations met
  1   some expectation not met, or no verdict was possible
  2   bad input or usage, or output that cannot be written
  3   no feasible plan where one was expected
  70  a bug in benchdog

Start with: benchdog run scenarios/quickstart.toml";

/// A command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Plan, simulate, judge, record and report scenarios: the main job
    Run(RunArgs),
    /// Plan a scenario's hold and write it to a file
    Plan(PlanArgs),
    /// Simulate and judge a plan, ours or anybody's
    Simulate(SimulateArgs),
    /// Write the best and worst muscular comfort along a circle that is cut, as CSV and SVG
    Curve(CurveArgs),
    /// Print the JSON Schema of a file format
    Schema(SchemaArgs),
    /// Raise a plan's load until the hold fails, beside what the statics predict
    Margin(MarginArgs),
    /// Write a plan's scene for another simulator
    Export(ExportArgs),
}

/// What `run` and `simulate` share.
#[derive(Clone, Debug, Args)]
pub struct ReportArgs {
    /// Form of what is printed to standard output
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Also write a JUnit report to this file
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Which runs to record
    #[arg(long, value_enum, default_value_t = RecordChoice::Always)]
    pub record: RecordChoice,
    /// Folder for plans, verdicts and recordings
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// `benchdog run`.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// Scenario files
    #[arg(required = true, value_name = "SCENARIO")]
    pub scenarios: Vec<PathBuf>,
    /// How many scenarios run at once; all cores unless given. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<std::num::NonZero<usize>>,
    /// Seed of the planner, in place of the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Reports and recordings.
    #[command(flatten)]
    pub report: ReportArgs,
}

/// `benchdog plan`.
#[derive(Clone, Debug, Args)]
pub struct PlanArgs {
    /// Scenario file
    pub scenario: PathBuf,
    /// Where to write the plan; standard output unless given
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Seed of the planner, in place of the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

/// `benchdog simulate`.
#[derive(Clone, Debug, Args)]
pub struct SimulateArgs {
    /// Plan file
    pub plan: PathBuf,
    /// Scenario whose friction, phases, limits and expectation apply, in place of those in the plan
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Reports and recordings.
    #[command(flatten)]
    pub report: ReportArgs,
}

/// `benchdog curve`.
#[derive(Clone, Debug, Args)]
pub struct CurveArgs {
    /// Scenario of a cut, whose person, tool, board, force and distance from the middle count; that of the paper's
    /// reproduction unless given
    pub scenario: Option<PathBuf>,
    /// Folder for `muscular_curve.csv` and `muscular_curve.svg`
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// `benchdog schema`.
#[derive(Clone, Debug, Args)]
pub struct SchemaArgs {
    /// The file format
    #[arg(value_enum)]
    pub of: SchemaOf,
}

/// `benchdog margin`.
#[derive(Clone, Debug, Args)]
pub struct MarginArgs {
    /// Plan file
    pub plan: PathBuf,
    /// Scenario whose friction, load, phases, limits and expectation apply, in place of those in the plan
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Form of what is printed to standard output
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

/// `benchdog export`.
#[derive(Clone, Debug, Args)]
pub struct ExportArgs {
    /// Plan file
    pub plan: PathBuf,
    /// Scenario whose friction, load and phases apply, in place of those in the plan
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Where to write the scene as MJCF, the format of MuJoCo
    #[arg(long, value_name = "FILE")]
    pub mjcf: PathBuf,
}

/// Form of what is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A table
    Human,
    /// The verdicts
    Json,
}

/// Which runs to record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordChoice {
    /// None
    Never,
    /// Those that do not meet their expectation
    Failed,
    /// All
    Always,
}

/// A file format that has a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// Scenario files (TOML)
    Scenario,
    /// Plan files (JSON)
    Plan,
    /// Verdict files (JSON)
    Verdict,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }
}
