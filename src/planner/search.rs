//! The search of one plan: starts, refinement, ranking.

use rand_pcg::Pcg64;

use super::{
    evaluate::{self, Evaluator, Feasible},
    library::{GraspLibrary, LibraryEntry, PostureMap},
    natural_boards::entries_for_place,
    outcome::Rejection,
    params::{SearchBudget, screening::MEAN_RESPONSES},
    problem::{self, Problem},
    random, refine, screen,
    task_family::TaskFamily,
    warm_starts::WarmStarts,
    watch::Watch,
};
use crate::{
    comfort,
    human::Human,
    model::scenario::{PlannerKind, PlannerSettings, ResponseKind, Scenario},
};

/// The candidates that the scenario's planner finds, the best first.
pub fn search(
    evaluator: &mut Evaluator<'_>,
    library: &GraspLibrary,
    warm: &WarmStarts,
    budget: &SearchBudget,
    watch: &dyn Watch,
) -> Vec<Feasible> {
    let PlannerSettings { kind, seed, .. } = evaluator.problem.scenario.planner;
    let found = if kind == PlannerKind::Random {
        random::draw(evaluator, &mut Pcg64::new(u128::from(seed), 0)).into_iter().collect()
    } else {
        let mut starts = warm.starts(evaluator, budget.warm_starts);
        match &budget.warm_rounds {
            Some(rounds) if !starts.is_empty() => refine::refine(evaluator, starts, rounds),
            _ => {
                // Without them the search has been stopped: it goes on with what it has.
                if let (Ok(postures), Ok(natural)) = (warm.postures(watch), warm.natural_entries(&library.robot, watch))
                {
                    starts.extend(screened(evaluator, library, postures, natural, budget, watch));
                }
                refine::refine(evaluator, starts, &budget.rounds)
            }
        }
    };
    rank(evaluator, found)
}

/// Starts from screening the library, the entries for natural postures and, if the place is given, those for it.
pub fn screened(
    evaluator: &mut Evaluator<'_>,
    library: &GraspLibrary,
    postures: &PostureMap,
    natural: &[LibraryEntry],
    budget: &SearchBudget,
    watch: &dyn Watch,
) -> Vec<Feasible> {
    let Problem { scenario, human, robot, .. } = &evaluator.problem;
    // After a stop there is no library.
    let (Ok(entries), Ok(failures)) = (library.entries(watch), library.failures(watch)) else { return Vec::new() };
    let of_place = entries_for_place(scenario, human, robot, postures, budget.natural_boards, watch);
    let entries: Vec<_> = entries.iter().chain(natural).chain(&of_place).collect();
    if entries.is_empty() {
        evaluator.stats.count_failed_draws(failures.rejections());
    }
    screen::screen(evaluator, entries.into_iter(), postures, budget)
}

/// The posture map of the scenario's task family.
pub fn own_postures(human: &Human, scenario: &Scenario, watch: &dyn Watch) -> PostureMap {
    problem::posture_map(TaskFamily::of(scenario).scenario(), human, watch)
}

/// Ranks candidates by the person's response that the scenario asks for, the best first.
///
/// With the best response they stay as they are: the search optimises it together with the grasp. With the mean response
/// the search has optimised the best response too; the first few candidates are ranked by the mean over all responses, and
/// the others are dropped. So the result is the best of those few.
pub fn rank(evaluator: &mut Evaluator<'_>, found: Vec<Feasible>) -> Vec<Feasible> {
    let Evaluator { problem, stats, .. } = evaluator;
    if problem.objective.person == ResponseKind::Best {
        return found;
    }
    let mut ranked: Vec<_> = found
        .into_iter()
        .take(MEAN_RESPONSES)
        .filter_map(|mut found| {
            let Some(mean) = evaluate::mean_response(problem, &found) else {
                // After a stop the mean is not known.
                let is_stopped = problem.stop.is_stopped();
                stats.reject(if is_stopped { Rejection::NotEvaluated } else { Rejection::PersonReach });
                return None;
            };
            comfort::use_mean_response(&mut found.comfort, mean, &problem.objective);
            found.objective = found.comfort.objective;
            stats.tell_found();
            Some(found)
        })
        .collect();
    ranked.sort_by(|a, b| b.objective.total_cmp(&a.objective));
    ranked
}
