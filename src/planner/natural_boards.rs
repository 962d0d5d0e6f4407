//! Grasps of the boards that natural postures ask for.
//!
//! Natural postures are rare: few boards of the grasp library are where one can work on them naturally. So boards are put where
//! the most promising postures of the map have them, anywhere in the search domain if the person may stand anywhere, and
//! grasps are drawn for these.

use nalgebra::Isometry3;
use rand_pcg::Pcg64;

use super::{
    domain::uniform,
    library::{GraspingRobot, LibraryEntry, Posture, PostureMap, grasps_for, resample},
    params::library::NATURAL_PASS,
    watch::{Counter, Phase, Watch},
};
use crate::{
    human::{Human, standing_pose_w},
    model::{
        frames::Pose,
        scenario::{Scenario, StandingPlace},
    },
};

/// Collision-free grasps of `count` boards with the height and tilt that natural postures give them, anywhere in the search
/// domain; none if the posture is unrestricted or the place is given. They serve all tasks of a family. After a stop they are
/// not complete.
pub fn natural_entries(
    scenario: &Scenario,
    human: &Human,
    robot: &GraspingRobot,
    postures: &PostureMap,
    count: usize,
    watch: &dyn Watch,
) -> Vec<LibraryEntry> {
    if !human.posture().is_natural() || human.place_is_given() {
        return Vec::new();
    }
    let boards: Vec<_> = boards(scenario, robot, postures, count).into_iter().map(|(x_wo, _)| x_wo).collect();
    let counter = Counter::new(watch, Phase::NaturalGrasps, count);
    resample(robot, &boards, count, [scenario.planner.seed, NATURAL_PASS], &counter)
}

/// Collision-free grasps of `count` boards where postures of a person in the given place have them; none if the place is free.
/// They serve one task. After a stop they are not complete.
pub fn entries_for_place(
    scenario: &Scenario,
    human: &Human,
    robot: &GraspingRobot,
    postures: &PostureMap,
    count: usize,
    watch: &dyn Watch,
) -> Vec<LibraryEntry> {
    if !human.place_is_given() {
        return Vec::new();
    }
    let boards = boards(scenario, robot, postures, count);
    let counter = Counter::new(watch, Phase::NaturalGrasps, boards.len());
    grasps_for(robot, &boards, [scenario.planner.seed, NATURAL_PASS], &counter)
}

/// The most promising postures with poses of the board in them: at random rolls of the tool where the roll is free and, if the
/// place is given, for a person who stands there within the tolerances.
fn boards(scenario: &Scenario, robot: &GraspingRobot, postures: &PostureMap, count: usize) -> Vec<(Pose, Posture)> {
    let floor_z_m = robot.robot.floor_z_m;
    let mut random = Pcg64::new(u128::from(scenario.planner.seed), u128::from(NATURAL_PASS));
    let operation = &scenario.operation;
    let mut board = |x_bt: &Pose| {
        let mut around = |middle: f64, by: f64| uniform(&mut random, middle - by, middle + by);
        let x_wb = match scenario.human.place {
            StandingPlace::Free => Isometry3::translation(0.0, 0.0, floor_z_m),
            StandingPlace::Given { p_wb_m: [x_m, y_m], heading_deg, tolerance_m, tolerance_deg } => {
                let [x_m, y_m] = [x_m, y_m].map(|place_m| around(place_m, tolerance_m));
                standing_pose_w(x_m, y_m, around(heading_deg, tolerance_deg).to_radians(), floor_z_m)
            }
        };
        let roll_rad = if operation.kind.roll_is_free() { around(0.0, std::f64::consts::PI) } else { 0.0 };
        x_wb * x_bt * operation.rolled(roll_rad).x_ot.inverse()
    };
    postures.ranked().take(count).map(|posture| (board(&posture.x_bt), *posture)).collect()
}
