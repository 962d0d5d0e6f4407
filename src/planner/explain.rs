//! Which limits of posture and place leave nothing, when a search finds nothing.
//!
//! The search keeps to natural postures from the start, so what it rejects does not tell which of their limits is in the way. So
//! grasps of the library are paired with postures of the same person without limits, and the limits are tested on the pairs that
//! this person could work on.

use super::{
    candidate::Candidate,
    evaluate::{self, Configuration},
    library::{GraspLibrary, LibraryEntry, PostureMap},
    outcome::{Infeasible, PlanError, UnnaturalHolds},
    params::explanation::{GRASPS, PAIRS_PER_GRASP},
    problem::{self, Problem},
    screen::align,
    watch::{Phase, Watch, begin, go_on},
};
use crate::{
    human::{Human, Standing},
    model::scenario::{Person, PostureLimits, Scenario, StandingPlace},
};

/// The evidence with the limits of posture and place that unrestricted candidates break; unchanged if the scenario has no such
/// limits.
///
/// # Errors
/// When the scenario's person or tool is invalid, and after a stop.
pub fn explained(
    scenario: &Scenario,
    library: &GraspLibrary,
    why: Infeasible,
    watch: &dyn Watch,
) -> Result<Infeasible, PlanError> {
    let person = scenario.human;
    if !person.posture.is_natural() && person.place == StandingPlace::Free {
        return Ok(why);
    }
    let free = Person { posture: PostureLimits::UNRESTRICTED, place: StandingPlace::Free, ..person };
    let relaxed = Scenario { human: free, ..scenario.clone() };
    let problem = Problem::new(&relaxed, &library.robot, watch)?;
    let limited = Human::new(&person, &scenario.tool)?;
    let mut unnatural = UnnaturalHolds::default();
    let postures = problem::posture_map(&relaxed, &problem.human, watch);
    begin(watch, Phase::Explanation);
    for candidate in feasible(&problem, library.entries(watch)?, &postures) {
        let configuration = Configuration::new(&problem, &candidate);
        let figures = limited.posture_figures(
            &candidate.work.q_h_rad,
            &problem.normal_t,
            configuration.free_share_of_sight(&problem),
        );
        let broken = figures.iter().filter(|(_, figure)| figure.margin() < 0.0);
        let elsewhere = !limited.may_stand(&Standing::of(&configuration.placement.x_wb));
        unnatural.count(broken.map(|(constraint, _)| constraint), elsewhere);
    }
    go_on(watch)?;
    Ok(Infeasible { unnatural: Some(unnatural), ..why })
}

/// Candidates that a person without limits could work on; stability is not tested. There are no more after a stop.
fn feasible<'a>(
    problem: &'a Problem<'_>,
    entries: &'a [LibraryEntry],
    postures: &'a PostureMap,
) -> impl Iterator<Item = Candidate> + 'a {
    let floor_z_m = problem.robot.robot.floor_z_m;
    let pairs = entries.iter().take(GRASPS).take_while(|_| !problem.stop.is_stopped()).flat_map(move |entry| {
        let x_wt = entry.grasp.x_wo * problem.scenario.operation.x_ot;
        let matching = postures.postures(&x_wt, floor_z_m).iter().take(PAIRS_PER_GRASP);
        matching.filter_map(|posture| align(problem, &entry.grasp, &posture.q_h_rad, &posture.x_bt)).collect::<Vec<_>>()
    });
    pairs.filter(|candidate| {
        evaluate::test_placement(problem, candidate).is_ok()
            && evaluate::test_collisions(problem, &Configuration::new(problem, candidate)).is_ok()
    })
}
