//! The problem of a task: one problem for each piece of the path, and what is tested of a hold.

use nalgebra::Point3;

use super::super::{
    assemble::{accepted, assemble_placed},
    candidate::{Candidate, Placement, WorkPose},
    evaluate::{self, Configuration, Evaluator},
    library::{BoardGrasp, GraspingRobot},
    outcome::PlanError,
    problem::Problem,
    stats::SearchStats,
    watch::Watch,
};
use crate::{
    comfort::{self, Response, ResponseQuery},
    human::{ArmAngles, Standing},
    model::{
        frames::Pose,
        operation::Operation,
        plan::{Comfort, Plan},
        scenario::Scenario,
        task::Task,
        tool_path::Piece,
    },
};

/// How far inside a piece its ends are tested, m: at a corner between two pieces the tool has the direction of the next.
const INSIDE_M: f64 = 1e-6;

/// The person at a piece.
#[derive(Clone, Copy, Debug)]
pub struct Posture {
    pub x_wb: Pose,
    pub q_h_rad: ArmAngles,
    /// Roll of the tool from the piece's operation, rad.
    pub roll_rad: f64,
}

impl Posture {
    /// The posture of a response; its roll is counted from `roll_rad`.
    pub fn of(response: &Response, roll_rad: f64) -> Self {
        Self { x_wb: response.x_wb, q_h_rad: response.q_rad, roll_rad: roll_rad + response.roll_rad() }
    }
}

/// The problems of all pieces.
pub struct TaskProblem<'a> {
    pub task: &'a Task,
    /// The pieces of the path.
    pieces_of_path: Vec<Piece>,
    pub robot: &'a GraspingRobot,
    pub evaluators: Vec<Evaluator<'a>>,
    /// The objective of the best hold for each piece alone.
    pub best: Vec<f64>,
    pub watch: &'a dyn Watch,
}

impl<'a> TaskProblem<'a> {
    /// The problem of a task whose pieces have these scenarios and best objectives.
    ///
    /// # Errors
    /// When the scenario's person or tool is invalid.
    pub fn new(
        task: &'a Task,
        pieces: &'a [Scenario],
        best: Vec<f64>,
        robot: &'a GraspingRobot,
        watch: &'a dyn Watch,
    ) -> Result<Self, PlanError> {
        let evaluator =
            |scenario| Ok(Evaluator::new(Problem::new(scenario, robot, watch)?, SearchStats::unlimited(watch)));
        let evaluators = pieces.iter().map(evaluator).collect::<Result<_, PlanError>>()?;
        Ok(Self { task, pieces_of_path: task.pieces(), robot, evaluators, best, watch })
    }

    pub fn pieces(&self) -> usize {
        self.evaluators.len()
    }

    /// Where a piece is on the path.
    pub fn piece(&self, piece: usize) -> Piece {
        self.pieces_of_path[piece]
    }

    pub fn of_piece(&self, piece: usize) -> &Problem<'a> {
        &self.evaluators[piece].problem
    }

    /// A piece's operation with the tool rolled.
    pub fn operation(&self, piece: usize, roll_rad: f64) -> Operation {
        self.of_piece(piece).scenario.operation.rolled(roll_rad)
    }

    /// The operations where a piece begins and ends, with the tool rolled; a hole has none beside its own.
    pub fn operations_at_ends(&self, piece: usize, roll_rad: f64) -> Vec<Operation> {
        let Piece { stroke, from_m, to_m } = self.piece(piece);
        if to_m - from_m <= 2.0 * INSIDE_M {
            return Vec::new();
        }
        let thickness_m = self.of_piece(piece).scenario.object.size_m[2];
        let ends_m = [from_m + INSIDE_M, to_m - INSIDE_M].into_iter();
        ends_m.filter_map(|at_m| Some(self.task.operation_at(stroke, at_m, thickness_m)?.rolled(roll_rad))).collect()
    }

    /// The pose of the board with a piece at a pose of the tool.
    pub fn board_pose(&self, x_wt: &Pose, roll_rad: f64, piece: usize) -> Pose {
        x_wt * self.operation(piece, roll_rad).x_ot.inverse()
    }

    /// What a piece costs with this objective: the share of the best one that it loses; `None` below the least comfort.
    pub fn cost(&self, piece: usize, objective: f64) -> Option<f64> {
        let kept = objective / self.best[piece];
        (kept >= self.task.least_comfort).then_some((1.0 - kept).max(0.0))
    }

    /// The comfort of a posture at a piece beside a robot with these points.
    pub fn comfort(&self, piece: usize, x_wo: &Pose, posture: &Posture, robot_points_w: &[Point3<f64>]) -> Comfort {
        let problem = self.of_piece(piece);
        let wrench_w = self.operation(piece, posture.roll_rad).wrench_w(x_wo);
        let Posture { x_wb, q_h_rad, .. } = posture;
        comfort::posture_comfort(&problem.human, &problem.objective, robot_points_w, x_wb, q_h_rad, &wrench_w)
    }

    /// The robot's points of the peripersonal metric.
    pub fn robot_points_w(&self, link_poses: &[Pose]) -> Vec<Point3<f64>> {
        comfort::robot_points_w(&self.robot.robot, link_poses)
    }

    /// The person's best response to a piece near a posture. Without link poses and points of the robot only the board is in the
    /// way.
    pub fn response_near(
        &self,
        piece: usize,
        x_wo: &Pose,
        from: &Posture,
        link_poses: &[Pose],
        robot_points_w: &[Point3<f64>],
    ) -> Option<Posture> {
        let operation = self.operation(piece, from.roll_rad);
        let query: ResponseQuery<'_> =
            evaluate::response_query(self.of_piece(piece), operation, link_poses, *x_wo, robot_points_w);
        comfort::response_near(&query, &from.x_wb, &from.q_h_rad).map(|found| Posture::of(&found, from.roll_rad))
    }

    /// True if a person in this posture, who keeps all limits of a posture by itself, may stand there, touches nothing and sees
    /// the work.
    pub fn is_free(&self, piece: usize, grasp: &BoardGrasp, posture: &Posture) -> bool {
        let problem = self.of_piece(piece);
        if !problem.human.may_stand(&Standing::of(&posture.x_wb)) {
            return false;
        }
        let candidate = candidate(grasp, posture);
        let placement = Placement { x_wo: grasp.x_wo, x_wb: posture.x_wb };
        let configuration = Configuration::placed(problem, &candidate, placement);
        let scene = configuration.scene(problem);
        self.robot.collision.first_violation_of_person(&scene).is_none()
            && evaluate::test_sight(problem, &configuration).is_ok()
    }

    /// The plan of a hold for a piece, if it is accepted.
    pub fn plan(&mut self, piece: usize, grasp: &BoardGrasp, posture: &Posture) -> Option<Plan> {
        let link_poses = self.robot.link_poses(&grasp.arms);
        let points_w = self.robot_points_w(&link_poses);
        let comfort = self.comfort(piece, &grasp.x_wo, posture, &points_w);
        let placement = Placement { x_wo: grasp.x_wo, x_wb: posture.x_wb };
        let evaluator = &mut self.evaluators[piece];
        let plan = assemble_placed(evaluator, &candidate(grasp, posture), &placement, &comfort, 0)?;
        accepted(evaluator, plan)
    }
}

/// A grasp with a posture as a candidate of the search for single holds.
fn candidate(grasp: &BoardGrasp, posture: &Posture) -> Candidate {
    let mut candidate = Candidate::without_person(grasp);
    let heading_rad = Standing::of(&posture.x_wb).heading_rad;
    let Posture { q_h_rad, roll_rad, .. } = *posture;
    candidate.work = WorkPose { q_h_rad, heading_rad, roll_rad, ..candidate.work };
    candidate
}
