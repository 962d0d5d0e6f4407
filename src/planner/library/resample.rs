//! Resamples grasps for boards oriented like given ones.
//!
//! What is comfortable for the person fixes the board's height and its tilt against the vertical. It leaves open where the
//! board is, its heading, and the grasp, and good choices of these are rare. So boards with the height and tilt of good
//! candidates are put at random places of the search domain, and grasps are drawn for every arm by itself. Few are reached;
//! those are combined with all reached grasps of the other arms, so some dozen draws give some dozen grasps.

use std::f64::consts::PI;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{board_grasps::grasps_of_board, entry::LibraryEntry, grasping_robot::GraspingRobot, postures::Posture};
use crate::{
    model::{frames::Pose, stop::Stop as _},
    planner::{
        domain::{SearchDomain, uniform},
        watch::Counter,
    },
};

/// Grasps of `count` boards with the height and tilt of the given ones; boards outside the search domain have none. The same
/// arguments give the same grasps, whatever the number of threads. After a stop they are not complete.
pub fn resample(
    robot: &GraspingRobot,
    boards: &[Pose],
    count: usize,
    stream: [u64; 2],
    counter: &Counter<'_>,
) -> Vec<LibraryEntry> {
    let board = |number: usize, random: &mut Pcg64| moved(&boards[number % boards.len()], &robot.domain, random);
    if boards.is_empty() {
        return Vec::new();
    }
    numbered_grasps_of(robot, count, stream, board, counter).map(|(_, entry)| entry).collect()
}

/// Grasps of boards where postures have them, each entry with its posture; boards outside the search domain have none. The same
/// arguments give the same grasps, whatever the number of threads. After a stop they are not complete.
pub fn grasps_for(
    robot: &GraspingRobot,
    boards: &[(Pose, Posture)],
    stream: [u64; 2],
    counter: &Counter<'_>,
) -> Vec<LibraryEntry> {
    numbered_grasps_of(robot, boards.len(), stream, |number, _| boards[number].0, counter)
        .map(|(number, entry)| LibraryEntry { posture: Some(boards[number].1), ..entry })
        .collect()
}

/// Grasps of `count` boards, each board with a random generator of its own, each grasp with the number of its board.
fn numbered_grasps_of<'r>(
    robot: &'r GraspingRobot,
    count: usize,
    [seed, pass]: [u64; 2],
    board: impl Fn(usize, &mut Pcg64) -> Pose + Sync + Send + 'r,
    counter: &'r Counter<'r>,
) -> impl ParallelIterator<Item = (usize, LibraryEntry)> + 'r {
    let of_board = move |number: usize| {
        let stream = (u128::from(pass) << 64) + number as u128;
        let mut random = Pcg64::new(u128::from(seed), stream);
        let x_wo = board(number, &mut random);
        let is_drawn = robot.domain.contains(&x_wo) && !counter.is_stopped();
        let entries = if is_drawn { grasps_of_board(robot, &x_wo, &mut random).ok() } else { None };
        counter.advance();
        entries.into_iter().flatten().map(move |entry| (number, entry))
    };
    (0..count).into_par_iter().flat_map_iter(of_board)
}

/// A board turned about the vertical and moved anywhere in the domain at its own height.
fn moved(x_wo: &Pose, domain: &SearchDomain, random: &mut Pcg64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), uniform(random, -PI, PI));
    let [x_m, y_m] = [domain.x_m, domain.y_m].map(|[low, high]| uniform(random, low, high));
    Isometry3::from_parts(Vector3::new(x_m, y_m, x_wo.translation.z).into(), turn * x_wo.rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{board::BoardShape, plate::PlateRecord, stop::Never},
        planner::library::{BoardGrasp, GraspLibrary},
        reproduce::paper,
    };

    fn library() -> GraspLibrary {
        let loaded = paper::printed_operations()[0].load().unwrap();
        GraspLibrary::new(&loaded.robot, &loaded.scenario.object.shape(), loaded.scenario.limits.clearance_m())
    }

    #[test]
    fn every_grasp_is_of_a_similar_board_is_reached_and_collides_with_nothing() {
        let library = library();
        let (robot, entries) = (&library.robot, library.entries(&Never).unwrap());
        let boards: Vec<_> = entries.iter().take(20).map(|entry| entry.grasp.x_wo).collect();
        let found = resample(robot, &boards, 200, [1, 1], &Counter::quiet(&Never));
        assert!(found.len() > 20, "{}", found.len());
        for LibraryEntry { grasp: BoardGrasp { x_wo, arms }, .. } in &found {
            let similar = |board: &Pose| {
                let up = |pose: &Pose| pose.rotation.inverse() * Vector3::z();
                (board.translation.z - x_wo.translation.z).abs() < 1e-12 && (up(board) - up(x_wo)).norm() < 1e-12
            };
            assert!(boards.iter().any(similar));
            assert!(robot.domain.contains(x_wo));
            for (arm, own) in robot.arms.iter().zip(arms) {
                let missed = arm.chain.gripper_pose(&own.q_rad).inverse() * (x_wo * own.grasp.x_og(&robot.board));
                // The tolerance of docs/method.md#34-constraints: 1e-6 m and rad.
                assert!(missed.translation.vector.norm() < 1e-6 && missed.rotation.angle() < 1e-6);
                assert!(robot.fits(arm, &own.grasp));
            }
            let [left, right] = [0, 1].map(|arm: usize| arms[arm].grasp.edge);
            assert!(left == right || left == robot.opposite(right));
            let link_poses = robot.link_poses(arms);
            assert!(robot.collision.first_violation(&robot.scene(&link_poses, *x_wo)).is_none());
        }
        // Both edge patterns occur.
        let same =
            found.iter().filter(|entry| entry.grasp.arms[0].grasp.edge == entry.grasp.arms[1].grasp.edge).count();
        assert!(same > 0 && same < found.len());
    }

    /// A plate whose sides are 30 mm long has no edge for pads of 40.4 mm, and the evidence says so.
    #[test]
    fn a_plate_without_an_edge_for_the_pads_has_no_grasp() {
        let loaded = paper::printed_operations()[0].load().unwrap();
        let outline_m = vec![[0.015, -0.015], [0.015, 0.015], [-0.015, 0.015], [-0.015, -0.015]];
        let board = BoardShape::plate(PlateRecord { outline_m, holes_m: Vec::new() }.into(), 0.02);
        let library = GraspLibrary::new(&loaded.robot, &board, 0.005);
        assert!(library.entries(&Never).unwrap().is_empty() && library.robot.edges.is_empty());
        assert!(resample(&library.robot, &[Pose::identity()], 20, [1, 1], &Counter::quiet(&Never)).is_empty());
        let text = library.failures(&Never).unwrap().evidence(&loaded.robot).to_string();
        assert!(text.contains("100.0 % every edge of the board is shorter than a pad is wide"), "{text}");
    }

    #[test]
    fn the_number_of_threads_does_not_change_the_grasps() {
        let library = library();
        let (robot, entries) = (&library.robot, library.entries(&Never).unwrap());
        let boards = [entries[0].grasp.x_wo];
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| resample(robot, &boards, 60, [3, 2], &Counter::quiet(&Never)));
            found.iter().map(|entry| format!("{:?}", entry.grasp)).collect::<Vec<_>>()
        };
        let one = with(1);
        assert!(!one.is_empty());
        assert_eq!(one, with(3));
        assert!(resample(robot, &[], 60, [3, 2], &Counter::quiet(&Never)).is_empty());
    }
}
