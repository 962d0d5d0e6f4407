//! The motion of arms that keep their grasp while the board goes from one pose to another inside the search domain. The person is
//! left out: the knife is lifted and the person steps back while the arms move. Speeds and torques are not computed.

use super::{
    super::{library::BoardGrasp, task::motion},
    coverage::PathProblem,
};
use crate::model::frames::Pose;

/// A pose on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionStep {
    /// The board's pose.
    pub x_wo: Pose,
    /// Joint angles of each arm, rad.
    pub q_rad: Vec<Vec<f64>>,
}

/// The steps from one pose to another with the same grasp, both ends included; `None` if a step cannot be made.
pub fn between(problem: &PathProblem<'_>, from: &BoardGrasp, to: &BoardGrasp) -> Option<Vec<MotionStep>> {
    let robot = &problem.library.robot;
    let steps = motion::between(robot, from, to)?;
    let inside = steps.iter().skip(1).all(|grasp| robot.domain.contains(&grasp.x_wo));
    inside.then(|| steps.iter().map(step).collect())
}

/// The grasp after the board has moved to a pose step by step with the least motion of each arm; `None` if an arm cannot follow.
pub fn followed(problem: &PathProblem<'_>, from: &BoardGrasp, x_wo: &Pose) -> Option<BoardGrasp> {
    motion::followed(&problem.library.robot, from, x_wo).filter(|there| problem.is_clear(there))
}

fn step(grasp: &BoardGrasp) -> MotionStep {
    MotionStep { x_wo: grasp.x_wo, q_rad: grasp.arms.iter().map(|arm| arm.q_rad.clone()).collect() }
}
