//! The first half of the search: random candidates, the best of which are handed on.

use std::f64::consts::{FRAC_PI_4, PI};

use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

use super::{
    Problem,
    assess::{self, BOARD_X_M, BOARD_Y_M, Placed, Rejection, Tally},
    candidate::{Candidate, Hold},
};
use crate::{
    human::ArmAngles,
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
        plan::Comfort,
    },
};

/// Postures of the person's arm that are drawn before anything else.
const POSTURES: usize = 20_000;
/// The best postures that candidates are made of.
const POSTURES_KEPT: usize = 4_000;
/// Candidates that are drawn.
const DRAWS: usize = 30_000;
/// Headings that are tried for a posture, and grasps for an arm, before the candidate is given up.
const TRIES: usize = 16;
/// Random seeds that each arm's inverse kinematics is given for a drawn grasp.
const ARM_SEEDS: usize = 3;
/// Probability that a second arm holds the edge opposite to the first's, not the same one.
const OPPOSITE: f64 = 0.75;
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
    pub comfort: Comfort,
}

/// Draws candidates and returns the best that keep every constraint, the best first.
pub fn best_candidates(problem: &mut Problem<'_>, random: &mut Pcg64, tally: &mut Tally) -> Vec<Feasible> {
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
            Ok(()) => kept.push(Feasible { candidate, comfort }),
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
fn draw(problem: &Problem<'_>, postures: &[ArmAngles], random: &mut Pcg64) -> Result<(Candidate, Placed), Rejection> {
    let (mut candidate, placed) = draw_place(problem, postures, random)?;
    let size_m = problem.scenario.object.size_m;
    let first = random.random_range(0..Edge::ALL.len());
    for (index, arm) in problem.arms.iter().enumerate() {
        // Each next arm holds opposite to the first or on the same edge (METHOD section 2).
        let opposite = index > 0 && random.random_bool(OPPOSITE);
        let edge = Edge::ALL[if opposite { (first + 2) % Edge::ALL.len() } else { first }];
        let gripper = &problem.robot.arms[arm.index].gripper;
        let grasp = (0..TRIES)
            .map(|_| draw_grasp(edge, size_m, random))
            .find(|grasp| assess::pads_on_board(gripper, grasp, size_m))
            .ok_or(Rejection::PadOverEdge)?;
        let q_rad = draw_arm(problem, arm.index, &(placed.x_wo * grasp.x_og(size_m)), random)?;
        candidate.holds.push(Hold { grasp, q_rad });
    }
    assess::collisions(problem, &candidate, &placed)?;
    Ok((candidate, placed))
}

/// A candidate without its grasps: a comfortable posture, somewhere in the domain of the search.
fn draw_place(
    problem: &Problem<'_>,
    postures: &[ArmAngles],
    random: &mut Pcg64,
) -> Result<(Candidate, Placed), Rejection> {
    let roll_is_free = problem.scenario.operation.kind.roll_is_free();
    // The square leans towards the comfortable end of the list.
    let rank = uniform(random, 0.0, 1.0).powi(2) * postures.len() as f64;
    let mut candidate = Candidate {
        q_h_rad: postures[rank as usize],
        heading_rad: 0.0,
        roll_rad: if roll_is_free { uniform(random, -PI, PI) } else { 0.0 },
        p_wo_xy_m: [uniform(random, BOARD_X_M[0], BOARD_X_M[1]), uniform(random, BOARD_Y_M[0], BOARD_Y_M[1])],
        holds: Vec::new(),
    };
    let mut placed = Err(Rejection::Facing);
    for _ in 0..TRIES {
        candidate.heading_rad = uniform(random, -PI, PI);
        placed = assess::place(problem, &candidate);
        if !matches!(placed, Err(Rejection::Facing)) {
            break;
        }
    }
    placed.map(|placed| (candidate, placed))
}

fn draw_grasp(edge: Edge, size_m: [f64; 3], random: &mut Pcg64) -> EdgeGrasp {
    let (_, half_length_m) = edge.reach_and_half_length_m(size_m);
    EdgeGrasp {
        edge,
        along_m: uniform(random, -half_length_m, half_length_m),
        depth_m: uniform(random, DEPTH_M[0], DEPTH_M[1]),
        angle_rad: uniform(random, ANGLE_RAD[0], ANGLE_RAD[1]),
        flipped: random.random_bool(0.5),
    }
}

/// A configuration of an arm that brings its gripper there.
fn draw_arm(problem: &Problem<'_>, arm: usize, x_wg: &Pose, random: &mut Pcg64) -> Result<Vec<f64>, Rejection> {
    let arm = &problem.arms[arm];
    let found = (0..ARM_SEEDS).find_map(|_| {
        let limits = arm.chain.lower().iter().zip(arm.chain.upper());
        let seed: Vec<_> = limits.map(|(&low, &high)| uniform(random, low, high)).collect();
        arm.inverse.local(x_wg, &seed).found()
    });
    found.ok_or(Rejection::RobotReach)
}

/// A number drawn uniformly between two others.
pub fn uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}
