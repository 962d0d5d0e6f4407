//! The Pareto front of the two comforts.
//!
//! Every weighting of the two comforts asks for one grasp; swept from one comfort alone to the other, the weights give the
//! corners of the front's convex hull. The weights are relative to each metric's own optimum, so an even sweep is even
//! whatever the units. A weighted sum cannot find points in a concave part of the front, and every point is the result of a
//! search: the true front may lie farther out, never farther in.

use super::{
    assemble::{accepted, assemble},
    evaluate::{Evaluator, Feasible},
    library::GraspLibrary,
    natural_boards::natural_entries,
    outcome::{Infeasible, Outcome, PlanError, Rejection},
    params::{SearchBudget, select::FRONT_SHARES},
    problem::Problem,
    refine,
    search::{own_postures, screened},
    stats::SearchStats,
    warm_starts::WarmStarts,
    watch::{Phase, Watch, begin, go_on},
};
use crate::{
    comfort,
    model::{
        plan::{Comfort, Plan},
        scenario::{ComfortSettings, Optima, PlannerKind, PlannerSettings, ResponseKind, Scenario},
        stop::Never,
    },
};

/// The most searches of a front: each share and the scenario's own weights twice.
const SEARCHES: u64 = 2 * (FRONT_SHARES.len() as u64 + 1);

/// A point of the front.
#[derive(Clone, Debug)]
pub struct FrontPoint {
    /// Share of the peripersonal comfort, 0 to 1, in the normalised objective that was maximised.
    pub share: f64,
    /// The plan, checked; its scenario has the weights that were maximised.
    pub plan: Plan,
}

impl FrontPoint {
    /// The two comforts: regularised muscular, and peripersonal in m.
    #[must_use]
    pub fn comforts(&self) -> [f64; 2] {
        comforts(self.plan.comfort.as_ref())
    }
}

fn comforts(comfort: Option<&Comfort>) -> [f64; 2] {
    // The planner's plans state their comfort.
    comfort.map_or([0.0; 2], |comfort| [comfort.muscular_regularised, comfort.peripersonal_m])
}

/// The front.
#[derive(Clone, Debug)]
pub struct Front {
    /// The best regularised muscular comfort and the best peripersonal comfort (m) that were found.
    pub optima: [f64; 2],
    /// Points that no other point dominates, from the best muscular to the best peripersonal comfort.
    pub points: Vec<FrontPoint>,
    /// The plan for the scenario's own weights; it is on the front too unless it is dominated.
    pub own: FrontPoint,
}

/// The scenario of the comfort planner with the weights of a scenario's objective, for which a front needs warm starts.
pub fn own_weights(scenario: &Scenario) -> Scenario {
    weighted(scenario, scenario.comfort.weights())
}

/// The Pareto front of a scenario's two comforts with the person's best response. Each weighting is searched like a plan of its
/// own, from the best grasp of the others too, and then refined once more from the best of all; so no weighting has less than
/// what another one found for it. A limit of evaluations applies to each search. `scenario` has the optima of a normalised
/// objective, `warm` is made for [`own_weights`].
///
/// # Errors
/// When the scenario's person or tool is invalid, and after a stop before anything was found.
pub fn front(
    scenario: &Scenario,
    library: &GraspLibrary,
    warm: &WarmStarts,
    watch: &dyn Watch,
) -> Result<Outcome<Front>, PlanError> {
    let own = own_weights(scenario);
    let mut sweep = Sweep { library, warm, watch, searched: 0, pool: Vec::new(), infeasible: None };
    let alone = [[1.0, 0.0], [0.0, 1.0]].map(|weights| weighted(scenario, weights));
    for scenario in &alone {
        sweep.search(scenario, true)?;
    }
    let optima = sweep.optima();
    let swept: Vec<_> = FRONT_SHARES.into_iter().map(|share| weighted(scenario, normalised(share, optima))).collect();
    let all = || std::iter::once(&own).chain(&swept);
    for scenario in all().filter(|scenario| !is_alone(scenario)) {
        sweep.search(scenario, true)?;
    }
    for scenario in all().rev() {
        sweep.search(scenario, false)?;
    }
    let optima = sweep.optima();
    let mut points = Vec::new();
    for scenario in all() {
        points.extend(sweep.best(scenario)?.map(|plan| FrontPoint { share: share(scenario, optima), plan }));
    }
    Ok(match points.first().cloned() {
        Some(own) => Outcome::Found(Front { optima, points: non_dominated(points), own }),
        None => {
            go_on(watch)?;
            Outcome::Infeasible(sweep.infeasible.unwrap_or_default())
        }
    })
}

/// A scenario with other weights and the person's best response.
fn weighted(scenario: &Scenario, [weight_muscular, weight_peripersonal]: [f64; 2]) -> Scenario {
    let person = ResponseKind::Best;
    Scenario {
        comfort: ComfortSettings {
            person,
            weight_muscular,
            weight_peripersonal,
            peripersonal_share: None,
            optima: None,
            ..scenario.comfort
        },
        planner: PlannerSettings { kind: PlannerKind::Comfort, ..scenario.planner.clone() },
        ..scenario.clone()
    }
}

fn is_alone(scenario: &Scenario) -> bool {
    scenario.comfort.weight_muscular == 0.0 || scenario.comfort.weight_peripersonal == 0.0
}

/// The weights of the normalised objective.
fn normalised(share: f64, [muscular_regularised, peripersonal_m]: [f64; 2]) -> [f64; 2] {
    let optima = Some(Optima { muscular_regularised, peripersonal_m });
    ComfortSettings { peripersonal_share: Some(share), optima, ..ComfortSettings::default() }.weights()
}

/// The share of the peripersonal comfort in a scenario's weights, each comfort at its optimum.
fn share(scenario: &Scenario, optima: [f64; 2]) -> f64 {
    let ComfortSettings { weight_muscular, weight_peripersonal, .. } = scenario.comfort;
    let [muscular, peripersonal] = [weight_muscular * optima[0], weight_peripersonal * optima[1]];
    if muscular + peripersonal > 0.0 { peripersonal / (muscular + peripersonal) } else { 0.0 }
}

/// The searches of a front and what they found.
struct Sweep<'m> {
    library: &'m GraspLibrary,
    /// Warm starts for the scenario's own weights; they serve all weightings.
    warm: &'m WarmStarts,
    watch: &'m dyn Watch,
    /// Searches that have begun.
    searched: u64,
    pool: Vec<Feasible>,
    /// Why the first search without a result found nothing, or why every candidate was rejected.
    infeasible: Option<Infeasible>,
}

impl Sweep<'_> {
    /// Searches for the best grasp of a weighting from the best of the pool and, if `from_scratch`, from screening and warm
    /// starts too.
    fn search(&mut self, scenario: &Scenario, from_scratch: bool) -> Result<(), PlanError> {
        self.searched += 1;
        let (watch, phase) = (self.watch, Phase::Weighting { number: self.searched, of: SEARCHES });
        begin(watch, phase);
        let stats = SearchStats::new(scenario.planner.evaluations, watch);
        let mut evaluator = Evaluator::new(Problem::new(scenario, &self.library.robot, watch)?, stats);
        let mut budget = SearchBudget::of(scenario);
        let mut starts = Vec::new();
        if from_scratch {
            let postures = own_postures(&evaluator.problem.human, scenario, watch);
            // The postures of one comfort alone are others than those of both.
            let own = is_alone(scenario).then(|| {
                let Evaluator { problem, .. } = &evaluator;
                natural_entries(scenario, &problem.human, problem.robot, &postures, budget.natural_boards, watch)
            });
            // The front of what was found so far is the result of a stop.
            let of_warm = || self.warm.natural_entries(&self.library.robot, watch).unwrap_or_default();
            let entries = own.as_deref().unwrap_or_else(of_warm);
            begin(watch, phase);
            starts = screened(&mut evaluator, self.library, &postures, entries, &budget, watch);
        }
        let screened = starts.len();
        if from_scratch {
            starts.extend(self.warm.starts(&mut evaluator, budget.warm_starts));
        }
        if let Some(index) = self.index_of_best(scenario) {
            evaluator.stats.count();
            starts.extend(evaluator.evaluate(self.pool[index].candidate.clone()));
        }
        // Known starts take no screened candidate's place in a round.
        budget.rounds.iter_mut().for_each(|round| round.candidates += starts.len() - screened);
        let found = refine::refine(&mut evaluator, starts, &budget.rounds);
        let stats = evaluator.stats;
        self.pool.extend(found);
        if self.pool.is_empty() {
            self.infeasible.get_or_insert(stats.into_infeasible());
        }
        Ok(())
    }

    /// The index of the pool's best candidate for a scenario's weights.
    fn index_of_best(&self, scenario: &Scenario) -> Option<usize> {
        let objective = |index: &usize| comfort::weighted(self.pool[*index].comfort, &scenario.comfort).objective;
        (0..self.pool.len()).max_by(|a, b| objective(a).total_cmp(&objective(b)))
    }

    fn optima(&self) -> [f64; 2] {
        let comforts = self.pool.iter().map(|found| comforts(Some(&found.comfort)));
        comforts.fold([0.0; 2], |best, comforts| std::array::from_fn(|i| comforts[i].max(best[i])))
    }

    /// The plan of the pool's best candidate that is accepted. If none is, the rejections are why there is no front.
    fn best(&mut self, scenario: &Scenario) -> Result<Option<Plan>, PlanError> {
        let mut evaluator =
            Evaluator::new(Problem::new(scenario, &self.library.robot, &Never)?, SearchStats::unlimited(&Never));
        while let Some(index) = self.index_of_best(scenario) {
            match assemble(&mut evaluator, &self.pool[index], 0) {
                Some(plan) => {
                    if let Some(plan) = accepted(&mut evaluator, plan) {
                        return Ok(Some(plan));
                    }
                }
                None => evaluator.stats.reject(Rejection::Stability),
            }
            evaluator.stats.count();
            self.pool.swap_remove(index);
        }
        if evaluator.stats.candidates() > 0 {
            self.infeasible = Some(evaluator.stats.into_infeasible());
        }
        Ok(None)
    }
}

/// The points that no other point dominates or equals, from the best in the first comfort to the best in the second.
fn non_dominated(mut points: Vec<FrontPoint>) -> Vec<FrontPoint> {
    points.sort_by(|a, b| {
        let ([a0, a1], [b0, b1]) = (a.comforts(), b.comforts());
        b0.total_cmp(&a0).then(b1.total_cmp(&a1))
    });
    let mut best = f64::NEG_INFINITY;
    points.retain(|point| {
        let [_, second] = point.comforts();
        let kept = second > best;
        best = best.max(second);
        kept
    });
    points
}
