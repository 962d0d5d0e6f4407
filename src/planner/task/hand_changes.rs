//! The regrasps from one hold to another at the same board pose: one hand after the other changes its grasp.

use std::collections::BTreeMap;

use rand_pcg::Pcg64;

use super::{
    super::{library::BoardGrasp, params::task::SEED_STREAM},
    grasp_loads::GraspLoads,
    holds::{Holds, changed_arms},
    problem::TaskProblem,
    regrasp,
};
use crate::statics::StabilityWorkspace;

/// One arm's change of its grasp.
pub struct HandChange {
    pub arm: usize,
    /// All grasps before it.
    pub before: BoardGrasp,
    /// Its ways off the board.
    ends: regrasp::Ends,
}

impl HandChange {
    /// Its joint path, from random numbers of its own: it does not depend on what was asked before.
    pub fn path(&self, problem: &TaskProblem<'_>, [from, to]: [usize; 2]) -> Option<Vec<Vec<f64>>> {
        let stream = SEED_STREAM + ((from as u128) << 32) + ((to as u128) << 4) + self.arm as u128;
        let mut random = Pcg64::new(u128::from(problem.of_piece(0).scenario.planner.seed), stream);
        regrasp::path(problem.robot, &self.before, &self.ends, self.arm, &mut random)
    }
}

/// Whether holds carry the board without one of their arms, or with all (`None`).
pub type CarriedHolds = BTreeMap<(usize, Option<usize>), bool>;

/// Computes which holds carry the board with a reserve for its acceleration, each once.
pub struct Carrying<'k> {
    pub known: &'k CarriedHolds,
    /// What was computed beyond this.
    pub new: CarriedHolds,
    pub workspace: &'k mut StabilityWorkspace,
}

impl Carrying<'_> {
    /// True if the arms of a hold but `without` carry the board.
    pub fn carries(
        &mut self,
        problem: &TaskProblem<'_>,
        holds: &Holds<'_>,
        hold: usize,
        without: Option<usize>,
    ) -> bool {
        let key = (hold, without);
        if let Some(&known) = self.known.get(&key).or_else(|| self.new.get(&key)) {
            return known;
        }
        let carries = self.grasp_carries(problem, &holds.holds[hold].grasp, without);
        self.new.insert(key, carries);
        carries
    }

    fn grasp_carries(&mut self, problem: &TaskProblem<'_>, grasp: &BoardGrasp, without: Option<usize>) -> bool {
        GraspLoads::new(problem, grasp).carries(problem, self.workspace, without)
    }
}

/// The changes from one hold to another in the first order of arms that is possible.
pub fn hand_changes(
    problem: &TaskProblem<'_>,
    holds: &Holds<'_>,
    carrying: &mut Carrying<'_>,
    [from, to]: [usize; 2],
) -> Option<Vec<HandChange>> {
    let arms = changed_arms(&holds.holds[from].grasp, &holds.holds[to].grasp);
    if !carrying.carries(problem, holds, from, None) || !carrying.carries(problem, holds, to, None) {
        return None;
    }
    orders(arms).into_iter().find_map(|order| in_order(problem, holds, carrying, ([from, to], &order)))
}

/// The changes in this order of arms.
fn in_order(
    problem: &TaskProblem<'_>,
    holds: &Holds<'_>,
    carrying: &mut Carrying<'_>,
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
            0 => carrying.carries(problem, holds, from, Some(arm)),
            _ if is_last => carrying.carries(problem, holds, to, Some(arm)),
            _ => carrying.grasp_carries(problem, &here, Some(arm)),
        };
        if !is_held || !(is_last || robot.is_clear(&next) && carrying.grasp_carries(problem, &next, None)) {
            return None;
        }
        let ends = regrasp::ends(robot, &here, &next.arms[arm], arm)?;
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
