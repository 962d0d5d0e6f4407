//! Search statistics, and the limit of evaluations.
//!
//! A search counts its candidates and what rejected them. It tells its watch of every evaluated candidate and every
//! improvement; nothing is evaluated after a stop, and the best candidate so far is the result.

use std::collections::BTreeMap;

use super::{
    outcome::{Infeasible, Rejection},
    watch::{Event, Progress, Watch},
};
use crate::model::plan::Comfort;

/// The statistics of one search.
pub struct SearchStats<'a> {
    candidates: u64,
    limit: u64,
    best_objective: f64,
    removed: BTreeMap<Rejection, u64>,
    watch: &'a dyn Watch,
    /// True if the watch is told of candidates.
    tells: bool,
}

impl<'a> SearchStats<'a> {
    /// Statistics of a search of at most `limit` candidates, of which the watch is told.
    pub fn new(limit: Option<u64>, watch: &'a dyn Watch) -> Self {
        Self {
            candidates: 0,
            limit: limit.unwrap_or(u64::MAX),
            best_objective: f64::NEG_INFINITY,
            removed: BTreeMap::new(),
            watch,
            tells: true,
        }
    }

    /// Statistics without a limit; the watch may stop the search, but is not told of its candidates.
    pub fn unlimited(watch: &'a dyn Watch) -> Self {
        Self { tells: false, ..Self::new(None, watch) }
    }

    /// Number of candidates; those beyond the limit were not evaluated and do not count.
    pub fn candidates(&self) -> u64 {
        self.candidates.min(self.limit)
    }

    /// True if no further candidate may be drawn.
    pub fn is_exhausted(&self) -> bool {
        self.candidates >= self.limit || self.watch.is_stopped()
    }

    /// Counts a candidate.
    pub fn count(&mut self) {
        self.candidates += 1;
    }

    /// Counts draws of the grasp library that all failed, by what rejected them.
    pub fn count_failed_draws(&mut self, rejections: impl Iterator<Item = (Rejection, u64)>) {
        for (why, draws) in rejections {
            self.candidates += draws;
            *self.removed.entry(why).or_default() += draws;
        }
    }

    /// Counts a rejection; candidates that were not evaluated are left out.
    pub fn reject(&mut self, why: Rejection) {
        if why != Rejection::NotEvaluated {
            *self.removed.entry(why).or_default() += 1;
        }
    }

    /// True if the candidate counted last may be evaluated; the watch is told of it.
    pub fn may_evaluate(&mut self) -> bool {
        if self.candidates > self.limit || self.watch.is_stopped() {
            return false;
        }
        self.tell(None);
        !self.watch.is_stopped()
    }

    /// Tells of a feasible candidate if it is the best so far.
    pub fn found(&mut self, comfort: &Comfort) {
        if comfort.objective > self.best_objective {
            self.best_objective = comfort.objective;
            self.tell(Some(comfort));
        }
    }

    /// The evidence that nothing was found: every rejected candidate under the one constraint that rejected it. Grasps that
    /// led to candidates, and feasible candidates that the search left for better ones, are not among them.
    pub fn into_infeasible(self) -> Infeasible {
        let ended_early = self.is_exhausted();
        let mut removed: Vec<_> = self.removed.into_iter().map(|(why, count)| (why.name(), count)).collect();
        removed.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        let candidates = removed.iter().map(|(_, count)| count).sum();
        Infeasible { candidates, removed, ended_early, ..Infeasible::default() }
    }

    fn tell(&self, better: Option<&Comfort>) {
        if self.tells {
            self.watch.tell(&Event::Search(Progress { evaluations: self.candidates(), better }));
        }
    }

    /// Tells that a stopped search would now return something.
    pub fn tell_found(&self) {
        if self.tells {
            self.watch.tell(&Event::Found);
        }
    }
}
