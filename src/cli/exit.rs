//! Exit codes and errors of commands.

use std::{path::PathBuf, process::ExitCode};

use crate::{
    model::verdict::{Verdict, VerdictKind},
    pipeline::RunError,
    scenario::InputError,
};

/// The result of a command, in increasing order of precedence: of several scenarios the greatest one determines the exit
/// code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All expectations met.
    Met,
    /// Some expectation not met, or no verdict was possible.
    NotMet,
    /// No feasible plan where one was expected.
    Infeasible,
    /// Interrupted by the user before all scenarios were run.
    Interrupted,
    /// Bad input or usage, or output that cannot be written.
    Input,
    /// A bug in Benchdog.
    Bug,
}

impl Exit {
    /// The exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Met => 0,
            Self::NotMet => 1,
            Self::Input => 2,
            Self::Infeasible => 3,
            Self::Bug => 70,
            // The code that shells report for a program ended by Ctrl-C.
            Self::Interrupted => 130,
        }
    }

    /// The result for one verdict.
    pub fn of(verdict: &Verdict) -> Self {
        Self::judged(verdict.met, verdict.verdict)
    }

    /// The result for a verdict of this kind, which is the expected one if it is `met`.
    pub fn judged(met: bool, verdict: VerdictKind) -> Self {
        match (met, verdict) {
            (true, _) => Self::Met,
            (false, VerdictKind::Infeasible) => Self::Infeasible,
            (false, _) => Self::NotMet,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit.code())
    }
}

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A staged plan of the planner that does not fit its robot: a bug.
    #[error("the planner made a staged plan that does not fit its robot: {0}")]
    Staged(#[from] crate::check::StagedFlaw),
    /// An input file is invalid.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The simulation cannot be set up from a plan.
    #[error("failed to simulate the plan: {0}")]
    Simulation(crate::sim::SimError),
    /// A robot cannot be loaded.
    #[error(transparent)]
    Robot(#[from] crate::robot::RobotError),
    /// No description can be written.
    #[error(transparent)]
    Setup(#[from] crate::setup::SetupError),
    /// The person or the tool is invalid.
    #[error(transparent)]
    Human(#[from] crate::human::HumanError),
    /// A plan does not fit its robot or person.
    #[error("failed to check the plan: {0}")]
    Flaws(#[from] crate::check::Flaws),
    /// A scenario cannot be planned.
    #[error(transparent)]
    Plan(#[from] crate::planner::PlanError),
    /// A command would overwrite one of its input files.
    #[error("failed to write {}: it is an input file of this command", .0.display())]
    OverwritesInput(PathBuf),
    /// An output that cannot be a file.
    #[error("failed to write {}: {problem}", path.display())]
    NoFile {
        /// The output.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// A command would overwrite the plan of an earlier run with another one.
    #[error(
        "failed to write {}: it is another plan of this name; change the name of the simulated plan, or choose another --out",
        .0.display()
    )]
    OverwritesPlan(PathBuf),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] crate::report::file::WriteError),
    /// The JUnit report cannot be made.
    #[error("failed to write the JUnit report: {0}")]
    JUnit(#[from] quick_junit::SerializeError),
    /// The CSV summary cannot be made.
    #[error("failed to write the CSV summary: {0}")]
    Csv(#[from] csv::Error),
    /// The handler of Ctrl-C cannot be installed.
    #[error("failed to listen for Ctrl-C: {0}")]
    Signals(#[from] ctrlc::Error),
    /// A recording cannot be written or read.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    Record(#[from] crate::record::RecordError),
    /// An MCAP file cannot be made.
    #[error(transparent)]
    Mcap(#[from] crate::ros::EncodeError),
    /// Something on this machine does not work.
    #[error("{0}")]
    Machine(String),
    /// The arguments are invalid.
    #[error("{0}")]
    Usage(String),
    /// Standard output cannot be written.
    #[error("failed to write to standard output: {0}")]
    Stdout(std::io::Error),
}

impl From<RunError> for CliError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Flaws(flaws) => Self::Flaws(flaws),
            RunError::Simulation(error) => Self::Simulation(error),
            #[cfg(feature = "recording")]
            RunError::Record(error) => Self::Record(error),
            RunError::Mcap(error) => Self::Mcap(error),
        }
    }
}

impl CliError {
    /// True if Ctrl-C is the reason.
    pub fn is_stop(&self) -> bool {
        use crate::{planner::PlanError, sim::SimError};
        matches!(self, Self::Plan(PlanError::Stopped) | Self::Simulation(SimError::Stopped))
    }

    /// The result of a command with this error. An error that no input should cause is a bug.
    pub fn exit(&self) -> Exit {
        match self {
            _ if self.is_stop() => Exit::Interrupted,
            Self::JUnit(_) | Self::Csv(_) | Self::Staged(_) | Self::Mcap(_) => Exit::Bug,
            #[cfg(feature = "recording")]
            Self::Record(error) if error.is_about_a_file() => Exit::Input,
            #[cfg(feature = "recording")]
            Self::Record(_) => Exit::Bug,
            Self::Signals(_)
            | Self::Input(_)
            | Self::Simulation(_)
            | Self::Human(_)
            | Self::Robot(_)
            | Self::Setup(_)
            | Self::Plan(_)
            | Self::Flaws(_)
            | Self::OverwritesInput(_)
            | Self::NoFile { .. }
            | Self::OverwritesPlan(_)
            | Self::Write(_)
            | Self::Machine(_)
            | Self::Usage(_)
            | Self::Stdout(_) => Exit::Input,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_result_wins() {
        let order = [Exit::Met, Exit::NotMet, Exit::Infeasible, Exit::Interrupted, Exit::Input, Exit::Bug];
        assert!(order.is_sorted());
        assert_eq!(order.map(Exit::code), [0, 1, 3, 130, 2, 70]);
    }
}
