//! Who looks on while a search works, and may end it.
//!
//! A search tells its onlooker of every candidate that it tests in earnest and of every hold that is better than all before;
//! the onlooker may ask for an end, after which nothing more is tested and the best so far is the result. The search
//! does not know why: a clock, a key, a count are the caller's. An onlooker who never asks changes nothing.

use std::{cell::Cell, ops::ControlFlow, rc::Rc};

use crate::model::plan::Comfort;

/// What a search tells its onlooker.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Candidates looked at so far.
    pub evaluations: u64,
    /// The comfort of a hold that keeps every constraint and is better than all before; none when this candidate is not.
    pub better: Option<&'a Comfort>,
}

/// An onlooker: `Break` ends the search with the best hold so far.
pub type Onlooker<'a> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'a;

/// An onlooker who lets the search go on.
pub fn nobody(_: &Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// How many candidates were drawn and how many may be: shared by those who count and those who test.
#[derive(Debug)]
pub(super) struct Count {
    drawn: Cell<u64>,
    most: u64,
    stopped: Cell<bool>,
}

impl Count {
    /// Nothing drawn yet, of at most so many candidates.
    pub fn of_at_most(most: Option<u64>) -> Rc<Self> {
        Rc::new(Self { drawn: Cell::new(0), most: most.unwrap_or(u64::MAX), stopped: Cell::new(false) })
    }

    /// Counts a candidate, also one too many.
    pub fn draw(&self) {
        self.drawn.set(self.drawn.get() + 1);
    }

    /// Counts so many candidates at once.
    pub fn draw_all(&self, count: u64) {
        self.drawn.set(self.drawn.get() + count);
    }

    /// How many candidates were looked at: those beyond the limit were not.
    pub fn looked_at(&self) -> u64 {
        self.drawn.get().min(self.most)
    }

    /// True when no further candidate may be drawn.
    pub fn is_exhausted(&self) -> bool {
        self.stopped.get() || self.drawn.get() >= self.most
    }

    /// True when the candidate drawn last may not be looked at.
    pub fn is_over(&self) -> bool {
        self.stopped.get() || self.drawn.get() > self.most
    }
}

/// The count of a search and its onlooker.
pub(super) struct Watch<'a> {
    count: Rc<Count>,
    best: f64,
    onlooker: Option<&'a mut Onlooker<'a>>,
}

impl<'a> Watch<'a> {
    /// An onlooker of what is counted here.
    pub fn new(count: Rc<Count>, onlooker: &'a mut Onlooker<'a>) -> Self {
        Self { count, best: f64::NEG_INFINITY, onlooker: Some(onlooker) }
    }

    /// Nobody looks on, and there is no limit.
    pub fn unseen() -> Self {
        Self { count: Count::of_at_most(None), best: f64::NEG_INFINITY, onlooker: None }
    }

    /// True when the candidate drawn last may be looked at; the onlooker is asked.
    pub fn allows(&mut self) -> bool {
        if self.count.is_over() {
            return false;
        }
        self.tell(None);
        !self.count.stopped.get()
    }

    /// Tells of a hold that keeps every constraint, if it is the best so far.
    pub fn found(&mut self, comfort: &Comfort) {
        if comfort.objective > self.best {
            self.best = comfort.objective;
            self.tell(Some(comfort));
        }
    }

    fn tell(&mut self, better: Option<&Comfort>) {
        let progress = Progress { evaluations: self.count.looked_at(), better };
        if let Some(onlooker) = &mut self.onlooker
            && onlooker(&progress).is_break()
        {
            self.count.stopped.set(true);
        }
    }
}
