//! The moves that are left free around a hold, and how the arms' joints follow them.

use nalgebra::{DMatrix, DVector, Matrix6, Point3, Vector3, Vector6};

use super::super::{
    Problem,
    candidate::{Candidate, Placed, Stance},
};
use crate::model::{frames::Pose, grasp::EdgeGrasp};

/// Scale of a move: what one step of 1 means. Person's joints and heading, rad.
pub const PERSON_RAD: f64 = 0.15;
/// Place of the board and person, m.
pub const PLACE_M: f64 = 0.05;
/// Roll of the tool, rad.
const ROLL_RAD: f64 = 0.3;
/// Place along the edge, m; depth, m; angle, rad.
pub const GRASP: [f64; 3] = [0.04, 0.008, 0.15];
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
    /// How board and person move along each of the first moves, those that are not an arm's.
    pub stances: Vec<StanceRates>,
    /// Of each arm.
    pub rates: Vec<DMatrix<f64>>,
    count: usize,
}

/// How board and person move along one move, a unit of it.
#[derive(Clone, Copy, Debug)]
pub struct StanceRates {
    pub board: RigidRates,
    /// The person's body; the working arm moves beside.
    pub body: RigidRates,
}

/// The motion of a rigid body, W axes, a unit of a move.
#[derive(Clone, Copy, Debug)]
pub struct RigidRates {
    /// Of its frame's origin, m.
    pub linear: Vector3<f64>,
    /// rad.
    pub angular: Vector3<f64>,
    /// The origin, W.
    origin_w: Point3<f64>,
}

impl RigidRates {
    /// By the difference of two poses that are [`SMALL`] of a move apart.
    fn between(from: &Pose, to: &Pose) -> Self {
        let angular = (to.rotation * from.rotation.inverse()).scaled_axis() / SMALL;
        let linear = (to.translation.vector - from.translation.vector) / SMALL;
        Self { linear, angular, origin_w: from.translation.vector.into() }
    }

    /// Of a point that the body carries, m.
    pub fn at(&self, p_w: &Point3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(&(p_w - self.origin_w))
    }

    /// Linear rates at a point and the angular ones.
    fn twist_at(&self, p_w: &Point3<f64>) -> Vector6<f64> {
        let linear = self.at(p_w);
        let angular = &self.angular;
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }
}

/// Moves of the person and the place: seven joints, heading, x, y.
const FIRST: usize = 10;

impl Moves {
    /// The moves around a candidate.
    pub fn at(problem: &Problem<'_>, candidate: &Candidate, here: &Placed) -> Self {
        let roll_is_free = problem.scenario.operation.kind.roll_is_free();
        let mut count = FIRST + usize::from(roll_is_free);
        let mut arms = Vec::with_capacity(problem.map.arms.len());
        for arm in &problem.map.arms {
            arms.push(count);
            count += GRASP.len() + arm.chain.dof().saturating_sub(6);
        }
        let stances = (0..FIRST + usize::from(roll_is_free)).map(|number| {
            let there = nudged(candidate.stance(), number).placed(problem);
            StanceRates {
                board: RigidRates::between(&here.x_wo, &there.x_wo),
                body: RigidRates::between(&here.x_wb, &there.x_wb),
            }
        });
        let mut moves = Self { roll_is_free, arms, stances: stances.collect(), rates: Vec::new(), count };
        moves.rates =
            (0..problem.map.arms.len()).map(|arm| moves.joint_rates(problem, candidate, &here.x_wo, arm)).collect();
        moves
    }

    /// The moves of an arm's grasp: along the edge, in depth, in angle.
    pub fn of_grasp(&self, arm: usize) -> std::ops::Range<usize> {
        self.arms[arm]..self.arms[arm] + GRASP.len()
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
    fn joint_rates(&self, problem: &Problem<'_>, candidate: &Candidate, x_wo: &Pose, arm: usize) -> DMatrix<f64> {
        let chain = &problem.map.arms[arm].chain;
        let hold = &candidate.holds[arm];
        let jacobian = chain.jacobian_w(&hold.q_rad);
        let mut rates = DMatrix::zeros(chain.dof(), self.count);
        let normal: Matrix6<f64> = &jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(DAMPING);
        let Some(inverse) = normal.try_inverse() else { return rates };
        let pseudo_inverse = jacobian.transpose() * inverse;
        let size_m = problem.scenario.object.size_m;
        let here = x_wo * hold.grasp.x_og(size_m);
        for (number, stance) in self.stances.iter().enumerate() {
            let twist = stance.board.twist_at(&here.translation.vector.into());
            rates.set_column(number, &(&pseudo_inverse * twist));
        }
        let grasp = self.of_grasp(arm);
        for (part, number) in grasp.clone().enumerate() {
            let there = x_wo * nudged_grasp(hold.grasp, part, SMALL).x_og(size_m);
            let twist = RigidRates::between(&here, &there).twist_at(&here.translation.vector.into());
            rates.set_column(number, &(&pseudo_inverse * twist));
        }
        let projector = DMatrix::identity(chain.dof(), chain.dof()) - &pseudo_inverse * &jacobian;
        let redundancy = leading_directions(projector, chain.dof().saturating_sub(6));
        for (number, direction) in redundancy.iter().enumerate() {
            rates.set_column(grasp.end + number, &(direction * REDUNDANCY_RAD));
        }
        rates
    }
}

/// A stance a little along one of the first moves.
pub fn nudged(mut stance: Stance, number: usize) -> Stance {
    match number {
        0..7 => stance.q_h_rad[number] += PERSON_RAD * SMALL,
        7 => stance.heading_rad += PERSON_RAD * SMALL,
        8 | 9 => stance.p_wo_xy_m[number - 8] += PLACE_M * SMALL,
        _ => stance.roll_rad += ROLL_RAD * SMALL,
    }
    stance
}

/// A grasp moved by a share of one of its moves.
pub fn nudged_grasp(mut grasp: EdgeGrasp, part: usize, share: f64) -> EdgeGrasp {
    let value = [&mut grasp.along_m, &mut grasp.depth_m, &mut grasp.angle_rad];
    for (number, value) in value.into_iter().enumerate().filter(|(number, _)| *number == part) {
        *value += GRASP[number] * share;
    }
    grasp
}

/// Unit vectors that span the range of a projector of this rank, one after the other along its longest column, whose
/// own entry is positive: what is learned from step to step needs a sign.
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
