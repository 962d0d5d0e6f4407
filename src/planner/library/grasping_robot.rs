//! A robot prepared to grasp boards of one shape: kinematics, reach maps and collision model.

use std::sync::OnceLock;

use super::{
    grasp::{ArmGrasp, BoardGrasp, largest_joint_difference_rad},
    palm::Palm,
    reach::ReachMap,
};
use crate::{
    collision::{BoardBody, CollisionModel, Scene},
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
    },
    planner::domain::{self, DEPTH_M, SearchDomain},
    robot::{ArmState, Chain, InverseKinematics, Robot},
};

/// A robot with its fingers opened to a board's thickness.
pub struct GraspingRobot {
    pub robot: Robot,
    pub board: BoardShape,
    /// The edges of the board that the search grasps.
    pub edges: Vec<Edge>,
    board_body: BoardBody,
    pub arms: Vec<GraspingArm>,
    /// Where the search looks for poses of the board.
    pub domain: SearchDomain,
    pub collision: CollisionModel,
    /// Required distance of the robot from itself and from the board, m.
    pub clearance_m: f64,
    /// Of each link the arm that moves it, as an index into `arms`, and the last of the arm's joints before the link.
    pub moved_by: Vec<Option<(usize, usize)>>,
    /// The indices of all arms: each of them grasps.
    grasping: Vec<usize>,
}

/// An arm of a [`GraspingRobot`].
pub struct GraspingArm {
    /// Index into the robot's arms.
    pub index: usize,
    pub name: String,
    pub joints: Vec<String>,
    pub chain: Chain,
    pub inverse: InverseKinematics,
    reach: OnceLock<ReachMap>,
    /// Range of the depth of a grasp, m.
    pub depth_m: [f64; 2],
    /// Its palm, if it is near the board at some depth.
    pub palm: Option<Palm>,
    finger_travel_m: [f64; 2],
}

impl GraspingArm {
    /// Where its gripper can be. The map is made when it is first asked for, by one thread while others wait: it is made without parallel
    /// work, so the one that makes it waits for nobody.
    pub fn reach(&self) -> &ReachMap {
        self.reach.get_or_init(|| ReachMap::new(&self.chain))
    }

    /// Travel of its fingers on the board, m.
    pub fn finger_travel_m(&self) -> [f64; 2] {
        self.finger_travel_m
    }
}

impl GraspingRobot {
    /// Prepares a robot for boards of this shape and this clearance, m.
    pub fn new(robot: &Robot, board: &BoardShape, clearance_m: f64) -> Self {
        let collision = CollisionModel::new(robot);
        let board_body = BoardBody::new(board);
        let edges = domain::graspable_edges(board, robot.arms.iter().map(|arm| &arm.gripper));
        let arms = robot.arms.iter().enumerate().map(|(index, arm)| {
            let finger_travel_m = [0, 1].map(|finger| arm.gripper.travel_for_gap_m(finger, board.thickness_m()));
            let chain = Chain::new(robot, index, finger_travel_m[0]);
            let palm = palm(robot, index, &chain);
            let depth_m = palm.depths_m(&collision, &arm.gripper, (board, &board_body, &edges), clearance_m);
            GraspingArm {
                index,
                name: arm.name.clone(),
                joints: arm.joints.iter().map(|&joint| robot.joints[joint].name.clone()).collect(),
                inverse: InverseKinematics::for_chain(&chain),
                reach: OnceLock::new(),
                depth_m,
                palm: (depth_m[1] < DEPTH_M[1]).then_some(palm),
                chain,
                finger_travel_m,
            }
        });
        let arms: Vec<_> = arms.collect();
        let chains = arms.iter().map(|arm: &GraspingArm| &arm.chain);
        Self {
            domain: SearchDomain::of(chains, robot.floor_z_m, robot.search_box),
            robot: robot.clone(),
            edges,
            board_body,
            board: board.clone(),
            arms,
            collision,
            clearance_m,
            moved_by: moved_by(robot),
            grasping: (0..robot.arms.len()).collect(),
        }
    }

    /// The poses of all links in the world.
    pub fn link_poses(&self, arms: &[ArmGrasp]) -> Vec<Pose> {
        let states: Vec<_> = self
            .arms
            .iter()
            .zip(arms)
            .map(|(arm, grasp)| ArmState { arm: arm.index, q_rad: &grasp.q_rad, finger_travel_m: arm.finger_travel_m })
            .collect();
        self.robot.link_poses(&self.robot.positions(&states))
    }

    /// The collision scene of robot and board without a person.
    pub fn scene<'s>(&'s self, link_poses: &'s [Pose], x_wo: Pose) -> Scene<'s> {
        let (holding, board, clearance_m) = (&self.grasping[..], &self.board_body, self.clearance_m);
        Scene { link_poses, holding, board, x_wo, person: &[], clearance_m }
    }

    /// True if the arms and the board are clear of each other.
    pub fn is_clear(&self, grasp: &BoardGrasp) -> bool {
        let link_poses = self.link_poses(&grasp.arms);
        self.collision.first_violation(&self.scene(&link_poses, grasp.x_wo)).is_none()
    }

    /// True if grasps are those of this robot's arms on this board: as many, each on an edge that is grasped, with an angle for every
    /// joint.
    pub fn has_form_of(&self, arms: &[ArmGrasp]) -> bool {
        let fits = |(arm, own): (&GraspingArm, &ArmGrasp)| {
            own.q_rad.len() == arm.chain.dof() && self.edges.contains(&own.grasp.edge)
        };
        self.arms.len() == arms.len() && self.arms.iter().zip(arms).all(fits)
    }

    /// Moves the arms with the board to another pose, each by inverse kinematics from its present angles; false if one cannot
    /// follow.
    pub fn follow(&self, arms: &mut [ArmGrasp], x_wo: &Pose) -> bool {
        self.arms.iter().zip(arms).all(|(arm, own)| {
            let x_wg = x_wo * own.grasp.x_og(&self.board);
            let found = arm.inverse.local(&x_wg, &own.q_rad).found();
            let reached = found.is_some();
            own.q_rad = found.unwrap_or_default();
            reached
        })
    }

    /// The same grasp with the board at another pose, if the arms follow it there from their configurations, no joint by `most_rad` or
    /// more, and the robot is clear.
    pub fn followed(&self, from: &BoardGrasp, x_wo: Pose, most_rad: f64) -> Option<BoardGrasp> {
        let mut there = BoardGrasp { x_wo, arms: from.arms.clone() };
        let reached = self.follow(&mut there.arms, &x_wo)
            && largest_joint_difference_rad(&from.arms, &there.arms) < most_rad
            && self.is_clear(&there);
        reached.then_some(there)
    }

    /// True if the pads of an arm's gripper lie on the board and its palm is clear of it.
    pub fn fits(&self, arm: &GraspingArm, grasp: &EdgeGrasp) -> bool {
        self.has_pads_on_board(arm, grasp) && self.keeps_palm_clear(arm, grasp)
    }

    /// True if the pads of an arm's gripper lie on the board.
    pub fn has_pads_on_board(&self, arm: &GraspingArm, grasp: &EdgeGrasp) -> bool {
        domain::pads_on_board(&self.robot.arms[arm.index].gripper, grasp, &self.board)
    }

    /// True if the palm of an arm's gripper is clear of the board.
    pub fn keeps_palm_clear(&self, arm: &GraspingArm, grasp: &EdgeGrasp) -> bool {
        let x_go = || grasp.x_og(&self.board).inverse();
        let is_clear = |palm: &Palm| palm.is_clear(&self.collision, &self.board_body, &x_go(), self.clearance_m);
        arm.palm.as_ref().is_none_or(is_clear)
    }

    /// Of the edges that the search grasps the one most opposite to another.
    pub fn opposite(&self, edge: Edge) -> Edge {
        self.board.most_opposite(edge, &self.edges)
    }

    /// See [`domain::pad_margins_m`].
    pub fn pad_margins_m(&self, arm: &GraspingArm, grasp: &EdgeGrasp) -> Vec<f64> {
        domain::pad_margins_m(&self.robot.arms[arm.index].gripper, grasp, &self.board)
    }
}

/// The links that are fixed to an arm's gripper, its palm among them, but not the fingers.
fn palm(robot: &Robot, arm: usize, chain: &Chain) -> Palm {
    let q_rad = vec![0.0; chain.dof()];
    let link_poses = robot.link_poses(&robot.positions(&[ArmState { arm, q_rad: &q_rad, finger_travel_m: [0.0; 2] }]));
    let x_gw = chain.gripper_pose(&q_rad).inverse();
    let carriers = robot.carriers();
    let of_gripper = carriers[robot.arms[arm].gripper.frame_link];
    let links = (0..robot.links.len()).filter(|&link| carriers[link] == of_gripper);
    Palm { links: links.map(|link| (link, x_gw * link_poses[link])).collect() }
}

/// See [`GraspingRobot::moved_by`].
fn moved_by(robot: &Robot) -> Vec<Option<(usize, usize)>> {
    let driven = |joint: usize| {
        let of_arm =
            |arm: usize| robot.arms[arm].joints.iter().position(|&own| own == joint).map(|number| (arm, number));
        (0..robot.arms.len()).find_map(of_arm)
    };
    robot.nearest_above(driven)
}
