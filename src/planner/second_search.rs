//! The second search, after the first has found nothing.
//!
//! The first search looks for comfort: it tests the grasps that promise most. The second looks for anything feasible. It draws
//! more grasps and postures, with other random numbers, solves the stability of every grasp before it asks for a person, and
//! pairs the stable ones with postures. Without success it repairs the candidates that came nearest to stability.

use super::{
    assessment::utilisations,
    evaluate::{Evaluator, Feasible},
    library::GraspLibrary,
    natural_boards::{entries_for_place, natural_entries},
    near_miss::Miss,
    outcome::PlanError,
    params::{
        SearchBudget,
        second_search::{NEARLY_STABLE, REPAIR_ROUNDS, REPAIRED, SEED_STEP},
    },
    problem::{Problem, posture_map_of},
    refine, screen,
    watch::{Phase, Watch, begin},
};
use crate::model::scenario::{PlannerSettings, Scenario};

/// The candidates that the second search finds, the best first. It uses the library's further grasps too.
pub fn search_again(
    evaluator: &mut Evaluator<'_>,
    library: &GraspLibrary,
    watch: &dyn Watch,
) -> Result<Vec<Feasible>, PlanError> {
    let budget = SearchBudget::of_second_search();
    let Problem { scenario, human, robot, .. } = &evaluator.problem;
    let seed = scenario.planner.seed.wrapping_add(SEED_STEP);
    let reseeded = Scenario { planner: PlannerSettings { seed, ..scenario.planner.clone() }, ..(*scenario).clone() };
    let [first, further] = [library.entries(watch)?, library.further_entries(watch)?];
    let postures = posture_map_of(&reseeded, human, &budget, watch);
    let natural = natural_entries(&reseeded, human, robot, &postures, budget.natural_boards, watch);
    let of_place = entries_for_place(&reseeded, human, robot, &postures, budget.natural_boards, watch);
    begin(watch, Phase::SecondSearch);
    let entries: Vec<_> = first.iter().chain(further).chain(&natural).chain(&of_place).collect();
    let grasps: Vec<_> = entries.iter().map(|entry| &entry.grasp).collect();
    let mut ranked: Vec<_> = utilisations(&evaluator.problem, &grasps).into_iter().zip(entries).collect();
    // A stable sort keeps equal grasps in their order.
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (stable, others) = ranked.split_at(ranked.partition_point(|(utilisation, _)| *utilisation <= 1.0));
    let mut starts = screen::screen(evaluator, stable.iter().map(|(_, entry)| *entry), &postures, &budget);
    if starts.is_empty() {
        let nearly = others.iter().take(NEARLY_STABLE).map(|(_, entry)| *entry);
        starts = screen::screen(evaluator, nearly, &postures, &budget);
        starts.extend(repaired(evaluator));
    }
    Ok(refine::refine(evaluator, starts, &budget.rounds))
}

/// Feasible candidates near the nearest misses. What a failed repair comes to is a nearest miss itself and is repaired in the next
/// round.
fn repaired(evaluator: &mut Evaluator<'_>) -> Vec<Feasible> {
    let mut tried: Vec<f64> = Vec::new();
    let mut found = Vec::new();
    for _ in 0..REPAIR_ROUNDS {
        let near = evaluator.near_misses.kept().to_vec();
        for Miss { utilisation, candidate, .. } in near {
            // Equal to the last digit is the same candidate, or as good.
            if found.len() == REPAIRED || tried.contains(&utilisation) {
                continue;
            }
            tried.push(utilisation);
            found.extend(refine::repair(evaluator, candidate));
        }
    }
    found
}
