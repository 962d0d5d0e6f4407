//! The threads of a command: one pool, to which everything that runs in parallel is bound.

use std::num::NonZero;

use super::exit::CliError;

/// Runs `work` in a pool of this many threads, by default one per core. Whatever uses rayon inside, uses this pool.
///
/// # Errors
/// If the threads cannot be started.
pub fn with_threads<R: Send>(threads: Option<NonZero<usize>>, work: impl FnOnce() -> R + Send) -> Result<R, CliError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, NonZero::get)).build();
    let pool = pool.map_err(|error| CliError::Machine(format!("failed to start threads: {error}")))?;
    Ok(pool.install(work))
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, sync::Mutex};

    use rayon::prelude::*;

    use super::*;
    use crate::pipeline::parallel::map_in_parallel;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..50).collect();
        for threads in [1, 2, 7, 100] {
            let squares = with_threads(NonZero::new(threads), || map_in_parallel(&items, |item| item * item)).unwrap();
            assert_eq!(squares, items.iter().map(|i| i * i).collect::<Vec<_>>());
        }
        assert!(map_in_parallel(&[], |item: &u64| *item).is_empty());
    }

    #[test]
    fn one_thread_starts_the_jobs_in_order() {
        let items: Vec<usize> = (0..50).collect();
        let started = Mutex::new(Vec::new());
        with_threads(NonZero::new(1), || map_in_parallel(&items, |&item| started.lock().unwrap().push(item))).unwrap();
        assert_eq!(started.into_inner().unwrap(), items);
    }

    #[test]
    fn parallel_work_inside_a_job_uses_the_same_threads() {
        let used = Mutex::new(BTreeSet::new());
        let note = |_: usize| used.lock().unwrap().insert(format!("{:?}", std::thread::current().id()));
        let items: Vec<usize> = (0..20).collect();
        let job = |_: &usize| (0..100).into_par_iter().map(note).filter(|&new| new).count();
        with_threads(NonZero::new(2), || map_in_parallel(&items, job)).unwrap();
        assert!(used.into_inner().unwrap().len() <= 2);
    }
}
