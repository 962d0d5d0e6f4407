//! What the staged plan of a task is compared with (docs/method.md#117-comparison): for the same path and pieces one hold for as many
//! pieces as possible, the best hold for each piece by itself, and random holds, each with the person's best response.

use rayon::prelude::*;

pub use super::one_hold::PlansByPiece;

use super::{
    outcome::PlanError,
    params::comparison::RANDOM_PLANS,
    planner::{Planner, Search},
    task,
    watch::{Counter, Phase, Watch, go_on},
};
use crate::model::{
    plan::Plan,
    scenario::{PlannerKind, PlannerSettings, Scenario},
    task::Task,
};

/// The plans of the strategies beside the staged one.
#[derive(Clone, Debug)]
pub struct ComparedPlans {
    /// One hold: all plans have the same arms and the same board.
    pub one_hold: PlansByPiece,
    /// The best hold for each piece by itself.
    pub separate: PlansByPiece,
    /// The plans of the random planner: for each of several seeds those of all pieces.
    pub random: Vec<PlansByPiece>,
}

/// The plans that a task's staged plan is compared with. `scenario` is that of the staged plan, with the optima of a normalised
/// objective filled in; `separate` has the plans for pieces by themselves that are known already, those of the other pieces are made.
/// The same arguments give the same plans, bit for bit, for any number of threads.
///
/// # Errors
/// When the scenario's person or tool is invalid, and after a stop.
pub fn compared_plans(
    planner: &Planner,
    scenario: &Scenario,
    task: &Task,
    separate: &[Option<Plan>],
    watch: &dyn Watch,
) -> Result<ComparedPlans, PlanError> {
    let pieces = task::pieces(scenario, task);
    let search = || planner.search(scenario).watch(watch);
    let one_hold = search().one_hold(&pieces)?;
    let separate = completed(search(), &pieces, separate)?;
    let random = random_plans(planner, &pieces, watch)?;
    Ok(ComparedPlans { one_hold, separate, random })
}

/// The plans of pieces by themselves, with those that are not known.
fn completed(search: Search<'_>, pieces: &[Scenario], separate: &[Option<Plan>]) -> Result<PlansByPiece, PlanError> {
    let is_missing = |piece: &usize| !matches!(separate.get(*piece), Some(Some(_)));
    let missing: Vec<_> = (0..pieces.len()).filter(is_missing).collect();
    if missing.is_empty() {
        return Ok(separate.to_vec());
    }
    let planned = search.separate(missing.iter().map(|&piece| &pieces[piece]))?;
    let mut all: PlansByPiece = separate.iter().cloned().chain(std::iter::repeat(None)).take(pieces.len()).collect();
    for (piece, outcome) in missing.into_iter().zip(planned) {
        all[piece] = outcome.found();
    }
    Ok(all)
}

/// The random plans of all pieces, with the seeds from that of the task on.
fn random_plans(planner: &Planner, pieces: &[Scenario], watch: &dyn Watch) -> Result<Vec<PlansByPiece>, PlanError> {
    let with_seed = |number: usize| {
        let random = move |piece: &Scenario| {
            let seed = piece.planner.seed.wrapping_add(number as u64);
            let planner = PlannerSettings { kind: PlannerKind::Random, seed, ..piece.planner.clone() };
            Scenario { planner, ..piece.clone() }
        };
        pieces.iter().map(random)
    };
    let scenarios: Vec<_> = (0..RANDOM_PLANS).flat_map(with_seed).collect();
    let counter = Counter::new(watch, Phase::RandomHolds, scenarios.len());
    let plan = |scenario: &Scenario| {
        let plan = planner.search(scenario).watch(&counter).searched_once()?;
        counter.advance();
        Ok(plan)
    };
    let plans = scenarios.par_iter().map(plan).collect::<Result<Vec<_>, PlanError>>()?;
    go_on(watch)?;
    Ok(plans.chunks(pieces.len().max(1)).map(<[_]>::to_vec).collect())
}
