//! Collision checks of the built-in Baxter against distances computed by hand and by brute force over all pairs of primitives.

use std::sync::LazyLock;

use benchdog::{
    collision::{BoardBody, Body, CollisionModel, PersonClearance, PersonPart, Scene},
    human::{BodyPart, Side},
    model::{board::BoardShape, frames::Pose, plate::PlateRecord, polygon::circle},
    robot::{ArmState, PlacedShape, Robot, Shape},
};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use parry3d_f64::{
    glamx::{DQuat, DVec3},
    math::Pose as ParryPose,
    query,
    shape::SharedShape,
};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_pcg::Pcg64;

use crate::common::baxter;

const BOARD_SIZE_M: [f64; 3] = [0.5, 0.4, 0.03];
static BOARD: LazyLock<BoardBody> = LazyLock::new(|| BoardBody::new(&BoardShape::cuboid(BOARD_SIZE_M)));

/// The manufacturer's neutral posture of an arm, rad: elbow bent, forearm level.
const NEUTRAL_RAD: [f64; 7] = [0.0, -0.55, 0.0, 0.75, 0.0, 1.26, 0.0];

fn link_poses(robot: &Robot, left_rad: &[f64], right_rad: &[f64]) -> Vec<Pose> {
    let state =
        |name: &str, q_rad| ArmState { arm: robot.arm_index(name).unwrap(), q_rad, finger_travel_m: [0.0165; 2] };
    robot.link_poses(&robot.positions(&[state("left", left_rad), state("right", right_rad)]))
}

/// A board behind the robot, out of reach.
fn far_away() -> Pose {
    Isometry3::translation(-3.0, 0.0, 0.0)
}

fn part(p0: [f64; 3], p1: [f64; 3], radius_m: f64) -> PersonPart {
    let (p0_w, p1_w) = (Point3::from(p0), Point3::from(p1));
    PersonPart {
        name: BodyPart::Trunk(Side::Working),
        p0_w,
        p1_w,
        radius_m,
        robot_clearance_m: 0.05,
        board_clearance_m: Some(0.02),
    }
}

fn scene<'a>(link_poses: &'a [Pose], holding: &'a [usize], x_wo: Pose, person: &'a [PersonPart]) -> Scene<'a> {
    Scene { link_poses, holding, board: &BOARD, x_wo, person, clearance_m: 0.0 }
}

#[test]
fn the_robot_is_free_at_zero_and_parked() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    for q_rad in [[0.0; 7], NEUTRAL_RAD] {
        let poses = link_poses(robot, &q_rad, &q_rad);
        let scene = scene(&poses, &[], far_away(), &[]);
        assert_eq!(model.first_violation(&scene), None);
        assert!(model.min_margin_m(&scene) > 0.0);
    }
}

#[test]
fn arms_that_cross_are_found() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    // Both shoulders turned inward until the forearms meet in front of the torso.
    let poses = link_poses(robot, &[-1.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[1.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let violation = model.first_violation(&scene(&poses, &[], far_away(), &[])).unwrap();
    let [Body::Link(a), Body::Link(b)] = violation.bodies else { panic!("{violation:?}") };
    assert!(robot.links[a].name.starts_with("left") || robot.links[a].name.starts_with('l'));
    assert!(robot.links[b].name.starts_with("right") || robot.links[b].name.starts_with('r'));
}

#[test]
fn the_person_keeps_away_from_the_torso() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    // Arms spread to the sides; the front bulge of the torso ends at x = 0.1744 + 0.0251.
    let spread = [0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let poses = link_poses(robot, &spread, &spread.map(|q| -q));
    for (gap_m, allowed) in [(0.051, true), (0.049, false)] {
        let x_m = 0.1995 + 0.1 + gap_m;
        let person = [part([x_m, 0.0, 0.0], [x_m, 0.0, 0.15], 0.1)];
        let scene = scene(&poses, &[], far_away(), &person);
        assert_eq!(model.first_violation(&scene).is_none(), allowed);
        // The distance is a plane's: parry's iteration ends well below a micrometre.
        assert!((model.min_margin_m(&scene) - (gap_m - 0.05)).abs() < 1e-6);
        if let Some(violation) = model.first_violation(&scene) {
            assert_eq!(
                violation.bodies,
                [Body::Person(BodyPart::Trunk(Side::Working)), Body::Link(robot.link_index("torso").unwrap())]
            );
            assert!((violation.distance_m - gap_m).abs() < 1e-6);
        }
    }
}

#[test]
fn the_person_keeps_away_from_the_board_unless_at_work() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let above = |gap_m: f64, board_clearance_m| {
        let z_m = 0.015 + 0.05 + gap_m;
        PersonPart { board_clearance_m, ..part([-3.1, 0.0, z_m], [-2.9, 0.0, z_m], 0.05) }
    };
    let cases = [
        (above(0.021, Some(0.02)), true),
        (above(0.019, Some(0.02)), false),
        (above(0.001, Some(0.0)), true),
        (above(-0.001, Some(0.0)), false),
        (above(-0.02, None), true),
    ];
    for (person, allowed) in cases {
        let violation = model.first_violation(&scene(&poses, &[], far_away(), &[person]));
        assert_eq!(violation.is_none(), allowed, "{violation:?}");
    }
}

#[test]
fn only_the_fingers_of_a_holding_gripper_may_touch_the_board() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let left = robot.arm_index("left").unwrap();
    let x_wg = poses[robot.arms[left].gripper.frame_link];
    // The board's face normal along y_G, its edge 35 mm behind G; the pads are 29.3 mm apart: both press in.
    let x_go = |edge_z_m: f64| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
        Isometry3::from_parts(Translation3::new(0.0, 0.0, edge_z_m + 0.2), turn)
    };
    let held = x_wg * x_go(-0.035);
    assert_eq!(model.first_violation(&scene(&poses, &[left], held, &[])), None);
    let not_held = model.first_violation(&scene(&poses, &[], held, &[])).unwrap();
    assert_eq!(not_held.bodies[1], Body::Board);
    // Pushed in until its edge meets the palm, which is no finger.
    let too_deep = model.first_violation(&scene(&poses, &[left], x_wg * x_go(-0.12), &[])).unwrap();
    assert_eq!(too_deep.bodies, [Body::Link(robot.arms[left].gripper.palm_link), Body::Board]);
}

/// What is free with one hand at the board and with fingers off is what is free with no hand at it.
#[test]
fn fingers_that_are_off_are_as_other_links() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let left = robot.arm_index("left").unwrap();
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let hand_w = poses[robot.arms[left].gripper.frame_link];
    let mut random = Pcg64::seed_from_u64(1);
    let mut drawn = |most: f64| Vector3::from_fn(|_, _| random.random_range(-most..most));
    let mut counts = [[0; 2]; 2];
    for _ in 0..2_000 {
        // Its edge, 0.2 m from its centre, before the fingers, between them or at the palm.
        let x_go = Isometry3::new(Vector3::new(0.0, 0.0, 0.15) + drawn(0.08), drawn(0.3));
        let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
        let x_wo = hand_w * x_go * turned;
        let is_free = |holding: &[usize]| model.first_violation(&scene(&poses, holding, x_wo, &[])).is_none();
        let are_off = model.fingers_are_off(&scene(&poses, &[left], x_wo, &[]), left);
        let at_board = is_free(&[left]);
        assert_eq!(is_free(&[]), at_board && are_off);
        counts[usize::from(at_board)][usize::from(are_off)] += 1;
    }
    // Free with fingers at the board and off it, and not free.
    assert!(counts[1].iter().all(|count| *count > 50) && counts[0][0] > 50, "{counts:?}");
}

/// A primitive in W, converted independently of the library.
fn placed_at(shape: &PlacedShape, x_wl: &Pose) -> (ParryPose, SharedShape) {
    let x_ws = x_wl * shape.x_ls;
    match shape.shape {
        Shape::Hull(_) => unreachable!("Baxter has primitives only"),
        Shape::Box { half_m: [x, y, z] } => (parry(&x_ws), SharedShape::cuboid(x, y, z)),
        Shape::Sphere { radius_m } => (parry(&x_ws), SharedShape::ball(radius_m)),
        Shape::Cylinder { radius_m, half_length_m } => {
            // A cylinder about y; turned so that its y is the URDF's z. It is its own mirror image.
            let turn = UnitQuaternion::rotation_between(&Vector3::y(), &Vector3::z()).unwrap();
            (parry(&(x_ws * turn)), SharedShape::cylinder(half_length_m, radius_m))
        }
    }
}

fn parry(pose: &Pose) -> ParryPose {
    let (t, r) = (pose.translation.vector, pose.rotation.coords);
    ParryPose::from_parts(DVec3::new(t.x, t.y, t.z), DQuat::from_xyzw(r.x, r.y, r.z, r.w))
}

type Shapes = Vec<(ParryPose, SharedShape)>;

fn distance_m(a: &Shapes, b: &Shapes) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| query::distance(&a.0, &*a.1, &b.0, &*b.1).unwrap().distance).fold(f64::INFINITY, f64::min)
}

/// The primitives of all links in W.
fn links_w(robot: &Robot, link_poses: &[Pose]) -> Vec<Shapes> {
    let placed = robot.links.iter().zip(link_poses);
    placed.map(|(link, x_wl)| link.shapes.iter().map(|shape| placed_at(shape, x_wl)).collect()).collect()
}

fn board_w(size_m: [f64; 3], x_wo: &Pose) -> Shapes {
    let [x, y, z] = size_m.map(|side| side / 2.0);
    vec![(parry(x_wo), SharedShape::cuboid(x, y, z))]
}

fn capsule_w(part: &PersonPart) -> Shapes {
    let [p0, p1] = [part.p0_w, part.p1_w].map(|p| DVec3::new(p.x, p.y, p.z));
    vec![(ParryPose::IDENTITY, SharedShape::capsule(p0, p1, part.radius_m))]
}

/// The minimum margin over all pairs of primitives, m. The clearance must be below half the distance that the wrist's links
/// always have.
fn brute_force_margin_m(robot: &Robot, scene: &Scene) -> f64 {
    let links = links_w(robot, scene.link_poses);
    let board = board_w(BOARD_SIZE_M, &scene.x_wo);
    let mut margin_m = f64::INFINITY;
    for a in 0..links.len() {
        for b in a + 1..links.len() {
            if !robot.allowed_collisions.contains(&[a, b]) {
                margin_m = margin_m.min(distance_m(&links[a], &links[b]) - scene.clearance_m);
            }
        }
        let holder = scene.holding.iter().find(|&&arm| {
            let prefix = if robot.arms[arm].name == "left" { "l_gripper_" } else { "r_gripper_" };
            robot.links[a].name.starts_with(prefix)
        });
        if holder.is_none() {
            margin_m = margin_m.min(distance_m(&links[a], &board) - scene.clearance_m);
        }
    }
    for part in scene.person {
        let capsule = capsule_w(part);
        let nearest = links.iter().map(|link| distance_m(link, &capsule)).fold(f64::INFINITY, f64::min);
        margin_m = margin_m.min(nearest - part.robot_clearance_m);
        if let Some(clearance_m) = part.board_clearance_m {
            margin_m = margin_m.min(distance_m(&board, &capsule) - clearance_m);
        }
    }
    margin_m
}

/// The same scene without the person.
fn scene_without_person<'a>(scene: &Scene<'a>) -> Scene<'a> {
    Scene { person: &[], ..*scene }
}

/// Angles near the neutral posture, with and without collisions.
fn posture() -> impl Strategy<Value = Vec<f64>> {
    NEUTRAL_RAD.map(|q| q - 0.9..q + 0.9).to_vec()
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [0.2..1.6, -0.8..0.8, -0.6..0.8]
}

/// The left palm is a box that ends 106.75 mm behind G; a board whose edge faces it is another.
#[test]
fn the_palm_keeps_its_clearance_from_the_boards_edge() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let left = robot.arm_index("left").unwrap();
    let gripper = &robot.arms[left].gripper;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let held = [left];
    for (gap_m, clearance_m) in [(0.006, 0.005), (0.004, 0.005), (0.001, 0.0), (-0.002, 0.0), (-0.002, 0.005)] {
        let x_go = Isometry3::from_parts(Translation3::new(0.0, 0.0, gap_m - 0.10675 + 0.2), turn);
        let scene = Scene { clearance_m, ..scene(&poses, &held, poses[gripper.frame_link] * x_go, &[]) };
        let nearest = model.nearest_of_robot(&scene, f64::INFINITY).unwrap();
        assert_eq!(nearest.bodies, [Body::Link(gripper.palm_link), Body::Board]);
        // Between two boxes parry's iteration ends well below a micrometre.
        assert!((nearest.distance_m - gap_m).abs() < 1e-6, "{nearest:?}");
        assert!((model.min_signed_margin_m(&scene) - (gap_m - clearance_m)).abs() < 1e-6);
        let violation = model.first_violation(&scene);
        assert_eq!(violation.is_some(), gap_m <= clearance_m);
        if let Some(violation) = violation {
            assert_eq!((violation.bodies, violation.required_m), (nearest.bodies, clearance_m));
            assert!((violation.distance_m - gap_m.max(0.0)).abs() < 1e-6 && !violation.is_of_person());
        }
    }
}

/// The lower forearm and the hand are 14.8 mm apart whatever the joints between them do: no pair is asked for more than half of
/// the distance that it can have.
#[test]
fn links_that_are_always_near_each_other_do_not_make_every_pose_infeasible() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let is_free = |s1_rad: f64| {
        let [left, right] = [0.7, -0.7].map(|s0_rad| [s0_rad, s1_rad, 0.0, 0.75, 0.0, 1.26, 0.0]);
        let poses = link_poses(robot, &left, &right);
        let of = |clearance_m| Scene { clearance_m, ..scene(&poses, &[], far_away(), &[]) };
        let nearest = model.nearest_of_robot(&of(0.0), f64::INFINITY).unwrap();
        assert!(nearest.distance_m < 0.015, "{nearest:?}");
        // Nothing keeps half a metre.
        assert!(model.first_violation(&of(0.5)).is_some());
        model.first_violation(&of(0.020)).is_none()
    };
    let free = (0..20).filter(|&step| is_free(-2.0 + 0.15 * f64::from(step))).count();
    assert!((2..20).contains(&free), "{free}");
}

#[test]
fn the_depth_of_an_overlap_is_a_negative_distance() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let spread = [0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let poses = link_poses(robot, &spread, &spread.map(|q| -q));
    for depth_m in [0.002, 0.01] {
        // Into the front of the torso, which ends at x = 0.1995; the required distance adds to the depth.
        let x_m = 0.1995 + 0.1 - depth_m;
        let person = [part([x_m, 0.0, 0.0], [x_m, 0.0, 0.15], 0.1)];
        let scene = scene(&poses, &[], far_away(), &person);
        // A plane's depth: parry's iteration ends well below a micrometre.
        let margin_m = model.min_signed_margin_m(&scene);
        assert!((margin_m + depth_m + 0.05).abs() < 1e-6, "{margin_m}");
        assert!((model.min_margin_m(&scene) + 0.05).abs() < 1e-12);
    }
}

#[test]
fn tool_hand_and_forearm_are_ignored_near_the_board() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let in_the_board = part([-3.1, 0.0, 0.0], [-2.9, 0.0, 0.0], 0.05);
    let nearest = |part| {
        let person = PersonClearance::new(&[part], &BOARD);
        model.nearest_to_person(&person, &poses, &far_away(), 0.0).map(|nearest| nearest.bodies[0])
    };
    assert_eq!(nearest(in_the_board), Some(Body::Board));
    // The hand, and the forearm behind it.
    assert_eq!(nearest(PersonPart { board_clearance_m: None, ..in_the_board }), None);
    assert_eq!(nearest(PersonPart { board_clearance_m: Some(0.0), ..in_the_board }), None);
    let in_the_torso = part([0.1, 0.0, 0.0], [0.1, 0.0, 0.15], 0.05);
    let torso = robot.link_index("torso").unwrap();
    assert_eq!(nearest(in_the_torso), Some(Body::Link(torso)));
    // The tool.
    assert_eq!(nearest(PersonPart { robot_clearance_m: 0.0, board_clearance_m: None, ..in_the_torso }), None);
}

/// The body of a plate with this outline and a hole in its middle.
fn plate_body(outline_m: Vec<[f64; 2]>) -> BoardBody {
    let plate = PlateRecord { outline_m, holes_m: vec![circle([0.0, 0.0], 0.05, 32)] };
    BoardBody::new(&BoardShape::plate(plate.into(), BOARD_SIZE_M[2]))
}

#[test]
fn a_plate_is_the_prism_over_its_outline_and_its_hole_is_filled() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    // The board is 3 m behind the robot, which is farther from the part.
    let x_wo = far_away();
    let distance_m = |board: &BoardBody, p_o: [f64; 3]| {
        let p_w = x_wo * Point3::from(p_o);
        let part = part(p_w.coords.into(), p_w.coords.into(), 0.01);
        let found =
            model.nearest_to_person(&PersonClearance::new(&[part], board), &poses, &x_wo, f64::INFINITY).unwrap();
        (found.bodies[0] == Body::Board).then_some(found.distance_m)
    };
    let rectangle = plate_body(BoardShape::cuboid(BOARD_SIZE_M).outline_m());
    let diamond = plate_body(vec![[0.25, 0.0], [0.0, 0.2], [-0.25, 0.0], [0.0, -0.2]]);
    for p_o in [[0.3, 0.25, 0.0], [0.1, 0.1, 0.2], [0.0, 0.5, 0.1], [0.24, -0.19, 0.05]] {
        let [of_box, of_plate] = [&BOARD, &rectangle].map(|board| distance_m(board, p_o).unwrap());
        // parry's iteration.
        assert!((of_box - of_plate).abs() < 1e-6, "{p_o:?}: {of_box} {of_plate}");
    }
    // By hand: the line 0.2 x + 0.25 y = 0.05 of the diamond, from a corner of its bounding box.
    let expected_m = 0.05 / 0.2_f64.hypot(0.25) - 0.01;
    assert!((distance_m(&diamond, [0.25, 0.2, 0.0]).unwrap() - expected_m).abs() < 1e-6);
    assert!(distance_m(&rectangle, [0.25, 0.2, 0.0]).unwrap() < 0.0);
    // In the hole.
    assert!(distance_m(&diamond, [0.0, 0.0, 0.0]).unwrap() < 0.0);
}

#[test]
fn a_scene_that_is_not_finite_is_not_free() {
    let robot = baxter();
    let model = CollisionModel::new(robot);
    let poses = link_poses(robot, &NEUTRAL_RAD, &NEUTRAL_RAD);
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let mut broken = poses.clone();
    broken[7] = nowhere;
    let person = [part([f64::INFINITY, 0.0, 0.0], [2.0, 0.0, 0.0], 0.1)];
    let of_nan = BoardBody::new(&BoardShape::cuboid([f64::NAN, 0.4, 0.03]));
    let endless = Scene { board: &of_nan, ..scene(&poses, &[], far_away(), &[]) };
    let cases = [
        (scene(&broken, &[], far_away(), &[]), Body::Link(7)),
        (scene(&poses[..5], &[], far_away(), &[]), Body::Link(5)),
        (scene(&poses, &[], nowhere, &[]), Body::Board),
        (endless, Body::Board),
        (scene(&poses, &[], far_away(), &person), Body::Person(BodyPart::Trunk(Side::Working))),
    ];
    for (scene, body) in cases {
        let violation = model.first_violation(&scene).unwrap();
        assert_eq!(violation.bodies, [body; 2]);
        assert!(violation.distance_m.is_nan() && violation.describe(robot).contains("not finite"));
        assert!(model.min_margin_m(&scene).is_nan() && model.min_signed_margin_m(&scene).is_nan());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_nearest_body_is_found(
        left in posture(), right in posture(), place in point(), turn in [-3.0..3.0, -3.0..3.0, -3.0..3.0],
        ends in [point(), point()], radius_m in 0.03..0.12, within_m in 0.0..0.6,
    ) {
        let robot = baxter();
        let model = CollisionModel::new(robot);
        let poses = link_poses(robot, &left, &right);
        let x_wo = Isometry3::from_parts(
            Translation3::from(place),
            UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]),
        );
        let part = part(ends[0], ends[1], radius_m);
        let person = PersonClearance::new(&[part], &BOARD);
        let found = model.nearest_to_person(&person, &poses, &x_wo, f64::INFINITY).unwrap();
        let bodies = links_w(robot, &poses).into_iter().chain([board_w(BOARD_SIZE_M, &x_wo)]);
        let expected_m = bodies.map(|body| distance_m(&body, &capsule_w(&part))).fold(f64::INFINITY, f64::min);
        // As above: parry's iteration on round shapes ends up to some 10 um early.
        prop_assert!((found.distance_m.max(0.0) - expected_m).abs() < 1e-4, "{found:?} {expected_m}");
        let within = model.nearest_to_person(&person, &poses, &x_wo, within_m);
        prop_assert_eq!(within, Some(found).filter(|found| found.distance_m < within_m));
    }

    #[test]
    fn the_broad_phase_misses_no_pair(
        left in posture(), right in posture(), place in point(), turn in [-3.0..3.0, -3.0..3.0, -3.0..3.0],
        ends in [point(), point()], radius_m in 0.03..0.12, holds in any::<bool>(),
        clearance in prop::option::of(0.0..0.05), clearance_m in prop_oneof![Just(0.0), 0.0..0.007],
    ) {
        let robot = baxter();
        let model = CollisionModel::new(robot);
        let poses = link_poses(robot, &left, &right);
        let x_wo = Isometry3::from_parts(
            Translation3::from(place),
            UnitQuaternion::from_euler_angles(turn[0], turn[1], turn[2]),
        );
        let person = [PersonPart { board_clearance_m: clearance, ..part(ends[0], ends[1], radius_m) }];
        let holding: &[usize] = if holds { &[0, 1] } else { &[] };
        let scene = Scene { clearance_m, ..scene(&poses, holding, x_wo, &person) };
        let expected_m = brute_force_margin_m(robot, &scene);
        // Poses are put together in another order, and parry's iteration on round shapes ends up to some 10 um early.
        let found_m = model.min_margin_m(&scene);
        prop_assert!((found_m - expected_m).abs() < 1e-4, "{found_m} {expected_m}");
        let signed_m = model.min_signed_margin_m(&scene);
        prop_assert!(signed_m <= found_m + 1e-9, "{signed_m} {found_m}");
        if found_m > 0.0 {
            // Clearances aside, what does not overlap has the same distance either way.
            prop_assert!(signed_m <= 0.0 || (signed_m - found_m).abs() < 1e-9, "{signed_m} {found_m}");
        }
        let alone = scene_without_person(&scene);
        let nearest = model.nearest_of_robot(&alone, f64::INFINITY).unwrap();
        // With the same requirement for all pairs the nearest one has the least margin.
        let nearest_m = nearest.distance_m - clearance_m;
        prop_assert!((nearest_m - model.min_signed_margin_m(&alone)).abs() < 1e-9, "{nearest:?}");
        let within = model.nearest_of_robot(&alone, clearance_m);
        prop_assert_eq!(within, Some(nearest).filter(|nearest| nearest.distance_m < clearance_m));
        if expected_m.abs() > 1e-4 || expected_m == 0.0 {
            prop_assert_eq!(model.first_violation(&scene).is_some(), expected_m <= 0.0);
        }
    }
}
