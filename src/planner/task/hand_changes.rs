//! The regrasps from one hold to another at the same board pose: one hand after the other changes its grasp.

use std::collections::BTreeMap;

use rand_pcg::Pcg64;

use super::{
    super::{library::BoardGrasp, params::task::SEED_STREAM},
    grasp_loads::GraspLoads,
    holds::{Holds, changed_arms},
    problem::TaskProblem,
    regrasp::{self, Ends, WayOff},
};
use crate::statics::StabilityWorkspace;

/// One arm's change of its grasp.
pub struct HandChange {
    pub arm: usize,
    /// All grasps before it.
    pub before: BoardGrasp,
    /// Its ways off the board.
    ends: Ends,
}

impl HandChange {
    /// Its joint path, from random numbers of its own: it does not depend on what was asked before.
    pub fn path(&self, problem: &TaskProblem<'_>, [from, to]: [usize; 2]) -> Option<Vec<Vec<f64>>> {
        let stream = SEED_STREAM + ((from as u128) << 32) + ((to as u128) << 4) + self.arm as u128;
        let mut random = Pcg64::new(u128::from(problem.of_piece(0).scenario.planner.seed), stream);
        regrasp::path(problem.robot, &self.before, &self.ends, self.arm, &mut random)
    }
}

/// What is known of single holds.
#[derive(Default)]
pub struct HoldFacts {
    /// Whether a hold carries the board without one of its arms, or with all (`None`).
    carried: BTreeMap<(usize, Option<usize>), bool>,
    /// The way off the board of an arm of a hold, if there is one, while the others hold the board.
    ways_off: BTreeMap<(usize, usize), Option<WayOff>>,
}

impl HoldFacts {
    /// Takes over what others have found.
    pub fn extend(&mut self, Self { carried, ways_off }: Self) {
        self.carried.extend(carried);
        self.ways_off.extend(ways_off);
    }
}

/// Computes the facts about holds, each once.
pub struct FactFinder<'k> {
    pub known: &'k HoldFacts,
    /// What was computed beyond this.
    pub new: HoldFacts,
    pub workspace: &'k mut StabilityWorkspace,
}

impl<'k> FactFinder<'k> {
    pub fn new(known: &'k HoldFacts, workspace: &'k mut StabilityWorkspace) -> Self {
        Self { known, new: HoldFacts::default(), workspace }
    }

    /// True if the arms of a hold but `without` carry the board, with a reserve for its acceleration.
    pub fn carries(
        &mut self,
        problem: &TaskProblem<'_>,
        holds: &Holds<'_>,
        hold: usize,
        without: Option<usize>,
    ) -> bool {
        let key = (hold, without);
        if let Some(&known) = self.known.carried.get(&key).or_else(|| self.new.carried.get(&key)) {
            return known;
        }
        let carries = self.grasp_carries(problem, &holds.holds[hold].grasp, without);
        self.new.carried.insert(key, carries);
        carries
    }

    /// The way of an arm off the board from its grasp in a hold, while the others hold the board as in `here`.
    fn way_off(
        &mut self,
        problem: &TaskProblem<'_>,
        holds: &Holds<'_>,
        (here, hold): (&BoardGrasp, usize),
        arm: usize,
    ) -> Option<WayOff> {
        let grasp = &holds.holds[hold].grasp;
        let compute = || regrasp::way_off(problem.robot, here, &grasp.arms[arm], arm);
        let mut others = here.arms.iter().zip(&grasp.arms).enumerate().filter(|(number, _)| *number != arm);
        if here.x_wo != grasp.x_wo || !others.all(|(_, (here, of_hold))| here.q_rad == of_hold.q_rad) {
            return compute();
        }
        let key = (hold, arm);
        if let Some(known) = self.known.ways_off.get(&key).or_else(|| self.new.ways_off.get(&key)) {
            return known.clone();
        }
        let way = compute();
        self.new.ways_off.insert(key, way.clone());
        way
    }

    fn grasp_carries(&mut self, problem: &TaskProblem<'_>, grasp: &BoardGrasp, without: Option<usize>) -> bool {
        GraspLoads::new(problem, grasp).carries(problem, self.workspace, without)
    }
}

/// The changes from one hold to another in the first order of arms that is possible.
pub fn hand_changes(
    problem: &TaskProblem<'_>,
    holds: &Holds<'_>,
    facts: &mut FactFinder<'_>,
    [from, to]: [usize; 2],
) -> Option<Vec<HandChange>> {
    let arms = changed_arms(&holds.holds[from].grasp, &holds.holds[to].grasp);
    if !facts.carries(problem, holds, from, None) || !facts.carries(problem, holds, to, None) {
        return None;
    }
    orders(arms).into_iter().find_map(|order| in_order(problem, holds, facts, ([from, to], &order)))
}

/// The changes in this order of arms.
fn in_order(
    problem: &TaskProblem<'_>,
    holds: &Holds<'_>,
    facts: &mut FactFinder<'_>,
    ([from, to], order): ([usize; 2], &[usize]),
) -> Option<Vec<HandChange>> {
    let [before, after] = [from, to].map(|hold| &holds.holds[hold].grasp);
    let robot = problem.robot;
    let mut here = before.clone();
    let mut changes = Vec::with_capacity(order.len());
    for (number, &arm) in order.iter().enumerate() {
        let mut next = here.clone();
        next.arms[arm] = after.arms[arm].clone();
        // The last one reaches the hold, which is clear and carries the board; before it all other arms have its grasps.
        let is_last = number + 1 == order.len();
        let is_held = match number {
            0 => facts.carries(problem, holds, from, Some(arm)),
            _ if is_last => facts.carries(problem, holds, to, Some(arm)),
            _ => facts.grasp_carries(problem, &here, Some(arm)),
        };
        if !is_held || !(is_last || robot.is_clear(&next) && facts.grasp_carries(problem, &next, None)) {
            return None;
        }
        // Until its turn an arm has its grasp of the hold before.
        let ends = Ends {
            away: facts.way_off(problem, holds, (&here, from), arm)?,
            towards: facts.way_off(problem, holds, (&here, to), arm)?,
        };
        changes.push(HandChange { arm, before: here, ends });
        here = next;
    }
    Some(changes)
}

/// All orders of these numbers.
fn orders(numbers: Vec<usize>) -> Vec<Vec<usize>> {
    if numbers.len() <= 1 {
        return vec![numbers];
    }
    let first = |place: usize| {
        let mut rest = numbers.clone();
        let first = rest.remove(place);
        orders(rest).into_iter().map(move |rest| [&[first], &rest[..]].concat())
    };
    (0..numbers.len()).flat_map(first).collect()
}
