//! The holds that a task may use, and what leads from one to another.
//!
//! A hold for a single piece is comfortable because of where the tool is. So the board poses are those that bring each piece to
//! one of the best holds' poses of the tool, as it is there or with person, tool and board shifted and turned together
//! ([`Places`]): the robot turns and shifts the board under the tool, and the person stays. With the board where it is, the
//! pieces before and after are worked on as long as the person has a posture for them. A hold is a grip (`grips.rs`) at one of
//! these poses.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{
    super::{
        library::{BoardGrasp, largest_joint_difference_rad},
        params::task::{COST_PER_RAD, SAME_RAD},
    },
    graph::{Arc, ArcKind},
    grips::{Grip, grips},
    hold::Hold,
    level_poses::{LevelHold, LevelHolds},
    places::Places,
    problem::{Posture, TaskProblem},
    root::Root,
};

/// The holds and what leads from one to another.
#[derive(Clone)]
pub struct Holds<'p> {
    pub holds: Vec<Hold>,
    pub arcs: Vec<Vec<Arc>>,
    places: &'p Places,
    /// By hold and piece: what the piece costs if the hold resists its load; infinite where the person in the posture of the board
    /// alone would touch the robot or not see the work.
    pub serving: Vec<Vec<f64>>,
    /// The same from below for another posture of the person nearby.
    pub serving_nearby: Vec<Vec<f64>>,
}

impl<'p> Holds<'p> {
    /// The holds at some board poses that follow from the best holds of single pieces.
    pub fn new(problem: &TaskProblem<'_>, roots: &[Root], places: &'p Places) -> Self {
        let grips = grips(problem, roots, places);
        let of_grip = |(grip, Grip { at, .. }): (usize, &Grip)| {
            let hold =
                move |(&place, grasp): (&usize, &BoardGrasp)| Hold { grasp: grasp.clone(), place: Some(place), grip };
            at.iter().map(hold).collect::<Vec<_>>()
        };
        let holds: Vec<_> = grips.iter().enumerate().flat_map(of_grip).collect();
        let serving = |hold: &Hold| {
            let nearby = hold.place.map(|place| places.costs(problem, place, &hold.grasp)).unwrap_or_default();
            let is_free = |piece: usize| {
                let posture = hold.place.and_then(|place| places.posture(place, piece));
                posture.is_some_and(|posture| problem.is_free(piece, &hold.grasp, &posture))
            };
            let if_free = |(piece, &cost): (usize, &f64)| {
                if cost.is_finite() && is_free(piece) { cost } else { f64::INFINITY }
            };
            (nearby.iter().enumerate().map(if_free).collect(), nearby)
        };
        let (serving, serving_nearby) = holds.par_iter().map(serving).unzip();
        let arcs = arcs(&holds, &grips, places);
        Self { holds, arcs, places, serving, serving_nearby }
    }

    /// These holds, and after them those at level board poses, which serve no piece.
    pub fn with_level_poses(&self, problem: &TaskProblem<'_>) -> Self {
        let LevelHolds { holds, moves } = LevelHolds::new(problem, &self.holds);
        let first = self.holds.len();
        let mut all = self.clone();
        let mut at_pose: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (number, LevelHold { grasp, grip, pose, from }) in (first..).zip(holds) {
            all.holds.push(Hold { grasp, place: None, grip });
            all.arcs.push(Vec::new());
            for serving in [&mut all.serving, &mut all.serving_nearby] {
                serving.push(vec![f64::INFINITY; problem.pieces()]);
            }
            from.iter().for_each(|&from| all.connect(from, number, ArcKind::Move));
            let there = at_pose.entry(pose).or_default();
            there.iter().for_each(|&other| all.connect(other, number, ArcKind::Regrasp));
            there.push(number);
        }
        for [from, to] in moves {
            all.connect(first + from, first + to, ArcKind::Move);
        }
        all
    }

    /// Arcs from one hold to another and back.
    fn connect(&mut self, one: usize, other: usize, kind: ArcKind) {
        for (from, to) in [(one, other), (other, one)] {
            let arc = match kind {
                ArcKind::Move => Some(move_to(&self.holds, from, to)),
                ArcKind::Regrasp => regrasp_to(&self.holds, from, to),
            };
            self.arcs[from].extend(arc);
        }
    }

    /// The person's posture at a piece with the board as a hold has it.
    pub fn posture(&self, hold: usize, piece: usize) -> Option<Posture> {
        self.places.posture(self.holds[hold].place?, piece)
    }

    /// The number of pieces from the first on each of which some hold may serve.
    pub fn served_by_some(&self) -> usize {
        let pieces = self.serving_nearby.first().map_or(0, Vec::len);
        let is_served = |piece: usize| self.serving_nearby.iter().any(|costs| costs[piece].is_finite());
        (0..pieces).position(|piece| !is_served(piece)).unwrap_or(0)
    }
}

/// The arms whose grasps differ.
pub fn changed_arms(from: &BoardGrasp, to: &BoardGrasp) -> Vec<usize> {
    let pairs = from.arms.iter().zip(&to.arms).enumerate();
    pairs.filter(|(_, (a, b))| a.grasp != b.grasp).map(|(arm, _)| arm).collect()
}

/// True if the arms that keep their grasps keep their configurations, too: a redundant arm may have the same grasp in many.
fn keeps_others_still(from: &BoardGrasp, to: &BoardGrasp) -> bool {
    let pairs = from.arms.iter().zip(&to.arms).filter(|(a, b)| a.grasp == b.grasp);
    let differences = pairs.flat_map(|(a, b)| a.q_rad.iter().zip(&b.q_rad).map(|(a, b)| (a - b).abs()));
    differences.fold(0.0, f64::max) <= SAME_RAD
}

/// Motions of a grip between neighbouring board poses; regrasps between grips at the same one.
fn arcs(holds: &[Hold], grips: &[Grip], places: &Places) -> Vec<Vec<Arc>> {
    // Holds of one grip follow one another in the order of places.
    let mut first = Vec::with_capacity(grips.len());
    let mut count = 0;
    for grip in grips {
        first.push(count);
        count += grip.at.len();
    }
    let mut at_place: Vec<Vec<usize>> = vec![Vec::new(); places.count()];
    for (number, place) in holds.iter().enumerate().filter_map(|(number, hold)| Some((number, hold.place?))) {
        at_place[place].push(number);
    }
    let of_hold = |(number, hold): (usize, &Hold)| {
        let Some(place) = hold.place else { return Vec::new() };
        let own = &holds[first[hold.grip]..first[hold.grip] + grips[hold.grip].at.len()];
        let moves = places.beside(place).into_iter().filter_map(|beside| {
            let to = first[hold.grip] + own.binary_search_by_key(&Some(beside), |other| other.place).ok()?;
            Some(move_to(holds, number, to))
        });
        let regrasps = at_place[place].iter().filter_map(|&to| regrasp_to(holds, number, to));
        moves.chain(regrasps).collect()
    };
    holds.par_iter().enumerate().map(of_hold).collect()
}

/// The motion from a hold to another one of the same grip.
fn move_to(holds: &[Hold], from: usize, to: usize) -> Arc {
    let turned_rad = largest_joint_difference_rad(&holds[from].grasp.arms, &holds[to].grasp.arms);
    Arc { to, kind: ArcKind::Move, hands: 0, extra: COST_PER_RAD * turned_rad }
}

/// The regrasp from a hold to another one at the same board pose: `None` if no hand changes its grasp, if one that keeps it would have
/// to move, or if no hand can hold while another one lets go.
fn regrasp_to(holds: &[Hold], from: usize, to: usize) -> Option<Arc> {
    let [before, after] = [from, to].map(|hold| &holds[hold].grasp);
    let hands = changed_arms(before, after).len();
    let is_possible = hands > 0 && before.arms.len() > 1 && keeps_others_still(before, after);
    is_possible.then_some(Arc { to, kind: ArcKind::Regrasp, hands, extra: 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{board::Edge, frames::Pose, grasp::EdgeGrasp},
        planner::library::ArmGrasp,
    };

    #[test]
    fn an_arm_that_keeps_its_grasp_keeps_its_configuration() {
        let arm = |along_m: f64, q_rad: f64| ArmGrasp {
            grasp: EdgeGrasp { edge: Edge::PLUS_X, along_m, depth_m: 0.0, angle_rad: 0.0, flipped: false },
            q_rad: vec![0.3, q_rad],
        };
        let held = |left: ArmGrasp, right: ArmGrasp| BoardGrasp { x_wo: Pose::identity(), arms: vec![left, right] };
        let from = held(arm(0.1, 0.5), arm(0.2, 0.7));
        assert!(keeps_others_still(&from, &held(arm(0.1, 0.5), arm(0.0, -0.4))));
        assert!(keeps_others_still(&from, &held(arm(0.3, 0.1), arm(0.0, -0.4))));
        // The left hand keeps its grasp, but its elbow is elsewhere.
        assert!(!keeps_others_still(&from, &held(arm(0.1, 0.502), arm(0.0, -0.4))));
    }
}
