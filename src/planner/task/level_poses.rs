//! Level poses of the board, at which grips are changed.
//!
//! In one hand a board turns about the normal of the pads unless its centre is nearly above or below them, so a large board is seldom
//! carried by one hand where the person works on it. The weight of a level board has no moment about that normal: one hand carries
//! it far from its centre. The arms bring the board from a hold that serves to a level pose, change grips there, and bring it back.
//! Other grips are drawn for level poses, on any two edges of the board: by way of them a board that is held at two opposite edges
//! comes to be held at the other two.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{
    super::{
        domain::SearchDomain,
        library::{BoardGrasp, GraspingRobot, grasps_on_any_edges},
        params::task::{LEVEL_POSITIONS, LEVEL_SAMPLE, LEVEL_STEP_M, LEVEL_STREAM, LEVEL_TURN_RAD, LEVEL_TURNS},
    },
    hold::Hold,
    motion,
    problem::TaskProblem,
};
use crate::model::frames::Pose;

/// A grip with the board at a level pose.
pub struct LevelHold {
    pub grasp: BoardGrasp,
    /// The number of the grip; grips that were drawn for level poses follow the others.
    pub grip: usize,
    /// The number of the level pose.
    pub pose: usize,
    /// The hold from which the arms bring the board there; `None` if they bring it from another level pose.
    pub from: Option<usize>,
}

/// All holds at level poses.
pub struct LevelHolds {
    pub holds: Vec<LevelHold>,
    /// Pairs of these holds: one grip at neighbouring level poses.
    pub moves: Vec<[usize; 2]>,
}

/// A grip at level poses, each with the hold from which the arms bring the board there.
type AtPoses = BTreeMap<usize, (BoardGrasp, Option<usize>)>;

impl LevelHolds {
    /// The grips of some holds, which follow one another by grip, at the level poses to which the arms bring the board from there,
    /// and grips that are drawn for these poses; each at the neighbouring poses to which it follows the board.
    pub fn new(problem: &TaskProblem<'_>, holds: &[Hold]) -> Self {
        let robot = problem.robot;
        let poses = LevelPoses::new(robot, holds);
        let mut first = 0;
        let mut of_grips = Vec::new();
        for of_grip in holds.chunk_by(|a, b| a.grip == b.grip) {
            of_grips.push((first, of_grip));
            first += of_grip.len();
        }
        let brought = |&(first, of_grip): &(usize, &[Hold])| (of_grip[0].grip, brought(robot, &poses, first, of_grip));
        let brought: Vec<_> = of_grips.par_iter().map(brought).collect();
        let seed = u128::from(problem.of_piece(0).scenario.planner.seed);
        let drawn = |pose: usize| {
            let mut random = Pcg64::new(seed, LEVEL_STREAM + pose as u128);
            let entries = grasps_on_any_edges(robot, &poses.x_wo(pose), &mut random).unwrap_or_default();
            entries.into_iter().map(move |entry| AtPoses::from([(pose, (entry.grasp, None))]))
        };
        let drawn: Vec<_> = (0..poses.count()).into_par_iter().flat_map_iter(drawn).collect();
        let grips = holds.last().map_or(0, |hold| hold.grip + 1);
        let sources: Vec<_> = brought.into_iter().chain((grips..).zip(drawn)).collect();
        let grown: Vec<_> =
            sources.into_par_iter().map(|(grip, source)| (grip, grown(robot, &poses, source))).collect();
        let mut all = Self { holds: Vec::new(), moves: Vec::new() };
        for (grip, (at, moves)) in grown {
            let number: BTreeMap<_, _> = at.keys().copied().zip(all.holds.len()..).collect();
            all.moves.extend(moves.into_iter().map(|poses| poses.map(|pose| number[&pose])));
            all.holds.extend(at.into_iter().map(|(pose, (grasp, from))| LevelHold { grasp, grip, pose, from }));
        }
        all
    }
}

/// A grip at the level poses to which the arms bring the board from one of its holds, the first of which has this number: from that
/// which is turned least.
fn brought(robot: &GraspingRobot, poses: &LevelPoses, first: usize, of_grip: &[Hold]) -> AtPoses {
    let levelled: Vec<_> = of_grip.iter().map(|hold| levelled(&hold.grasp.x_wo.rotation)).collect();
    let mut at = AtPoses::new();
    for (rotation, turn) in poses.rotations.iter().enumerate() {
        let apart_rad = |number: &usize| levelled[*number].angle_to(turn);
        let nearest = (0..of_grip.len()).min_by(|a, b| apart_rad(a).total_cmp(&apart_rad(b)));
        let Some(nearest) = nearest.filter(|number| apart_rad(number) <= LEVEL_TURN_RAD) else { continue };
        let from = &of_grip[nearest].grasp;
        for position in 0..poses.positions_w.len() {
            let pose = poses.number(position, rotation);
            let there = reached(robot, from, poses.x_wo(pose));
            let there = there.filter(|there| motion::between(robot, from, there).is_some());
            at.extend(there.map(|grasp| (pose, (grasp, Some(first + nearest)))));
        }
    }
    at
}

/// A grip with all level poses that it reaches over neighbouring ones, and the pairs of these.
fn grown(robot: &GraspingRobot, poses: &LevelPoses, source: AtPoses) -> (AtPoses, Vec<[usize; 2]>) {
    let mut open: VecDeque<_> = source.keys().copied().collect();
    let mut at = source;
    while let Some(here) = open.pop_front() {
        for next in poses.beside(here) {
            if !at.contains_key(&next)
                && let Some(there) = reached(robot, &at[&here].0, poses.x_wo(next))
            {
                at.insert(next, (there, None));
                open.push_back(next);
            }
        }
    }
    let later =
        |&here: &usize| poses.beside(here).into_iter().filter(move |&next| next > here).map(move |next| [here, next]);
    let moves = at.keys().flat_map(later).filter(|[_, next]| at.contains_key(next)).collect();
    (at, moves)
}

/// The same grip at another board pose, if the arms reach it there from their configurations without a collision.
fn reached(robot: &GraspingRobot, from: &BoardGrasp, x_wo: Pose) -> Option<BoardGrasp> {
    robot.followed(from, x_wo, f64::INFINITY)
}

/// Level poses: every rotation at every position.
struct LevelPoses {
    positions_w: Vec<Vector3<f64>>,
    /// [`LEVEL_TURNS`] angles about the vertical for each face that is up.
    rotations: Vec<UnitQuaternion<f64>>,
}

impl LevelPoses {
    /// At the positions of a lattice over the search domain that most of some holds reach, each one for holds that do not reach those
    /// before; with the faces up that these holds turn up.
    fn new(robot: &GraspingRobot, holds: &[Hold]) -> Self {
        let sample: Vec<_> = holds.iter().step_by(holds.len().div_ceil(LEVEL_SAMPLE).max(1)).collect();
        let is_up = |hold: &&Hold| normal_w(&hold.grasp.x_wo.rotation).z >= 0.0;
        let faces = [sample.iter().any(is_up), !sample.iter().all(is_up)];
        let rotations: Vec<_> = [0.0, 1.0]
            .into_iter()
            .zip(faces)
            .filter(|(_, used)| *used)
            .flat_map(|(half_turns, _)| (0..LEVEL_TURNS).map(move |turn| rotation(half_turns, turn)))
            .collect();
        let nearest = |hold: &&Hold| {
            let levelled = levelled(&hold.grasp.x_wo.rotation);
            rotations.iter().copied().min_by(|a, b| a.angle_to(&levelled).total_cmp(&b.angle_to(&levelled)))
        };
        let turned: Vec<_> = sample.iter().map(nearest).collect();
        let reached_by = |p_wo: &Vector3<f64>| -> Vec<bool> {
            let reaches = |(hold, turned): (&&Hold, &Option<UnitQuaternion<f64>>)| {
                turned.is_some_and(|turned| {
                    reached(robot, &hold.grasp, Pose::from_parts((*p_wo).into(), turned)).is_some()
                })
            };
            sample.iter().zip(&turned).map(reaches).collect()
        };
        let lattice = lattice_w(&robot.domain);
        let reached: Vec<_> = lattice.par_iter().map(reached_by).collect();
        let positions_w = covering(&reached, LEVEL_POSITIONS).into_iter().map(|at| lattice[at]).collect();
        Self { positions_w, rotations }
    }

    fn count(&self) -> usize {
        self.positions_w.len() * self.rotations.len()
    }

    fn number(&self, position: usize, rotation: usize) -> usize {
        position * self.rotations.len() + rotation
    }

    fn x_wo(&self, pose: usize) -> Pose {
        let (position, rotation) = (pose / self.rotations.len(), pose % self.rotations.len());
        Isometry3::from_parts(self.positions_w[position].into(), self.rotations[rotation])
    }

    /// The poses beside one: turned by one step, and at the other positions.
    fn beside(&self, pose: usize) -> Vec<usize> {
        let (position, rotation) = (pose / self.rotations.len(), pose % self.rotations.len());
        let (face, turn) = (rotation / LEVEL_TURNS, rotation % LEVEL_TURNS);
        let turned = [1, LEVEL_TURNS - 1].map(|by| face * LEVEL_TURNS + (turn + by) % LEVEL_TURNS);
        let others = (0..self.positions_w.len()).filter(|&other| other != position);
        let turned = turned.into_iter().map(|rotation| self.number(position, rotation));
        turned.chain(others.map(|other| self.number(other, rotation))).collect()
    }
}

/// At most `most` sets, each of which has the most members that are in none of those before; of equal ones the first.
fn covering(sets: &[Vec<bool>], most: usize) -> Vec<usize> {
    let mut covered = vec![false; sets.first().map_or(0, Vec::len)];
    let mut chosen = Vec::new();
    for _ in 0..most {
        let new = |set: &usize| sets[*set].iter().zip(&covered).filter(|(has, covered)| **has && !**covered).count();
        let Some(best) = (0..sets.len()).rev().max_by_key(new).filter(|set| new(set) > 0) else { break };
        for (covered, has) in covered.iter_mut().zip(&sets[best]) {
            *covered |= has;
        }
        chosen.push(best);
    }
    chosen
}

/// Positions of the board at equal distances over the search domain.
fn lattice_w(domain: &SearchDomain) -> Vec<Vector3<f64>> {
    let along = |[low, high]: [f64; 2]| {
        let steps = ((high - low) / LEVEL_STEP_M).round().max(1.0) as usize;
        (0..=steps).map(|step| low + (high - low) * step as f64 / steps as f64).collect::<Vec<_>>()
    };
    let [xs, ys, zs] = [domain.x_m, domain.y_m, domain.z_m].map(along);
    let planes = xs.iter().flat_map(|x| ys.iter().map(move |y| (*x, *y)));
    planes.flat_map(|(x, y)| zs.iter().map(move |z| Vector3::new(x, y, *z))).collect()
}

/// The rotation of a level board that is turned over by half turns about its x axis, and then by steps about the vertical.
fn rotation(half_turns: f64, turn: usize) -> UnitQuaternion<f64> {
    let over = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), half_turns * std::f64::consts::PI);
    let angle_rad = turn as f64 * std::f64::consts::TAU / LEVEL_TURNS as f64;
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_rad) * over
}

/// A board's rotation turned by the least angle that makes it level.
fn levelled(rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let normal_w = normal_w(rotation);
    let up_w = if normal_w.z >= 0.0 { Vector3::z() } else { -Vector3::z() };
    UnitQuaternion::rotation_between(&normal_w, &up_w).unwrap_or_default() * rotation
}

/// The normal of the worked face.
fn normal_w(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    rotation * Vector3::z()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_levelled_board_is_level_and_turned_by_its_tilt(roll in -3.0..3.0, pitch in -1.5..1.5, yaw in -3.0..3.0) {
            let before = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let after = levelled(&before);
            let tilt_rad = normal_w(&before).z.abs().min(1.0).acos();
            prop_assert!((normal_w(&after).z.abs() - 1.0).abs() < 1e-12);
            prop_assert!(normal_w(&after).z * normal_w(&before).z >= 0.0);
            // Near a level board the arc cosine is ill-conditioned: its error is the root of that of the normal.
            prop_assert!((before.angle_to(&after) - tilt_rad).abs() < 1e-7);
        }

        #[test]
        fn each_chosen_set_covers_the_most_of_what_is_left(
            sets in prop::collection::vec(prop::collection::vec(any::<bool>(), 12), 1..8), most in 1_usize..5,
        ) {
            let chosen = covering(&sets, most);
            prop_assert!(chosen.len() <= most);
            let mut covered = [false; 12];
            for &set in &chosen {
                let new = |set: usize| (0..12).filter(|&at| sets[set][at] && !covered[at]).count();
                prop_assert!(new(set) > 0 && (0..sets.len()).all(|other| new(other) <= new(set)));
                (0..12).for_each(|at| covered[at] |= sets[set][at]);
            }
            // Fewer than allowed cover all that there is.
            let all = (0..12).all(|at| covered[at] || sets.iter().all(|set| !set[at]));
            prop_assert!(chosen.len() == most || all);
        }
    }

    #[test]
    fn neighbours_of_level_poses_are_mutual_and_one_step_away() {
        let turns = |half_turns| (0..LEVEL_TURNS).map(move |turn| rotation(half_turns, turn));
        let positions_w = vec![Vector3::zeros(), Vector3::x()];
        let poses = LevelPoses { positions_w, rotations: turns(0.0).chain(turns(1.0)).collect() };
        let step_rad = std::f64::consts::TAU / LEVEL_TURNS as f64;
        for pose in 0..poses.count() {
            let beside = poses.beside(pose);
            assert_eq!(beside.len(), 3);
            for other in beside {
                assert!(poses.beside(other).contains(&pose));
                let [a, b] = [pose, other].map(|pose| poses.x_wo(pose));
                let turned_rad = a.rotation.angle_to(&b.rotation);
                let is_shifted = (a.translation.vector - b.translation.vector).norm() > 0.5;
                assert!((turned_rad - if is_shifted { 0.0 } else { step_rad }).abs() < 1e-9);
            }
        }
    }
}
