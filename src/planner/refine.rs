//! The second half of the search: small random steps from the best draws, each of which must keep every constraint.
//!
//! A (1+1) evolution strategy with the step size adapted to its success (Rechenberg's one-fifth rule): derivative-free,
//! so the hard constraints need no model, and the objective is cheap enough for thousands of steps.

use rand::RngExt;
use rand_pcg::Pcg64;

use super::{
    Problem,
    assess::{self, Assessment, Tally},
    candidate::Candidate,
    draw::{ANGLE_RAD, DEPTH_M, Feasible, uniform},
};

/// Steps from each of the candidates that were handed over.
const FIRST_STEPS: usize = 250;
/// Steps from the best of those.
const LAST_STEPS: usize = 2_000;
/// Step size at the start; 1 is the scale of [`step`].
const START_SIZE: f64 = 1.0;
/// A step that succeeds makes the next larger by this factor; one that fails makes it smaller by its fourth root, so
/// that the size stays where one step in five succeeds.
const GROWTH: f64 = 1.5;
/// The range of the step size.
const SIZE_RANGE: [f64; 2] = [0.01, 2.0];
/// Probability that a step changes a given number of the candidate.
const CHANGE_PROBABILITY: f64 = 0.4;

/// What small steps lead to from each start, the best first.
pub fn refine(
    problem: &Problem<'_>,
    starts: Vec<Feasible>,
    random: &mut Pcg64,
    tally: &mut Tally,
) -> Vec<Feasible> {
    let mut refined: Vec<_> =
        starts.into_iter().map(|start| climb(problem, start, FIRST_STEPS, random, tally)).collect();
    sort_best_first(&mut refined);
    if let Some(best) = refined.first().cloned() {
        refined.insert(0, climb(problem, best, LAST_STEPS, random, tally));
    }
    refined
}

fn sort_best_first(found: &mut [Feasible]) {
    found.sort_by(|a, b| b.assessment.comfort.objective.total_cmp(&a.assessment.comfort.objective));
}

fn climb(problem: &Problem<'_>, start: Feasible, steps: usize, random: &mut Pcg64, tally: &mut Tally) -> Feasible {
    let mut best = start;
    let mut size = START_SIZE;
    for _ in 0..steps {
        tally.draw();
        let least = best.assessment.comfort.objective;
        match step(problem, &best.candidate, size, random).and_then(|next| better(problem, next, least)) {
            Some(next) => {
                best = next;
                size *= GROWTH;
            }
            None => size *= GROWTH.powf(-0.25),
        }
        size = size.clamp(SIZE_RANGE[0], SIZE_RANGE[1]);
    }
    best
}

/// The candidate's figures when it is better than `least` and keeps every constraint.
fn better(problem: &Problem<'_>, candidate: Candidate, least: f64) -> Option<Feasible> {
    let placed = assess::place(problem, &candidate).ok()?;
    let comfort = assess::comfort(problem, &candidate, &placed);
    if comfort.objective <= least {
        return None;
    }
    assess::collisions(problem, &candidate, &placed).ok()?;
    let stability = assess::stability(problem, &candidate, &placed).ok()?;
    Some(Feasible { candidate, assessment: Assessment { comfort, stability } })
}

/// A neighbour of a candidate whose arms reach, with steps of `size` times: 0.15 rad in the person's joints and heading,
/// 5 cm in place, 4 cm along an edge, 5 mm in depth, 0.15 rad in a grasp's angle, 0.3 rad in roll and in the robot's joints.
fn step(problem: &Problem<'_>, from: &Candidate, size: f64, random: &mut Pcg64) -> Option<Candidate> {
    let mut next = from.clone();
    for (q, [low, high]) in next.q_h_rad.iter_mut().zip(problem.human.arm().limits_rad) {
        *q = nudge(random, *q, 0.15 * size).clamp(low, high);
    }
    next.heading_rad = nudge(random, next.heading_rad, 0.15 * size);
    if problem.scenario.operation.kind.roll_is_free() {
        next.roll_rad = nudge(random, next.roll_rad, 0.3 * size);
    }
    next.p_wo_xy_m = next.p_wo_xy_m.map(|p| nudge(random, p, 0.05 * size));
    let x_wo = next.x_wo(problem);
    let size_m = problem.scenario.object.size_m;
    for (arm, hold) in problem.arms.iter().zip(&mut next.holds) {
        hold.grasp.along_m = nudge(random, hold.grasp.along_m, 0.04 * size);
        hold.grasp.depth_m = nudge(random, hold.grasp.depth_m, 0.005 * size).clamp(DEPTH_M[0], DEPTH_M[1]);
        hold.grasp.angle_rad = nudge(random, hold.grasp.angle_rad, 0.15 * size).clamp(ANGLE_RAD[0], ANGLE_RAD[1]);
        if !assess::pads_on_board(&problem.robot.arms[arm.index].gripper, &hold.grasp, size_m) {
            return None;
        }
        for (q, (&low, &high)) in hold.q_rad.iter_mut().zip(arm.chain.lower().iter().zip(arm.chain.upper())) {
            *q = nudge(random, *q, 0.3 * size).clamp(low, high);
        }
        hold.q_rad = arm.inverse.local(&(x_wo * hold.grasp.x_og(size_m)), &hold.q_rad).found()?;
    }
    Some(next)
}

/// A value moved by up to `scale`, or left alone.
fn nudge(random: &mut Pcg64, value: f64, scale: f64) -> f64 {
    if random.random_bool(CHANGE_PROBABILITY) { value + uniform(random, -scale, scale) } else { value }
}
