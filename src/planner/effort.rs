//! How much work a search does, in numbers of candidates: never in time, so that a plan does not depend on the machine.

use crate::model::scenario::Budget;

/// The numbers of a budget.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Postures of the person's arm that are drawn.
    pub postures: usize,
    /// The best of them that a cell of the person's map keeps.
    pub postures_a_cell: usize,
    /// Pairs of a hold and a posture that are tested in earnest, at most.
    pub disposed: usize,
    /// The best proposals that keep every constraint: where refinement starts.
    pub starts: usize,
    /// At most so many of them hold the same edges the same way.
    pub starts_of_a_kind: usize,
    /// Refinement goes in heats: the best so many take so many steps more.
    pub heats: Vec<Heat>,
    /// Starts that are taken from what was learned of the kind of work.
    pub known_starts: usize,
    /// The heats where such starts are all there is; none when proposals are climbed from too.
    pub known_heats: Option<Vec<Heat>>,
    /// Places in which the search for a whole circle holds good boards anew.
    pub circle_places: usize,
    /// Holds of the bank, and of those places, of which it works out what they stand.
    pub circle_guesses: usize,
    /// Holds that it climbs from, and the steps of each climb.
    pub circle_climbs: usize,
    pub circle_steps: usize,
}

/// One heat of the refinement.
#[derive(Clone, Copy, Debug)]
pub struct Heat {
    /// Climbs that take part, the best first.
    pub climbs: usize,
    /// Steps that each takes.
    pub steps: usize,
}

/// So many climbs with so many steps each, heat by heat.
fn heats(heats: &[[usize; 2]]) -> Vec<Heat> {
    heats.iter().map(|&[climbs, steps]| Heat { climbs, steps }).collect()
}

impl Effort {
    /// The numbers of a budget.
    pub fn of(budget: Budget) -> Self {
        match budget {
            Budget::Fast => Self {
                postures: 100_000,
                postures_a_cell: 4,
                disposed: 400,
                starts: 8,
                starts_of_a_kind: 2,
                heats: heats(&[[8, 6], [3, 10], [1, 20]]),
                known_starts: 0,
                known_heats: None,
                circle_places: 200,
                circle_guesses: 200,
                circle_climbs: 1,
                circle_steps: 25,
            },
            Budget::Default => Self {
                postures: 100_000,
                postures_a_cell: 4,
                disposed: 1_500,
                starts: 24,
                starts_of_a_kind: 3,
                heats: heats(&[[24, 6], [12, 8], [2, 25]]),
                known_starts: 10,
                known_heats: Some(heats(&[[10, 4], [4, 8], [1, 25]])),
                circle_places: 2_000,
                circle_guesses: 1_500,
                circle_climbs: 3,
                circle_steps: 30,
            },
            Budget::Exhaustive => Self {
                postures: 400_000,
                postures_a_cell: 40,
                disposed: 50_000,
                starts: 400,
                starts_of_a_kind: 400,
                heats: heats(&[[440, 40], [60, 100]]),
                known_starts: 40,
                known_heats: None,
                circle_places: 10_000,
                circle_guesses: 10_000,
                circle_climbs: 60,
                circle_steps: 100,
            },
        }
    }
}

/// The numbers of the searches that practise a kind of work, once for many plans.
#[derive(Clone, Debug)]
pub struct Practice {
    /// The first search for each practised operation.
    pub first: Effort,
    /// The later ones, which know what was found before.
    pub later: Effort,
    /// How often all operations are searched for: what one teaches helps its neighbours the next time.
    pub passes: u64,
    /// Places in which good boards are held anew before each later pass.
    pub places: usize,
}

impl Practice {
    /// The numbers of a budget; none when nothing is practised.
    pub fn of(budget: Budget) -> Option<Self> {
        let plan = Effort::of(budget);
        match budget {
            Budget::Fast => None,
            Budget::Default => {
                let later = Effort {
                    disposed: 4_000,
                    starts: 48,
                    starts_of_a_kind: 2,
                    heats: heats(&[[56, 8], [24, 30]]),
                    known_starts: 8,
                    ..plan
                };
                let first = Effort { starts: 16, heats: heats(&[[16, 8], [6, 20]]), known_starts: 0, ..later.clone() };
                Some(Self { first, later, passes: 3, places: 1_000 })
            }
            Budget::Exhaustive => {
                let later = Effort {
                    disposed: 20_000,
                    starts: 200,
                    starts_of_a_kind: 10,
                    heats: heats(&[[240, 15], [60, 60]]),
                    known_starts: 40,
                    ..plan
                };
                let first = Effort { heats: heats(&[[200, 15], [60, 60]]), known_starts: 0, ..later.clone() };
                Some(Self { first, later, passes: 4, places: 10_000 })
            }
        }
    }
}
