//! How much work a search does, in numbers of candidates: never in time, so that a plan does not depend on the machine.

use crate::model::scenario::Budget;

/// The numbers of a budget.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Postures of the person's arm that are drawn.
    pub postures: usize,
    /// The best of them that a cell of the person's map keeps.
    pub postures_a_cell: usize,
    /// Pairs of a hold and a posture that are tested in earnest, at most.
    pub disposed: usize,
    /// The best proposals that keep every constraint: where refinement starts.
    pub starts: usize,
    /// Steps from each start.
    pub first_steps: usize,
    /// The best of those.
    pub finalists: usize,
    /// Steps from each finalist.
    pub last_steps: usize,
}

impl Effort {
    /// The numbers of a budget.
    pub fn of(budget: Budget) -> Self {
        match budget {
            Budget::Fast => Self {
                postures: 10_000,
                postures_a_cell: 4,
                disposed: 400,
                starts: 4,
                first_steps: 5,
                finalists: 1,
                last_steps: 25,
            },
            Budget::Default => Self {
                postures: 20_000,
                postures_a_cell: 8,
                disposed: 800,
                starts: 12,
                first_steps: 6,
                finalists: 3,
                last_steps: 30,
            },
            Budget::Exhaustive => Self {
                postures: 200_000,
                postures_a_cell: 100,
                disposed: 50_000,
                starts: 400,
                first_steps: 15,
                finalists: 60,
                last_steps: 100,
            },
        }
    }
}
