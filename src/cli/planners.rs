//! The planners of one command, by robot.

use std::{
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use super::{
    cache::{self, CacheArgs},
    exit::CliError,
    progress::Progress,
    robust,
};
use crate::{
    model::{plan::Plan, scenario::Scenario, stop::Stop as _},
    planner::{MapStore, Outcome, Planner, Watch},
    robot::{Robot, RobotOptions},
};

/// One planner per robot: scenarios with the same robot share its maps.
#[derive(Default)]
pub struct Planners {
    /// Whether plans must hold with a probability, and the probability if it is not that of the scenario.
    robust: Option<Option<f64>>,
    store: Option<Arc<dyn MapStore>>,
    known: Mutex<Vec<(RobotKey, Arc<Planner>)>>,
    /// Time that the maps of each scenario took to read or make, ms.
    map_ms: Mutex<HashMap<String, f64>>,
}

impl Planners {
    /// Planners with a command's store of maps.
    pub fn new(args: CacheArgs) -> Self {
        Self { store: cache::store(args), ..Self::default() }
    }

    /// The same, as `--robust` says: for plans that hold with a probability.
    #[must_use]
    pub fn robust(self, wanted: Option<Option<f64>>) -> Self {
        Self { robust: wanted, ..self }
    }

    /// The planner of a robot.
    pub fn of(&self, robot: &Robot) -> Arc<Planner> {
        let mut known = lock(&self.known);
        let key = (robot.description.clone(), robot.options.clone());
        if let Some((_, planner)) = known.iter().find(|(other, _)| *other == key) {
            return planner.clone();
        }
        let planner = Arc::new(match &self.store {
            Some(store) => Planner::with_store(robot, store.clone()),
            None => Planner::new(robot),
        });
        known.push((key, planner.clone()));
        planner
    }

    /// Makes the maps of scenarios before they are planned in parallel, each on all threads. A thread of rayon's pool must not
    /// wait for a map that another thread makes: while it makes parts of its own map, rayon gives it other work, which may
    /// need that same map. Stops early after Ctrl-C. A map that cannot be made is left out: the plan that needs it fails.
    pub fn prepare(&self, scenarios: &[(&Robot, &Scenario)], progress: &Progress) {
        for (robot, scenario) in scenarios {
            if !progress.is_stopped() {
                progress.begins(&scenario.name);
                let _ = catch_unwind(AssertUnwindSafe(|| self.prepare_one(robot, scenario, progress)));
            }
        }
    }

    fn prepare_one(&self, robot: &Robot, scenario: &Scenario, watch: &dyn Watch) -> Result<(), CliError> {
        let start = Instant::now();
        self.of(robot).search(scenario).watch(watch).prepare()?;
        *lock(&self.map_ms).entry(scenario.name.clone()).or_default() += start.elapsed().as_secs_f64() * 1e3;
        Ok(())
    }

    /// Plans a scenario and writes into the plan how long that took: its maps, and the search.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid, and after a stop before anything was found.
    pub fn timed_plan(&self, scenario: &Scenario, robot: &Robot, watch: &dyn Watch) -> Result<Outcome<Plan>, CliError> {
        self.prepare_one(robot, scenario, watch)?;
        let map_ms = lock(&self.map_ms).remove(&scenario.name);
        let planner = self.of(robot);
        let start = Instant::now();
        let outcome = match self.robust {
            Some(given) => {
                let wanted = given.or(scenario.expect.probability).unwrap_or(robust::PROBABILITY);
                robust::plan(&planner, scenario, wanted, watch)?
            }
            None => planner.search(scenario).watch(watch).plan()?,
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

/// A robot's description and with what it was loaded: another posture of idle joints is another robot to a planner.
type RobotKey = (String, RobotOptions);

/// The tables stay valid if a thread panics: they only change by whole entries.
fn lock<T>(table: &Mutex<T>) -> MutexGuard<'_, T> {
    table.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_robot_in_another_posture_has_a_planner_of_its_own() {
        let load = |head_pan_rad: f64| {
            let options =
                RobotOptions { posture: [("head_pan".to_owned(), head_pan_rad)].into(), ..RobotOptions::default() };
            Robot::load_with("baxter", Path::new(""), &options).unwrap()
        };
        let planners = Planners::default();
        let [ahead, again, aside] = [0.0, 0.0, 0.5].map(|head_pan_rad| planners.of(&load(head_pan_rad)));
        assert!(Arc::ptr_eq(&ahead, &again) && !Arc::ptr_eq(&ahead, &aside));
    }
}
