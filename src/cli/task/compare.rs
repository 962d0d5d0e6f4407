//! `benchdog task --compare`: the staged plan beside other strategies for the same path.

use super::super::{exit::CliError, progress::Progress};
use crate::{
    model::{plan::Plan, scenario::Scenario},
    planner::{
        Planner,
        comparison::{ComparedPlans, PlansByPiece, compared_plans},
        task::TaskPlan,
    },
    report::comparison::{Comparison, PieceFigures, Strategy, StrategyKind},
};

/// Plans the other strategies and compares their figures.
///
/// # Errors
/// As [`compared_plans`].
pub fn compared(
    planner: &Planner,
    scenario: &Scenario,
    found: &TaskPlan,
    progress: &Progress,
) -> Result<Comparison, CliError> {
    // The staged plan's scenario has the optima of a normalised objective.
    let scenario = found.staged.scenario.as_ref().unwrap_or(scenario);
    let ComparedPlans { one_hold, separate, random } =
        compared_plans(planner, scenario, &found.staged.task, &found.separate, progress)?;
    let others = vec![
        strategy(StrategyKind::OneHold, &[one_hold]),
        strategy(StrategyKind::Separate, &[separate]),
        strategy(StrategyKind::Random, &random),
    ];
    Ok(Comparison::new(&found.staged, scenario.simulation.hold_s, others))
}

/// The figures of a strategy: at each piece the means of its plans.
fn strategy(kind: StrategyKind, plans: &[PlansByPiece]) -> Strategy {
    let count = plans.first().map_or(0, Vec::len);
    let at_piece = |piece: usize| {
        let of_plan =
            |plans: &PlansByPiece| plans.get(piece)?.as_ref().and_then(|plan: &Plan| PieceFigures::of_plan(plan));
        PieceFigures::mean(&plans.iter().filter_map(of_plan).collect::<Vec<_>>())
    };
    Strategy { kind, pieces: (0..count).map(at_piece).collect() }
}
