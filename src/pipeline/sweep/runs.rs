//! The runs of a sweep in blocks, on the threads of the current pool.

use std::collections::BTreeSet;

use super::study::Study;
use crate::{
    model::stop::Stop,
    pipeline::{RunError, parallel::map_in_parallel},
    sweep::record::RunRecord,
};

/// The runs of a block: some seconds.
const BLOCK: usize = 20;

/// The blocks after which it is asked whether there are enough runs.
const BLOCKS_LOOKED_AT: usize = 5;

/// Which runs there are, and when there are enough.
pub struct Extent<'a> {
    /// The indices, in increasing order.
    pub indices: Vec<u64>,
    /// True if the first runs are enough; asked after every fifth block.
    pub enough: &'a dyn Fn(&[RunRecord]) -> bool,
}

/// Watches the runs of a sweep, and may stop them.
pub trait SweepWatch: Stop {
    /// Told of every run that is finished, from any thread; it must return soon.
    fn finished_run(&self);
}

/// Does the runs that are not yet known. `keep` is given the new runs of each block. Returns the runs in the order of their indices;
/// fewer after a stop, and if the first ones are enough.
///
/// # Errors
/// If a simulation cannot be set up, and an error of `keep`.
pub fn run<E: From<RunError>>(
    study: &Study<'_>,
    extent: &Extent<'_>,
    known: Vec<RunRecord>,
    keep: &mut dyn FnMut(&[RunRecord]) -> Result<(), E>,
    watch: &dyn SweepWatch,
) -> Result<Vec<RunRecord>, E> {
    let wanted: BTreeSet<u64> = extent.indices.iter().copied().collect();
    let mut known: Vec<_> = known.into_iter().filter(|record| wanted.contains(&record.index)).collect();
    known.sort_unstable_by_key(|record| record.index);
    known.dedup_by_key(|record| record.index);
    let mut records: Vec<RunRecord> = Vec::with_capacity(extent.indices.len());
    let mut known = known.into_iter().peekable();
    for (number, block) in extent.indices.chunks(BLOCK).enumerate() {
        let mut from_before = Vec::new();
        while let Some(record) = known.next_if(|record| block.last().is_some_and(|&last| record.index <= last)) {
            from_before.push(record);
        }
        let has = |index: &u64| from_before.iter().any(|record| record.index == *index);
        let missing: Vec<u64> = block.iter().copied().filter(|index| !has(index)).collect();
        let new = map_in_parallel(&missing, |&index| {
            let record = study.run(index, watch);
            watch.finished_run();
            record
        });
        // After a stop the runs of this block that were finished are kept.
        let stopped = watch.is_stopped();
        let new: Vec<_> = new.into_iter().filter(|run| !(stopped && run.is_err())).collect::<Result<_, RunError>>()?;
        keep(&new)?;
        (0..from_before.len()).for_each(|_| watch.finished_run());
        let before = records.len();
        records.extend(from_before);
        records.extend(new);
        records[before..].sort_unstable_by_key(|record| record.index);
        if stopped || (number + 1).is_multiple_of(BLOCKS_LOOKED_AT) && (extent.enough)(&records) {
            break;
        }
    }
    Ok(records)
}
