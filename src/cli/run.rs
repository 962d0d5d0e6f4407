//! `benchdog run`: the main job, on one scenario or many.

use std::{
    collections::BTreeMap,
    num::NonZero,
    path::Path,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    args::RunArgs,
    exit::{CliError, Exit},
    finish::{Ended, finish, report},
    maps::Maps,
    pipeline,
};
use crate::scenario::{self, LoadedScenario};

/// Runs scenarios: all are read and checked before the first is planned.
pub fn run(args: &RunArgs) -> Result<Exit, CliError> {
    let scenarios = load_all(args)?;
    let maps = Maps::default();
    let jobs = args.jobs.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZero::get);
    let ended = in_parallel(jobs, &scenarios, |loaded| {
        Ended::catch(&loaded.scenario.name, || {
            let run = pipeline::run_scenario(loaded, &maps)?;
            finish(run, &loaded.scenario, &loaded.robot, &args.report)
        })
    });
    report(ended, &args.report)
}

fn load_all(args: &RunArgs) -> Result<Vec<LoadedScenario>, CliError> {
    let mut scenarios = Vec::with_capacity(args.scenarios.len());
    let mut names = BTreeMap::<String, &Path>::new();
    for path in &args.scenarios {
        let mut loaded = scenario::load(path)?;
        if let Some(seed) = args.seed {
            loaded.scenario.planner.seed = seed;
        }
        let name = loaded.scenario.name.clone();
        if let Some(other) = names.insert(name.clone(), path) {
            let (path, other) = (path.display(), other.display());
            return Err(CliError::Usage(format!("{path}: name: found \"{name}\", which is the name of {other} too")));
        }
        scenarios.push(loaded);
    }
    Ok(scenarios)
}

/// The results of a job on every item, in the order of the items, worked off by so many threads.
fn in_parallel<T: Sync, R: Send>(jobs: usize, items: &[T], job: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::with_capacity(items.len()));
    std::thread::scope(|scope| {
        for _ in 0..jobs.min(items.len()) {
            scope.spawn(|| {
                while let Some((index, item)) = {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    items.get(index).map(|item| (index, item))
                } {
                    let result = job(item);
                    done.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((index, result));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    done.sort_by_key(|&(index, _)| index);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..50).collect();
        for jobs in [1, 2, 7, 100] {
            assert_eq!(in_parallel(jobs, &items, |item| item * item), items.iter().map(|i| i * i).collect::<Vec<_>>());
        }
        assert!(in_parallel(2, &[], |item: &u64| *item).is_empty());
    }
}
