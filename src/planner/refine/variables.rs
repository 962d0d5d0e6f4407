//! The free variables of a refinement around a candidate, and how the arms' joints follow them.
//!
//! A step d is in units of the scales in [`super::super::params::refine`]. In this order: seven joints of the person, heading,
//! x and y, the tool's roll where it is free, then for each arm three variables of its grasp and its redundancy.

use nalgebra::{DMatrix, DVector, Matrix6, Point3, Vector3, Vector6};

use super::super::{
    candidate::{Candidate, Placement, WorkPose},
    params::refine::{DAMPING, DIFFERENCE, PERSON_RAD, PLACE_M, REDUNDANCY_RAD, ROLL_RAD},
    problem::Problem,
};
use crate::model::{frames::Pose, grasp::EdgeGrasp};

/// The free variables, and the derivatives of all poses by them.
#[derive(Clone, Debug)]
pub struct Variables {
    roll_is_free: bool,
    /// Scales of the variables of a grasp.
    grasp_scales: [f64; 3],
    /// Index of each arm's first variable: three of its grasp, then its redundancy.
    arms: Vec<usize>,
    /// Derivatives of board and body by each variable that is not an arm's.
    pub work: Vec<WorkTwist>,
    /// Derivatives of each arm's joints by all variables, rad per unit: joints by variables.
    pub joints: Vec<DMatrix<f64>>,
    count: usize,
}

/// Derivatives of board and body by one variable.
#[derive(Clone, Copy, Debug)]
pub struct WorkTwist {
    pub board: RigidTwist,
    /// The person's body without the working arm.
    pub body: RigidTwist,
}

/// Derivative of a rigid body's pose by one variable, W axes.
#[derive(Clone, Copy, Debug)]
pub struct RigidTwist {
    /// Of its frame's origin, m per unit.
    pub linear: Vector3<f64>,
    /// rad per unit.
    pub angular: Vector3<f64>,
    /// The origin, W.
    origin_w: Point3<f64>,
}

impl RigidTwist {
    /// From two poses that are [`DIFFERENCE`] of a unit apart.
    fn between(from: &Pose, to: &Pose) -> Self {
        let angular = (to.rotation * from.rotation.inverse()).scaled_axis() / DIFFERENCE;
        let linear = (to.translation.vector - from.translation.vector) / DIFFERENCE;
        Self { linear, angular, origin_w: from.translation.vector.into() }
    }

    /// Derivative of a point fixed to the body, m per unit.
    pub fn at(&self, p_w: &Point3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(&(p_w - self.origin_w))
    }

    /// Linear derivative at a point, then the angular one.
    fn twist_at(&self, p_w: &Point3<f64>) -> Vector6<f64> {
        let linear = self.at(p_w);
        let angular = &self.angular;
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }
}

/// Variables of the person and the place: seven joints, heading, x, y.
const WORK: usize = 10;

impl Variables {
    /// The variables around a candidate.
    pub fn new(problem: &Problem<'_>, candidate: &Candidate, here: &Placement) -> Self {
        let roll_is_free = problem.scenario.operation.kind.roll_is_free();
        let mut count = WORK + usize::from(roll_is_free);
        let mut arms = Vec::with_capacity(problem.robot.arms.len());
        for arm in &problem.robot.arms {
            arms.push(count);
            count += problem.grasp_scales.len() + arm.chain.dof().saturating_sub(6);
        }
        let work = (0..WORK + usize::from(roll_is_free)).map(|number| {
            let there = perturbed(candidate.work, number).placement(problem);
            WorkTwist {
                board: RigidTwist::between(&here.x_wo, &there.x_wo),
                body: RigidTwist::between(&here.x_wb, &there.x_wb),
            }
        });
        let grasp_scales = problem.grasp_scales;
        let mut variables = Self { roll_is_free, grasp_scales, arms, work: work.collect(), joints: Vec::new(), count };
        let of_arm = |arm| variables.joint_derivatives(problem, candidate, &here.x_wo, arm);
        variables.joints = (0..problem.robot.arms.len()).map(of_arm).collect();
        variables
    }

    /// The variables of an arm's grasp: along the edge, depth, angle.
    pub fn of_grasp(&self, arm: usize) -> std::ops::Range<usize> {
        self.arms[arm]..self.arms[arm] + self.grasp_scales.len()
    }

    /// Number of variables.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A candidate after a step, to first order: the grippers miss their grasps by the square of the step.
    pub fn apply_linear(&self, from: &Candidate, d: &DVector<f64>) -> Candidate {
        let mut to = self.apply_without_joints(from, d);
        for (arm, derivatives) in to.arms.iter_mut().zip(&self.joints) {
            for (joint, q) in arm.q_rad.iter_mut().enumerate() {
                *q += derivatives.row(joint).dot(&d.transpose());
            }
        }
        to
    }

    /// A candidate after a step, exactly; `None` if an arm cannot follow.
    pub fn apply(&self, problem: &Problem<'_>, from: &Candidate, d: &DVector<f64>) -> Option<Candidate> {
        let mut to = self.apply_linear(from, d);
        for (q, [low, high]) in to.work.q_h_rad.iter_mut().zip(problem.human.arm().ranges.joints_rad) {
            *q = q.clamp(low, high);
        }
        let x_wo = to.x_wo(problem);
        problem.robot.follow(&mut to.arms, &x_wo).then_some(to)
    }

    /// A candidate after a step, with the arms' joints as they were.
    fn apply_without_joints(&self, from: &Candidate, d: &DVector<f64>) -> Candidate {
        let mut to = from.clone();
        for (joint, q) in to.work.q_h_rad.iter_mut().enumerate() {
            *q += PERSON_RAD * d[joint];
        }
        to.work.heading_rad += PERSON_RAD * d[7];
        to.work.p_wo_xy_m[0] += PLACE_M * d[8];
        to.work.p_wo_xy_m[1] += PLACE_M * d[9];
        if self.roll_is_free {
            to.work.roll_rad += ROLL_RAD * d[WORK];
        }
        for (arm, &first) in to.arms.iter_mut().zip(&self.arms) {
            let [along_m, depth_m, angle_rad] = self.grasp_scales;
            arm.grasp.along_m += along_m * d[first];
            arm.grasp.depth_m += depth_m * d[first + 1];
            arm.grasp.angle_rad += angle_rad * d[first + 2];
        }
        to
    }

    /// Derivatives of an arm's joints, `J+ xi + N`: the joints follow the gripper's twist xi by the least motion, and move
    /// freely along the null space N.
    fn joint_derivatives(&self, problem: &Problem<'_>, candidate: &Candidate, x_wo: &Pose, arm: usize) -> DMatrix<f64> {
        let chain = &problem.robot.arms[arm].chain;
        let own = &candidate.arms[arm];
        let jacobian = chain.jacobian_w(&own.q_rad);
        let mut derivatives = DMatrix::zeros(chain.dof(), self.count);
        let normal: Matrix6<f64> = &jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(DAMPING);
        let Some(inverse) = normal.try_inverse() else { return derivatives };
        let pseudo_inverse = jacobian.transpose() * inverse;
        let board = &problem.robot.board;
        let here = x_wo * own.grasp.x_og(board);
        for (number, work) in self.work.iter().enumerate() {
            let twist = work.board.twist_at(&here.translation.vector.into());
            derivatives.set_column(number, &(&pseudo_inverse * twist));
        }
        let grasp = self.of_grasp(arm);
        for (part, number) in grasp.clone().enumerate() {
            let there = x_wo * perturbed_grasp(own.grasp, &problem.grasp_scales, part, DIFFERENCE).x_og(board);
            let twist = RigidTwist::between(&here, &there).twist_at(&here.translation.vector.into());
            derivatives.set_column(number, &(&pseudo_inverse * twist));
        }
        let projector = DMatrix::identity(chain.dof(), chain.dof()) - &pseudo_inverse * &jacobian;
        let redundancy = leading_directions(projector, chain.dof().saturating_sub(6));
        for (number, direction) in redundancy.iter().enumerate() {
            derivatives.set_column(grasp.end + number, &(direction * REDUNDANCY_RAD));
        }
        derivatives
    }
}

/// A work pose changed by [`DIFFERENCE`] of one of its variables.
fn perturbed(mut work: WorkPose, number: usize) -> WorkPose {
    match number {
        0..7 => work.q_h_rad[number] += PERSON_RAD * DIFFERENCE,
        7 => work.heading_rad += PERSON_RAD * DIFFERENCE,
        8 | 9 => work.p_wo_xy_m[number - 8] += PLACE_M * DIFFERENCE,
        _ => work.roll_rad += ROLL_RAD * DIFFERENCE,
    }
    work
}

/// A grasp changed by a step in one of its variables.
pub fn perturbed_grasp(mut grasp: EdgeGrasp, scales: &[f64; 3], part: usize, step: f64) -> EdgeGrasp {
    let value = [&mut grasp.along_m, &mut grasp.depth_m, &mut grasp.angle_rad];
    for (number, value) in value.into_iter().enumerate().filter(|(number, _)| *number == part) {
        *value += scales[number] * step;
    }
    grasp
}

/// Orthonormal vectors that span the range of a projector of this rank: one after the other the direction of its longest
/// column, whose own entry is positive. The sign must not change from step to step, since the Hessian is kept.
fn leading_directions(mut projector: DMatrix<f64>, rank: usize) -> Vec<DVector<f64>> {
    let mut directions = Vec::with_capacity(rank);
    for _ in 0..rank {
        let lengths = projector.column_iter().map(|column| column.norm_squared());
        let longest = lengths.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(column, _)| column);
        let direction = projector.column(longest).normalize();
        projector -= &direction * (direction.transpose() * &projector);
        directions.push(direction);
    }
    directions
}
