//! The random planner, the baseline of the others (docs/method.md#38-random-planner).
//!
//! The board's pose is drawn uniformly from the search domain, and one grasp for each arm; all are drawn again until the arms
//! reach, nothing collides and the grasp is stable. The arms take the first configuration that is found, and the person
//! gives the best response.

use nalgebra::Vector3;
use rand_pcg::Pcg64;

use super::{
    candidate::{Candidate, WorkPose},
    domain::{draw_edge, draw_other_edge},
    evaluate::{self, Configuration, Evaluator, Feasible},
    library::{ArmGrasp, BoardGrasp, draw_grasp},
    outcome::Rejection,
    params::screening::RANDOM_DRAWS,
    problem::Problem,
    scores::{self, scored},
};
use crate::{
    comfort,
    model::{frames::Pose, plan::Comfort},
};

/// The first draw that satisfies every constraint and has a response.
pub fn draw(evaluator: &mut Evaluator<'_>, random: &mut Pcg64) -> Option<Feasible> {
    for _ in 0..RANDOM_DRAWS {
        if evaluator.stats.is_exhausted() {
            break;
        }
        evaluator.stats.count();
        if !evaluator.stats.may_evaluate() {
            break;
        }
        match draw_once(evaluator, random) {
            Ok(found) => return Some(found),
            Err(why) => evaluator.stats.reject(why),
        }
    }
    None
}

fn draw_once(evaluator: &mut Evaluator<'_>, random: &mut Pcg64) -> Result<Feasible, Rejection> {
    let robot = evaluator.problem.robot;
    let x_wo = robot.domain.draw_board(random);
    let mut edge = draw_edge(&robot.edges, random).ok_or(Rejection::RobotReach)?;
    let mut grasps = Vec::with_capacity(robot.arms.len());
    for (number, arm) in robot.arms.iter().enumerate() {
        if number > 0 {
            edge = draw_other_edge(edge, robot.opposite(edge), random);
        }
        // One grasp per arm: if it is out of reach everything is drawn again, so that the draw is not biased.
        let grasp = draw_grasp(robot, arm, edge, |_| true, random).ok_or(Rejection::RobotReach)?;
        if !arm.reach().reaches(&arm.chain, &(x_wo * grasp.x_og(&robot.board))) {
            return Err(Rejection::RobotReach);
        }
        grasps.push(grasp);
    }
    let mut arms = Vec::with_capacity(grasps.len());
    for (arm, grasp) in robot.arms.iter().zip(grasps) {
        let x_wg = x_wo * grasp.x_og(&robot.board);
        let mut seeds = arm.reach().seeds(&arm.chain, &x_wg);
        let found = seeds.find_map(|seed| arm.inverse.local(&x_wg, &seed).found());
        arms.push(ArmGrasp { grasp, q_rad: found.ok_or(Rejection::RobotReach)? });
    }
    let link_poses = robot.link_poses(&arms);
    if robot.collision.first_violation(&robot.scene(&link_poses, x_wo)).is_some() {
        return Err(Rejection::Collision);
    }
    with_response(evaluator, &BoardGrasp { x_wo, arms }, &link_poses)
}

/// The grasp with the person's best response, if it is stable.
fn with_response(
    evaluator: &mut Evaluator<'_>,
    grasp: &BoardGrasp,
    link_poses: &[Pose],
) -> Result<Feasible, Rejection> {
    let mut candidate = Candidate::without_person(grasp);
    // Stability costs about a thousandth of the person's response.
    evaluator.test_grasp(&candidate, &grasp.x_wo)?;
    let problem = &evaluator.problem;
    let points_w = comfort::robot_points_w(&problem.robot.robot, link_poses);
    let query = evaluate::response_query(problem, problem.scenario.operation, link_poses, grasp.x_wo, &points_w);
    let response = comfort::best_response(&query);
    if problem.stop.is_stopped() {
        return Err(Rejection::NotEvaluated);
    }
    let response = response.ok_or(Rejection::PersonReach)?;
    let ahead = response.x_wb.rotation * Vector3::x();
    candidate.work = WorkPose {
        q_h_rad: response.q_rad,
        heading_rad: ahead.y.atan2(ahead.x),
        roll_rad: response.roll_rad(),
        ..candidate.work
    };
    evaluate::test_placement(problem, &candidate)?;
    let configuration = Configuration::new(problem, &candidate);
    evaluate::test_collisions(problem, &configuration)?;
    let comfort = evaluate::comfort(problem, &candidate, &configuration);
    test_scores(problem, &candidate, &comfort)?;
    // The roll is now the response's.
    let stability = evaluator.assess(&candidate, &grasp.x_wo);
    Ok(evaluator.feasible(candidate, configuration, comfort, stability))
}

/// Tests the scores of the posture: the planner draws again instead of trying the next of several candidates.
fn test_scores(problem: &Problem<'_>, candidate: &Candidate, comfort: &Comfort) -> Result<(), Rejection> {
    let wrench_w = problem.scenario.operation.wrench_w(&candidate.x_wo(problem));
    let comfort = scored(&problem.human, &candidate.work.q_h_rad, &wrench_w, *comfort);
    scores::rejection(&comfort, &problem.scenario.limits).map_or(Ok(()), Err)
}
