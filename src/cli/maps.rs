//! The maps of one command: each is made once, by the first scenario that asks for it.

use std::{
    sync::{Arc, Mutex, OnceLock},
    time::Instant,
};

use crate::{
    human::HumanError,
    model::scenario::Scenario,
    planner::{self, RobotMap, WorkMap},
    robot::Robot,
};

/// A map that is there or being made.
type Cell<T> = Arc<OnceLock<T>>;

/// Maps of robots by robot and size of board, each with the maps of the kinds of work that were practised on it. A plan does
/// not depend on which scenario made its maps.
#[derive(Default)]
pub struct Maps {
    known: Mutex<Vec<Entry>>,
}

/// A robot's description, the bits of a board's sides, and their map once it is there.
type Entry = (String, [u64; 3], Cell<Arc<Known>>);

/// The map of a robot, and those of kinds of work.
struct Known {
    robot: RobotMap,
    work: Mutex<Vec<Work>>,
}

/// A kind of work that is practised: a scenario of it, and its map once it is there.
type Work = (Scenario, Cell<Result<WorkMap, HumanError>>);

impl Maps {
    /// Calls `with` with the map of this robot and size, and with the time that it took to make it just now, ms.
    pub fn with<T>(&self, robot: &Robot, size_m: [f64; 3], with: impl FnOnce(&RobotMap, f64) -> T) -> T {
        let start = Instant::now();
        let known = self.known(robot, size_m);
        with(&known.robot, start.elapsed().as_secs_f64() * 1e3)
    }

    /// Calls `with` with the map of this robot and of a scenario's kind of work, and with the time that it took to make
    /// them just now, ms.
    ///
    /// # Errors
    /// When the scenario's person or tool is none.
    pub fn with_work<T>(
        &self,
        robot: &Robot,
        scenario: &Scenario,
        with: impl FnOnce(&RobotMap, &WorkMap, f64) -> Result<T, HumanError>,
    ) -> Result<T, HumanError> {
        let start = Instant::now();
        let known = self.known(robot, scenario.object.size_m);
        let cell = known.cell(scenario);
        let work = cell.get_or_init(|| WorkMap::new(scenario, &known.robot)).as_ref().map_err(Clone::clone)?;
        with(&known.robot, work, start.elapsed().as_secs_f64() * 1e3)
    }

    fn known(&self, robot: &Robot, size_m: [f64; 3]) -> Arc<Known> {
        let size = size_m.map(f64::to_bits);
        let cell = {
            let mut known = lock(&self.known);
            match known.iter().find(|(name, other, _)| *name == robot.description && *other == size) {
                Some((.., cell)) => cell.clone(),
                None => {
                    let cell = Cell::default();
                    known.push((robot.description.clone(), size, cell.clone()));
                    cell
                }
            }
        };
        let make = || Arc::new(Known { robot: RobotMap::new(robot, size_m), work: Mutex::default() });
        cell.get_or_init(make).clone()
    }
}

impl Known {
    fn cell(&self, scenario: &Scenario) -> Cell<Result<WorkMap, HumanError>> {
        let mut work = lock(&self.work);
        if let Some((_, cell)) = work.iter().find(|(other, _)| planner::same_work(other, scenario)) {
            return cell.clone();
        }
        let cell = Cell::default();
        work.push((scenario.clone(), cell.clone()));
        cell
    }
}

/// A panic elsewhere leaves a list whole: it only ever grows by whole entries.
fn lock<T>(list: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    list.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}
