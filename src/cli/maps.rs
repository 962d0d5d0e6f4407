//! The planner's maps, made once per command and shared by its plans.
//!
//! Nothing here blocks while a map is made. A thread of rayon's pool that waits for another thread's map could be the one
//! that has to finish it: while it waits for parts of its own map, rayon gives it other work, which may ask for the same
//! map. So [`Maps::prepare`] makes all maps before the plans that share them run in parallel, and a map that is missing
//! after that is made by whoever needs it, if need be twice. A plan does not depend on who made its maps.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use rayon::prelude::*;

use super::interrupt;
use crate::{
    human::HumanError,
    model::scenario::Scenario,
    planner::{self, RobotMap, WorkMap},
    robot::Robot,
};

/// The maps of robots and board sizes, each with the maps of the task families planned on it.
#[derive(Default)]
pub struct Maps {
    robots: Mutex<Vec<Arc<RobotEntry>>>,
}

/// The map of a robot and a board size.
struct RobotEntry {
    description: String,
    size_m: [f64; 3],
    map: RobotMap,
    /// How long it took to make, ms.
    ms: f64,
    work: Mutex<Vec<Arc<WorkEntry>>>,
}

/// The map of a task family.
struct WorkEntry {
    /// A scenario of the family.
    scenario: Scenario,
    map: Result<WorkMap, HumanError>,
    /// How long it took to make, ms.
    ms: f64,
}

impl Maps {
    /// Makes the maps that plans of these scenarios need. Stops early after Ctrl-C. A map whose making panics is left out: the
    /// plan that needs it panics again.
    pub fn prepare(&self, scenarios: &[(&Robot, &Scenario)]) {
        let mut robots: Vec<(&Robot, &Scenario)> = Vec::new();
        let mut families = robots.clone();
        for &(robot, scenario) in scenarios {
            let same_map =
                |other: &Robot, size_m| other.description == robot.description && size_m == scenario.object.size_m;
            if !robots.iter().any(|(other, known)| same_map(other, known.object.size_m)) {
                robots.push((robot, scenario));
            }
            let same_family = |&(other, known): &(&Robot, &Scenario)| {
                same_map(other, known.object.size_m) && planner::same_work(known, scenario)
            };
            if !families.iter().any(same_family) {
                families.push((robot, scenario));
            }
        }
        let unless_interrupted = |make: &dyn Fn()| {
            if !interrupt::requested() {
                let _ = catch_unwind(AssertUnwindSafe(make));
            }
        };
        // The map of a robot is made by one thread, that of a task family by all.
        robots.par_iter().for_each(|(robot, scenario)| {
            unless_interrupted(&|| drop(self.robot(robot, scenario.object.size_m)));
        });
        for (robot, scenario) in families {
            unless_interrupted(&|| drop(self.robot(robot, scenario.object.size_m).work(scenario)));
        }
    }

    /// Calls `with` with the map of this robot and board size.
    pub fn with<T>(&self, robot: &Robot, size_m: [f64; 3], with: impl FnOnce(&RobotMap) -> T) -> T {
        with(&self.robot(robot, size_m).map)
    }

    /// Calls `with` with the maps of this robot and of a scenario's task family, and the time that they took to make, ms.
    ///
    /// # Errors
    /// If the scenario's person or tool is invalid.
    pub fn with_work<T>(
        &self,
        robot: &Robot,
        scenario: &Scenario,
        with: impl FnOnce(&RobotMap, &WorkMap, f64) -> Result<T, HumanError>,
    ) -> Result<T, HumanError> {
        let robot = self.robot(robot, scenario.object.size_m);
        let work = robot.work(scenario);
        with(&robot.map, work.map.as_ref().map_err(Clone::clone)?, robot.ms + work.ms)
    }

    fn robot(&self, robot: &Robot, size_m: [f64; 3]) -> Arc<RobotEntry> {
        let is_it = |entry: &RobotEntry| entry.description == robot.description && entry.size_m == size_m;
        find_or_make(&self.robots, is_it, || {
            let start = Instant::now();
            let map = RobotMap::new(robot, size_m);
            let description = robot.description.clone();
            RobotEntry { description, size_m, map, ms: elapsed_ms(start), work: Mutex::default() }
        })
    }
}

impl RobotEntry {
    fn work(&self, scenario: &Scenario) -> Arc<WorkEntry> {
        find_or_make(
            &self.work,
            |entry| planner::same_work(&entry.scenario, scenario),
            || {
                let start = Instant::now();
                let map = WorkMap::new(scenario, &self.map);
                WorkEntry { scenario: scenario.clone(), map, ms: elapsed_ms(start) }
            },
        )
    }
}

/// The entry of a list that `is_it` selects, or a new one. The list is not locked while the entry is made; if another thread
/// has added it meanwhile, that one is returned.
fn find_or_make<T>(list: &Mutex<Vec<Arc<T>>>, is_it: impl Fn(&T) -> bool, make: impl FnOnce() -> T) -> Arc<T> {
    let find = |list: &[Arc<T>]| list.iter().find(|entry| is_it(entry)).cloned();
    if let Some(found) = find(&lock(list)) {
        return found;
    }
    let made = Arc::new(make());
    let mut list = lock(list);
    find(&list).unwrap_or_else(|| {
        list.push(made.clone());
        made
    })
}

/// Entries are pushed whole, so the list is valid even if a thread has panicked.
fn lock<T>(list: &Mutex<T>) -> MutexGuard<'_, T> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}

fn elapsed_ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
