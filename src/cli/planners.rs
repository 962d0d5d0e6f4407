//! The planners of one command, by robot.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use super::exit::CliError;
use crate::{
    model::{plan::Plan, scenario::Scenario},
    planner::{Observer, Outcome, Planner},
    robot::Robot,
};

/// One planner per robot: scenarios with the same robot share its maps.
#[derive(Default)]
pub struct Planners {
    known: Mutex<Vec<(String, Arc<Planner>)>>,
    /// Time that [`Planners::prepare`] took for each scenario, ms.
    prepared_ms: Mutex<HashMap<String, f64>>,
}

impl Planners {
    /// The planner of a robot.
    pub fn of(&self, robot: &Robot) -> Arc<Planner> {
        let mut known = lock(&self.known);
        if let Some((_, planner)) = known.iter().find(|(description, _)| *description == robot.description) {
            return planner.clone();
        }
        let planner = Arc::new(Planner::new(robot));
        known.push((robot.description.clone(), planner.clone()));
        planner
    }

    /// Makes the maps of a scenario. A command does this for all its scenarios before it plans them in parallel: every map is
    /// made once, on all cores.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn prepare(&self, scenario: &Scenario, robot: &Robot) -> Result<(), CliError> {
        let start = Instant::now();
        self.of(robot).prepare(scenario)?;
        *lock(&self.prepared_ms).entry(scenario.name.clone()).or_default() += start.elapsed().as_secs_f64() * 1e3;
        Ok(())
    }

    /// Plans a scenario and writes into the plan how long that took: its maps, and the search.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn timed_plan<'a>(
        &self,
        scenario: &'a Scenario,
        robot: &Robot,
        observer: Option<&'a mut Observer<'a>>,
    ) -> Result<Outcome<Plan>, CliError> {
        self.prepare(scenario, robot)?;
        let map_ms = lock(&self.prepared_ms).remove(&scenario.name);
        let planner = self.of(robot);
        let start = Instant::now();
        let search = planner.search(scenario);
        let outcome = match observer {
            Some(observer) => search.observer(observer).plan()?,
            None => search.plan()?,
        };
        Ok(outcome.map(|mut plan| {
            if let Some(record) = &mut plan.planner {
                record.wall_ms = Some(start.elapsed().as_secs_f64() * 1e3);
                record.map_ms = map_ms;
            }
            plan
        }))
    }
}

/// The tables stay valid if a thread panics: they only change by whole entries.
fn lock<T>(table: &Mutex<T>) -> MutexGuard<'_, T> {
    table.lock().unwrap_or_else(PoisonError::into_inner)
}
