//! The moves that are left free around a hold, and how the arms' joints follow them.

use nalgebra::{DMatrix, DVector, Matrix6};

use super::super::{Problem, candidate::Candidate};
use crate::model::frames::Pose;

/// Scale of a move: what one step of 1 means. Person's joints and heading, rad.
const PERSON_RAD: f64 = 0.15;
/// Place of the board and person, m.
const PLACE_M: f64 = 0.05;
/// Roll of the tool, rad.
const ROLL_RAD: f64 = 0.3;
/// Place along the edge, m; depth, m; angle, rad.
const GRASP: [f64; 3] = [0.04, 0.008, 0.15];
/// Redundancy of an arm: length of the joints' motion, rad.
const REDUNDANCY_RAD: f64 = 0.3;
/// Damping of the pseudo-inverse of an arm's Jacobian: it bounds the joints' rates near a singularity.
const DAMPING: f64 = 1e-6;
/// Share of a move with which it is differentiated.
pub const SMALL: f64 = 1e-5;

/// The free moves, and for every arm the joints' rates along each of them: rad a unit of the move.
#[derive(Clone, Debug)]
pub struct Moves {
    roll_is_free: bool,
    /// Where each arm's moves begin: three of its grasp, then those of its redundancy.
    arms: Vec<usize>,
    rates: Vec<DMatrix<f64>>,
    count: usize,
}

/// Moves of the person and the place: seven joints, heading, x, y.
const FIRST: usize = 10;

impl Moves {
    /// The moves around a candidate.
    pub fn at(problem: &Problem<'_>, candidate: &Candidate) -> Self {
        let roll_is_free = problem.scenario.operation.kind.roll_is_free();
        let mut count = FIRST + usize::from(roll_is_free);
        let mut arms = Vec::with_capacity(problem.map.arms.len());
        for arm in &problem.map.arms {
            arms.push(count);
            count += GRASP.len() + arm.chain.dof().saturating_sub(6);
        }
        let mut moves = Self { roll_is_free, arms, rates: Vec::new(), count };
        moves.rates = (0..problem.map.arms.len()).map(|arm| moves.joint_rates(problem, candidate, arm)).collect();
        moves
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A candidate moved, to first order: the arms' hands are off by the square of the move.
    pub fn moved(&self, from: &Candidate, d: &DVector<f64>) -> Candidate {
        let mut to = self.numbers_moved(from, d);
        for (hold, rates) in to.holds.iter_mut().zip(&self.rates) {
            for (joint, q) in hold.q_rad.iter_mut().enumerate() {
                *q += rates.row(joint).dot(&d.transpose());
            }
        }
        to
    }

    /// A candidate moved exactly; none when an arm cannot follow.
    pub fn make(&self, problem: &Problem<'_>, from: &Candidate, d: &DVector<f64>) -> Option<Candidate> {
        let mut to = self.moved(from, d);
        for (q, [low, high]) in to.q_h_rad.iter_mut().zip(problem.human.arm().limits_rad) {
            *q = q.clamp(low, high);
        }
        let x_wo = to.x_wo(problem);
        for (arm, hold) in problem.map.arms.iter().zip(&mut to.holds) {
            let x_wg = x_wo * hold.grasp.x_og(problem.scenario.object.size_m);
            hold.q_rad = arm.inverse.local(&x_wg, &hold.q_rad).found()?;
        }
        Some(to)
    }

    /// A candidate with all numbers moved but the arms' joints.
    fn numbers_moved(&self, from: &Candidate, d: &DVector<f64>) -> Candidate {
        let mut to = from.clone();
        for (joint, q) in to.q_h_rad.iter_mut().enumerate() {
            *q += PERSON_RAD * d[joint];
        }
        to.heading_rad += PERSON_RAD * d[7];
        to.p_wo_xy_m[0] += PLACE_M * d[8];
        to.p_wo_xy_m[1] += PLACE_M * d[9];
        if self.roll_is_free {
            to.roll_rad += ROLL_RAD * d[FIRST];
        }
        for (hold, &first) in to.holds.iter_mut().zip(&self.arms) {
            hold.grasp.along_m += GRASP[0] * d[first];
            hold.grasp.depth_m += GRASP[1] * d[first + 1];
            hold.grasp.angle_rad += GRASP[2] * d[first + 2];
        }
        to
    }

    /// `J+ xi + N`: the joints follow the hand's twist by the least motion, and move freely along the null space.
    fn joint_rates(&self, problem: &Problem<'_>, candidate: &Candidate, arm: usize) -> DMatrix<f64> {
        let chain = &problem.map.arms[arm].chain;
        let size_m = problem.scenario.object.size_m;
        let jacobian = chain.jacobian_w(&candidate.holds[arm].q_rad);
        let normal: Matrix6<f64> = &jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(DAMPING);
        let Some(inverse) = normal.try_inverse() else { return DMatrix::zeros(chain.dof(), self.count) };
        let pseudo_inverse = jacobian.transpose() * inverse;
        let hand = |candidate: &Candidate| candidate.x_wo(problem) * candidate.holds[arm].grasp.x_og(size_m);
        let here = hand(candidate);
        let mut rates = DMatrix::zeros(chain.dof(), self.count);
        let grasp = self.arms[arm]..self.arms[arm] + GRASP.len();
        for number in (0..self.arms[0]).chain(grasp.clone()) {
            let mut d = DVector::zeros(self.count);
            d[number] = SMALL;
            let there = hand(&self.numbers_moved(candidate, &d));
            rates.set_column(number, &(&pseudo_inverse * twist(&here, &there) / SMALL));
        }
        let projector = DMatrix::identity(chain.dof(), chain.dof()) - &pseudo_inverse * &jacobian;
        let eigen = projector.symmetric_eigen();
        let mut order: Vec<_> = (0..chain.dof()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        for (number, &column) in order.iter().take(chain.dof().saturating_sub(6)).enumerate() {
            let direction = eigen.eigenvectors.column(column);
            // An eigenvector's sign is arbitrary; what is learned from step to step needs one.
            let sign = direction[direction.iamax()].signum();
            rates.set_column(grasp.end + number, &(direction * (sign * REDUNDANCY_RAD)));
        }
        rates
    }
}

/// The small motion from one pose to another: translation, then rotation vector, W.
fn twist(from: &Pose, to: &Pose) -> nalgebra::Vector6<f64> {
    let linear = to.translation.vector - from.translation.vector;
    let angular = (to.rotation * from.rotation.inverse()).scaled_axis();
    nalgebra::Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}
