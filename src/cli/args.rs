//! Definition of the command line.

use std::{num::NonZero, path::PathBuf};

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};

use super::{
    cache::{CacheArgs, CacheCommand},
    explain::ExplainArgs,
    format::Format,
    help,
    init::InitArgs,
    out_folder::OutFolder,
    output::ColorWhen,
    search_args::SearchArgs,
    streams::input_file,
    sweep_args::{CompareArgs, MergeArgs, SweepArgs},
    task_args::TaskArgs,
};
use crate::{
    model::{
        frames::{Pose, PoseRecord, RpyRecord},
        scenario::{PlannerKind, PlannerSettings},
    },
    pipeline::versions,
};

/// Plans how a two-armed robot holds a board that a person drills or cuts, and verifies the plan in simulation.
#[derive(Debug, Parser)]
#[command(name = "benchdog", version, long_version = versions::LONG.as_str(), about, after_help = help::EXIT_CODES)]
pub struct Cli {
    /// When messages and tables have colours: auto, always or never
    #[arg(long, global = true, help_heading = "Global options", value_name = "WHEN")]
    #[arg(value_enum, default_value_t = ColorWhen::Auto, hide_possible_values = true)]
    pub color: ColorWhen,
    /// Say on standard error what is done: files, maps, searches, simulations; -vv also their parts
    #[arg(short, long, global = true, action = ArgAction::Count, help_heading = "Global options")]
    pub verbose: u8,
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// A command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a starter scenario, plans of it, tests and a workflow into a folder
    Init(InitArgs),
    /// Plan, simulate, judge, record and report scenarios
    Run(RunArgs),
    /// Plan a scenario and write the plan
    Plan(PlanArgs),
    /// Answer requests on standard input with plans, while the person moves
    Replan(ReplanArgs),
    /// Write the Pareto front of muscular and peripersonal comfort as CSV, SVG and plans
    Front(FrontArgs),
    /// Plan, simulate and judge a whole task: a path that is cut or drilled in holds, motions and regrasps
    Task(TaskArgs),
    /// Simulate and judge a plan, also one from another planner
    Simulate(SimulateArgs),
    /// Make a plan of the grasps of another planner, from isaac_grasp or moveit_msgs/Grasp in YAML
    Import(ImportArgs),
    /// Write the best and worst muscular comfort along a circular cut as CSV and SVG
    Curve(CurveArgs),
    /// Plan, simulate and report the paper's evaluation for a natural person and as printed: 25 operations, four planners
    Reproduce(ReproduceArgs),
    /// Say what a verdict or a check means, how it is measured and what helps if it fails
    Explain(ExplainArgs),
    /// Print the JSON Schema of a file format
    Schema(SchemaArgs),
    /// Simulate a plan many times with parameters drawn at random: how likely does it hold?
    Sweep(SweepArgs),
    /// Join the parts of a sweep into the sweep
    Merge(MergeArgs),
    /// Compare two results, or a result with a baseline: what got worse?
    Compare(CompareArgs),
    /// Find the load at which a plan fails in simulation, and compare it with the predictions
    Margin(MarginArgs),
    /// Write a plan's scene for another simulator
    Export(ExportArgs),
    /// Print a recording's verdict, checks, peaks and first failure; judge its trace again with other limits
    #[cfg(feature = "recording")]
    Inspect(InspectArgs),
    /// Open a recording in the rerun viewer
    #[cfg(feature = "recording")]
    View(ViewArgs),
    /// Write the description of a robot from its URDF
    #[command(subcommand, after_help = help::ROBOT_NEW)]
    Robot(RobotCommand),
    /// List or remove the maps that are kept between commands
    #[command(subcommand, after_help = help::CACHE)]
    Cache(CacheCommand),
    /// Check the installation: assets, versions, physics and solver; or the description of a robot
    Doctor(DoctorArgs),
    /// Print a shell's completion script
    Completions(CompletionsArgs),
    /// Print the manual page, or write those of all commands
    Man(ManArgs),
}

/// A command about robots.
#[derive(Debug, Subcommand)]
pub enum RobotCommand {
    /// Find arms and grippers of a URDF and write a description that can be used at once
    New(RobotNewArgs),
}

/// `benchdog robot new`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::ROBOT_NEW)]
pub struct RobotNewArgs {
    /// URDF file
    pub urdf: PathBuf,
    /// SRDF file; the pairs of links that it disables may overlap
    #[arg(long, value_name = "FILE")]
    pub srdf: Option<PathBuf>,
    /// Folder that contains packages of meshes, beside ROS_PACKAGE_PATH and the folders above the URDF; may be repeated
    #[arg(long, value_name = "DIR")]
    pub packages: Vec<PathBuf>,
    /// File for the description
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Also write a scenario to this file: a board drilled with 10 N
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
}

/// `benchdog doctor`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::DOCTOR)]
pub struct DoctorArgs {
    /// Description of a robot to check in place of the installation
    pub description: Option<PathBuf>,
    /// Record the robot with pads and points, its arms in the middle of their ranges
    #[arg(long, value_name = "FILE", requires = "description")]
    pub record: Option<PathBuf>,
}

/// Options of `run` and `simulate`.
#[derive(Clone, Debug, Args)]
pub struct ReportArgs {
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Also write a JUnit report to this file
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Which simulations to record
    #[arg(long, value_enum, default_value_t = RecordChoice::Always)]
    pub record: RecordChoice,
    /// Also write each simulation as trace.mcap: ROS 2 messages for Foxglove and ROS tools
    #[arg(long)]
    pub mcap: bool,
    /// Folder for plans, verdicts, recordings and reports; or that of each scenario with {name}, {kind} or {seed}, such as
    /// 'out/{name}-{seed}'
    #[arg(long, value_name = "DIR", default_value = "out", value_parser = OutFolder::parser())]
    pub out: OutFolder,
}

/// `benchdog run`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::RUN)]
pub struct RunArgs {
    /// Scenario files, folders with scenario files, or patterns such as 'grasps/**/*.toml'; - is standard input
    #[arg(required = true, value_name = "SCENARIO", value_parser = input_file())]
    pub scenarios: Vec<PathBuf>,
    /// Run only scenarios whose name contains this text or, if it has one of * ? [, matches it as a pattern; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub filter: Vec<String>,
    /// Start no scenario after one that does not meet its expectation
    #[arg(long)]
    pub fail_fast: bool,
    /// Number of threads; by default one per core. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZero<usize>>,
    /// The planner.
    #[command(flatten)]
    pub planner: PlannerArgs,
    /// Reports and recordings.
    #[command(flatten)]
    pub report: ReportArgs,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// `benchdog plan`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::PLAN)]
pub struct PlanArgs {
    /// Scenario file; - is standard input
    #[arg(value_parser = input_file())]
    pub scenario: PathBuf,
    /// File for the plan, by default or with - standard output; with --top the folder for plan-1.json, plan-2.json, ...
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write the best K plans that differ in an edge, by 50 mm or 15 degrees of the board, or by 30 degrees of a joint
    #[arg(long, value_name = "K", requires = "output", conflicts_with = "robust")]
    pub top: Option<NonZero<usize>>,
    /// The planner.
    #[command(flatten)]
    pub planner: PlannerArgs,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// `benchdog replan`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::REPLAN)]
pub struct ReplanArgs {
    /// Scenario file
    pub scenario: PathBuf,
    /// Plan file of the hold to start from; by default the first answer plans it
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Budget and seed.
    #[command(flatten)]
    pub search: SearchArgs,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// Options that override the scenario's `[planner]` keys.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Search")]
pub struct PlannerArgs {
    /// Planner; overrides the scenario's
    #[arg(long, value_enum, value_name = "KIND")]
    pub planner: Option<PlannerChoice>,
    /// The most comfortable plan that holds with this probability under the deviations of [sweep]; by default that of [expect], or
    /// 0.99
    #[arg(long, value_name = "PROBABILITY", num_args = 0..=1, require_equals = true, value_parser = probability)]
    pub robust: Option<Option<f64>>,
    /// Budget and seed.
    #[command(flatten)]
    pub search: SearchArgs,
}

/// A probability from a half to almost one.
fn probability(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|found| (0.5..=0.999).contains(found));
    found.ok_or_else(|| "expected a number from 0.5 to 0.999".into())
}

impl PlannerArgs {
    /// Overrides a scenario's settings.
    pub fn apply(&self, settings: &mut PlannerSettings) {
        settings.kind = self.planner.map_or(settings.kind, PlannerKind::from);
        self.search.apply(settings);
    }
}

/// `benchdog front`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::FRONT)]
pub struct FrontArgs {
    /// Scenario file; - is standard input
    #[arg(value_parser = input_file())]
    pub scenario: PathBuf,
    /// Folder for `front.csv`, `front.svg` and the plans
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Budget and seed of each search.
    #[command(flatten)]
    pub search: SearchArgs,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// `benchdog simulate`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::SIMULATE)]
pub struct SimulateArgs {
    /// Plan files, folders with plan files, or patterns such as 'plans/*.json'; - is standard input
    #[arg(required = true, value_name = "PLAN", value_parser = input_file())]
    pub plans: Vec<PathBuf>,
    /// Scenario whose friction, phases, limits and expectation apply instead of those in each plan
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// Number of threads for several plans; by default one per core. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZero<usize>>,
    /// Reports and recordings.
    #[command(flatten)]
    pub report: ReportArgs,
}

/// `benchdog import`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::IMPORT)]
pub struct ImportArgs {
    /// File with grasps: isaac_grasp 1.0 or messages of moveit_msgs/Grasp in YAML; or 4x4 matrices, in JSON or as rows of numbers
    #[arg(value_name = "GRASPS", value_parser = input_file())]
    pub grasps: PathBuf,
    /// Scenario with the robot, the board and the operation
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: PathBuf,
    /// An arm and its grasp by name; once for each arm that holds the board
    #[arg(long, required_unless_present = "all", value_name = "ARM=GRASP", value_parser = arm_choice)]
    pub arm: Vec<ArmChoice>,
    /// Make a plan of each grasp of the file, with this arm, beside those of --arm; -o is then a folder
    #[arg(long, requires = "output", value_name = "ARM")]
    pub all: Option<String>,
    /// Pose of the board in the robot's base; by default the first of the search domain that the arms reach
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = pose)]
    pub board_pose: Option<Pose>,
    /// Pose of our gripper frame G in the file's gripper frame
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = pose, default_value = "0 0 0 0 0 0")]
    pub gripper_frame: Pose,
    /// Pose of the file's object frame in our board frame O
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = pose, default_value = "0 0 0 0 0 0")]
    pub object_frame: Pose,
    /// Name of a frame in the file that is the robot's base; all other frames are the board's. Needs --board-pose
    #[arg(long, value_name = "NAME", requires = "board_pose")]
    pub world_frame: Option<String>,
    /// File for the plan, by default or with - standard output; with --all the folder for the plans
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// An arm and its grasp.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArmChoice {
    /// Name of the arm.
    pub arm: String,
    /// Name of the grasp.
    pub grasp: String,
}

/// Parses `ARM=GRASP`.
fn arm_choice(text: &str) -> Result<ArmChoice, String> {
    match text.split_once('=') {
        Some((arm, grasp)) if !arm.is_empty() && !grasp.is_empty() => {
            Ok(ArmChoice { arm: arm.to_owned(), grasp: grasp.to_owned() })
        }
        _ => Err("expected ARM=GRASP, such as left=grasp_0".into()),
    }
}

/// Parses a pose: `x y z roll pitch yaw` in m and rad, or `x y z qx qy qz qw`.
fn pose(text: &str) -> Result<Pose, String> {
    let numbers: Result<Vec<f64>, _> =
        text.split([' ', ',']).filter(|part| !part.is_empty()).map(str::parse::<f64>).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z, roll, pitch, yaw]) => Pose::try_from(RpyRecord { xyz_m: [x, y, z], rpy_rad: [roll, pitch, yaw] }),
        Ok(&[x, y, z, qx, qy, qz, qw]) => {
            Pose::try_from(PoseRecord { translation_m: [x, y, z], rotation_xyzw: [qx, qy, qz, qw] })
        }
        _ => Err("expected \"x y z roll pitch yaw\" in m and rad, or \"x y z qx qy qz qw\"".into()),
    }
}

/// `benchdog curve`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::CURVE)]
pub struct CurveArgs {
    /// Scenario of a cut: its person, tool, board, force and distance from the centre are used; by default the first cut
    /// of the paper's evaluation
    #[arg(value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// Folder for `muscular_curve.csv` and `muscular_curve.svg`
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// `benchdog reproduce`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::REPRODUCE)]
pub struct ReproduceArgs {
    /// Use fewer seeds of the random planner; omit failing loads, sensitivity analysis, fronts and the whole circle
    #[arg(long)]
    pub quick: bool,
    /// Only operations whose name contains this text or, if it has one of * ? [, matches it as a pattern; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub filter: Vec<String>,
    /// Number of threads; by default one per core. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZero<usize>>,
    /// Which simulations to record
    #[arg(long, value_enum, default_value_t = RecordChoice::Never)]
    pub record: RecordChoice,
    /// Folder for the results; by default `results`, with --quick `out/reproduce-quick`
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Maps between runs.
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// `benchdog schema`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::SCHEMA)]
pub struct SchemaArgs {
    /// The file format
    #[arg(value_enum)]
    pub of: SchemaOf,
}

/// `benchdog margin`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::MARGIN)]
pub struct MarginArgs {
    /// Plan file; - is standard input
    #[arg(value_parser = input_file())]
    pub plan: PathBuf,
    /// Scenario whose friction, load, phases, limits and expectation apply instead of those in the plan
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

/// `benchdog export`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::EXPORT)]
pub struct ExportArgs {
    /// Plan file; - is standard input
    #[arg(value_parser = input_file())]
    pub plan: PathBuf,
    /// Scenario whose friction, load and phases apply instead of those in the plan
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// File for the scene as MJCF, the format of MuJoCo; - is standard output
    #[arg(long, value_name = "FILE")]
    pub mjcf: PathBuf,
}

/// `benchdog inspect`.
#[cfg(feature = "recording")]
#[derive(Clone, Debug, Args)]
#[command(after_help = help::INSPECT)]
pub struct InspectArgs {
    /// Recording
    #[arg(value_name = "FILE.rrd")]
    pub recording: PathBuf,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Human)]
    pub format: Format,
    /// Judge the stored trace again, with the run's limits except those given here
    #[arg(long)]
    pub check: bool,
    /// Scenario whose limits and expectation apply instead of the run's
    #[arg(long, value_name = "FILE", value_parser = input_file())]
    pub scenario: Option<PathBuf>,
    /// Limits.
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Limits that override those of the run.
#[cfg(feature = "recording")]
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Limits")]
pub struct LimitArgs {
    /// Translation of a hand relative to the board, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    pub slip_mm: Option<f64>,
    /// Rotation of a hand relative to the board, degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = positive)]
    pub slip_deg: Option<f64>,
    /// Displacement of the board's tool point under the board's weight, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    pub sag_mm: Option<f64>,
    /// Displacement of the board's tool point under the load, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = positive)]
    pub deflection_mm: Option<f64>,
    /// Rate of slip in the second half of the hold phase, mm/s
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = positive)]
    pub creep_mm_s: Option<f64>,
    /// Demanded joint torque divided by its limit
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true, value_parser = positive)]
    pub torque_ratio: Option<f64>,
}

/// Parses a limit.
#[cfg(feature = "recording")]
fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a positive number".to_owned())?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err("expected a positive number".to_owned()) }
}

/// `benchdog view`.
#[cfg(feature = "recording")]
#[derive(Clone, Debug, Args)]
#[command(after_help = help::VIEW)]
pub struct ViewArgs {
    /// Recording
    #[arg(value_name = "FILE.rrd")]
    pub recording: PathBuf,
}

/// `benchdog completions`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::COMPLETIONS)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// `benchdog man`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::MAN)]
pub struct ManArgs {
    /// Folder for the pages of all commands; by default the page of benchdog itself goes to standard output
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlannerChoice {
    /// Maximise the weighted sum of both comforts
    Comfort,
    /// Maximise muscular comfort
    Muscular,
    /// Maximise peripersonal comfort
    Peripersonal,
    /// Draw a feasible grasp uniformly
    Random,
}

impl From<PlannerChoice> for PlannerKind {
    fn from(choice: PlannerChoice) -> Self {
        match choice {
            PlannerChoice::Comfort => Self::Comfort,
            PlannerChoice::Muscular => Self::Muscular,
            PlannerChoice::Peripersonal => Self::Peripersonal,
            PlannerChoice::Random => Self::Random,
        }
    }
}

/// Which simulations to record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordChoice {
    /// Record none
    Never,
    /// Record those that do not meet their expectation
    Failed,
    /// Record all
    Always,
}

impl RecordChoice {
    /// True if a simulation is recorded whose expectation was met or not.
    pub fn wants(self, met: bool) -> bool {
        match self {
            Self::Never => false,
            Self::Failed => !met,
            Self::Always => true,
        }
    }
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
    /// Plans of tasks (JSON)
    StagedPlan,
    /// Verdicts on plans of tasks (JSON)
    StagedVerdict,
    /// What a sweep leaves: `sweep.json`
    Sweep,
    /// Requests to `benchdog replan` (a line of JSON each)
    ReplanRequest,
    /// Answers of `benchdog replan` (a line of JSON each)
    ReplanAnswer,
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
