//! What a robot can do with boards of one size, computed once for all operations on them.

use crate::{
    collision::{CollisionModel, Scene},
    robot::{ArmState, Chain, InverseKinematics, Robot},
};

use super::{
    bank::{self, BankedHold},
    candidate::Hold,
    reach::ReachMap,
};
use crate::model::frames::Pose;

/// Holds that a map keeps.
const HOLDS: usize = 4_000;

/// Where a robot's arms can hold boards of one size. It serves every scenario with that robot and size; it depends on
/// nothing else, so a plan does not depend on whether the map was at hand or made for it.
pub struct RobotMap {
    pub(super) robot: Robot,
    pub(super) size_m: [f64; 3],
    pub(super) arms: Vec<ArmSearch>,
    /// The indices of the arms.
    pub(super) holding: Vec<usize>,
    pub(super) collision: CollisionModel,
    pub(super) bank: Vec<BankedHold>,
    /// What carries each link: an arm, by its number in `arms`, and the last of its joints on the way there.
    pub(super) carriers: Vec<Option<(usize, usize)>>,
    /// How often a hold was looked for.
    pub(super) drawn: u64,
}

/// An arm as the search needs it.
pub struct ArmSearch {
    pub index: usize,
    pub name: String,
    pub joints: Vec<String>,
    pub chain: Chain,
    pub inverse: InverseKinematics,
    pub reach: ReachMap,
    pub finger_travel_m: [f64; 2],
}

impl RobotMap {
    /// The map of a robot for boards with these sides.
    pub fn new(robot: &Robot, size_m: [f64; 3]) -> Self {
        let arms = robot.arms.iter().enumerate().map(|(index, arm)| {
            let finger_travel_m = [0, 1].map(|finger| arm.gripper.travel_for_gap_m(finger, size_m[2]));
            let chain = Chain::new(robot, index, finger_travel_m[0]);
            ArmSearch {
                index,
                name: arm.name.clone(),
                joints: arm.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
                inverse: InverseKinematics::for_chain(&chain),
                reach: ReachMap::new(&chain),
                chain,
                finger_travel_m,
            }
        });
        let mut map = Self {
            robot: robot.clone(),
            size_m,
            arms: arms.collect(),
            holding: (0..robot.arms.len()).collect(),
            collision: CollisionModel::new(robot),
            carriers: carriers(robot),
            bank: Vec::new(),
            drawn: 0,
        };
        (map.bank, map.drawn) = bank::holds(&map, HOLDS);
        map
    }

    /// The poses of all links when the arms take these configurations.
    pub(super) fn link_poses(&self, holds: &[Hold]) -> Vec<Pose> {
        let states: Vec<_> = self
            .arms
            .iter()
            .zip(holds)
            .map(|(arm, hold)| ArmState { arm: arm.index, q_rad: &hold.q_rad, finger_travel_m: arm.finger_travel_m })
            .collect();
        self.robot.link_poses(&self.robot.positions(&states))
    }

    /// Robot and board, with nobody there.
    pub(super) fn scene<'s>(&'s self, link_poses: &'s [Pose], x_wo: Pose) -> Scene<'s> {
        Scene { link_poses, holding: &self.holding, board_size_m: self.size_m, x_wo, person: &[] }
    }
}

/// What carries each link of a robot, see [`RobotMap::carriers`].
fn carriers(robot: &Robot) -> Vec<Option<(usize, usize)>> {
    let driven = |joint: usize| {
        let of_arm =
            |arm: usize| robot.arms[arm].joints.iter().position(|&own| own == joint).map(|number| (arm, number));
        (0..robot.arms.len()).find_map(of_arm)
    };
    let mut carriers: Vec<Option<(usize, usize)>> = Vec::with_capacity(robot.links.len());
    // Parents come before children.
    for link in &robot.links {
        let carrier =
            link.parent_joint.and_then(|joint| driven(joint).or_else(|| carriers[robot.joints[joint].parent_link]));
        carriers.push(carrier);
    }
    carriers
}
