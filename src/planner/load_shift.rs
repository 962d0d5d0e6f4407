//! The pose under the load, as the compliant equilibrium predicts it (docs/method.md#35-clearances).

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::library::ArmGrasp;
use crate::{
    collision::{BoardBody, Body, CollisionModel, Nearest, Scene},
    model::{
        frames::Pose,
        plan::{ArmHold, Clearance, LeastDistance, PlacedObject},
    },
    robot::Robot,
    statics::{CompliantResponse, Twist},
};

/// The displacement of arms and board by the load.
#[derive(Clone, Debug)]
pub struct LoadShift {
    /// Of each arm's joints, rad.
    joints_rad: Vec<Vec<f64>>,
    /// Of the board at O's origin, O axes.
    board: Twist,
}

impl LoadShift {
    /// The displacement of a response.
    pub fn of(response: &CompliantResponse) -> Self {
        let joints_rad = response.joints_rad.iter().map(|joints_rad| joints_rad.as_slice().to_vec()).collect();
        Self { joints_rad, board: response.board }
    }

    /// The board's pose under the load.
    pub fn board(&self, x_wo: &Pose) -> Pose {
        let turn = UnitQuaternion::from_scaled_axis(self.board.angular);
        x_wo * Isometry3::from_parts(Translation3::from(self.board.linear), turn)
    }

    /// The arms' configurations under the load.
    pub fn arms(&self, arms: &[ArmGrasp]) -> Vec<ArmGrasp> {
        let shifted = |(arm, by_rad): (&ArmGrasp, &Vec<f64>)| ArmGrasp { q_rad: added(&arm.q_rad, by_rad), ..*arm };
        arms.iter().zip(&self.joints_rad).map(shifted).collect()
    }

    /// The same of a plan's arms.
    fn holds(&self, arms: &[ArmHold]) -> Vec<ArmHold> {
        let shifted =
            |(arm, by_rad): (&ArmHold, &Vec<f64>)| ArmHold { q_rad: added(&arm.q_rad, by_rad), ..arm.clone() };
        arms.iter().zip(&self.joints_rad).map(shifted).collect()
    }
}

fn added(q_rad: &[f64], by_rad: &[f64]) -> Vec<f64> {
    q_rad.iter().zip(by_rad).map(|(q_rad, by_rad)| q_rad + by_rad).collect()
}

/// Arms and board of a plan, with the collision model of their robot.
#[derive(Clone, Copy)]
pub struct Held<'a> {
    pub robot: &'a Robot,
    pub collision: &'a CollisionModel,
    pub arms: &'a [ArmHold],
    pub object: &'a PlacedObject,
}

impl Held<'_> {
    /// The least distances in the planned pose and in the pose under the load; `None` if no two bodies of the robot can meet.
    pub fn clearance(&self, shift: Option<&LoadShift>) -> Option<Clearance> {
        let planned = self.with_scene(None, |scene| self.least_distance(scene))?;
        let loaded = shift.and_then(|shift| self.with_scene(Some(shift), |scene| self.least_distance(scene)));
        Some(Clearance { planned, loaded })
    }

    /// The first two bodies that are closer than `clearance_m` under the load, in words.
    pub fn first_contact(&self, shift: &LoadShift, clearance_m: f64) -> Option<String> {
        let found =
            self.with_scene(Some(shift), |scene| self.collision.first_violation(&Scene { clearance_m, ..*scene }))?;
        Some(format!("under the load {}", found.describe(self.robot)))
    }

    fn least_distance(&self, scene: &Scene<'_>) -> Option<LeastDistance> {
        let Nearest { bodies, distance_m } = self.collision.nearest_of_robot(scene, f64::INFINITY)?;
        let between = bodies.map(|body: Body| body.describe(self.robot));
        Some(LeastDistance { distance_mm: distance_m * 1e3, between })
    }

    /// Evaluates a function of the scene of robot and board, planned or under the load.
    fn with_scene<T>(&self, shift: Option<&LoadShift>, of: impl FnOnce(&Scene<'_>) -> T) -> T {
        let (arms, x_wo) = match shift {
            Some(shift) => (shift.holds(self.arms), shift.board(&self.object.x_wo)),
            None => (self.arms.to_vec(), self.object.x_wo),
        };
        let board = &BoardBody::new(&self.object.shape());
        let link_poses = self.robot.planned_link_poses(&arms, self.object.size_m[2]);
        let holding: Vec<usize> = arms.iter().filter_map(|arm| self.robot.arm_index(&arm.name)).collect();
        let (link_poses, holding) = (&link_poses[..], &holding[..]);
        of(&Scene { link_poses, holding, board, x_wo, person: &[], clearance_m: 0.0 })
    }
}
