//! The random planner: what the others are measured against (METHOD section 3).
//!
//! The board's pose is drawn uniformly from the domain of the search, its rotation uniformly from all that face the person's
//! side, and a grasp for each hand; again and again until the arms reach, nothing touches and the hold stands the load.
//! The arms take the first configuration that is found, and the person then answers as best they can.

use nalgebra::Vector3;
use rand_pcg::Pcg64;

use super::{
    Problem,
    assess::{self, Configured, Feasible, Rejection, Tally},
    bank::{draw_edge, draw_grasp, other_edge},
    candidate::{Candidate, Hold},
};
use crate::{comfort, model::frames::Pose};

/// Holds that are drawn before the search is given up.
const DRAWS: u64 = 2_000_000;

/// The first hold that keeps every constraint and that the person has an answer to.
pub fn draw(problem: &mut Problem<'_>, random: &mut Pcg64, tally: &mut Tally) -> Option<Feasible> {
    for _ in 0..DRAWS {
        if tally.is_exhausted() {
            break;
        }
        tally.draw();
        if !problem.watch.allows() {
            break;
        }
        match draw_once(problem, random) {
            Ok(found) => return Some(found),
            Err(why) => tally.remove(why),
        }
    }
    None
}

fn draw_once(problem: &mut Problem<'_>, random: &mut Pcg64) -> Result<Feasible, Rejection> {
    let map = problem.map;
    let x_wo = assess::draw_board(random);
    let mut edge = draw_edge(random);
    let mut grasps = Vec::with_capacity(map.arms.len());
    for (number, arm) in map.arms.iter().enumerate() {
        if number > 0 {
            edge = other_edge(edge, random);
        }
        // One grasp an arm: where it is not within reach the whole hold is drawn again, lest the draw be biased.
        let grasp = draw_grasp(map, arm, edge, |_| true, random).ok_or(Rejection::RobotReach)?;
        if !arm.reach.reaches(&arm.chain, &(x_wo * grasp.x_og(map.size_m))) {
            return Err(Rejection::RobotReach);
        }
        grasps.push(grasp);
    }
    let mut holds = Vec::with_capacity(grasps.len());
    for (arm, grasp) in map.arms.iter().zip(grasps) {
        let x_wg = x_wo * grasp.x_og(map.size_m);
        let mut seeds = arm.reach.seeds(&arm.chain, &x_wg);
        let found = seeds.find_map(|seed| arm.inverse.local(&x_wg, &seed).found());
        holds.push(Hold { grasp, q_rad: found.ok_or(Rejection::RobotReach)? });
    }
    let poses = map.link_poses(&holds);
    if map.collision.first_violation(&map.scene(&poses, x_wo)).is_some() {
        return Err(Rejection::Collision);
    }
    answered(problem, &x_wo, holds, &poses)
}

/// The hold with the person's best answer, when it stands the load.
fn answered(
    problem: &mut Problem<'_>,
    x_wo: &Pose,
    holds: Vec<Hold>,
    link_poses: &[Pose],
) -> Result<Feasible, Rejection> {
    let p_wo = x_wo.translation.vector;
    let mut candidate =
        Candidate { q_h_rad: [0.0; 7], heading_rad: 0.0, roll_rad: 0.0, p_wo_xy_m: [p_wo.x, p_wo.y], holds };
    // Stability hardly costs more than a thousandth of the person's answer.
    if assess::utilisation(problem, &candidate, x_wo) > 1.0 {
        return Err(Rejection::Stability);
    }
    let points = comfort::robot_points_w(&problem.map.robot, link_poses);
    let answer = comfort::most(&comfort::Hold {
        human: &problem.human,
        collision: &problem.map.collision,
        settings: problem.objective,
        operation: problem.scenario.operation,
        floor_z_m: problem.map.robot.floor_z_m,
        robot_points_w: &points,
        scene: problem.map.scene(link_poses, *x_wo),
    })
    .ok_or(Rejection::PersonReach)?;
    let ahead = answer.x_wb.rotation * Vector3::x();
    candidate.q_h_rad = answer.q_rad;
    candidate.heading_rad = ahead.y.atan2(ahead.x);
    candidate.roll_rad = answer.roll_rad();
    assess::place(problem, &candidate)?;
    let configured = Configured::new(problem, &candidate);
    assess::collisions(problem, &configured)?;
    let comfort = assess::comfort(problem, &candidate, &configured);
    problem.watch.found(&comfort);
    let utilisation = assess::utilisation(problem, &candidate, x_wo);
    Ok(Feasible { candidate, configured, comfort, worth: comfort.objective, utilisation })
}
