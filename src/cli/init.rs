//! `benchdog init`: files to begin with, which are part of the program, so that nothing else is needed to use it.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{
    exit::{CliError, Exit},
    help, inputs, interrupt, output,
};
use crate::report::file;

/// `benchdog init`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help::INIT)]
pub struct InitArgs {
    /// Folder for the files; it is made if it does not exist
    #[arg(value_name = "DIR", default_value = ".")]
    pub folder: PathBuf,
    /// What to begin with
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Example::Drill)]
    pub example: Example,
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
}

/// What to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Example {
    /// A person drills a board: scenarios, plans and tests of the plans
    Drill,
    /// A person cuts a board with a knife
    Cut,
    /// A person drills several holes; the robot moves the board in between
    Task,
    /// Plans of another planner, with grasps only, are completed and judged
    YourPlan,
}

/// A file below the folder: its path, and its text.
type Starter = (&'static str, &'static str);

/// A file that has the same path in the folder of its example.
macro_rules! of {
    ($example:literal, $path:literal) => {
        ($path, include_str!(concat!("../../assets/init/", $example, "/", $path)))
    };
}

/// Where files are written whose names begin with a dot, which the files of the program do not.
const WORKFLOW: &str = ".github/workflows/benchdog.yml";

/// Files of every example.
const COMMON: [Starter; 2] =
    [(".gitignore", include_str!("../../assets/init/common/gitignore")), of!("common", "pytest.ini")];

/// The workflow and the tests of examples with scenarios.
const OF_SCENARIOS: [Starter; 2] =
    [(WORKFLOW, include_str!("../../assets/init/common/workflow.yml")), of!("common", "test_plans.py")];

const DRILL: [Starter; 7] = [
    of!("drill", "README.md"),
    of!("drill", "scenarios/drill.toml"),
    of!("drill", "scenarios/drill-left.toml"),
    of!("drill", "scenarios/drill-right.toml"),
    of!("drill", "plans/drill.json"),
    of!("drill", "plans/drill-left.json"),
    of!("drill", "plans/drill-right.json"),
];

const CUT: [Starter; 7] = [
    of!("cut", "README.md"),
    of!("cut", "scenarios/cut.toml"),
    of!("cut", "scenarios/cut-smooth.toml"),
    of!("cut", "scenarios/cut-slow.toml"),
    of!("cut", "plans/cut.json"),
    of!("cut", "plans/cut-smooth.json"),
    of!("cut", "plans/cut-slow.json"),
];

const TASK: [Starter; 9] = [
    of!("task", "README.md"),
    of!("task", "tasks/edge.toml"),
    of!("task", "tasks/pair.toml"),
    of!("task", "tasks/row.toml"),
    of!("task", "plans/edge.json"),
    of!("task", "plans/pair.json"),
    of!("task", "plans/row.json"),
    of!("task", "test_plans.py"),
    (WORKFLOW, include_str!("../../assets/init/task/workflow.yml")),
];

const YOUR_PLAN: [Starter; 7] = [
    of!("your-plan", "README.md"),
    of!("your-plan", "scenarios/panel.toml"),
    of!("your-plan", "scenarios/panel-left.toml"),
    of!("your-plan", "scenarios/panel-right.toml"),
    of!("your-plan", "plans/panel.json"),
    of!("your-plan", "plans/panel-left.json"),
    of!("your-plan", "plans/panel-right.json"),
];

impl Example {
    /// Its files.
    fn files(self) -> Vec<Starter> {
        let parts: [&[Starter]; 3] = match self {
            Self::Drill => [&DRILL, &OF_SCENARIOS, &COMMON],
            Self::Cut => [&CUT, &OF_SCENARIOS, &COMMON],
            Self::Task => [&TASK, &[], &COMMON],
            Self::YourPlan => [&YOUR_PLAN, &OF_SCENARIOS, &COMMON],
        };
        parts.concat()
    }

    /// The command to run in the folder.
    fn next(self) -> &'static str {
        match self {
            Self::Task => "benchdog task tasks/edge.toml",
            Self::Drill | Self::Cut | Self::YourPlan => "benchdog run scenarios",
        }
    }
}

/// Writes the files of an example into a folder, all or none of them.
pub fn init(args: &InitArgs) -> Result<Exit, CliError> {
    let files = args.example.files();
    let place = |path: &str| if args.folder == Path::new(".") { path.into() } else { args.folder.join(path) };
    let places: Vec<PathBuf> = files.iter().map(|(path, _)| place(path)).collect();
    inputs::protect(&[], places.iter().cloned())?;
    // A link that leads nowhere is there, too.
    if let Some(path) = places.iter().find(|path| path.symlink_metadata().is_ok() && !args.force) {
        let problem = "it exists; choose an empty folder, or --force to replace it".to_owned();
        return Err(CliError::NoFile { path: path.clone(), problem });
    }
    let _writing = interrupt::writing();
    file::check_folder(&args.folder)?;
    for (place, (_, text)) in places.iter().zip(&files) {
        file::write_whole(place, text.as_bytes())?;
    }
    output::print(&summary(args, &places))?;
    Ok(Exit::Met)
}

/// What was written, and the next command.
fn summary(args: &InitArgs, places: &[PathBuf]) -> String {
    let mut lines: Vec<_> = places.iter().map(|place| format!("wrote {}", place.display())).collect();
    let next = args.example.next();
    if args.folder == Path::new(".") {
        lines.push(format!("next: {next}"));
    } else {
        let folder = args.folder.display().to_string();
        let quote = if folder.contains(char::is_whitespace) { "\"" } else { "" };
        lines.push(format!("next: cd {quote}{folder}{quote}"));
        lines.push(format!("then: {next}"));
    }
    lines.join("\n") + "\n"
}
