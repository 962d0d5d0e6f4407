//! Ranking by the mean of the person's answers.

use super::{
    Problem,
    assess::{self, Feasible},
};
use crate::{comfort, model::scenario::ResponseKind};

/// How many of the best holds are compared by their mean comfort: one takes some seconds when the roll is free.
const COMPARED: usize = 4;

/// The holds as the scenario's person rates them, the best first.
///
/// With `most` they are as they came: the search chose the person's answer together with the hold. With `average` the
/// search has looked for the best answer too; the first few of what it found are ranked by the mean over all answers, and
/// the rest left out. So the mean is the best of those few, not of all holds.
pub fn rank(problem: &Problem<'_>, found: Vec<Feasible>) -> Vec<Feasible> {
    let settings = &problem.objective;
    if settings.person == ResponseKind::Best {
        return found;
    }
    let mut rated: Vec<_> = found
        .into_iter()
        .take(COMPARED)
        .filter_map(|mut found| {
            let average = assess::average(problem, &found)?;
            comfort::rate_by_average(&mut found.comfort, average, settings);
            found.worth = found.comfort.objective;
            Some(found)
        })
        .collect();
    rated.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    rated
}
