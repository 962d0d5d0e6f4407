//! Search statistics, the limit of evaluations, and the observer.
//!
//! A search counts its candidates and what rejected them. It reports every evaluated candidate and every improvement to
//! its observer, which may stop it; nothing is evaluated after that and the best candidate so far is the result. The search
//! knows no clock. An observer that never stops the search does not change its result.

use std::{collections::BTreeMap, ops::ControlFlow};

use super::outcome::{Infeasible, Rejection};
use crate::model::plan::Comfort;

/// What a search reports to its observer.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Candidates so far.
    pub evaluations: u64,
    /// The comfort of a feasible candidate that is better than all before; `None` for any other candidate.
    pub better: Option<&'a Comfort>,
}

/// Called with the progress of a search; `Break` stops the search.
pub type Observer<'a> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'a;

/// A shorter borrow of an observer.
pub fn reborrow<'s>(observer: &'s mut Option<&mut Observer<'_>>) -> Option<&'s mut Observer<'s>> {
    match observer {
        Some(observer) => Some(&mut **observer),
        None => None,
    }
}

/// The statistics of one search.
pub struct SearchStats<'a> {
    candidates: u64,
    limit: u64,
    stopped: bool,
    best_objective: f64,
    removed: BTreeMap<Rejection, u64>,
    observer: Option<&'a mut Observer<'a>>,
}

impl<'a> SearchStats<'a> {
    /// Statistics of a search of at most `limit` candidates, with an observer.
    pub fn new(limit: Option<u64>, observer: Option<&'a mut Observer<'a>>) -> Self {
        Self {
            candidates: 0,
            limit: limit.unwrap_or(u64::MAX),
            stopped: false,
            best_objective: f64::NEG_INFINITY,
            removed: BTreeMap::new(),
            observer,
        }
    }

    /// Statistics without limit or observer.
    pub fn unlimited() -> Self {
        Self::new(None, None)
    }

    /// Number of candidates; those beyond the limit were not evaluated and do not count.
    pub fn candidates(&self) -> u64 {
        self.candidates.min(self.limit)
    }

    /// True if no further candidate may be drawn.
    pub fn is_exhausted(&self) -> bool {
        self.stopped || self.candidates >= self.limit
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

    /// True if the candidate counted last may be evaluated; reports it to the observer.
    pub fn may_evaluate(&mut self) -> bool {
        if self.stopped || self.candidates > self.limit {
            return false;
        }
        self.report(None);
        !self.stopped
    }

    /// Reports a feasible candidate if it is the best so far.
    pub fn found(&mut self, comfort: &Comfort) {
        if comfort.objective > self.best_objective {
            self.best_objective = comfort.objective;
            self.report(Some(comfort));
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

    fn report(&mut self, better: Option<&Comfort>) {
        let progress = Progress { evaluations: self.candidates(), better };
        if let Some(observer) = &mut self.observer
            && observer(&progress).is_break()
        {
            self.stopped = true;
        }
    }
}
