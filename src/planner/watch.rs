//! What a caller learns while a plan is made, and how they stop it.
//!
//! A [`Watch`] is told of every part of the work, and asked again and again whether to stop: in every loop that may take
//! longer than some milliseconds, from any thread. A watch that never stops does not change a plan by a bit. After a stop no
//! map is kept, and a search gives the best that it has found so far, or [`PlanError::Stopped`]. The planner knows no clock.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::outcome::PlanError;
use crate::model::{
    plan::Comfort,
    stop::{Never, Stop},
};

/// Watches the making of maps and plans, and may stop it. An [`AtomicBool`] is a watch that stops once it is set.
pub trait Watch: Stop {
    /// Told of what happens, from any thread; it must return soon.
    fn tell(&self, _event: &Event<'_>) {}
}

impl Watch for Never {}

impl Watch for AtomicBool {}

/// What a watch is told.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A part of the work has begun or gone on.
    Part(Part),
    /// A search goes on. Searches for maps, and for the optima of a normalised objective, are not told of.
    Search(Progress<'a>),
    /// A stopped search would now return something. Told at least once before a search that finds anything ends.
    Found,
}

/// How far a part of the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The part.
    pub phase: Phase,
    /// What is done of it.
    pub done: u64,
    /// All of it: never less than `done`; zero if that is not known.
    pub total: u64,
}

/// How far a search is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Candidates so far.
    pub evaluations: u64,
    /// The comfort of a feasible candidate that is better than all before; `None` for any other candidate.
    pub better: Option<&'a Comfort>,
}

/// A part of the work. Its `Display` says what is done, such as `making the warm starts (pass 3 of 7)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Where the arms reach, and grasps of the board: once per robot, board and clearance.
    GraspLibrary,
    /// The person's postures.
    Postures,
    /// Grasps of boards where natural postures, or a person in the given place, have them.
    NaturalGrasps,
    /// Solutions of a few tasks of the family.
    WarmStarts {
        /// The present pass, from 1.
        pass: u64,
        /// All passes.
        passes: u64,
    },
    /// The search of the plan.
    Search,
    /// The second search, after one that found nothing.
    SecondSearch,
    /// Why nothing was found.
    Explanation,
    /// One of the weightings of a front.
    Weighting {
        /// Its number, from 1.
        number: u64,
        /// All weightings, those that are searched again included.
        of: u64,
    },
    /// The best holds of a task's pieces by themselves.
    Pieces,
    /// The way through the holds of a task.
    Task,
    /// One hold for all pieces of a path.
    OneHold,
    /// Random holds of a path's pieces.
    RandomHolds,
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::GraspLibrary => write!(f, "collecting grasps of the board"),
            Self::Postures => write!(f, "drawing postures of the person"),
            Self::NaturalGrasps => write!(f, "collecting grasps for natural postures"),
            Self::WarmStarts { pass, passes } => write!(f, "making the warm starts (pass {pass} of {passes})"),
            Self::Search => write!(f, "searching"),
            Self::SecondSearch => write!(f, "searching a second time, more thoroughly"),
            Self::Explanation => write!(f, "finding out why nothing was found"),
            Self::Weighting { number, of } => write!(f, "searching weighting {number} of {of}"),
            Self::Pieces => write!(f, "planning the pieces of the path"),
            Self::Task => write!(f, "searching the stages of the task"),
            Self::OneHold => write!(f, "comparing: searching one hold for the whole path"),
            Self::RandomHolds => write!(f, "comparing: drawing random holds of the pieces"),
        }
    }
}

/// Tells a watch that a part has begun whose size is not known.
pub fn begin(watch: &dyn Watch, phase: Phase) {
    tracing::info!("{phase}");
    watch.tell(&Event::Part(Part { phase, done: 0, total: 0 }));
}

/// An error after a stop.
///
/// # Errors
/// [`PlanError::Stopped`] if the work must end.
pub fn go_on(stop: &dyn Stop) -> Result<(), PlanError> {
    if stop.is_stopped() { Err(PlanError::Stopped) } else { Ok(()) }
}

/// Counts what is done of a part, from any thread, and tells the watch about every hundredth of it.
pub struct Counter<'w> {
    watch: &'w dyn Watch,
    part: Option<Part>,
    done: AtomicU64,
}

impl<'w> Counter<'w> {
    /// Begins a part of this size.
    pub fn new(watch: &'w dyn Watch, phase: Phase, total: usize) -> Self {
        let part = Part { phase, done: 0, total: total as u64 };
        tracing::info!(total, "{phase}");
        watch.tell(&Event::Part(part));
        Self { watch, part: Some(part), done: AtomicU64::new(0) }
    }

    /// Counts nothing: the part belongs to one that is counted.
    pub fn quiet(watch: &'w dyn Watch) -> Self {
        Self { watch, part: None, done: AtomicU64::new(0) }
    }

    /// Counts one.
    pub fn advance(&self) {
        let Some(part) = self.part else { return };
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of((part.total / 100).max(1)) {
            self.watch.tell(&Event::Part(Part { done: done.min(part.total), ..part }));
        }
    }
}

impl Watch for Counter<'_> {}

impl Stop for Counter<'_> {
    fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }
}

/// Tells of the parts of a search that serves another one, not of its candidates.
pub struct Subordinate<'w>(pub &'w dyn Watch);

impl Stop for Subordinate<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}

impl Watch for Subordinate<'_> {
    fn tell(&self, event: &Event<'_>) {
        if let Event::Part(_) = event {
            self.0.tell(event);
        }
    }
}
