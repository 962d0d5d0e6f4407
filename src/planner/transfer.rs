//! Solutions of one task, transferred to another.
//!
//! The board is turned by quarters about its normal (a rectangle is the same after half a turn, and nearly so after a quarter; a
//! plate only after the turns that leave its outline as it is), then the person or the board moves so that the tool is where the
//! new task needs it and, if their place is given, the person stands there.

use std::f64::consts::FRAC_PI_2;

use arrayvec::ArrayVec;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::{
    candidate::{Candidate, WorkPose},
    evaluate::{self, Configuration, Evaluator},
    library::{ArmGrasp, BoardGrasp, GraspingRobot},
    outcome::Rejection,
    problem::Problem,
    screen::{align, aligning_roll},
};
use crate::model::{
    board::{BoardShape, Edge, QUARTERS},
    frames::Pose,
    grasp::EdgeGrasp,
    plan::Comfort,
};

/// A candidate that solves a task.
#[derive(Clone, Debug)]
pub struct Solution {
    pub candidate: Candidate,
    /// Pose of the board, W.
    pub x_wo: Pose,
    pub comfort: Comfort,
    /// The tool tip on the board.
    p_ot_m: Point3<f64>,
}

impl Solution {
    /// A candidate that solves a problem's task.
    pub fn new(problem: &Problem<'_>, candidate: Candidate) -> Self {
        let configuration = Configuration::new(problem, &candidate);
        let comfort = evaluate::comfort(problem, &candidate, &configuration);
        let p_ot_m = problem.scenario.operation.x_ot.translation.vector.into();
        Self { candidate, x_wo: configuration.placement.x_wo, comfort, p_ot_m }
    }

    /// The candidates to which the solution is transferred with the board turned by quarters, each with its objective. Those that an
    /// arm cannot follow are counted as rejected.
    pub fn transfers(&self, evaluator: &mut Evaluator<'_>, quarters: usize) -> ArrayVec<(f64, Candidate), 2> {
        let mut transfers = ArrayVec::new();
        for candidate in self.transferred(&evaluator.problem, quarters) {
            match candidate {
                Some(candidate) => transfers.push((evaluator.objective(&candidate), candidate)),
                None => {
                    evaluator.stats.count();
                    evaluator.stats.reject(Rejection::RobotReach);
                }
            }
        }
        transfers
    }

    /// The solution with the board turned by quarters about its normal and the tool where the problem's operation needs it:
    /// once with the board left in place and the person moved, once with the person left in place and the board moved.
    fn transferred(&self, problem: &Problem<'_>, quarters: usize) -> [Option<Candidate>; 2] {
        let grasp = BoardGrasp { x_wo: self.x_wo, arms: self.candidate.arms.clone() };
        let Some(grasp) = turned(problem.robot, &grasp, quarters) else { return [None, None] };
        [self.with_person_moved(problem, &grasp), self.with_board_moved(problem, &grasp)]
    }

    fn with_person_moved(&self, problem: &Problem<'_>, grasp: &BoardGrasp) -> Option<Candidate> {
        let q_h_rad = &self.candidate.work.q_h_rad;
        let x_bt = problem.human.tool_pose_b(q_h_rad);
        align(problem, grasp, q_h_rad, &x_bt)
    }

    fn with_board_moved(&self, problem: &Problem<'_>, grasp: &BoardGrasp) -> Option<Candidate> {
        let work = self.candidate.work;
        let x_bt = problem.human.tool_pose_b(&work.q_h_rad);
        let roll_rad = aligning_roll(problem, &grasp.x_wo, &x_bt);
        let mut candidate = Candidate { work: WorkPose { roll_rad, ..work }, arms: grasp.arms.clone() };
        // The tip stays where it is, and the board moves under it.
        let p_ot_m = Point3::from(problem.scenario.operation.x_ot.translation.vector);
        let missed = self.x_wo * self.p_ot_m - candidate.x_wo(problem) * p_ot_m;
        candidate.work.p_wo_xy_m[0] += missed.x;
        candidate.work.p_wo_xy_m[1] += missed.y;
        candidate.work.stand_as_given(problem);
        let x_wo = candidate.x_wo(problem);
        problem.robot.follow(&mut candidate.arms, &x_wo).then_some(candidate)
    }
}

/// The numbers of quarters by which a board can be turned so that its outline is the same.
pub fn turns(board: &BoardShape) -> Vec<usize> {
    (0..QUARTERS).filter(|quarters| board.turns(*quarters)).collect()
}

/// The grasp with the board turned by quarters about its normal: each gripper takes the edge that is now where its own was.
/// `None` if the outline is another one then, or an arm cannot make up for the board's unequal sides.
fn turned(robot: &GraspingRobot, grasp: &BoardGrasp, quarters: usize) -> Option<BoardGrasp> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 * quarters as f64);
    let x_wo = Isometry3::from_parts(grasp.x_wo.translation, grasp.x_wo.rotation * turn);
    let arms = grasp.arms.iter().map(|ArmGrasp { grasp, q_rad }| {
        let edge = robot.board.turned(grasp.edge, QUARTERS - quarters)?;
        let along_m = match robot.board.plate {
            // The outline is the same, and so is the place on it.
            Some(_) => grasp.along_m,
            None => grasp.along_m * half_length_m(robot, edge) / half_length_m(robot, grasp.edge),
        };
        Some(ArmGrasp { grasp: EdgeGrasp { edge, along_m, ..*grasp }, q_rad: q_rad.clone() })
    });
    let mut arms = arms.collect::<Option<Vec<_>>>()?;
    // After half a turn the grippers are where they were.
    (quarters.is_multiple_of(2) || robot.follow(&mut arms, &x_wo)).then_some(BoardGrasp { x_wo, arms })
}

/// Half the length of an edge of a box, m.
fn half_length_m(robot: &GraspingRobot, edge: Edge) -> f64 {
    robot.board.edge(edge).along_m[1]
}
