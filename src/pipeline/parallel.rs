//! Jobs on the threads of the current pool.

use rayon::prelude::*;

/// The results of a job on every item, in the order of the items. The jobs run in parallel in the current pool and start in
/// this order.
pub fn map_in_parallel<T: Sync, R: Send>(items: &[T], job: impl Fn(&T) -> R + Sync) -> Vec<R> {
    // Unlike `par_iter`, a bridge hands out the items one by one, from the first to the last.
    let mut results: Vec<_> = items.iter().enumerate().par_bridge().map(|(index, item)| (index, job(item))).collect();
    results.sort_unstable_by_key(|&(index, _)| index);
    results.into_iter().map(|(_, result)| result).collect()
}
