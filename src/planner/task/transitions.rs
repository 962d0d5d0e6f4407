//! What is exact about the holds of a task: which pieces they serve, and how the robot gets from one to another.

use std::collections::BTreeMap;

use rand_pcg::Pcg64;

use super::{
    super::{library::BoardGrasp, params::task::SEED_STREAM},
    graph::{Arc, ArcKind, Exact},
    grasp_loads::GraspLoads,
    holds::{Holds, changed_arms},
    motion,
    problem::{Posture, TaskProblem},
    regrasp,
};
use crate::{model::plan::Plan, statics::StabilityWorkspace};

/// Computes what is exact, each figure once.
pub struct Transitions<'p, 'a> {
    pub problem: &'p mut TaskProblem<'a>,
    /// May be exchanged for ones that begin with these.
    pub holds: &'p Holds<'p>,
    workspace: StabilityWorkspace,
    /// By hold.
    loads: BTreeMap<usize, GraspLoads<'p>>,
    served: BTreeMap<(usize, usize), Option<Posture>>,
    moves: BTreeMap<(usize, usize), bool>,
    regrasps: BTreeMap<(usize, usize), Option<Vec<HandChange>>>,
    carried: BTreeMap<(usize, Option<usize>), bool>,
}

impl<'p, 'a> Transitions<'p, 'a> {
    pub fn new(problem: &'p mut TaskProblem<'a>, holds: &'p Holds<'p>) -> Self {
        Self {
            problem,
            holds,
            workspace: StabilityWorkspace::new(),
            loads: BTreeMap::new(),
            served: BTreeMap::new(),
            moves: BTreeMap::new(),
            regrasps: BTreeMap::new(),
            carried: BTreeMap::new(),
        }
    }

    /// The person's posture at a piece that a hold serves.
    pub fn posture(&self, hold: usize, piece: usize) -> Option<Posture> {
        self.served.get(&(hold, piece)).copied().flatten()
    }

    /// The changes of grasps between two holds, if they are possible.
    pub fn regrasps(&self, from: usize, to: usize) -> Option<&[HandChange]> {
        self.regrasps.get(&(from, to))?.as_deref()
    }

    /// The person's posture at a piece if the hold resists its load: that beside the board alone or, if it touches the robot or
    /// cannot see, the best near it.
    fn serve(&mut self, number: usize, piece: usize) -> Option<Posture> {
        let holds = self.holds;
        let hold = &holds.holds[number];
        let posture = holds.posture(number, piece)?;
        let loads = self.loads.entry(number).or_insert_with(|| GraspLoads::new(self.problem, &hold.grasp));
        if !loads.resists_along(self.problem, &mut self.workspace, piece, posture.roll_rad) {
            return None;
        }
        if holds.serving[number][piece].is_finite() {
            return Some(posture);
        }
        let link_poses = self.problem.robot.link_poses(&hold.grasp.arms);
        let points_w = self.problem.robot_points_w(&link_poses);
        self.problem.response_near(piece, &hold.grasp.x_wo, &posture, &link_poses, &points_w)
    }

    /// The plan of a hold for a piece with the person's best response near the posture that was found; that posture itself if the
    /// better one is not accepted.
    pub fn accepted_plan(&mut self, hold: usize, piece: usize, grasp: &BoardGrasp) -> Option<(Plan, Posture)> {
        let posture = self.posture(hold, piece)?;
        let link_poses = self.problem.robot.link_poses(&grasp.arms);
        let points_w = self.problem.robot_points_w(&link_poses);
        let better = self.problem.response_near(piece, &grasp.x_wo, &posture, &link_poses, &points_w);
        let postures = better.into_iter().chain([posture]);
        postures.into_iter().find_map(|posture| Some((self.problem.plan(piece, grasp, &posture)?, posture)))
    }

    /// Excludes a hold for a piece.
    pub fn exclude(&mut self, hold: usize, piece: usize) {
        self.served.insert((hold, piece), None);
    }

    /// Excludes the motion between two holds.
    pub fn exclude_move(&mut self, from: usize, to: usize) {
        self.moves.insert((from, to), false);
    }

    /// Excludes the regrasps between two holds.
    pub fn exclude_regrasp(&mut self, from: usize, to: usize) {
        self.regrasps.insert((from, to), None);
    }

    /// True if the arms but `without` carry the board with a reserve for its acceleration.
    fn carries(&mut self, hold: usize, without: Option<usize>) -> bool {
        if let Some(&known) = self.carried.get(&(hold, without)) {
            return known;
        }
        let carries = self.grasp_carries(&self.holds.holds[hold].grasp, without);
        self.carried.insert((hold, without), carries);
        carries
    }

    fn grasp_carries(&mut self, grasp: &BoardGrasp, without: Option<usize>) -> bool {
        GraspLoads::new(self.problem, grasp).carries(self.problem, &mut self.workspace, without)
    }

    fn moves(&mut self, from: usize, to: usize) -> bool {
        let holds = &self.holds.holds;
        self.carries(from, None)
            && self.carries(to, None)
            && motion::between(self.problem.robot, &holds[from].grasp, &holds[to].grasp).is_some()
    }

    /// The regrasps from one hold to another at the same board pose, one hand after the other, in the first order that is possible.
    fn found_regrasps(&mut self, from: usize, to: usize) -> Option<Vec<HandChange>> {
        let holds = &self.holds.holds;
        let arms = changed_arms(&holds[from].grasp, &holds[to].grasp);
        if !self.carries(from, None) || !self.carries(to, None) {
            return None;
        }
        orders(arms).into_iter().find_map(|order| self.in_order(from, to, &order))
    }

    /// The regrasps in this order of arms.
    fn in_order(&mut self, from: usize, to: usize, order: &[usize]) -> Option<Vec<HandChange>> {
        let holds = self.holds;
        let [before, after] = [from, to].map(|hold| &holds.holds[hold].grasp);
        let robot = self.problem.robot;
        let mut here = before.clone();
        let mut changes = Vec::with_capacity(order.len());
        for (number, &arm) in order.iter().enumerate() {
            let mut next = here.clone();
            next.arms[arm] = after.arms[arm].clone();
            // The last one reaches the hold, which is clear and carries the board; before it all other arms have its grasps.
            let is_last = number + 1 == order.len();
            let is_held = match number {
                0 => self.carries(from, Some(arm)),
                _ if is_last => self.carries(to, Some(arm)),
                _ => self.grasp_carries(&here, Some(arm)),
            };
            if !is_held || !(is_last || robot.is_clear(&next) && self.grasp_carries(&next, None)) {
                return None;
            }
            let ends = regrasp::ends(robot, &here, &next.arms[arm], arm)?;
            changes.push(HandChange { arm, before: here, ends });
            here = next;
        }
        Some(changes)
    }
}

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

impl Exact for Transitions<'_, '_> {
    fn serving(&mut self, hold: usize, piece: usize) -> Option<f64> {
        if !self.served.contains_key(&(hold, piece)) {
            let posture = self.serve(hold, piece);
            self.served.insert((hold, piece), posture);
        }
        let posture = self.posture(hold, piece)?;
        let known = self.holds.serving[hold][piece];
        if known.is_finite() {
            return Some(known);
        }
        let grasp = &self.holds.holds[hold].grasp;
        let points_w = self.problem.robot_points_w(&self.problem.robot.link_poses(&grasp.arms));
        let objective = self.problem.comfort(piece, &grasp.x_wo, &posture, &points_w).objective;
        self.problem.cost(piece, objective)
    }

    fn may_serve(&self, hold: usize, piece: usize) -> bool {
        self.served.get(&(hold, piece)).is_none_or(Option::is_some)
    }

    fn may_exist(&self, from: usize, arc: &Arc) -> bool {
        let key = (from, arc.to);
        match arc.kind {
            ArcKind::Move => self.moves.get(&key).is_none_or(|exists| *exists),
            ArcKind::Regrasp => self.regrasps.get(&key).is_none_or(Option::is_some),
        }
    }

    fn exists(&mut self, from: usize, arc: &Arc) -> bool {
        let key = (from, arc.to);
        match arc.kind {
            ArcKind::Move => {
                if !self.moves.contains_key(&key) {
                    let exists = self.moves(from, arc.to);
                    self.moves.insert(key, exists);
                }
                self.moves.get(&key).copied().unwrap_or(false)
            }
            ArcKind::Regrasp => {
                if !self.regrasps.contains_key(&key) {
                    let changes = self.found_regrasps(from, arc.to);
                    self.regrasps.insert(key, changes);
                }
                self.regrasps(from, arc.to).is_some()
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.problem.watch.is_stopped()
    }
}
