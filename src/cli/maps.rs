//! The robot maps of one command: each is made once, by the first scenario that asks for it.

use std::{
    sync::{Arc, Mutex, OnceLock},
    time::Instant,
};

use crate::{planner::RobotMap, robot::Robot};

/// A map that is there or being made.
type Cell = Arc<OnceLock<RobotMap>>;

/// Maps by robot and size of board. A plan does not depend on which scenario made its map.
#[derive(Default)]
pub struct Maps {
    known: Mutex<Vec<(String, [u64; 3], Cell)>>,
}

impl Maps {
    /// Calls `with` with the map of this robot and size, and with the time that it took to make it just now, ms.
    pub fn with<T>(&self, robot: &Robot, size_m: [f64; 3], with: impl FnOnce(&RobotMap, f64) -> T) -> T {
        let cell = self.cell(robot, size_m);
        let start = Instant::now();
        let map = cell.get_or_init(|| RobotMap::new(robot, size_m));
        with(map, start.elapsed().as_secs_f64() * 1e3)
    }

    fn cell(&self, robot: &Robot, size_m: [f64; 3]) -> Cell {
        let size = size_m.map(f64::to_bits);
        // A panic elsewhere leaves the list whole: it only ever grows by whole entries.
        let mut known = self.known.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((.., cell)) = known.iter().find(|(name, other, _)| *name == robot.description && *other == size) {
            return cell.clone();
        }
        let cell = Cell::default();
        known.push((robot.description.clone(), size, cell.clone()));
        cell
    }
}
