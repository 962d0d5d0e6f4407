//! The planner: the maps that it keeps, and the searches on them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::{
    assemble::verified,
    evaluate::{Evaluator, Feasible},
    explain::explained,
    front::{self, Front},
    library::GraspLibrary,
    map_store::MapStore,
    normalise::{alone, needs_optima, with_optima},
    one_hold::{self, PlansByPiece},
    outcome::{Infeasible, Outcome, PlanError},
    params::SearchBudget,
    problem::Problem,
    replan::{self, KnownHolds, Replanned, Replanning},
    search::{rank, search},
    second_search::search_again,
    select,
    stats::SearchStats,
    task::{self, Ahead, TaskInfeasible, TaskPlan, TaskSearch},
    task_family::TaskFamily,
    warm_starts::WarmStarts,
    watch::{Counter, Phase, Subordinate, Watch, begin, go_on},
};
use crate::{
    model::{
        board::BoardShape,
        plan::Plan,
        scenario::{Optima, Person, PlannerKind, PlannerSettings, Scenario, StandingPlace},
        staged_plan::StagedPlan,
        stop::Never,
        task::Task,
    },
    robot::Robot,
};

/// Plans for one robot. It keeps what many plans share: a grasp library per shape of board and clearance (about a second) and warm starts per
/// task family (seconds), each made when it is first needed or read from a store. A plan does not depend on what was kept.
pub struct Planner {
    robot: Robot,
    store: Option<Arc<dyn MapStore>>,
    maps: Mutex<Vec<Arc<Maps>>>,
    /// The holds of the last replanning.
    known: Option<KnownHolds>,
}

/// The grasp library for one shape of board and one clearance, and the warm starts on it.
struct Maps {
    board: BoardShape,
    clearance_mm: f64,
    library: GraspLibrary,
    warm_starts: Mutex<Vec<Arc<WarmStarts>>>,
}

impl Planner {
    /// A planner without maps: they are made when a scenario needs them.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self { robot: robot.clone(), store: None, maps: Mutex::default(), known: None }
    }

    /// The robot that it plans for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// A planner that reads maps from a store before it makes them, and writes those that it makes.
    #[must_use]
    pub fn with_store(robot: &Robot, store: Arc<dyn MapStore>) -> Self {
        Self { store: Some(store), ..Self::new(robot) }
    }

    /// Reads or makes the maps that a plan of this scenario certainly needs, unless they are kept already. A search that finds nothing among
    /// the warm starts makes further ones.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn prepare(&self, scenario: &Scenario) -> Result<(), PlanError> {
        self.search(scenario).prepare()
    }

    /// Reads or makes the grasp library for the scenario's board, unless it is kept already.
    pub fn prepare_library(&self, scenario: &Scenario) {
        // Nobody stops it, and nothing else is an error.
        drop(self.maps(scenario).library.entries(&Never));
    }

    /// The best plan of a scenario. The same scenario and seed give the same plan, bit for bit.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn plan(&self, scenario: &Scenario) -> Result<Outcome<Plan>, PlanError> {
        self.search(scenario).plan()
    }

    /// A plan of a scenario that has changed since the last call: the person has moved, or the tool works at another point or with
    /// another force. It starts from the holds that are known from the calls before, and needs no maps of the new task; the first
    /// call makes those of the scenario for a person who may stand anywhere. The same calls in the same order give the same plans,
    /// bit for bit. If nothing is found, the known holds stay as they are.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn replan(
        &mut self,
        scenario: &Scenario,
        how: &Replanning,
        watch: &dyn Watch,
    ) -> Result<Outcome<Replanned>, PlanError> {
        let maps = self.maps(scenario);
        let known = self.known.as_ref().filter(|known| known.serve(scenario));
        let is_first = known.is_none();
        let with_optima = match known.and_then(KnownHolds::optima) {
            Some(optima) if needs_optima(scenario) => Outcome::Found(with_optima(scenario, optima)),
            _ => self.normalised(&maps, scenario, watch)?,
        };
        let scenario = match with_optima {
            Outcome::Found(scenario) => scenario,
            Outcome::Infeasible(why) => return Ok(Outcome::Infeasible(why)),
        };
        let mut evaluator = evaluator(&scenario, &maps, watch)?;
        let found = match self.known.as_mut().filter(|known| known.serve(&scenario)) {
            Some(known) => known.replan(&mut evaluator, how),
            None => {
                let warm = self.warm_starts(&maps, &anywhere(&scenario), watch)?;
                replan::first(&mut evaluator, &warm).map(|(plan, known)| {
                    self.known = Some(known);
                    Replanned { plan, motion: None, searched: false }
                })
            }
        };
        if let Some(found) = found {
            return Ok(Outcome::Found(found));
        }
        let is_limited = !is_first && (how.most_motion_rad.is_some() || how.keep_grasps);
        if !how.search || is_limited {
            return Ok(Outcome::Infeasible(evaluator.stats.into_infeasible()));
        }
        drop(evaluator);
        self.search_instead(&maps, &scenario, watch)
    }

    /// Makes the maps that the first [`Planner::replan`] of a scenario needs, unless they are kept already.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn prepare_replanning(&self, scenario: &Scenario, watch: &dyn Watch) -> Result<(), PlanError> {
        self.warm_starts(&self.maps(scenario), &anywhere(scenario), watch).map(drop)
    }

    /// Plans a scenario as [`Planner::plan`] does, and makes the plan the one that the next replanning starts from.
    fn search_instead(
        &mut self,
        maps: &Maps,
        scenario: &Scenario,
        watch: &dyn Watch,
    ) -> Result<Outcome<Replanned>, PlanError> {
        Ok(match self.search(scenario).watch(watch).plan()? {
            Outcome::Found(plan) => {
                let after = self.holds_of(maps, scenario, &plan, watch)?;
                let before = self.known.take().filter(|known| known.serve(scenario));
                let motion = before.zip(after.as_ref()).map(|(before, after)| before.motion_to(after));
                self.known = after;
                Outcome::Found(Replanned { plan, motion, searched: true })
            }
            Outcome::Infeasible(why) => Outcome::Infeasible(why),
        })
    }

    /// Makes a plan of the scenario the one that the next [`Planner::replan`] starts from, such as that which the robot holds now.
    /// False, and nothing is changed, if the plan does not satisfy every constraint of the scenario.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn resume(&mut self, scenario: &Scenario, plan: &Plan, watch: &dyn Watch) -> Result<bool, PlanError> {
        let maps = self.maps(scenario);
        let holds = self.holds_of(&maps, scenario, plan, watch)?;
        let serves = holds.is_some();
        self.known = holds.or_else(|| self.known.take());
        Ok(serves)
    }

    fn holds_of(
        &self,
        maps: &Maps,
        scenario: &Scenario,
        plan: &Plan,
        watch: &dyn Watch,
    ) -> Result<Option<KnownHolds>, PlanError> {
        let warm = self.warm_starts(maps, &anywhere(scenario), watch)?;
        let mut evaluator = evaluator(scenario, maps, watch)?;
        Ok(replan::of_plan(&mut evaluator, plan, &warm))
    }

    /// A search of a scenario, for several plans or with a watch.
    pub fn search<'a>(&'a self, scenario: &'a Scenario) -> Search<'a> {
        Search { planner: self, scenario, watch: &Never }
    }

    /// The maps for a scenario's shape of board and clearance. They are made outside the lock, so threads never wait for each other; two that
    /// make the same maps at once make equal ones.
    fn maps(&self, scenario: &Scenario) -> Arc<Maps> {
        let (board, clearance_mm) = (scenario.object.shape(), scenario.limits.clearance_mm);
        let is_same = |maps: &&Arc<Maps>| maps.board == board && maps.clearance_mm == clearance_mm;
        let kept = |maps: &[Arc<Maps>]| maps.iter().find(is_same).cloned();
        if let Some(maps) = kept(&lock(&self.maps)) {
            return maps;
        }
        let robot = self.robot.at_gap(board.thickness_m());
        let library = GraspLibrary::kept_in(self.store.clone(), &robot, &board, scenario.limits.clearance_m());
        let made = Maps { board: board.clone(), clearance_mm, library, warm_starts: Mutex::default() };
        let mut maps = lock(&self.maps);
        kept(&maps).unwrap_or_else(|| {
            maps.push(Arc::new(made));
            maps[maps.len() - 1].clone()
        })
    }

    /// The warm starts for a scenario's task family; made as [`Planner::maps`].
    fn warm_starts(&self, maps: &Maps, scenario: &Scenario, watch: &dyn Watch) -> Result<Arc<WarmStarts>, PlanError> {
        let family = TaskFamily::of(scenario);
        let kept = |warm: &[Arc<WarmStarts>]| warm.iter().find(|warm| warm.family == family).cloned();
        if let Some(warm) = kept(&lock(&maps.warm_starts)) {
            return Ok(warm);
        }
        let shared = self.with_solved_optima(maps, scenario, family.scenario(), watch)?;
        let made = WarmStarts::new(family.clone(), &shared, &maps.library, watch)?;
        let mut warm_starts = lock(&maps.warm_starts);
        Ok(kept(&warm_starts).unwrap_or_else(|| {
            warm_starts.push(Arc::new(made));
            warm_starts[warm_starts.len() - 1].clone()
        }))
    }

    /// A family's scenario with the optima of a normalised objective, taken from the warm starts of the two planners of one
    /// comfort: they depend on the family alone.
    fn with_solved_optima(
        &self,
        maps: &Maps,
        scenario: &Scenario,
        shared: &Scenario,
        watch: &dyn Watch,
    ) -> Result<Scenario, PlanError> {
        if !needs_optima(shared) {
            return Ok(shared.clone());
        }
        let [muscular, peripersonal] = alone(scenario).map(|scenario| self.warm_starts(maps, &scenario, watch));
        let optima = (
            muscular?.best(|comfort| comfort.muscular_regularised),
            peripersonal?.best(|comfort| comfort.peripersonal_m),
        );
        Ok(match optima {
            (Some(muscular), Some(peripersonal_m)) => {
                with_optima(shared, Optima { muscular_regularised: muscular, peripersonal_m })
            }
            _ => shared.clone(),
        })
    }

    /// The scenario with the optima of its normalised objective, which two plans find; unchanged if it does not need them.
    fn normalised(&self, maps: &Maps, scenario: &Scenario, watch: &dyn Watch) -> Result<Outcome<Scenario>, PlanError> {
        if !needs_optima(scenario) {
            return Ok(Outcome::Found(scenario.clone()));
        }
        let mut optima = [0.0; 2];
        for (scenario, optimum) in alone(scenario).iter().zip(&mut optima) {
            let warm = self.warm_starts(maps, scenario, watch)?;
            let found = best_plan(scenario, maps, &warm, true, &Subordinate(watch))?;
            // The best so far is no optimum.
            go_on(watch)?;
            match found {
                // One of the weights is 1 and the other 0.
                Outcome::Found(plan) => *optimum = plan.comfort.map_or(0.0, |comfort| comfort.objective),
                Outcome::Infeasible(why) => return Ok(Outcome::Infeasible(why)),
            }
        }
        let [muscular_regularised, peripersonal_m] = optima;
        Ok(Outcome::Found(with_optima(scenario, Optima { muscular_regularised, peripersonal_m })))
    }
}

/// The scenario for a person who may stand anywhere.
fn anywhere(scenario: &Scenario) -> Scenario {
    Scenario { human: Person { place: StandingPlace::Free, ..scenario.human }, ..scenario.clone() }
}

/// The best plan of a scenario whose objective needs no optima; `twice` allows a second search if the first finds nothing.
fn best_plan<'a>(
    scenario: &'a Scenario,
    maps: &'a Maps,
    warm: &WarmStarts,
    twice: bool,
    watch: &'a dyn Watch,
) -> Result<Outcome<Plan>, PlanError> {
    let mut evaluator = evaluator(scenario, maps, watch)?;
    if let Some(plan) = best_found(&mut evaluator, maps, warm, watch) {
        return Ok(Outcome::Found(plan));
    }
    go_on(watch)?;
    let again = if twice { second_search(&mut evaluator, maps, watch)? } else { None };
    let searched_twice = again.is_some();
    match again.and_then(|found| best_verified(&mut evaluator, &found)) {
        Some(plan) => Ok(Outcome::Found(plan)),
        None => Ok(Outcome::Infeasible(evidence(evaluator, maps, searched_twice, watch)?)),
    }
}

/// The best plan that one search finds.
fn best_found(evaluator: &mut Evaluator<'_>, maps: &Maps, warm: &WarmStarts, watch: &dyn Watch) -> Option<Plan> {
    let budget = SearchBudget::of(evaluator.problem.scenario);
    let found = search(evaluator, &maps.library, warm, &budget, watch);
    tracing::info!(evaluations = evaluator.stats.candidates(), feasible = found.len(), "searched a plan");
    best_verified(evaluator, &found)
}

fn best_verified(evaluator: &mut Evaluator<'_>, found: &[Feasible]) -> Option<Plan> {
    found.iter().find_map(|found| verified(evaluator, found))
}

/// The candidates of the second search; `None` without one: the search has ended early, or the planner is the random one, which
/// draws until it finds something.
fn second_search(
    evaluator: &mut Evaluator<'_>,
    maps: &Maps,
    watch: &dyn Watch,
) -> Result<Option<Vec<Feasible>>, PlanError> {
    if evaluator.stats.is_exhausted() || evaluator.problem.scenario.planner.kind == PlannerKind::Random {
        return Ok(None);
    }
    let found = search_again(evaluator, &maps.library, watch)?;
    Ok(Some(rank(evaluator, found)))
}

/// Why a search found nothing.
fn evidence(
    evaluator: Evaluator<'_>,
    maps: &Maps,
    searched_twice: bool,
    watch: &dyn Watch,
) -> Result<Infeasible, PlanError> {
    go_on(watch)?;
    begin(watch, Phase::Explanation);
    let Evaluator { problem, stats, near_misses, .. } = evaluator;
    let nearest = near_misses.nearest(&problem).map(Box::new);
    let library = &maps.library;
    let library = match library.is_empty(watch)? {
        true => Some(library.failures(watch)?.evidence(&library.robot.robot)),
        false => None,
    };
    let why = Infeasible { searched_twice, nearest, library, ..stats.into_infeasible() };
    explained(problem.scenario, &maps.library, why, watch)
}

fn evaluator<'a>(scenario: &'a Scenario, maps: &'a Maps, watch: &'a dyn Watch) -> Result<Evaluator<'a>, PlanError> {
    let stats = SearchStats::new(scenario.planner.evaluations, watch);
    let problem = Problem::new(scenario, &maps.library.robot, watch)?;
    begin(watch, Phase::Search);
    Ok(Evaluator::new(problem, stats))
}

/// A list stays valid if a thread panics: it only grows by whole entries.
fn lock<T>(list: &Mutex<T>) -> MutexGuard<'_, T> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A search of one scenario on a planner's maps.
#[must_use]
pub struct Search<'a> {
    planner: &'a Planner,
    scenario: &'a Scenario,
    watch: &'a dyn Watch,
}

impl<'a> Search<'a> {
    /// Tells a watch of all parts of the work, and stops when it says so: with the best that was found so far, checked like
    /// any other, or else with [`PlanError::Stopped`]. No map is kept that was not finished.
    pub fn watch(self, watch: &'a dyn Watch) -> Self {
        Self { watch, ..self }
    }

    /// Makes the maps that a plan needs, unless they are kept already.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn prepare(self) -> Result<(), PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let warm = planner.warm_starts(&maps, scenario, watch)?;
        let is_screened = SearchBudget::of(scenario).warm_rounds.is_none();
        if is_screened && scenario.planner.kind != PlannerKind::Random {
            maps.library.entries(watch)?;
            warm.natural_entries(&maps.library.robot, watch)?;
        }
        Ok(())
    }

    /// The best plan.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn plan(self) -> Result<Outcome<Plan>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let warm = planner.warm_starts(&maps, scenario, watch)?;
        match planner.normalised(&maps, scenario, watch)? {
            Outcome::Found(scenario) => best_plan(&scenario, &maps, &warm, true, watch),
            Outcome::Infeasible(why) => Ok(Outcome::Infeasible(why)),
        }
    }

    /// The best `wanted` plans that [`super::differ`] from one another, the best first: at least one, perhaps fewer than
    /// wanted. The search is that of [`Search::plan`] from more starts.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn top(self, wanted: usize) -> Result<Outcome<Vec<Plan>>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        match planner.normalised(&maps, scenario, watch)? {
            Outcome::Found(scenario) => {
                let warm = planner.warm_starts(&maps, &scenario, watch)?;
                let mut evaluator = evaluator(&scenario, &maps, watch)?;
                let plans = select::top(&mut evaluator, &maps.library, &warm, wanted, watch);
                if !plans.is_empty() {
                    return Ok(Outcome::Found(plans));
                }
                go_on(watch)?;
                let again = second_search(&mut evaluator, &maps, watch)?;
                let searched_twice = again.is_some();
                let plans =
                    again.map_or_else(Vec::new, |found| select::best_that_differ(&mut evaluator, found, wanted));
                if plans.is_empty() {
                    return Ok(Outcome::Infeasible(evidence(evaluator, &maps, searched_twice, watch)?));
                }
                Ok(Outcome::Found(plans))
            }
            Outcome::Infeasible(why) => Ok(Outcome::Infeasible(why)),
        }
    }

    /// The Pareto front of the two comforts with the person's best response, whatever planner the scenario names. A limit of
    /// evaluations applies to each weighting. A stopped search gives the front of what was found.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn front(self) -> Result<Outcome<Front>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let settings = PlannerSettings { kind: PlannerKind::Comfort, ..scenario.planner.clone() };
        match planner.normalised(&maps, &Scenario { planner: settings, ..scenario.clone() }, watch)? {
            Outcome::Found(scenario) => {
                let warm = planner.warm_starts(&maps, &front::own_weights(&scenario), watch)?;
                match front::front(&scenario, &maps.library, &warm, watch)? {
                    Outcome::Found(front) => Ok(Outcome::Found(front)),
                    Outcome::Infeasible(why) => {
                        Ok(Outcome::Infeasible(explained(&scenario, &maps.library, why, watch)?))
                    }
                }
            }
            Outcome::Infeasible(why) => Ok(Outcome::Infeasible(why)),
        }
    }

    /// Makes the maps that the plan of a task needs, unless they are kept already.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn prepare_task(self, task: &Task) -> Result<(), PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let pieces = task::pieces(scenario, task);
        for piece in task::planned_by_themselves(pieces.len()) {
            planner.warm_starts(&maps, &pieces[piece], watch)?;
        }
        Ok(())
    }

    /// The staged plan of a task with the person's best response, beside the best plans for its pieces by themselves.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn task(self, task: &Task) -> Result<Result<TaskPlan, TaskInfeasible>, PlanError> {
        self.task_ahead(task, Ahead::Whole, &mut |_| {})
    }

    /// As [`Search::task`], part by part: `ready` is told of the plan so far whenever it has new stages, which stay as they are, so
    /// that they can be carried out while the next ones are planned. Only the loads and regrasps of the next `pieces_ahead` pieces
    /// are known then: the plan may be less good than that as a whole, and a plan that begins may not end.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop.
    pub fn task_in_parts(
        self,
        task: &Task,
        pieces_ahead: usize,
        ready: &mut dyn FnMut(&StagedPlan),
    ) -> Result<Result<TaskPlan, TaskInfeasible>, PlanError> {
        self.task_ahead(task, Ahead::Pieces(pieces_ahead), ready)
    }

    fn task_ahead(
        self,
        task: &Task,
        ahead: Ahead,
        ready: &mut dyn FnMut(&StagedPlan),
    ) -> Result<Result<TaskPlan, TaskInfeasible>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        // The optima of the first piece serve for all, and make them comparable.
        let scenario = match planner.normalised(&maps, scenario, watch)? {
            Outcome::Found(scenario) => scenario,
            Outcome::Infeasible(why) => return Ok(Err(TaskInfeasible::new(task, 0, Some(why)))),
        };
        let pieces = task::pieces(&scenario, task);
        let chosen = task::planned_by_themselves(pieces.len());
        let planned = planner.search(&scenario).watch(watch).separate(chosen.iter().map(|&piece| &pieces[piece]))?;
        let mut separate = vec![None; pieces.len()];
        for (piece, outcome) in chosen.into_iter().zip(planned) {
            match outcome {
                Outcome::Found(plan) => separate[piece] = Some(plan),
                Outcome::Infeasible(why) => return Ok(Err(TaskInfeasible::new(task, piece, Some(why)))),
            }
        }
        let robot = &maps.library.robot;
        let search = TaskSearch { task, scenario: &scenario, pieces: &pieces, separate: &separate, robot, watch };
        Ok(search.run(ahead, ready)?.map(|staged| TaskPlan { staged, separate: separate.clone() }))
    }

    /// The best plan for each of these pieces of one task by itself, or why there is no plan. The optima of a normalised objective are
    /// filled in.
    pub(super) fn separate<'s>(
        self,
        pieces: impl Iterator<Item = &'s Scenario>,
    ) -> Result<Vec<Outcome<Plan>>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let pieces: Vec<_> = pieces.collect();
        // Threads that make the same map would make it twice.
        for piece in &pieces {
            planner.warm_starts(&maps, piece, watch)?;
        }
        let counter = Counter::new(watch, Phase::Pieces, pieces.len());
        let plan = |piece: &&Scenario| -> Result<Outcome<Plan>, PlanError> {
            let warm = planner.warm_starts(&maps, piece, &counter)?;
            // A piece has neighbours that are searched too.
            let found = best_plan(piece, &maps, &warm, false, &counter)?;
            counter.advance();
            Ok(found)
        };
        let planned = pieces.par_iter().map(plan).collect::<Result<_, _>>()?;
        go_on(watch)?;
        Ok(planned)
    }

    /// The plans of one hold for as many of a path's pieces as possible, with the person's best response. The pieces are of one task
    /// ([`task::pieces`]), with the optima of a normalised objective filled in.
    pub(super) fn one_hold(self, pieces: &[Scenario]) -> Result<PlansByPiece, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        one_hold::plans(pieces, &task::planned_by_themselves(pieces.len()), &maps.library, watch)
    }

    /// The best plan that one search finds, without evidence if it finds nothing. The optima of a normalised objective are filled in.
    pub(super) fn searched_once(self) -> Result<Option<Plan>, PlanError> {
        let Self { planner, scenario, watch } = self;
        let maps = planner.maps(scenario);
        let warm = planner.warm_starts(&maps, scenario, watch)?;
        let mut evaluator = evaluator(scenario, &maps, watch)?;
        Ok(best_found(&mut evaluator, &maps, &warm, watch))
    }
}
