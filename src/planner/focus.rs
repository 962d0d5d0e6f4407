//! Boards as good holds have them, placed anew around the robot and held anew.
//!
//! What is comfortable for the person says how high the board is and how it leans. It does not say where it is, which way it
//! looks, or how the robot holds it: all of that is open, and what is good about it is rare. So boards that lean like those
//! of good holds are put down in many places, and in each of them grasps are drawn for every hand by itself. Few of them are
//! reached; all that are go together with all of the other hands, so that some dozen draws make some dozen holds.

use std::f64::consts::PI;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{
    RobotMap,
    assess::{self, BOARD_X_M, BOARD_Y_M},
    bank::{self, BankedHold, KnownHold},
    candidate::{Hold, hold_kind},
    propose::uniform,
    robot_map::ArmSearch,
};
use crate::{
    collision::{Body, Violation},
    model::{frames::Pose, grasp::Edge},
};

/// Grasps that are drawn for each hand in a place.
const GRASPS: usize = 40;
/// Holds of a kind that are kept of a place.
const KEPT_OF_A_KIND: usize = 2;

/// Holds of boards that lean as these do and are as high, in so many places, of which those outside the search's domain have
/// none. The same numbers give the same holds, whatever the number of threads.
pub fn holds(map: &RobotMap, boards: &[Pose], places: usize, [seed, pass]: [u64; 2]) -> Vec<BankedHold> {
    if boards.is_empty() {
        return Vec::new();
    }
    let in_place = |place: usize| {
        let stream = (u128::from(pass) << 64) + place as u128;
        let mut random = Pcg64::new(u128::from(seed), stream);
        let x_wo = placed_anew(&boards[place % boards.len()], &mut random);
        if assess::in_domain(&x_wo) { held(map, &x_wo, &mut random) } else { Vec::new() }
    };
    (0..places).into_par_iter().flat_map_iter(in_place).collect()
}

/// A board turned about the vertical and moved, anywhere in the domain of the search.
fn placed_anew(x_wo: &Pose, random: &mut Pcg64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), uniform(random, -PI, PI));
    let [x_m, y_m] = [BOARD_X_M, BOARD_Y_M].map(|[low, high]| uniform(random, low, high));
    Isometry3::from_parts(Vector3::new(x_m, y_m, x_wo.translation.z).into(), turn * x_wo.rotation)
}

/// Holds of a board that touch nothing.
fn held(map: &RobotMap, x_wo: &Pose, random: &mut Pcg64) -> Vec<BankedHold> {
    let hands: Vec<_> = map.arms.iter().map(|arm| reached(map, arm, x_wo, random)).collect();
    let mut touching: Vec<Vec<bool>> = hands.iter().map(|holds| vec![false; holds.len()]).collect();
    let mut free: Vec<BankedHold> = Vec::new();
    let mut kinds = Vec::new();
    for numbers in together(&hands) {
        if numbers.iter().zip(&touching).any(|(&number, touching)| touching[number]) {
            continue;
        }
        let holds: Vec<Hold> = numbers.iter().zip(&hands).map(|(&number, holds)| holds[number].clone()).collect();
        let kind = hold_kind(&holds);
        if kinds.iter().filter(|other| **other == kind).count() >= KEPT_OF_A_KIND {
            continue;
        }
        let poses = map.link_poses(&holds);
        match map.collision.first_violation(&map.scene(&poses, *x_wo)) {
            None => {
                kinds.push(kind);
                free.push(BankedHold::new(map, KnownHold { x_wo: *x_wo, holds }, &poses));
            }
            Some(violation) => {
                // With whatever hand beside it.
                if let [arm] = arms_of(map, &violation)[..] {
                    touching[arm][numbers[arm]] = true;
                }
            }
        }
    }
    free
}

/// Grasps of one hand with configurations of its arm, those of the drawn ones that it reaches.
fn reached(map: &RobotMap, arm: &ArmSearch, x_wo: &Pose, random: &mut Pcg64) -> Vec<Hold> {
    let draw = |_| {
        let edge = bank::draw_edge(random);
        bank::draw_hold(map, arm, edge, x_wo, random)
    };
    (0..GRASPS).filter_map(draw).collect()
}

/// Every choice of one hold a hand in which all edges are the first's or opposite to it (METHOD section 2), by the holds'
/// numbers.
fn together(hands: &[Vec<Hold>]) -> Vec<Vec<usize>> {
    let mut chosen = vec![Vec::new()];
    for holds in hands {
        let longer = |numbers: &Vec<usize>| {
            let first = numbers.first().map(|&first| hands[0][first].grasp.edge);
            let fits = |edge: Edge| first.is_none_or(|first| edge == first || edge == first.turned(2));
            let fitting = holds.iter().enumerate().filter(|(_, hold)| fits(hold.grasp.edge));
            fitting.map(|(number, _)| [&numbers[..], &[number]].concat()).collect::<Vec<_>>()
        };
        chosen = chosen.iter().flat_map(longer).collect();
    }
    chosen
}

/// The arms that take part in a violation.
fn arms_of(map: &RobotMap, violation: &Violation) -> Vec<usize> {
    let mut arms: Vec<_> = violation
        .bodies
        .iter()
        .filter_map(|body| match *body {
            Body::Link(link) => map.carriers[link].map(|(arm, _)| arm),
            Body::Board | Body::Person(_) => None,
        })
        .collect();
    arms.dedup();
    arms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::paper;

    fn map() -> RobotMap {
        let loaded = paper::operations()[0].load().unwrap();
        RobotMap::new(&loaded.robot, loaded.scenario.object.size_m)
    }

    #[test]
    fn every_hold_is_of_such_a_board_reaches_it_and_touches_nothing() {
        let map = map();
        let boards: Vec<_> = map.bank.iter().take(20).map(|known| known.hold.x_wo).collect();
        let found = holds(&map, &boards, 200, [1, 1]);
        assert!(found.len() > 20, "{}", found.len());
        for BankedHold { hold: KnownHold { x_wo, holds }, .. } in &found {
            let alike = |board: &Pose| {
                let up = |pose: &Pose| pose.rotation.inverse() * Vector3::z();
                (board.translation.z - x_wo.translation.z).abs() < 1e-12 && (up(board) - up(x_wo)).norm() < 1e-12
            };
            assert!(boards.iter().any(alike));
            assert!(assess::in_domain(x_wo));
            for (arm, hold) in map.arms.iter().zip(holds) {
                let missed = arm.chain.gripper_pose(&hold.q_rad).inverse() * (x_wo * hold.grasp.x_og(map.size_m));
                // What the solver calls found: METHOD section 3 asks for 1e-6 m and rad.
                assert!(missed.translation.vector.norm() < 1e-6 && missed.rotation.angle() < 1e-6);
                assert!(assess::pads_on_board(&map.robot.arms[arm.index].gripper, &hold.grasp, map.size_m));
            }
            let [left, right] = [0, 1].map(|hand: usize| holds[hand].grasp.edge);
            assert!(left == right || left == right.turned(2));
            let poses = map.link_poses(holds);
            assert!(map.collision.first_violation(&map.scene(&poses, *x_wo)).is_none());
        }
        // Both ways to hold a board are there.
        let same =
            found.iter().filter(|known| known.hold.holds[0].grasp.edge == known.hold.holds[1].grasp.edge).count();
        assert!(same > 0 && same < found.len());
    }

    #[test]
    fn one_thread_finds_what_many_find() {
        let map = map();
        let boards = [map.bank[0].hold.x_wo];
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| holds(&map, &boards, 60, [3, 2]));
            found.iter().map(|known| format!("{:?}", known.hold)).collect::<Vec<_>>()
        };
        let alone = with(1);
        assert!(!alone.is_empty());
        assert_eq!(alone, with(3));
        assert!(holds(&map, &[], 60, [3, 2]).is_empty());
    }
}
