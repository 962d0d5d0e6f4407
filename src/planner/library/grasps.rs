//! The grasp library: collision-free grasps of boards of one shape.
//!
//! Whether a robot can grasp a board in some pose depends neither on the person nor on the task, and is the constraint that
//! random candidates satisfy least often. So grasps are found once and serve all tasks on boards of that shape: the first
//! arm's configuration and grasp are drawn, which gives the board's pose; inverse kinematics brings the other arms there.

use nalgebra::Point3;
use rand_pcg::Pcg64;

use super::{
    failures::{DrawFailure, DrawFailures},
    grasp::{ArmGrasp, BoardGrasp},
    grasping_robot::{GraspingArm, GraspingRobot},
    postures::Posture,
};
use crate::{
    collision::Violation,
    comfort,
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
    },
    planner::{
        domain::{self, draw_edge, draw_other_edge},
        params::library::{
            COARSE_STRIDE, DRAWS_PER_GRASP, FIRST_ARM_ATTEMPTS, FURTHER_GRASPS, GRASP_ATTEMPTS, GRASPS, HOPELESS_SHARE,
            SEED,
        },
    },
    robot::Robot,
};

/// Collision-free grasps of a robot for boards of one shape with one clearance. It depends on nothing else.
pub struct GraspLibrary {
    /// The robot, prepared for boards of that shape.
    pub robot: GraspingRobot,
    /// The grasps.
    pub entries: Vec<LibraryEntry>,
    /// What the draws failed at that gave no grasp.
    pub failures: DrawFailures,
}

/// A grasp of a library, with what screening asks about it.
#[derive(Clone, Debug)]
pub struct LibraryEntry {
    pub grasp: BoardGrasp,
    /// The robot's points of the peripersonal metric, W.
    pub robot_points_w: Vec<Point3<f64>>,
    /// Some of them, for a first ranking.
    pub coarse_points_w: Vec<Point3<f64>>,
    /// The posture that the board was put for; it responds to the grasp exactly.
    pub posture: Option<Posture>,
}

impl LibraryEntry {
    /// An entry from a grasp and the poses of the robot's links in it.
    pub fn new(robot: &GraspingRobot, grasp: BoardGrasp, link_poses: &[Pose]) -> Self {
        let robot_points_w = comfort::robot_points_w(&robot.robot, link_poses);
        let coarse_points_w = robot_points_w.iter().step_by(COARSE_STRIDE).copied().collect();
        Self { grasp, robot_points_w, coarse_points_w, posture: None }
    }
}

impl GraspLibrary {
    /// The library of a robot for boards of this shape that keeps a clearance, m; it has fewer than the usual number of
    /// entries where grasps are rare.
    pub fn new(robot: &Robot, board: &BoardShape, clearance_m: f64) -> Self {
        let robot = GraspingRobot::new(robot, board, clearance_m);
        let (entries, failures) = draw_entries(&robot, GRASPS, 0);
        Self { robot, entries, failures }
    }

    /// Further grasps for the same boards, from random numbers of their own: for a search that found nothing among the
    /// library's.
    pub fn further_entries(&self) -> Vec<LibraryEntry> {
        draw_entries(&self.robot, FURTHER_GRASPS, 1).0
    }
}

/// At most `wanted` grasps from a stream of random numbers, and what the other draws failed at.
fn draw_entries(robot: &GraspingRobot, wanted: usize, stream: u128) -> (Vec<LibraryEntry>, DrawFailures) {
    let mut random = Pcg64::new(SEED, stream);
    let mut entries = Vec::with_capacity(wanted);
    let mut failures = DrawFailures::default();
    let mut draws = 0;
    while entries.len() < wanted && draws < max_draws(wanted, entries.len()) {
        draws += 1;
        match draw_entry(robot, &mut random) {
            Ok(entry) => entries.push(entry),
            Err(failure) => failures.count(failure),
        }
    }
    (entries, failures)
}

/// The search for entries ends sooner if nothing at all was found.
fn max_draws(wanted: usize, found: usize) -> u64 {
    (DRAWS_PER_GRASP * if found == 0 { wanted / HOPELESS_SHARE } else { wanted }) as u64
}

fn draw_entry(robot: &GraspingRobot, random: &mut Pcg64) -> Result<LibraryEntry, DrawFailure> {
    let (first, others) = robot.arms.split_first().ok_or(DrawFailure::NoArm)?;
    let edge = draw_edge(&robot.edges, random).ok_or(DrawFailure::NoEdge)?;
    let grasp = draw_grasp(robot, first, edge, |_| true, random).ok_or(DrawFailure::Pads { arm: 0 })?;
    let x_go = grasp.x_og(&robot.board).inverse();
    let in_domain = |x_wo: &Pose| robot.domain.contains(x_wo);
    let (q_rad, x_wo) = (0..FIRST_ARM_ATTEMPTS)
        .find_map(|_| first.reach.draw(&first.chain, &x_go, in_domain, random))
        .ok_or(DrawFailure::Domain)?;
    let mut arms = vec![ArmGrasp { grasp, q_rad }];
    for (number, arm) in others.iter().enumerate() {
        let edge = draw_other_edge(edge, robot.opposite(edge), random);
        let reached = draw_arm_grasp(robot, arm, edge, &x_wo, random);
        arms.push(reached.ok_or(DrawFailure::Reach { arm: number + 1 })?);
    }
    let link_poses = robot.link_poses(&arms);
    match robot.collision.first_violation(&robot.scene(&link_poses, x_wo)) {
        None => Ok(LibraryEntry::new(robot, BoardGrasp { x_wo, arms }, &link_poses)),
        Some(Violation { bodies, .. }) => Err(DrawFailure::Collision { bodies }),
    }
}

/// A grasp of one arm on an edge of a board at a known pose, with a configuration; `None` if no drawn grasp is reached.
pub fn draw_arm_grasp(
    robot: &GraspingRobot,
    arm: &GraspingArm,
    edge: Edge,
    x_wo: &Pose,
    random: &mut Pcg64,
) -> Option<ArmGrasp> {
    let near = |x_og: &Pose| arm.reach.reaches(&arm.chain, &(x_wo * x_og));
    let grasp = draw_grasp(robot, arm, edge, near, random)?;
    let x_wg = x_wo * grasp.x_og(&robot.board);
    let mut seeds = arm.reach.seeds(&arm.chain, &x_wg);
    Some(ArmGrasp { grasp, q_rad: seeds.find_map(|seed| arm.inverse.near(&x_wg, &seed).found())? })
}

/// A grasp on an edge with the pads on the board whose pose X_OG is accepted.
pub fn draw_grasp(
    robot: &GraspingRobot,
    arm: &GraspingArm,
    edge: Edge,
    accepts: impl Fn(&Pose) -> bool,
    random: &mut Pcg64,
) -> Option<EdgeGrasp> {
    (0..GRASP_ATTEMPTS)
        .map(|_| domain::draw_grasp(edge, &robot.board, random))
        .find(|grasp| robot.pads_on_board(arm, grasp) && accepts(&grasp.x_og(&robot.board)))
}
