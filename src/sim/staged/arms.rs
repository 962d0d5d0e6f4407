//! The torques that the arms of a staged plan feed forward.

use std::cell::RefCell;

use super::segment::{ArmSegment, Knot};
use crate::{
    model::{
        frames::Pose,
        plan::{ArmHold, PlacedObject, Plan},
        staged_plan::{Holding, MoveStage},
    },
    robot::{Chain, Robot},
    statics::{ContactModel, HandModel, StabilityWorkspace},
};

/// Time between two poses of a motion at which the weight's distribution among the hands is computed, s; linear in between.
const EVERY_S: f64 = 0.1;

/// The arms of a plan with what they carry.
pub struct CarriedBy<'a> {
    robot: &'a Robot,
    /// A plan with the task's board and an operation, which does not matter here.
    plan: &'a Plan,
    friction: f64,
    chains: Vec<Chain>,
    indices: Vec<usize>,
    workspace: RefCell<StabilityWorkspace>,
}

impl<'a> CarriedBy<'a> {
    /// The arms of a plan, which has passed its check.
    pub fn new(robot: &'a Robot, plan: &'a Plan, friction: f64) -> Self {
        let indices: Vec<_> = plan.arms.iter().filter_map(|hold| robot.arm_index(&hold.name)).collect();
        let thickness_m = plan.object.size_m[2];
        let chain = |&arm: &usize| Chain::new(robot, arm, robot.arms[arm].gripper.travel_for_gap_m(0, thickness_m));
        let chains = indices.iter().map(chain).collect();
        Self { robot, plan, friction, chains, indices, workspace: RefCell::new(StabilityWorkspace::new()) }
    }

    /// Torques for an arm's own weight, N m.
    pub fn arm_nm(&self, arm: usize, q_rad: &[f64]) -> Vec<f64> {
        self.chains[arm].gravity_torque_nm(q_rad).as_slice().to_vec()
    }

    /// Torques of every arm for its share of the board's weight in the compliant equilibrium of the arms but `without`, N m; zero of
    /// that one, and of all without an equilibrium.
    pub fn board_nm(&self, holding: &Holding, without: Option<usize>) -> Vec<Vec<f64>> {
        let object = PlacedObject { x_wo: holding.x_wo, ..self.plan.object.clone() };
        let numbers: Vec<_> = (0..holding.arms.len()).filter(|arm| Some(*arm) != without).collect();
        let hand = |&arm: &usize| {
            let of_robot = &self.robot.arms[self.indices[arm]];
            HandModel::new(of_robot, &self.chains[arm], &holding.arms[arm], &object, self.friction)
        };
        let hands: Option<Vec<_>> = numbers.iter().map(|arm| hand(arm).ok()).collect();
        let torques = hands.and_then(|hands| {
            let model = ContactModel::from_hands(hands, &object, &self.plan.operation);
            self.workspace.borrow_mut().carrying_torque_nm(&model).ok().flatten()
        });
        let mut all: Vec<Vec<f64>> = holding.arms.iter().map(|hold| vec![0.0; hold.q_rad.len()]).collect();
        for (arm, torque_nm) in numbers.into_iter().zip(torques.into_iter().flatten()) {
            all[arm] = torque_nm.as_slice().to_vec();
        }
        all
    }

    /// The arms along a motion of the board, and the board's poses at the same times.
    pub fn along(&self, from: &Holding, motion: &MoveStage) -> (Vec<ArmSegment>, Vec<Pose>) {
        let time_s = &motion.time_s;
        let at = |row: usize| {
            let arms: Vec<_> = from
                .arms
                .iter()
                .zip(&motion.arms)
                .map(|(hold, path)| ArmHold { q_rad: path.q_rad[row].clone(), ..hold.clone() })
                .collect();
            let first = arms.first().zip(self.chains.first());
            let x_wo = first.map_or(from.x_wo, |(hold, chain)| chain.gripper_pose(&hold.q_rad) * hold.x_og.inverse());
            Holding { x_wo, arms }
        };
        let rows: Vec<_> = (0..time_s.len()).map(at).collect();
        let mut marks: Vec<usize> = Vec::new();
        for row in 0..rows.len() {
            let is_due = marks.last().is_none_or(|&last| time_s[row] - time_s[last] >= EVERY_S);
            if is_due || row + 1 == rows.len() {
                marks.push(row);
            }
        }
        let torques: Vec<_> = marks.iter().map(|&row| self.board_nm(&rows[row], None)).collect();
        let knot = |arm: usize, row: usize| {
            let next = marks.partition_point(|&mark| mark <= row).min(marks.len() - 1);
            let last = next.saturating_sub(1);
            let whole_s = time_s[marks[next]] - time_s[marks[last]];
            let share = if whole_s > 0.0 { (time_s[row] - time_s[marks[last]]) / whole_s } else { 1.0 };
            let between = torques[last][arm].iter().zip(&torques[next][arm]);
            let q_rad = &motion.arms[arm].q_rad[row];
            Knot {
                time_s: time_s[row],
                q_rad: q_rad.clone(),
                arm_nm: self.arm_nm(arm, q_rad),
                board_nm: between.map(|(a, b)| a + share * (b - a)).collect(),
            }
        };
        let arm =
            |arm: usize| ArmSegment { knots: (0..time_s.len()).map(|row| knot(arm, row)).collect(), grip: [1.0; 2] };
        ((0..motion.arms.len()).map(arm).collect(), rows.iter().map(|row| row.x_wo).collect())
    }

    /// An arm along a path without the board.
    pub fn free_path(&self, arm: usize, time_s: &[f64], path: &[Vec<f64>]) -> ArmSegment {
        let knot = |(&time_s, q_rad): (&f64, &Vec<f64>)| Knot {
            time_s,
            q_rad: q_rad.clone(),
            arm_nm: self.arm_nm(arm, q_rad),
            board_nm: vec![0.0; q_rad.len()],
        };
        ArmSegment { knots: time_s.iter().zip(path).map(knot).collect(), grip: [1.0; 2] }
    }
}
