//! The height of the floor, and where boards can be held, from samples of the arms' reach.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64;

use crate::robot::{Chain, Robot, SearchBox};

/// A robot whose shoulders are lower than this above its lowest point stands on a bench, m.
const BENCH_SHOULDER_M: f64 = 0.65;

/// Height of a bench, m: assumed.
const BENCH_M: f64 = 0.80;

/// Height of the board's centre above the floor that a person can work at, m.
const WORK_HEIGHT_M: [f64; 2] = [0.62, 1.52];

/// The least mean of the horizontal offsets from shoulder to gripper, as a share of the reach, that tells a robot's front.
const LEAST_FORWARD: f64 = 0.1;

/// Number of postures of each arm.
const SAMPLES: usize = 4_000;

/// Seed of the postures.
const SEED: u64 = 2;

/// Side of the cells in which samples are counted, m.
const CELL_M: f64 = 0.1;

/// Distance from the board's centre within which each gripper must come, m: half a board.
const HALF_BOARD_M: f64 = 0.25;

/// Share of the places on either side of each axis that is left out: the rim of the reach.
const RIM: f64 = 0.1;

/// Distance of the board in front of the shoulders, and to the side of their middle, as shares of the reach
/// (docs/method.md#36-search-domain).
const AHEAD: [f64; 2] = [0.20, 0.60];
const ASIDE: f64 = 0.25;

/// Height of the floor, m, and true if a bench was assumed. It is below the links that stand still.
pub(super) fn floor_z_m(robot: &Robot) -> (f64, bool) {
    let x_wl = robot.link_poses(&robot.positions(&[]));
    let moves = robot.moved_links();
    let fixed = robot.links.iter().zip(&x_wl).zip(&moves).filter(|(_, moves)| !**moves).map(|(link, _)| link);
    let shapes = fixed.flat_map(|(link, x_wl)| {
        link.shapes.iter().map(move |placed| {
            let x_ws = x_wl * placed.x_ls;
            x_ws.translation.z - placed.shape.support_m(&(x_ws.rotation.inverse() * -Vector3::z()))
        })
    });
    let lowest_m = shapes.fold(robot.x_wr.translation.z, f64::min);
    let shoulders: Vec<f64> = chains(robot).map(|chain| chain.shoulder_w().z).collect();
    let shoulder_m = shoulders.iter().sum::<f64>() / shoulders.len().max(1) as f64;
    let is_on_bench = shoulder_m - lowest_m < BENCH_SHOULDER_M;
    // A bench is under the root link; what reaches below it hangs over its edge.
    let floor_m = if is_on_bench { robot.x_wr.translation.z - BENCH_M } else { lowest_m };
    ((floor_m * 1e3).round() / 1e3, is_on_bench)
}

fn chains(robot: &Robot) -> impl Iterator<Item = Chain> {
    (0..robot.arms.len()).map(|arm| Chain::new(robot, arm, 0.0))
}

/// By how many degrees about z the robot must be turned so that its arms reach forward along +x of W, a multiple of 90. Joint
/// limits make the arms of a robot with a front reach there; those of an industrial arm reach all around, and it stays.
pub(super) fn yaw_deg(robot: &Robot) -> f64 {
    let mut random = Pcg64::new(SEED.into(), 1);
    let mean = |chain: &Chain, random: &mut Pcg64| {
        let offsets = samples_w(chain, random).into_iter().map(|point| point - chain.shoulder_w());
        offsets.sum::<Vector3<f64>>() / (SAMPLES as f64 * chain.reach_m())
    };
    let chains: Vec<Chain> = chains(robot).collect();
    let forward = chains.iter().map(|chain| mean(chain, &mut random)).sum::<Vector3<f64>>() / chains.len() as f64;
    if forward.xy().norm() < LEAST_FORWARD {
        return 0.0;
    }
    let quarters = (forward.y.atan2(forward.x).to_degrees() / 90.0).round();
    -90.0 * quarters + 0.0
}

/// A box of places in front of the robot, at a person's working height, that all grippers come near; `None` if there are none.
pub(super) fn search_box(robot: &Robot) -> Option<SearchBox> {
    let mut random = Pcg64::new(SEED.into(), 0);
    let chains: Vec<Chain> = chains(robot).collect();
    let grasps: Vec<Vec<Vector3<f64>>> = chains.iter().map(|chain| samples_w(chain, &mut random)).collect();
    let reach_m = chains.iter().map(Chain::reach_m).fold(f64::INFINITY, f64::min);
    let shoulders_m = chains.iter().map(Chain::shoulder_w).sum::<Vector3<f64>>() / chains.len() as f64;
    let low = Vector3::new(
        shoulders_m.x + AHEAD[0] * reach_m,
        shoulders_m.y - ASIDE * reach_m,
        robot.floor_z_m + WORK_HEIGHT_M[0],
    );
    let high = Vector3::new(
        shoulders_m.x + AHEAD[1] * reach_m,
        shoulders_m.y + ASIDE * reach_m,
        robot.floor_z_m + WORK_HEIGHT_M[1],
    );
    let is_inside = |place: &Vector3<f64>| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]));
    let near = |place: &Vector3<f64>| {
        grasps.iter().all(|points| points.iter().any(|point| (point - place).norm() < HALF_BOARD_M))
    };
    let cells = grasps.iter().flatten().map(|point| point.map(|v| (v / CELL_M).round() as i32));
    let cells: BTreeSet<[i32; 3]> = cells.map(<[i32; 3]>::from).collect();
    let places = cells.into_iter().map(|cell| Vector3::from(cell.map(|number| f64::from(number) * CELL_M)));
    let places: Vec<Vector3<f64>> = places.filter(is_inside).filter(near).collect();
    let range = |axis: usize| {
        let mut values: Vec<f64> = places.iter().map(|place| place[axis]).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let at = |share: f64| values[(share * last as f64).round() as usize];
        let [low, high] = [at(RIM) - CELL_M / 2.0, at(1.0 - RIM) + CELL_M / 2.0];
        Some([low, high].map(|v| (v * 1e3).round() / 1e3))
    };
    Some(SearchBox { x_m: range(0)?, y_m: range(1)?, z_m: range(2)? })
}

/// Where the gripper is in random postures, W.
fn samples_w(chain: &Chain, random: &mut Pcg64) -> Vec<Vector3<f64>> {
    let mut draw = || {
        let limits = chain.lower().iter().zip(chain.upper());
        let q_rad: Vec<f64> = limits.map(|(low, high)| low + (high - low) * random.random::<f64>()).collect();
        chain.gripper_pose(&q_rad).translation.vector
    };
    (0..SAMPLES).map(|_| draw()).collect()
}
