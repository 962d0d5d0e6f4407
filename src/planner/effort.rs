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
    /// Proposals are climbed from even when such starts are there.
    pub looks_further: bool,
    /// Holds that are kept of each practised operation; none when nothing is practised.
    pub practised: usize,
    /// Holds that the search for a whole circle climbs from, and the steps of each climb.
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

impl Effort {
    /// The numbers of a budget.
    pub fn of(budget: Budget) -> Self { Self::of_(budget).tuned() }
    fn of_(budget: Budget) -> Self {
        match budget {
            Budget::Fast => Self {
                postures: 100_000,
                postures_a_cell: 4,
                disposed: 400,
                starts: 8,
                starts_of_a_kind: 2,
                heats: vec![Heat { climbs: 8, steps: 6 }, Heat { climbs: 3, steps: 10 }, Heat { climbs: 1, steps: 20 }],
                known_starts: 0,
                looks_further: true,
                practised: 0,
                circle_climbs: 1,
                circle_steps: 25,
            },
            Budget::Default => Self {
                postures: 100_000,
                postures_a_cell: 4,
                disposed: 1_500,
                starts: 24,
                starts_of_a_kind: 3,
                heats: vec![
                    Heat { climbs: 24, steps: 6 },
                    Heat { climbs: 12, steps: 6 },
                    Heat { climbs: 6, steps: 10 },
                    Heat { climbs: 2, steps: 25 },
                ],
                known_starts: 8,
                looks_further: false,
                practised: 8,
                circle_climbs: 3,
                circle_steps: 30,
            },
            Budget::Exhaustive => Self {
                postures: 400_000,
                postures_a_cell: 40,
                disposed: 50_000,
                starts: 400,
                starts_of_a_kind: 400,
                heats: vec![Heat { climbs: 400, steps: 40 }, Heat { climbs: 60, steps: 100 }],
                known_starts: 40,
                looks_further: true,
                practised: 8,
                circle_climbs: 60,
                circle_steps: 100,
            },
        }
    }
}
impl Effort {
    /// The effort of practising a kind of work once.
    pub fn practice(self) -> Self { let h = env("PSTEPS", 30); let n = env("PSTARTS", 32); Self { starts: n, heats: vec![Heat { climbs: n, steps: 8 }, Heat { climbs: n/2, steps: h } ], ..self } }
}
pub fn env(name: &str, default: usize) -> usize { std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default) }
impl Effort { pub fn tuned(self) -> Self {
    let heats: Vec<Heat> = std::env::var("HEATS").map(|h| h.split(',').map(|x| { let (a, b) = x.split_once('x').unwrap(); Heat { climbs: a.parse().unwrap(), steps: b.parse().unwrap() } }).collect()).unwrap_or(self.heats.clone());
    Self { postures: env("POSTURES", self.postures), postures_a_cell: env("KEPT", self.postures_a_cell), disposed: env("DISPOSED", self.disposed), starts: env("STARTS", self.starts), starts_of_a_kind: env("KIND", self.starts_of_a_kind), heats, known_starts: env("KNOWN", self.known_starts), practised: env("PRACTISED", self.practised), looks_further: env("FURTHER", self.looks_further as usize) > 0, ..self } } }
