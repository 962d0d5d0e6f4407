//! The first half of the search: random candidates, the best of which are handed on.

use std::f64::consts::{FRAC_PI_4, PI};

use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

use super::{
    Problem,
    assess::{self, Assessment, BOARD_X_M, BOARD_Y_M, Placed, Rejection, Tally},
    candidate::{Candidate, Hold},
};
use crate::{
    human::ArmAngles,
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
    },
};

/// Postures of the person's arm that are drawn before anything else.
const POSTURES: usize = 20_000;
/// The best postures that candidates are made of.
const POSTURES_KEPT: usize = 4_000;
/// Candidates that are drawn.
const DRAWS: usize = 6_000;
/// Random seeds that each arm's inverse kinematics is given for a drawn grasp.
const ARM_SEEDS: usize = 3;
/// Candidates that are handed on.
const KEPT: usize = 8;

/// Depth of G inside the edge, m (METHOD section 2).
pub const DEPTH_M: [f64; 2] = [0.020, 0.060];
/// Turn of the gripper in the plane of the board, rad (METHOD section 2).
pub const ANGLE_RAD: [f64; 2] = [-FRAC_PI_4, FRAC_PI_4];

/// A candidate that keeps every constraint, with its figures.
#[derive(Clone, Debug)]
pub struct Feasible {
    pub candidate: Candidate,
    pub assessment: Assessment,
}

/// Draws candidates and returns the best that keep every constraint, the best first.
pub fn best_candidates(problem: &Problem<'_>, random: &mut Pcg64, tally: &mut Tally) -> Vec<Feasible> {
    let postures = comfortable_postures(problem, random);
    let mut reachable = Vec::new();
    for _ in 0..DRAWS {
        tally.draw();
        if postures.is_empty() {
            tally.remove(Rejection::Strength);
            continue;
        }
        match draw(problem, &postures, random) {
            Ok((candidate, placed)) => {
                let comfort = assess::comfort(problem, &candidate, &placed);
                reachable.push((candidate, placed, comfort));
            }
            Err(why) => tally.remove(why),
        }
    }
    reachable.sort_by(|a, b| b.2.objective.total_cmp(&a.2.objective));
    let mut kept = Vec::new();
    for (candidate, placed, comfort) in reachable {
        if kept.len() == KEPT {
            break;
        }
        match assess::stability(problem, &candidate, &placed) {
            Ok(stability) => kept.push(Feasible { candidate, assessment: Assessment { comfort, stability } }),
            Err(why) => tally.remove(why),
        }
    }
    kept
}

/// Postures that the person's strength allows, the most comfortable first.
fn comfortable_postures(problem: &Problem<'_>, random: &mut Pcg64) -> Vec<ArmAngles> {
    let mut postures: Vec<_> = (0..POSTURES)
        .filter_map(|_| {
            let q_h_rad = problem.human.arm().limits_rad.map(|[low, high]| uniform(random, low, high));
            assess::posture_comfort(problem, &q_h_rad).map(|muscular| (muscular.regularised, q_h_rad))
        })
        .collect();
    postures.sort_by(|a, b| b.0.total_cmp(&a.0));
    postures.truncate(POSTURES_KEPT);
    postures.into_iter().map(|(_, q_h_rad)| q_h_rad).collect()
}

/// One candidate whose arms reach and where nothing collides.
fn draw(
    problem: &Problem<'_>,
    postures: &[ArmAngles],
    random: &mut Pcg64,
) -> Result<(Candidate, Placed), Rejection> {
    let roll_is_free = problem.scenario.operation.kind.roll_is_free();
    let mut candidate = Candidate {
        // The square leans towards the comfortable end of the list.
        q_h_rad: postures[(uniform(random, 0.0, 1.0).powi(2) * postures.len() as f64) as usize],
        heading_rad: uniform(random, -PI, PI),
        roll_rad: if roll_is_free { uniform(random, -PI, PI) } else { 0.0 },
        p_wo_xy_m: [uniform(random, BOARD_X_M[0], BOARD_X_M[1]), uniform(random, BOARD_Y_M[0], BOARD_Y_M[1])],
        holds: Vec::new(),
    };
    let placed = assess::place(problem, &candidate)?;
    for (arm, grasp) in problem.arms.iter().zip(draw_grasps(problem, random)) {
        let gripper = &problem.robot.arms[arm.index].gripper;
        if !assess::pads_on_board(gripper, &grasp, problem.scenario.object.size_m) {
            return Err(Rejection::PadOverEdge);
        }
        let x_wg = placed.x_wo * grasp.x_og(problem.scenario.object.size_m);
        let q_rad = draw_arm(problem, arm.index, &x_wg, random).ok_or(Rejection::RobotReach)?;
        candidate.holds.push(Hold { grasp, q_rad });
    }
    assess::collisions(problem, &candidate, &placed)?;
    Ok((candidate, placed))
}

/// A grasp for every arm: each next arm opposite to the first or on the same edge (METHOD section 2).
fn draw_grasps(problem: &Problem<'_>, random: &mut Pcg64) -> Vec<EdgeGrasp> {
    let first = random.random_range(0..Edge::ALL.len());
    let mut grasps = Vec::with_capacity(problem.arms.len());
    for index in 0..problem.arms.len() {
        let opposite = index > 0 && random.random_bool(0.75);
        let edge = Edge::ALL[if opposite { (first + 2) % Edge::ALL.len() } else { first }];
        let (_, half_length_m) = edge.reach_and_half_length_m(problem.scenario.object.size_m);
        grasps.push(EdgeGrasp {
            edge,
            along_m: uniform(random, -half_length_m, half_length_m),
            depth_m: uniform(random, DEPTH_M[0], DEPTH_M[1]),
            angle_rad: uniform(random, ANGLE_RAD[0], ANGLE_RAD[1]),
            flipped: random.random_bool(0.5),
        });
    }
    grasps
}

/// A configuration of an arm that brings its gripper there.
fn draw_arm(problem: &Problem<'_>, arm: usize, x_wg: &Pose, random: &mut Pcg64) -> Option<Vec<f64>> {
    let arm = &problem.arms[arm];
    (0..ARM_SEEDS).find_map(|_| {
        let limits = arm.chain.lower().iter().zip(arm.chain.upper());
        let seed: Vec<_> = limits.map(|(&low, &high)| uniform(random, low, high)).collect();
        arm.inverse.local(x_wg, &seed).found()
    })
}

/// A number drawn uniformly between two others.
pub fn uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}
