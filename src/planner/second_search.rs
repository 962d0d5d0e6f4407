//! The second search, after the first has found nothing.
//!
//! The first search looks for comfort: it tests the grasps that promise most. The second looks for anything feasible. It draws
//! more grasps and postures, with other random numbers, solves the stability of every grasp before it asks for a person, and
//! pairs the stable ones with postures. Without success it repairs the candidates that came nearest to stability.

use super::{
    evaluate::{Evaluator, Feasible, utilisations},
    library::{GraspLibrary, LibraryEntry},
    natural_boards::{entries_for_place, natural_entries},
    params::{
        SearchBudget,
        second_search::{NEARLY_STABLE, SEED_STEP},
    },
    problem::{Problem, posture_map_of},
    refine, screen,
};
use crate::model::scenario::{PlannerSettings, Scenario};

/// The candidates that the second search finds, the best first. `further` are the library's further grasps.
pub fn search_again(evaluator: &mut Evaluator<'_>, library: &GraspLibrary, further: &[LibraryEntry]) -> Vec<Feasible> {
    let budget = SearchBudget::of_second_search();
    let Problem { scenario, human, robot, .. } = &evaluator.problem;
    let seed = scenario.planner.seed.wrapping_add(SEED_STEP);
    let reseeded = Scenario { planner: PlannerSettings { seed, ..scenario.planner.clone() }, ..(*scenario).clone() };
    let postures = posture_map_of(&reseeded, human, &budget);
    let natural = natural_entries(&reseeded, human, robot, &postures, budget.natural_boards);
    let of_place = entries_for_place(&reseeded, human, robot, &postures, budget.natural_boards);
    let entries: Vec<_> = library.entries.iter().chain(further).chain(&natural).chain(&of_place).collect();
    let grasps: Vec<_> = entries.iter().map(|entry| &entry.grasp).collect();
    let mut ranked: Vec<_> = utilisations(&evaluator.problem, &grasps).into_iter().zip(entries).collect();
    // A stable sort keeps equal grasps in their order.
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (stable, others) = ranked.split_at(ranked.partition_point(|(utilisation, _)| *utilisation <= 1.0));
    let mut starts = screen::screen(evaluator, stable.iter().map(|(_, entry)| *entry), &postures, &budget);
    if starts.is_empty() {
        let nearly = others.iter().take(NEARLY_STABLE).map(|(_, entry)| *entry);
        starts = screen::screen(evaluator, nearly, &postures, &budget);
        let near: Vec<_> = evaluator.near_misses.candidates().cloned().collect();
        starts.extend(near.into_iter().filter_map(|candidate| refine::repair(evaluator, candidate)));
    }
    refine::refine(evaluator, starts, &budget.rounds)
}
