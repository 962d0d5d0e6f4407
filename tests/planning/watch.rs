//! What a watch is told, and plans that are stopped in every part of the work.

use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

use benchdog::{
    model::{
        plan::Plan,
        scenario::{Budget, ResponseKind, Scenario},
        stop::Stop,
    },
    planner::{Event, Outcome, Part, Phase, PlanError, Planner, Watch},
};

use crate::{
    common::baxter,
    comparison::{compared, square},
    shared::{PLANNER, fast, found, plan, plan_by, verified},
};

/// Stops at a poll, or at an event; counts and keeps what it is told.
#[derive(Default)]
struct Recorder {
    polls: AtomicU64,
    last_poll: Option<u64>,
    stops_at: Option<fn(&Event<'_>) -> bool>,
    stopped: AtomicBool,
    parts: Mutex<Vec<Part>>,
    /// Objectives of the candidates that were better than all before.
    better: Mutex<Vec<f64>>,
    /// Candidates that were told of, and of these those after the stop.
    candidates: [AtomicU64; 2],
    found: AtomicBool,
}

impl Recorder {
    fn at_poll(poll: u64) -> Self {
        Self { last_poll: Some(poll), ..Self::default() }
    }

    fn at(stops_at: fn(&Event<'_>) -> bool) -> Self {
        Self { stops_at: Some(stops_at), ..Self::default() }
    }
}

impl Stop for Recorder {
    fn is_stopped(&self) -> bool {
        let poll = self.polls.fetch_add(1, Ordering::SeqCst);
        if self.last_poll.is_some_and(|last| poll >= last) {
            self.stopped.store(true, Ordering::SeqCst);
        }
        self.stopped.load(Ordering::SeqCst)
    }
}

impl Watch for Recorder {
    fn tell(&self, event: &Event<'_>) {
        match event {
            Event::Part(part) => self.parts.lock().unwrap().push(*part),
            Event::Search(progress) => {
                let is_late = usize::from(self.stopped.load(Ordering::SeqCst));
                self.candidates[is_late].fetch_add(1, Ordering::SeqCst);
                self.better.lock().unwrap().extend(progress.better.map(|comfort| comfort.objective));
            }
            Event::Found => self.found.store(true, Ordering::SeqCst),
        }
        if self.stops_at.is_some_and(|stops_at| stops_at(event)) {
            self.stopped.store(true, Ordering::SeqCst);
        }
    }
}

fn json(plan: &Plan) -> String {
    serde_json::to_string(plan).unwrap()
}

fn objective(plan: &Plan) -> f64 {
    plan.comfort.as_ref().unwrap().objective
}

fn is_stopped<T>(outcome: &Result<Outcome<T>, PlanError>) -> bool {
    matches!(outcome, Err(PlanError::Stopped))
}

fn is_phase(event: &Event<'_>, of: impl Fn(Phase) -> bool) -> bool {
    matches!(event, Event::Part(Part { phase, .. }) if of(*phase))
}

#[test]
fn a_watch_sees_every_improvement_and_changes_nothing() {
    let scenario = fast("quickstart");
    let alone = plan(&scenario);
    let watch = Recorder::default();
    let watched = found(PLANNER.search(&scenario).watch(&watch).plan().unwrap());
    assert_eq!(json(&watched), json(&alone));
    let better = watch.better.lock().unwrap();
    assert!(better.len() > 2 && better.windows(2).all(|pair| pair[0] < pair[1]), "{better:?}");
    // The last improvement is the plan, but for rounding of one evaluation.
    assert!((better[better.len() - 1] - objective(&alone)).abs() < 1e-9);
    assert!(watch.found.load(Ordering::SeqCst));
}

/// Stopped at drawn polls of a plan and its maps: never a panic, a plan only if it keeps every constraint, and no map that is
/// not whole, since the same planner then finds the usual plan.
#[test]
fn a_plan_that_is_stopped_anywhere_keeps_no_part_of_a_map() {
    let scenario = fast("quickstart");
    let usual = plan(&scenario);
    let counted = Recorder::default();
    let planner = Planner::new(baxter());
    assert_eq!(json(&found(planner.search(&scenario).watch(&counted).plan().unwrap())), json(&usual));
    let polls = counted.polls.load(Ordering::SeqCst);
    assert!(polls > 100_000, "{polls}");

    let planner = Planner::new(baxter());
    let mut random = 1_u64;
    let mut stopped = 0;
    for _ in 0..16 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // As many draws near the beginning of the work as near its end.
        let drawn = (polls as f64).powf((random >> 11) as f64 / (1_u64 << 53) as f64) as u64;
        match planner.search(&scenario).watch(&Recorder::at_poll(drawn)).plan() {
            Err(error) => {
                assert_eq!(error, PlanError::Stopped);
                stopped += 1;
            }
            Ok(outcome) => verified(&found(outcome), &scenario),
        }
    }
    assert!(stopped > 4, "{stopped}");
    assert_eq!(json(&plan_by(&planner, &scenario)), json(&usual));
}

/// Every part of the work is told of before it begins, and can be stopped then.
#[test]
fn a_plan_can_be_stopped_as_each_part_begins() {
    let mut scenario = fast("quickstart");
    scenario.planner.budget = Budget::Default;
    let planner = Planner::new(baxter());
    let parts: [fn(&Event<'_>) -> bool; 6] = [
        |event| is_phase(event, |phase| phase == Phase::GraspLibrary),
        |event| is_phase(event, |phase| phase == Phase::Postures),
        |event| is_phase(event, |phase| phase == Phase::NaturalGrasps),
        |event| is_phase(event, |phase| matches!(phase, Phase::WarmStarts { pass: 1, .. })),
        |event| is_phase(event, |phase| matches!(phase, Phase::WarmStarts { pass: 3, .. })),
        |event| is_phase(event, |phase| phase == Phase::Search),
    ];
    for (number, part) in parts.into_iter().enumerate() {
        let watch = Recorder::at(part);
        assert!(is_stopped(&planner.search(&scenario).watch(&watch).plan()), "{number}");
        assert!(watch.stopped.load(Ordering::SeqCst) && !watch.found.load(Ordering::SeqCst), "{number}");
        let parts = watch.parts.lock().unwrap();
        assert!(parts.iter().all(|part| part.done <= part.total), "{parts:?}");
    }
    assert_eq!(json(&plan_by(&planner, &scenario)), json(&plan(&scenario)));
}

#[test]
fn a_stopped_search_has_the_best_plan_so_far() {
    let scenario = fast("quickstart");
    let full = plan(&scenario);
    // The fast budget improves its first plan a few times.
    let watch = Recorder::at(|event| {
        static BETTER: AtomicU64 = AtomicU64::new(0);
        matches!(event, Event::Search(progress) if progress.better.is_some())
            && BETTER.fetch_add(1, Ordering::SeqCst) == 2
    });
    let stopped = found(PLANNER.search(&scenario).watch(&watch).plan().unwrap());
    verified(&stopped, &scenario);
    let better = watch.better.lock().unwrap();
    assert_eq!(better.len(), 3);
    assert!((objective(&stopped) - better[2]).abs() < 1e-9);
    assert!(objective(&stopped) < objective(&full));
    assert_eq!(watch.candidates[1].load(Ordering::SeqCst), 0, "nothing is evaluated once the search is stopped");
}

/// A stopped search for several plans has the best at least; the others may cost too long to check.
#[test]
fn a_stopped_search_for_several_plans_has_the_best_of_them() {
    let scenario = fast("quickstart");
    let watch = Recorder::at(|event| matches!(event, Event::Found));
    let plans = found(PLANNER.search(&scenario).watch(&watch).top(20).unwrap());
    assert_eq!(plans.len(), 1);
    verified(&plans[0], &scenario);
}

/// A flag that is set before the search begins: there is no plan, and no claim that the scenario is infeasible.
#[test]
fn a_search_that_is_stopped_at_once_is_not_infeasible() {
    let scenario = fast("quickstart");
    let flag = AtomicBool::new(true);
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&flag).plan()));
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&flag).top(2)));
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&flag).front()));
    assert!(matches!(compared(&fast("cut-rim"), &square(), &flag), Err(PlanError::Stopped)));
    flag.store(false, Ordering::SeqCst);
    verified(&found(PLANNER.search(&scenario).watch(&flag).plan().unwrap()), &scenario);
}

/// A search that has found nothing, stopped in the second search and while the reasons are looked for.
#[test]
fn a_search_that_finds_nothing_can_be_stopped_too() {
    let mut scenario = fast("quickstart");
    scenario.operation.wrench_o.force_n *= 50.0;
    let second = Recorder::at(|event| is_phase(event, |phase| phase == Phase::SecondSearch));
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&second).plan()));
    assert!(second.stopped.load(Ordering::SeqCst));
    // A search that has ended early is not repeated.
    scenario.planner.evaluations = Some(50);
    let explanation = Recorder::at(|event| is_phase(event, |phase| phase == Phase::Explanation));
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&explanation).plan()));
    assert!(explanation.stopped.load(Ordering::SeqCst));
    assert!(matches!(PLANNER.plan(&scenario).unwrap(), Outcome::Infeasible(why) if why.ended_early));
}

/// With the mean response a plan is found once the first mean is known, not before.
#[test]
fn mean_responses_are_stopped_before_the_first_is_known() {
    let mut scenario = fast("quickstart");
    scenario.comfort.person = ResponseKind::Mean;
    let better = |event: &Event<'_>| matches!(event, Event::Search(progress) if progress.better.is_some());
    let watch = Recorder::at(better);
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&watch).plan()));
    assert!(!watch.found.load(Ordering::SeqCst));
    let watch = Recorder::at(|event| matches!(event, Event::Found));
    verified(&found(PLANNER.search(&scenario).watch(&watch).plan().unwrap()), &scenario);
}

/// The optima of a normalised objective are no plan: a search stopped while it looks for them has nothing.
#[test]
fn the_searches_for_optima_are_no_result() {
    let mut scenario = fast("quickstart");
    scenario.comfort.peripersonal_share = Some(0.3);
    let watch = Recorder::at(|event| is_phase(event, |phase| phase == Phase::Search));
    assert!(is_stopped(&PLANNER.search(&scenario).watch(&watch).plan()));
    let watch = Recorder::default();
    let watched = found(PLANNER.search(&scenario).watch(&watch).plan().unwrap());
    let parts = watch.parts.lock().unwrap();
    assert_eq!(parts.iter().filter(|part| part.phase == Phase::Search).count(), 3, "{parts:?}");
    assert_eq!(json(&watched), json(&plan(&scenario)));
}

/// A comparison that is not complete compares nothing.
#[test]
fn a_comparison_can_be_stopped_in_each_of_its_searches() {
    let scenario = fast("cut-rim");
    let phases: [fn(&Event<'_>) -> bool; 3] = [
        |event| is_phase(event, |phase| phase == Phase::OneHold),
        |event| is_phase(event, |phase| phase == Phase::Pieces),
        |event| is_phase(event, |phase| phase == Phase::RandomHolds),
    ];
    for phase in phases {
        let watch = Recorder::at(phase);
        assert!(matches!(compared(&scenario, &square(), &watch), Err(PlanError::Stopped)));
        assert!(watch.stopped.load(Ordering::SeqCst), "the watch is told of the phase");
    }
}

#[test]
fn a_stopped_front_has_the_weightings_that_were_searched() {
    let scenario: Scenario = fast("quickstart");
    let stopped_at = |at: fn(&Event<'_>) -> bool| PLANNER.search(&scenario).watch(&Recorder::at(at)).front();
    let first = stopped_at(|event| is_phase(event, |phase| matches!(phase, Phase::Weighting { number: 1, .. })));
    assert!(is_stopped(&first));
    let third = stopped_at(|event| is_phase(event, |phase| matches!(phase, Phase::Weighting { number: 3, .. })));
    let front = found(third.unwrap());
    for point in front.points.iter().chain([&front.own]) {
        verified(&point.plan, point.plan.scenario.as_ref().unwrap());
    }
}
