//! The holds that a task may use, and what leads from one to another.
//!
//! A hold for a single piece is comfortable because of where the tool is. So the board poses are those that bring each piece to
//! one of the best holds' poses of the tool, as it is there or with person, tool and board shifted and turned together
//! ([`Places`]): the robot turns and shifts the board under the tool, and the person stays. With the board where it is, the
//! pieces before and after are worked on as long as the person has a posture for them. A hold is a grip (`grips.rs`) at one of
//! these poses.

use rayon::prelude::*;

use super::{
    super::{
        library::{BoardGrasp, largest_joint_difference_rad},
        params::task::{COST_PER_RAD, SAME_RAD},
        problem::posture_map,
    },
    graph::{Arc, ArcKind},
    grips::{Grip, grips},
    places::Places,
    problem::TaskProblem,
    root::Root,
};
/// A grasp of the board at a pose.
pub struct Hold {
    pub grasp: BoardGrasp,
    /// The number of its board pose.
    pub place: usize,
    /// The number of its grip.
    grip: usize,
}

/// The holds and what leads from one to another.
pub struct Holds {
    pub holds: Vec<Hold>,
    pub arcs: Vec<Vec<Arc>>,
    pub places: Places,
    /// By hold and piece: what the piece costs if the hold resists its load; infinite where the person in the posture of the board
    /// alone would touch the robot or not see the work.
    pub serving: Vec<Vec<f64>>,
    /// The same from below for another posture of the person nearby.
    pub serving_nearby: Vec<Vec<f64>>,
}

impl Holds {
    /// The holds that follow from the best holds of single pieces; the last piece of a closed path is beside the first one.
    pub fn new(problem: &TaskProblem<'_>, roots: &[Root], closed: bool) -> Self {
        let of_first = problem.of_piece(0);
        // Force and person are the same at all pieces, seen from the tool.

        let map = posture_map(of_first.scenario, &of_first.human, problem.watch);

        let places = Places::new(problem, &map, roots, closed);

        let grips = grips(problem, roots, &places);

        let of_grip = |(grip, Grip { at, .. }): (usize, &Grip)| {
            at.iter().map(move |(&place, grasp)| Hold { grasp: grasp.clone(), place, grip }).collect::<Vec<_>>()
        };
        let holds: Vec<_> = grips.iter().enumerate().flat_map(of_grip).collect();
        let serving = |hold: &Hold| {
            let nearby = places.costs(problem, hold.place, &hold.grasp);
            let is_free = |piece: usize| {
                places.posture(hold.place, piece).is_some_and(|posture| problem.is_free(piece, &hold.grasp, &posture))
            };
            let if_free = |(piece, &cost): (usize, &f64)| {
                if cost.is_finite() && is_free(piece) { cost } else { f64::INFINITY }
            };
            (nearby.iter().enumerate().map(if_free).collect(), nearby)
        };
        let (serving, serving_nearby) = holds.par_iter().map(serving).unzip();

        let arcs = arcs(&holds, &grips, &places);

        Self { holds, arcs, places, serving, serving_nearby }
    }
}

impl Holds {
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
    for (number, hold) in holds.iter().enumerate() {
        at_place[hold.place].push(number);
    }
    let of_hold = |(number, hold): (usize, &Hold)| {
        let own = &holds[first[hold.grip]..first[hold.grip] + grips[hold.grip].at.len()];
        let beside = places.beside(hold.place);
        let moves = beside.into_iter().filter_map(|place| {
            let to = first[hold.grip] + own.binary_search_by_key(&place, |other| other.place).ok()?;
            let turned_rad = largest_joint_difference_rad(&hold.grasp.arms, &holds[to].grasp.arms);
            Some(Arc { to, kind: ArcKind::Move, hands: 0, extra: COST_PER_RAD * turned_rad })
        });
        // A hand that lets go needs another one that holds meanwhile.
        let may_regrasp = hold.grasp.arms.len() > 1;
        let others = at_place[hold.place]
            .iter()
            .copied()
            .filter(|&to| may_regrasp && to != number && keeps_others_still(&hold.grasp, &holds[to].grasp));
        let regrasps = others.map(|to| {
            let hands = changed_arms(&hold.grasp, &holds[to].grasp).len();
            Arc { to, kind: ArcKind::Regrasp, hands, extra: 0.0 }
        });
        moves.chain(regrasps.filter(|arc| arc.hands > 0)).collect()
    };
    holds.par_iter().enumerate().map(of_hold).collect()
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
