//! One arm lets go, moves and grips the board elsewhere, while the others hold it still.
//!
//! The open gripper leaves the board in the board's plane, a planner of free motions (`free_motion.rs`) brings the arm beside the
//! new grasp, and the gripper comes onto the board in its plane. On the first and the last way its fingers may be beside the
//! board, as they are in a grasp; in between the whole arm keeps its clearance from robot and board. The clearance is larger than that
//! of a hold: the board has slid in the hands that hold it.

use std::sync::Arc;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;

use super::{
    super::{
        library::{ArmGrasp, BoardGrasp, GraspingArm, GraspingRobot},
        params::task::{
            FREE_TESTS, MORE_CLEARANCE_M, STEP_M, STEP_RAD, WITHDRAWAL_ANGLES_RAD, WITHDRAWAL_M, WITHDRAWAL_TURNS_RAD,
        },
    },
    free_motion::{self, FreeMotion},
};
use crate::{
    collision::Scene,
    model::frames::Pose,
    robot::{ArmState, Gripper},
};

/// The joint path of an open gripper off the board, from its grasp on.
pub type WayOff = Arc<[Vec<f64>]>;

/// The ways off the board at both ends of a regrasp; between them the arm moves freely.
pub struct Ends {
    /// From the old grasp.
    pub away: WayOff,
    /// From the new grasp.
    pub towards: WayOff,
}

/// The way off the board from a grasp `own` of an arm, while the others hold the board as in `from`; `None` without one.
pub fn way_off(robot: &GraspingRobot, from: &BoardGrasp, own: &ArmGrasp, arm: usize) -> Option<WayOff> {
    FreeArm::new(robot, from, arm).withdrawn(own).map(Arc::from)
}

/// The joint path of a regrasp with these ends; `None` if none was found.
pub fn path(
    robot: &GraspingRobot,
    from: &BoardGrasp,
    Ends { away, towards }: &Ends,
    arm: usize,
    random: &mut Pcg64,
) -> Option<Vec<Vec<f64>>> {
    let free = FreeArm::new(robot, from, arm);
    let chain = &robot.arms[arm].chain;
    let is_free = |q_rad: &[f64]| free.is_clear(&free.scene(&free.link_poses(q_rad), &free.others));
    let problem = FreeMotion {
        lower: chain.lower(),
        upper: chain.upper(),
        is_free: &is_free,
        step_rad: STEP_RAD,
        most_tests: FREE_TESTS,
    };
    let between = free_motion::find(&problem, away.last()?, towards.last()?, random)?;
    let towards = towards.iter().rev().cloned().collect();
    Some([away.to_vec(), between, towards].concat())
}

/// An arm that has let go, beside the others that hold the board.
struct FreeArm<'a> {
    robot: &'a GraspingRobot,
    from: &'a BoardGrasp,
    arm: usize,
    /// The robot's other arms, which hold the board.
    others: Vec<usize>,
    /// All arms of the robot.
    all: Vec<usize>,
    open_m: [f64; 2],
}

impl<'a> FreeArm<'a> {
    fn new(robot: &'a GraspingRobot, from: &'a BoardGrasp, arm: usize) -> Self {
        let all: Vec<_> = robot.arms.iter().map(|arm| arm.index).collect();
        let others = all.iter().copied().filter(|&index| index != robot.arms[arm].index).collect();
        Self { robot, from, arm, others, all, open_m: open_travel_m(Self::gripper_of(robot, arm)) }
    }

    fn gripper_of(robot: &GraspingRobot, arm: usize) -> &Gripper {
        &robot.robot.arms[robot.arms[arm].index].gripper
    }

    /// The robot's links with the arm in a configuration, its gripper open.
    fn link_poses(&self, q_rad: &[f64]) -> Vec<Pose> {
        let state = |(number, (arm, own)): (usize, (&'a GraspingArm, &'a ArmGrasp))| (number, arm.index, &own.q_rad);
        let states = self.robot.arms.iter().zip(&self.from.arms).enumerate().map(state);
        let states: Vec<_> = states
            .map(|(number, index, own)| {
                let is_free = number == self.arm;
                let closed_m = self.robot.arms[number].finger_travel_m();
                let finger_travel_m = if is_free { self.open_m } else { closed_m };
                ArmState { arm: index, q_rad: if is_free { q_rad } else { own }, finger_travel_m }
            })
            .collect();
        self.robot.robot.link_poses(&self.robot.robot.positions(&states))
    }

    /// The arm with an open gripper, with the arms whose fingers may be at the board.
    fn scene<'s>(&'s self, link_poses: &'s [Pose], holding: &'s [usize]) -> Scene<'s> {
        let planned = self.robot.scene(link_poses, self.from.x_wo);
        Scene { holding, clearance_m: planned.clearance_m + MORE_CLEARANCE_M, ..planned }
    }

    fn is_clear(&self, scene: &Scene<'_>) -> bool {
        self.robot.collision.first_violation(scene).is_none()
    }

    /// The shortest of some ways off the board in its plane, the grasp first: at its end the whole arm keeps its clearance.
    fn withdrawn(&self, own: &ArmGrasp) -> Option<Vec<Vec<f64>>> {
        let turns = WITHDRAWAL_TURNS_RAD.into_iter();
        let ways = turns.flat_map(|turn_rad| WITHDRAWAL_ANGLES_RAD.map(|angle_rad| (angle_rad, turn_rad)));
        ways.into_iter().find_map(|(angle_rad, turn_rad)| self.withdrawn_along(own, angle_rad, turn_rad))
    }

    /// The way off the board at an angle from -z_G in the board's plane, while the gripper turns about its y axis.
    fn withdrawn_along(&self, own: &ArmGrasp, angle_rad: f64, turn_rad: f64) -> Option<Vec<Vec<f64>>> {
        let x_wg = self.from.x_wo * own.grasp.x_og(&self.robot.board);
        let about_y = |angle_rad: f64| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle_rad);
        let direction_g = about_y(angle_rad) * -Vector3::z();
        let steps = (WITHDRAWAL_M / STEP_M).ceil() as usize;
        let mut way = vec![own.q_rad.clone()];
        for number in 1..=steps {
            let share = number as f64 / steps as f64;
            let shift = Isometry3::from_parts((direction_g * (WITHDRAWAL_M * share)).into(), about_y(turn_rad * share));
            let q_rad = self.robot.arms[self.arm].inverse.near(&(x_wg * shift), &way[number - 1]).found()?;
            let link_poses = self.link_poses(&q_rad);
            let at_board = self.scene(&link_poses, &self.all);
            if !self.is_clear(&at_board) {
                return None;
            }
            way.push(q_rad);
            if self.robot.collision.fingers_are_off(&at_board, self.robot.arms[self.arm].index) {
                return Some(way);
            }
        }
        None
    }
}

/// Travel of each finger of an open gripper, m.
pub fn open_travel_m(gripper: &Gripper) -> [f64; 2] {
    [0, 1].map(|finger| gripper.travel_for_gap_m(finger, gripper.opening_m[1]))
}
