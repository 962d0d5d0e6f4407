//! A candidate: the decision variables of the search, and the poses that follow from them
//! (docs/method.md#31-decision-variables).

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::{
    library::{ArmGrasp, BoardGrasp, GraspPattern, GraspingArm, pattern},
    problem::Problem,
};
use crate::{
    human::{ArmAngles, Standing},
    model::{
        board::{BoardShape, QUARTERS},
        frames::Pose,
        grasp::EdgeGrasp,
        plan::{ArmHold, HumanPosture, Plan},
    },
};

/// A grasp of the board and a response of the person to it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Candidate {
    /// Person, tool and place of the board.
    pub work: WorkPose,
    /// One entry per arm of the robot.
    pub arms: Vec<ArmGrasp>,
}

/// The person's posture, the tool's roll and the board's place.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct WorkPose {
    /// Angles of the person's working arm, rad.
    pub q_h_rad: ArmAngles,
    /// The person's heading: direction of x_B in W, rad from x_W.
    pub heading_rad: f64,
    /// Roll of the tool about its axis, rad; zero unless the operation leaves it free.
    pub roll_rad: f64,
    /// The board's centre in W along x and y, m. Its height follows from the posture.
    pub p_wo_xy_m: [f64; 2],
}

/// The poses of board and person.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub x_wo: Pose,
    pub x_wb: Pose,
}

impl WorkPose {
    /// Moves person and board together, as little as possible, to where the person may stand; not at all if the place is free.
    pub fn stand_as_given(&mut self, problem: &Problem<'_>) {
        let Placement { x_wo, x_wb } = self.placement(problem);
        let there = problem.as_given(x_wb);
        if there == x_wb {
            return;
        }
        let moved = there * x_wb.inverse() * x_wo;
        self.heading_rad = Standing::of(&there).heading_rad;
        self.p_wo_xy_m = [moved.translation.x, moved.translation.y];
    }

    /// The poses that follow from the posture: the person stands upright on the floor, which gives the board's height and
    /// rotation, `X_WO = X_WB X_BT X_OT^-1`.
    pub fn placement(&self, problem: &Problem<'_>) -> Placement {
        let x_ot = problem.scenario.operation.rolled(self.roll_rad).x_ot;
        let x_bo = problem.human.tool_pose_b(&self.q_h_rad) * x_ot.inverse();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.heading_rad);
        let floor_z_m = problem.robot.robot.floor_z_m;
        let p_bo_w = turn * x_bo.translation.vector;
        let [x_m, y_m] = self.p_wo_xy_m;
        Placement {
            x_wo: Isometry3::from_parts(Vector3::new(x_m, y_m, floor_z_m + p_bo_w.z).into(), turn * x_bo.rotation),
            x_wb: Isometry3::from_parts(Vector3::new(x_m - p_bo_w.x, y_m - p_bo_w.y, floor_z_m).into(), turn),
        }
    }
}

impl Candidate {
    /// A grasp without a response of the person.
    pub fn without_person(grasp: &BoardGrasp) -> Self {
        let p_wo = grasp.x_wo.translation.vector;
        let work = WorkPose { q_h_rad: [0.0; 7], heading_rad: 0.0, roll_rad: 0.0, p_wo_xy_m: [p_wo.x, p_wo.y] };
        Self { work, arms: grasp.arms.clone() }
    }

    /// The candidate of a plan for the problem's task; `None` if the plan has no person or a grasp that is not one of an edge.
    pub fn of_plan(problem: &Problem<'_>, plan: &Plan) -> Option<Self> {
        let HumanPosture { x_wb, q_rad: q_h_rad, .. } = plan.human?;
        let arm = |hold: &ArmHold| {
            let grasp = EdgeGrasp::of(&hold.x_og, &problem.robot.board)?;
            Some(ArmGrasp { grasp, q_rad: hold.q_rad.clone() })
        };
        let of_arm = |arm: &GraspingArm| plan.arms.iter().find(|hold| hold.name == arm.name);
        let arms = problem.robot.arms.iter().map(|own| arm(of_arm(own)?)).collect::<Option<Vec<_>>>()?;
        let roll = problem.scenario.operation.x_ot.rotation.inverse() * plan.operation.x_ot.rotation;
        let is_free = problem.scenario.operation.kind.roll_is_free();
        let work = WorkPose {
            q_h_rad,
            heading_rad: Standing::of(&x_wb).heading_rad,
            roll_rad: if is_free { roll.scaled_axis().z } else { 0.0 },
            p_wo_xy_m: [plan.object.x_wo.translation.x, plan.object.x_wo.translation.y],
        };
        Some(Self { work, arms })
    }

    /// The pattern of the grasp.
    pub fn pattern(&self) -> GraspPattern {
        pattern(&self.arms)
    }

    /// The pattern with the board turned by those quarters that leave it as it is until the first arm's edge has the least
    /// number: that of +x_O for a box.
    pub fn normalised_pattern(&self, board: &BoardShape) -> GraspPattern {
        let pattern = self.pattern();
        let turned = |quarters: usize| -> Option<GraspPattern> {
            pattern.iter().map(|(edge, flipped)| Some((board.turned(*edge, quarters)?, *flipped))).collect()
        };
        let first = |pattern: &GraspPattern| pattern.first().map(|(edge, _)| *edge);
        (0..QUARTERS).filter_map(turned).min_by_key(first).unwrap_or_default()
    }

    /// The poses of board and person.
    pub fn placement(&self, problem: &Problem<'_>) -> Placement {
        self.work.placement(problem)
    }

    /// The board's pose in the world.
    pub fn x_wo(&self, problem: &Problem<'_>) -> Pose {
        self.placement(problem).x_wo
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{board::Edge, grasp::EdgeGrasp};

    #[test]
    fn a_normalised_pattern_is_the_same_for_all_turns_of_the_board() {
        let board = BoardShape::cuboid([0.5, 0.4, 0.03]);
        let arm = |edge, flipped| ArmGrasp {
            grasp: EdgeGrasp { edge, along_m: 0.0, depth_m: 0.03, angle_rad: 0.0, flipped },
            q_rad: Vec::new(),
        };
        let pattern = |edges: [Edge; 2]| {
            let arms = vec![arm(edges[0], true), arm(edges[1], false)];
            Candidate::without_person(&BoardGrasp { x_wo: Pose::identity(), arms }).normalised_pattern(&board)
        };
        for quarters in 0..4 {
            let turned = |edge: Edge| board.turned(edge, quarters).unwrap();
            assert_eq!(pattern([Edge::PLUS_Y, Edge::PLUS_Y].map(turned)), pattern([Edge::PLUS_X, Edge::PLUS_X]));
            assert_eq!(pattern([Edge::PLUS_X, Edge::MINUS_X].map(turned)), pattern([Edge::MINUS_Y, Edge::PLUS_Y]));
        }
        assert_ne!(pattern([Edge::PLUS_X, Edge::PLUS_X]), pattern([Edge::PLUS_X, Edge::MINUS_X]));
    }
}
