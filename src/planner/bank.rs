//! A bank of holds that a robot can take with a board of some size: what its arms reach without touching anything.
//!
//! Whether a robot can hold a board in some pose depends neither on the person nor on the operation, and is the rarest of
//! all things that a plan needs. So holds are found once and serve every operation on boards of that size. A first arm's
//! configuration is drawn, its grasp then says where the board is, and the reach maps and inverse kinematics bring the other
//! hands there. The bank knows nothing of people, comfort or loads.

use nalgebra::Point3;
use rand::RngExt;
use rand_pcg::Pcg64;

use super::{
    assess,
    candidate::Hold,
    propose,
    robot_map::{ArmSearch, RobotMap},
};
use crate::{
    comfort,
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
    },
};

/// Grasps that are tried for every hand.
const TRIES: usize = 12;
/// Configurations of the first arm that are tried for a grasp.
const FIRST_TRIES: usize = 200;
/// Probability that a second arm holds the edge opposite to the first's, not the same one: all allowed pairs are alike.
const OPPOSITE: f64 = 0.5;
/// One in so many of the robot's points does for a first look.
const GLANCE: usize = 3;
/// The bank's seed: it is the same for every search.
const SEED: u128 = 0x0b0a_7d00_ba4c_0001;
/// First configurations that are drawn for each hold that is wanted, at most.
const DRAWS_A_HOLD: usize = 200;

/// A hold that the robot can take.
#[derive(Clone, Debug)]
pub struct KnownHold {
    pub x_wo: Pose,
    pub holds: Vec<Hold>,
}

/// A hold of the bank, with what every scenario asks about it.
#[derive(Clone, Debug)]
pub struct BankedHold {
    pub hold: KnownHold,
    /// The robot's points that peripersonal comfort looks at, W.
    pub robot_points_w: Vec<Point3<f64>>,
    /// A few of them, for a first look.
    pub glance_w: Vec<Point3<f64>>,
}

impl BankedHold {
    /// A hold and the poses of the robot's links in it.
    pub fn new(map: &RobotMap, hold: KnownHold, link_poses: &[Pose]) -> Self {
        let robot_points_w = comfort::robot_points_w(&map.robot, link_poses);
        let glance_w = robot_points_w.iter().step_by(GLANCE).copied().collect();
        Self { hold, robot_points_w, glance_w }
    }
}

/// So many holds of the map's size of board, or fewer where they are rare, and how often one was looked for.
pub fn holds(map: &RobotMap, wanted: usize) -> (Vec<BankedHold>, u64) {
    let mut random = Pcg64::new(SEED, 0);
    let mut found = Vec::with_capacity(wanted);
    let mut drawn = 0;
    while found.len() < wanted && drawn < most_draws(wanted, found.len()) {
        drawn += 1;
        found.extend(draw(map, &mut random));
    }
    (found, drawn)
}

/// Where nothing at all is found the search for holds ends sooner.
fn most_draws(wanted: usize, found: usize) -> u64 {
    (DRAWS_A_HOLD * if found == 0 { wanted / 20 } else { wanted }) as u64
}

fn draw(map: &RobotMap, random: &mut Pcg64) -> Option<BankedHold> {
    let (first, others) = map.arms.split_first()?;
    let edge = draw_edge(random);
    let grasp = draw_grasp(map, first, edge, |_| true, random)?;
    let x_go = grasp.x_og(map.size_m).inverse();
    let (q_rad, x_wo) =
        (0..FIRST_TRIES).find_map(|_| first.reach.draw(&first.chain, &x_go, assess::in_domain, random))?;
    let mut holds = vec![Hold { grasp, q_rad }];
    for arm in others {
        let edge = other_edge(edge, random);
        holds.push(draw_hold(map, arm, edge, &x_wo, random)?);
    }
    let poses = map.link_poses(&holds);
    let touches = map.collision.first_violation(&map.scene(&poses, x_wo)).is_some();
    (!touches).then(|| BankedHold::new(map, KnownHold { x_wo, holds }, &poses))
}

/// Any edge.
pub fn draw_edge(random: &mut Pcg64) -> Edge {
    Edge::ALL[random.random_range(0..Edge::ALL.len())]
}

/// The edge of a further hand: opposite to the first's or the same (METHOD section 2).
pub fn other_edge(edge: Edge, random: &mut Pcg64) -> Edge {
    if random.random_bool(OPPOSITE) { edge.turned(2) } else { edge }
}

/// A grasp of one hand on an edge of a board that is there already, and a configuration that brings the hand to it; none when
/// the arm does not reach the grasps that are drawn.
pub fn draw_hold(map: &RobotMap, arm: &ArmSearch, edge: Edge, x_wo: &Pose, random: &mut Pcg64) -> Option<Hold> {
    let near = |x_og: &Pose| arm.reach.reaches(&arm.chain, &(x_wo * x_og));
    let grasp = draw_grasp(map, arm, edge, near, random)?;
    let x_wg = x_wo * grasp.x_og(map.size_m);
    let mut seeds = arm.reach.seeds(&arm.chain, &x_wg);
    Some(Hold { grasp, q_rad: seeds.find_map(|seed| arm.inverse.near(&x_wg, &seed).found())? })
}

/// A grasp on an edge with the pads on the board, at a pose of the hand that is accepted.
pub fn draw_grasp(
    map: &RobotMap,
    arm: &ArmSearch,
    edge: Edge,
    accepts: impl Fn(&Pose) -> bool,
    random: &mut Pcg64,
) -> Option<EdgeGrasp> {
    let gripper = &map.robot.arms[arm.index].gripper;
    (0..TRIES)
        .map(|_| propose::draw_grasp(edge, map.size_m, random))
        .find(|grasp| assess::pads_on_board(gripper, grasp, map.size_m) && accepts(&grasp.x_og(map.size_m)))
}
