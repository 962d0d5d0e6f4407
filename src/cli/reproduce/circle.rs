//! The whole circle of `benchdog reproduce`, as `benchdog task --compare` plans, compares and judges it.

use std::path::Path;

use crate::{
    check::StagedStates,
    cli::{
        exit::CliError,
        planners::Planners,
        progress::Progress,
        task::{compared, run_staged},
    },
    model::scenario::ResponseKind,
    report::comparison::{Comparison, Strategy},
    reproduce::evaluation::{Circle, CircleRow},
    scenario,
};

/// The task file.
pub const SCENARIO: &str = include_str!("../../../scenarios/whole-circle.toml");

/// Plans, compares, simulates and judges the task.
///
/// # Errors
/// If there is no plan, it cannot be simulated, and after a stop.
pub fn circle(planners: &Planners, progress: &Progress) -> Result<Circle, CliError> {
    progress.begins("whole circle");
    let (mut loaded, task) = scenario::load_task_text(Path::new("scenarios/whole-circle.toml"), SCENARIO)?;
    // Holds are compared by the person's best response, as `benchdog task` does.
    loaded.scenario.comfort.person = ResponseKind::Best;
    let planner = planners.of(&loaded.robot);
    let search = || planner.search(&loaded.scenario).watch(progress);
    search().prepare_task(&task)?;
    let found =
        search().task(&task)?.map_err(|why| CliError::Machine(format!("the whole circle has no plan: {why}")))?;
    let comparison = compared(&planner, &loaded.scenario, &found, progress)?;
    let robot = loaded.robot.at_gap(found.staged.object.size_m[2]);
    let states = StagedStates::new(&robot, &found.staged)?;
    let run = run_staged(&loaded.scenario, &robot, &found.staged, &states, progress)?;
    Ok(Circle {
        verdict: run.verdict.verdict,
        pieces: comparison.pieces.len(),
        moves_and_regrasps: comparison.moves_and_regrasps,
        duration_s: run.verdict.duration_s,
        rows: comparison.strategies.iter().map(|strategy| row(&comparison, strategy)).collect(),
    })
}

fn row(comparison: &Comparison, strategy: &Strategy) -> CircleRow {
    let totals = comparison.totals(strategy);
    CircleRow {
        strategy: strategy.kind.title().to_owned(),
        served: totals.served,
        mean_effort: totals.mean_effort,
        staged_ratio: comparison.staged_ratio(strategy).1,
        mean_objective: totals.mean_objective,
    }
}
