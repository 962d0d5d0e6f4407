//! The trade-off between the two comforts: a Pareto front.
//!
//! Every weighting of the two comforts asks for one hold; swept from one comfort alone to the other alone, the weights give
//! the corners of the front's convex hull. The weights are each over the metric's own optimum, so that an even sweep is
//! even whatever the units: half and half is the normalised objective. A weighted sum cannot find what lies inside a dent
//! of the front, and every hold is the best of a search, not of all holds: the true front may lie further out, never
//! further in.

use super::{
    Count, Effort, Feasible, Infeasible, Onlooker, Problem, RobotMap, Tally, Watch, WorkMap, assemble, assess, propose,
    refine, verify, with_optima,
};
use crate::{
    comfort,
    human::HumanError,
    model::{
        plan::{Comfort, Plan},
        scenario::{ComfortSettings, Optima, PlannerKind, PlannerSettings, ResponseKind, Scenario},
    },
};

/// Shares of the peripersonal comfort in the sweep, besides the scenario's own: closer together towards either end, where
/// one comfort buys much of the other.
const SHARES: [f64; 13] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0];

/// A hold of the front.
#[derive(Clone, Debug)]
pub struct FrontPoint {
    /// The share of the peripersonal comfort in the objective that asked for it, from 0 to 1, when each comfort counts by
    /// what it is over its own optimum.
    pub share: f64,
    /// The plan, checked from scratch; its scenario has the weights that asked for it.
    pub plan: Plan,
}

impl FrontPoint {
    /// The two comforts: regularised muscular, and peripersonal in m.
    pub fn comforts(&self) -> [f64; 2] {
        comforts(self.plan.comfort.as_ref())
    }
}

fn comforts(comfort: Option<&Comfort>) -> [f64; 2] {
    // A plan of the planner has its comfort; one without would be worth nothing.
    comfort.map_or([0.0; 2], |comfort| [comfort.muscular_regularised, comfort.peripersonal_m])
}

/// The front.
#[derive(Clone, Debug)]
pub struct Front {
    /// The best regularised muscular comfort and the best peripersonal comfort (m) that were found.
    pub optima: [f64; 2],
    /// Holds of which none is beaten or equalled in both comforts by another, from the best muscular to the best
    /// peripersonal comfort.
    pub points: Vec<FrontPoint>,
    /// The hold that the scenario's own weights ask for; it is on the front too unless it is beaten.
    pub own: FrontPoint,
}

/// What a search for the front came to.
#[derive(Clone, Debug)]
pub enum FrontOutcome {
    /// The front: at least one hold.
    Found(Box<Front>),
    /// No candidate kept every constraint.
    Infeasible(Infeasible),
}

/// The Pareto front of a scenario's two comforts, by the person's best answers. Each weighting is searched like a plan of
/// its own, from the best hold of the others too, and then climbed to once more from the best of all; so no weighting has
/// less than what another one found for it. A limit of evaluations is for each search. Once stopped the front is that of
/// what was found.
///
/// # Errors
/// As [`super::plan`].
pub fn front(scenario: &Scenario, map: &RobotMap, onlooker: &mut Onlooker<'_>) -> Result<FrontOutcome, HumanError> {
    let both = PlannerSettings { kind: PlannerKind::Comfort, ..scenario.planner.clone() };
    let resolved = match with_optima(&Scenario { planner: both, ..scenario.clone() }, map)? {
        Ok(scenario) => scenario,
        Err(why) => return Ok(FrontOutcome::Infeasible(why)),
    };
    let scenario = &resolved;
    let own = weighted(scenario, scenario.comfort.weights());
    let work = WorkMap::new(&own, map)?;
    let mut sweep = Sweep { map, work: &work, pool: Vec::new(), infeasible: None };
    let alone = [[1.0, 0.0], [0.0, 1.0]].map(|weights| weighted(scenario, weights));
    for scenario in &alone {
        sweep.search(scenario, true, onlooker)?;
    }
    let optima = sweep.optima();
    let swept: Vec<_> = SHARES.into_iter().map(|share| weighted(scenario, normalised(share, optima))).collect();
    let all = || std::iter::once(&own).chain(&swept);
    for scenario in all().filter(|scenario| !is_alone(scenario)) {
        sweep.search(scenario, true, onlooker)?;
    }
    for scenario in all().rev() {
        sweep.search(scenario, false, onlooker)?;
    }
    let optima = sweep.optima();
    let mut points = Vec::new();
    for scenario in all() {
        points.extend(sweep.best(scenario)?.map(|plan| FrontPoint { share: share(scenario, optima), plan }));
    }
    Ok(match points.first().cloned() {
        Some(own) => FrontOutcome::Found(Box::new(Front { optima, points: non_dominated(points), own })),
        None => FrontOutcome::Infeasible(sweep.infeasible.unwrap_or(Infeasible { candidates: 0, removed: Vec::new() })),
    })
}

/// A scenario with other weights, of the person's best answers.
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

/// The share of the peripersonal comfort in a scenario's weights, by what each counts at its optimum.
fn share(scenario: &Scenario, optima: [f64; 2]) -> f64 {
    let ComfortSettings { weight_muscular, weight_peripersonal, .. } = scenario.comfort;
    let [muscular, peripersonal] = [weight_muscular * optima[0], weight_peripersonal * optima[1]];
    if muscular + peripersonal > 0.0 { peripersonal / (muscular + peripersonal) } else { 0.0 }
}

/// The searches of a front and what they found.
struct Sweep<'m> {
    map: &'m RobotMap,
    /// Of the scenario's own weights: what is good for them is a start for all.
    work: &'m WorkMap,
    pool: Vec<Feasible>,
    /// Why the first search that found nothing did not.
    infeasible: Option<Infeasible>,
}

impl Sweep<'_> {
    /// Searches for the best hold of a weighting, from the best of the pool and, when `anew`, from proposals too.
    fn search(&mut self, scenario: &Scenario, anew: bool, onlooker: &mut Onlooker<'_>) -> Result<(), HumanError> {
        let count = Count::of_at_most(scenario.planner.evaluations);
        let mut problem = Problem::new(scenario, self.map, Watch::new(count.clone(), onlooker))?;
        let mut tally = Tally::new(count);
        let mut effort = Effort::of(scenario.planner.budget);
        let mut starts = Vec::new();
        if anew {
            starts = propose::best_candidates(&mut problem, &self.map.bank, &effort, &mut tally);
        }
        let proposed = starts.len();
        if anew {
            starts.extend(self.work.starts(&mut problem, effort.known_starts, &mut tally));
        }
        if let Some(index) = self.index_of_best(scenario) {
            tally.draw();
            starts.extend(assess::feasible(&mut problem, self.pool[index].candidate.clone()));
        }
        // What is known goes along, and takes no proposal's place in a heat.
        effort.heats.iter_mut().for_each(|heat| heat.climbs += starts.len() - proposed);
        self.pool.extend(refine::refine(&mut problem, starts, &effort.heats, &mut tally));
        if self.pool.is_empty() {
            self.infeasible.get_or_insert(tally.into_infeasible());
        }
        Ok(())
    }

    /// The number of the pool's best hold under a scenario's weights.
    fn index_of_best(&self, scenario: &Scenario) -> Option<usize> {
        let worth = |index: &usize| comfort::weighted(self.pool[*index].comfort, &scenario.comfort).objective;
        (0..self.pool.len()).max_by(|a, b| worth(a).total_cmp(&worth(b)))
    }

    fn optima(&self) -> [f64; 2] {
        let comforts = self.pool.iter().map(|found| comforts(Some(&found.comfort)));
        comforts.fold([0.0; 2], |best, comforts| std::array::from_fn(|i| comforts[i].max(best[i])))
    }

    /// The plan of the best hold of the pool that the check from scratch confirms.
    fn best(&mut self, scenario: &Scenario) -> Result<Option<Plan>, HumanError> {
        let mut problem = Problem::new(scenario, self.map, Watch::unseen())?;
        while let Some(index) = self.index_of_best(scenario) {
            if let Some(plan) = assemble(&mut problem, &self.pool[index], 0)
                && verify(&plan, scenario, &self.map.robot)?.is_empty()
            {
                return Ok(Some(plan));
            }
            self.pool.swap_remove(index);
        }
        Ok(None)
    }
}

/// Those of which none is beaten or equalled in both comforts, from the best in the first to the best in the second.
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
