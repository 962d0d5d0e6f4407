//! Plans, and the planner that keeps its maps and replans.

use std::{
    path::{Path, PathBuf},
    sync::Mutex,
};

use benchdog::{
    cli::{MotionAnswer, kept_maps},
    model::{
        plan::Plan,
        scenario::{Budget, PlannerKind, PlannerSettings, Scenario},
    },
    planner::{self, Outcome, Part, PlanError, Replanned, Replanning},
    robot::Robot,
    scenario::{self, LoadedScenario, read_replan_request},
};
use pyo3::{prelude::*, types::PyDict};
use serde::{Serialize, de::DeserializeOwned};

use crate::{
    document::document,
    errors::{self, DICT, Infeasible},
    source::{self, Source},
    work::Work,
};

/// What a call says of the search in place of the scenario.
#[derive(FromPyObject, Default)]
#[pyo3(from_item_all)]
pub struct SearchOptions {
    seed: Option<u64>,
    kind: Option<String>,
    budget: Option<String>,
    evaluations: Option<u64>,
}

impl SearchOptions {
    /// Changes the scenario of a file.
    fn apply(&self, path: &Path, scenario: &mut Scenario, robot: &Robot) -> PyResult<()> {
        let now = &mut scenario.planner;
        let kind = choice::<PlannerKind>("kind", self.kind.as_deref())?.unwrap_or(now.kind);
        let budget = choice::<Budget>("budget", self.budget.as_deref())?.unwrap_or(now.budget);
        let (seed, evaluations) = (self.seed.unwrap_or(now.seed), self.evaluations.or(now.evaluations));
        *now = PlannerSettings { kind, budget, seed, evaluations, ..now.clone() };
        scenario::check_changed(path, scenario, robot).map_err(errors::input)
    }
}

/// One of the values of an enumeration, as files name it.
pub fn choice<T: DeserializeOwned>(key: &str, given: Option<&str>) -> PyResult<Option<T>> {
    let Some(given) = given else { return Ok(None) };
    serde_json::from_value(given.into()).map(Some).map_err(|error| {
        // `unknown variant `x`, expected one of `a`, `b``
        let text = error.to_string();
        let expected = text.split_once("expected ").map_or(text.clone(), |(_, expected)| expected.to_owned());
        errors::argument(key, format!("\"{given}\""), expected)
    })
}

/// A progress callback that is called when a part of the work has gone on.
struct Callback<'py> {
    function: Option<Bound<'py, PyAny>>,
    last: Option<Part>,
}

impl Callback<'_> {
    fn call(&mut self, now: Option<Part>) -> PyResult<()> {
        let (Some(function), Some(part)) = (&self.function, now) else { return Ok(()) };
        if self.last != now {
            self.last = now;
            function.call1((part.phase.to_string(), part.done, part.total))?;
        }
        Ok(())
    }
}

/// What a planner keeps.
struct State {
    planner: planner::Planner,
    /// The file of the scenario.
    path: PathBuf,
    /// The scenario with the changes of all requests so far.
    scenario: Scenario,
}

impl State {
    fn new(scenario: &Bound<'_, PyAny>, options: &SearchOptions, cache: bool) -> PyResult<Self> {
        let source = Source::scenario(scenario)?;
        let loaded = Work::default().run(scenario.py(), |_| Ok(()), || source.load_scenario())??;
        let LoadedScenario { path, mut scenario, robot, .. } = loaded;
        options.apply(&path, &mut scenario, &robot)?;
        let planner = match kept_maps().filter(|_| cache) {
            Some(store) => planner::Planner::with_store(&robot, store),
            None => planner::Planner::new(&robot),
        };
        Ok(Self { planner, path, scenario })
    }
}

/// Works with the state of a planner, without the GIL.
fn with_state<T: Send>(
    py: Python<'_>,
    state: &Mutex<State>,
    progress: Option<Bound<'_, PyAny>>,
    job: impl FnOnce(&mut State, &Work) -> PyResult<T> + Send,
) -> PyResult<T> {
    let work = Work::default();
    let mut callback = Callback { function: progress, last: None };
    let job = || match work.wait_for(state) {
        Some(mut state) => job(&mut state, &work),
        None => Err(errors::planning(PlanError::Stopped)),
    };
    work.run(py, |_| callback.call(work.part()), job)?
}

/// What was found; `benchdog.Infeasible` if nothing was.
fn found<T>(outcome: Result<Outcome<T>, PlanError>) -> PyResult<T> {
    match outcome.map_err(errors::planning)? {
        Outcome::Found(found) => Ok(found),
        Outcome::Infeasible(why) => Err(Infeasible::new_err((why.to_string(),))),
    }
}

/// The best plan of a scenario, as a dict.
#[pyfunction]
pub fn plan(
    scenario: &Bound<'_, PyAny>,
    options: SearchOptions,
    cache: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let py = scenario.py();
    let state = Mutex::new(State::new(scenario, &options, cache)?);
    let plan = with_state(py, &state, progress, |state, work| {
        found(state.planner.search(&state.scenario).watch(work).plan())
    })?;
    Ok(document(py, &plan)?.unbind())
}

/// A planner for one robot that keeps its maps, and replans.
#[pyclass(frozen, module = "benchdog._native")]
pub struct Planner(Mutex<State>);

/// An answer to a request.
#[derive(Serialize)]
struct Answer {
    plan: Plan,
    motion: Option<MotionAnswer>,
    searched: bool,
}

#[pymethods]
impl Planner {
    #[new]
    fn new(scenario: &Bound<'_, PyAny>, options: SearchOptions, cache: bool) -> PyResult<Self> {
        Ok(Self(Mutex::new(State::new(scenario, &options, cache)?)))
    }

    /// The best plan of a scenario with the same robot, by default of this planner's.
    fn plan(
        &self,
        py: Python<'_>,
        scenario: Option<&Bound<'_, PyAny>>,
        options: SearchOptions,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let given = scenario.map(Source::scenario).transpose()?;
        let plan = with_state(py, &self.0, progress, |state, work| {
            let own = state.planner.robot();
            let (path, mut scenario) = match given {
                Some(given) => {
                    let given = given.load_scenario()?;
                    is_robot_of(own, &given.robot)?;
                    (given.path, given.scenario)
                }
                None => (state.path.clone(), state.scenario.clone()),
            };
            options.apply(&path, &mut scenario, own)?;
            found(state.planner.search(&scenario).watch(work).plan())
        })?;
        Ok(document(py, &plan)?.unbind())
    }

    /// Makes or reads the maps that the first replanning needs.
    fn prepare(&self, py: Python<'_>, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        with_state(py, &self.0, progress, |state, work| {
            state.planner.prepare_replanning(&state.scenario, work).map_err(errors::planning)
        })
    }

    /// Makes a plan the one that the next replanning starts from; false if it breaks a limit of the scenario.
    fn resume(&self, plan: &Bound<'_, PyAny>) -> PyResult<bool> {
        let source = Source::plan(plan)?;
        with_state(plan.py(), &self.0, None, |state, work| {
            let given = source.load_plan(None)?;
            is_robot_of(state.planner.robot(), &given.robot)?;
            state.planner.resume(&state.scenario, &given.plan, work).map_err(errors::planning)
        })
    }

    /// A plan for what has changed: the keys of a request of `benchdog replan`.
    fn replan(&self, request: &Bound<'_, PyDict>) -> PyResult<Py<PyAny>> {
        let py = request.py();
        let text = source::values::<serde_json::Value>(request)?.to_string();
        let Replanned { plan, motion, searched } = with_state(py, &self.0, None, |state, work| {
            let request = read_replan_request(DICT.as_ref(), 1, &text, &mut state.scenario).map_err(errors::input)?;
            let how = Replanning {
                most_motion_rad: request.most_motion_deg.map(f64::to_radians),
                keep_grasps: request.keep_grasps.unwrap_or_default(),
                search: request.search.unwrap_or(true),
            };
            found(state.planner.replan(&state.scenario, &how, work))
        })?;
        Ok(document(py, &Answer { plan, motion: motion.map(MotionAnswer::from), searched })?.unbind())
    }
}

/// Requires the robot of a planner.
fn is_robot_of(own: &Robot, found: &Robot) -> PyResult<()> {
    if (&found.description, &found.options) == (&own.description, &own.options) {
        return Ok(());
    }
    Err(errors::argument("robot", &found.description, format!("{}, that of the planner", own.description)))
}
