//! Invariances of the whole person.

use std::f64::consts::PI;

use approx::assert_abs_diff_eq;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use rand::RngExt;

use super::{
    testing::{average_man, generator, leaning, random_angles, worker},
    *,
};
use crate::model::{
    operation::OperationKind,
    scenario::{PeripersonalForm, Sex},
};

const DIRECTIONS: [StrengthDirection; 2] = [StrengthDirection::Paper, StrengthDirection::Torque];

/// Points about where a robot would be.
fn robot_points(generator: &mut impl RngExt) -> Vec<Point3<f64>> {
    (0..56).map(|_| Point3::from(Vector3::from_fn(|_, _| generator.random_range(-0.6..0.6)))).collect()
}

fn wrench(components: [f64; 6]) -> Wrench {
    Wrench::from(components)
}

/// Any posture, as fractions of the joints' ranges.
fn fractions() -> impl Strategy<Value = [f64; 7]> {
    prop::array::uniform7(0.0..=1.0)
}

fn posture(human: &Human, fractions: [f64; 7]) -> ArmAngles {
    std::array::from_fn(|i| {
        let [low, high] = human.arm().ranges.joints_rad[i];
        low + fractions[i] * (high - low)
    })
}

proptest! {
    #[test]
    fn a_left_handed_person_is_the_mirror_image(
        fractions in fractions(),
        components in prop::array::uniform6(-30.0..30.0),
        place in prop::array::uniform3(-2.0..2.0),
    ) {
        let right = worker(Hand::Right, OperationKind::Cut);
        let left = worker(Hand::Left, OperationKind::Cut);
        let q_rad = posture(&right, fractions);
        let x_wb = standing_pose_w(place[0], place[1], place[2], -0.9);
        // Mirrored in the plane y_W = 0, the person stands at -y and turns the other way.
        let x_wb_mirrored = standing_pose_w(place[0], -place[1], -place[2], -0.9);
        let w = wrench(components);
        prop_assert_eq!(left.tool_pose_b(&q_rad), right.tool_pose_b(&q_rad).mirrored());
        for direction in DIRECTIONS {
            let of_right = right.activations(&q_rad, &x_wb, &w, direction);
            let of_left = left.activations(&q_rad, &x_wb_mirrored, &w.mirrored(), direction);
            for (l, r) in of_left.iter().zip(of_right) {
                // Torques of up to 50 N m over strengths of at least 4, rounded some ten times.
                prop_assert!((l - r).abs() < 1e-12, "{of_left:?} {of_right:?}");
            }
        }
        let pairs = left.body_points_w(&x_wb_mirrored, &q_rad).into_iter().zip(right.body_points_w(&x_wb, &q_rad));
        for (l, r) in pairs {
            prop_assert!((l.coords - r.coords.mirrored()).norm() < 1e-14);
        }
        for (l, r) in left.capsules_w(&x_wb_mirrored, &q_rad).iter().zip(right.capsules_w(&x_wb, &q_rad)) {
            prop_assert_eq!(l.name, r.name);
            prop_assert!((l.p0_w.coords - r.p0_w.coords.mirrored()).norm() < 1e-14);
            prop_assert!((l.p1_w.coords - r.p1_w.coords.mirrored()).norm() < 1e-14);
        }
    }

    #[test]
    fn the_inverse_kinematics_of_a_left_handed_person_finds_every_posture(fractions in fractions()) {
        let left = worker(Hand::Left, OperationKind::Drill);
        let q_rad = posture(&left, fractions);
        let x_bt = left.tool_pose_b(&q_rad);
        let swivel_rad = left.swivel_rad(&q_rad);
        let covered = left.swivel_circle(&x_bt).unwrap().intervals().iter().any(|interval| {
            // Sampled fractions include postures on a limit, at the very end of a range.
            (swivel_rad - interval.from_rad + 1e-6).rem_euclid(2.0 * PI) <= interval.to_rad - interval.from_rad + 2e-6
        });
        let solutions = left.arm_solutions(&x_bt, swivel_rad);
        prop_assert!(!solutions.is_empty());
        for solution in solutions {
            prop_assert!((left.tool_pose_b(&solution).translation.vector - x_bt.translation.vector).norm() < 1e-9);
            prop_assert!(left.tool_pose_b(&solution).rotation.angle_to(&x_bt.rotation) < 1e-7);
        }
        prop_assert!(covered || fractions.iter().any(|&f| f == 0.0 || f == 1.0));
    }

    #[test]
    fn only_the_relative_placement_matters(
        fractions in fractions(),
        components in prop::array::uniform6(-30.0..30.0),
        move_by in prop::array::uniform3(-3.0..3.0),
        turn_rad in -PI..PI,
    ) {
        let human = worker(Hand::Right, OperationKind::Drill);
        let q_rad = posture(&human, fractions);
        let x_wb = standing_pose_w(1.2, -0.1, 2.9, -0.9);
        let moved = Isometry3::from_parts(
            Vector3::from(move_by).into(),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad),
        );
        let x_wb_moved = moved * x_wb;
        let w = wrench(components);
        let w_turned = Wrench::new(moved.rotation * w.force_n, moved.rotation * w.moment_nm);
        for direction in DIRECTIONS {
            let here = human.activations(&q_rad, &x_wb, &w, direction);
            let there = human.activations(&q_rad, &x_wb_moved, &w_turned, direction);
            for (a, b) in here.iter().zip(there) {
                // As for the mirror image.
                prop_assert!((a - b).abs() < 1e-12, "{here:?} {there:?}");
            }
        }
        let robot = robot_points(&mut generator(7));
        let robot_moved: Vec<_> = robot.iter().map(|p| moved * p).collect();
        for form in [PeripersonalForm::Min, PeripersonalForm::Mean, PeripersonalForm::Weighted] {
            let here = peripersonal_m(form, None, &human.body_points_w(&x_wb, &q_rad), &robot);
            let there = peripersonal_m(form, None, &human.body_points_w(&x_wb_moved, &q_rad), &robot_moved);
            // Distances of order one from positions of order three.
            prop_assert!((here - there).abs() < 1e-13);
        }
    }
}

#[test]
fn the_tool_frame_stays_right_handed_on_either_side() {
    for hand in [Hand::Right, Hand::Left] {
        for kind in [OperationKind::Drill, OperationKind::Cut] {
            let x_bt = worker(hand, kind).tool_pose_b(&[0.0; 7]);
            let (x_t, y_t, z_t) = (x_bt * Vector3::x(), x_bt * Vector3::y(), x_bt * Vector3::z());
            assert_abs_diff_eq!(x_t.cross(&y_t), z_t, epsilon = 1e-15);
            // Hanging: the drill points down, the knife forward with its edge down, on both sides.
            let expected = if kind == OperationKind::Drill {
                (-Vector3::z(), Vector3::x())
            } else {
                (Vector3::x(), -Vector3::z())
            };
            assert_abs_diff_eq!(z_t, expected.0, epsilon = 1e-15);
            assert_abs_diff_eq!(x_t, expected.1, epsilon = 1e-15);
        }
    }
}

#[test]
fn the_shoulder_is_on_the_side_of_the_hand() {
    let right = worker(Hand::Right, OperationKind::Drill).x_bs();
    let left = worker(Hand::Left, OperationKind::Drill).x_bs();
    assert_abs_diff_eq!(right.translation.vector, Vector3::new(0.0, -0.22575, 1.4315), epsilon = 1e-12);
    assert_abs_diff_eq!(left.translation.vector, Vector3::new(0.0, 0.22575, 1.4315), epsilon = 1e-12);
}

#[test]
fn leaning_brings_the_shoulder_forward_about_the_hips() {
    let shoulder = leaning(Hand::Left, 15.0).x_bs();
    // 1.4315 - 0.9275 = 0.504 m over the hips: forward by 0.504 sin 15, down to 0.9275 + 0.504 cos 15.
    assert_abs_diff_eq!(shoulder.translation.vector, Vector3::new(0.130_445, 0.225_75, 1.414_327), epsilon = 1e-6);
    assert_abs_diff_eq!(shoulder.rotation * Vector3::z(), Vector3::new(0.258_819, 0.0, 0.965_926), epsilon = 1e-6);
}

#[test]
fn parts_above_the_hips_lean_and_the_legs_do_not() {
    let (upright, leaning) = (worker(Hand::Right, OperationKind::Drill), leaning(Hand::Right, 10.0));
    let (x_wb, q_rad) = (standing_pose_w(1.0, 0.2, 2.0, -0.9), [0.6, 0.3, 0.2, 1.2, 0.3, 0.1, 0.05]);
    let lean_w = x_wb * leaning.body().x_bv() * x_wb.inverse();
    for (up, lean) in upright.capsules_w(&x_wb, &q_rad).iter().zip(leaning.capsules_w(&x_wb, &q_rad)) {
        let is_leg = matches!(up.name, BodyPart::Thigh(_) | BodyPart::Shank(_));
        for (up, lean) in [(up.p0_w, lean.p0_w), (up.p1_w, lean.p1_w)] {
            let expected = if is_leg { up } else { lean_w * up };
            assert_abs_diff_eq!(lean, expected, epsilon = 1e-14);
        }
    }
    let hips_w_m = -0.9 + upright.body().hip_m;
    let mut moved = 0;
    for (up, lean) in upright.body_points_w(&x_wb, &q_rad).iter().zip(leaning.body_points_w(&x_wb, &q_rad)) {
        if (lean - up).norm() > 1e-12 {
            assert_abs_diff_eq!(lean, lean_w * up, epsilon = 1e-14);
            moved += 1;
        } else {
            assert!(up.z < hips_w_m);
        }
    }
    assert!((32..60).contains(&moved), "{moved}");
}

#[test]
fn kinematics_and_torques_of_a_leaning_person() {
    for hand in [Hand::Right, Hand::Left] {
        let (human, mut generator) = (leaning(hand, 12.0), generator(31));
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        for _ in 0..200 {
            let q_rad = random_angles(human.arm(), &mut generator);
            let x_bt = human.tool_pose_b(&q_rad);
            for solution in human.arm_solutions(&x_bt, human.swivel_rad(&q_rad)) {
                assert_abs_diff_eq!(human.tool_pose_b(&solution), x_bt, epsilon = 1e-12);
            }
            // The same arm on an upright body that is tipped as a whole.
            let (upright, tipped) = (worker(hand, OperationKind::Drill), x_wb * human.body().x_bv());
            let w = wrench([3.0, -7.0, 12.0, 0.3, 0.2, -0.5]);
            let found = human.joint_torques(&q_rad, &x_wb, &w).total_nm();
            for (found, expected) in found.iter().zip(upright.joint_torques(&q_rad, &tipped, &w).total_nm()) {
                // Torques of up to 50 N m, rounded some ten times.
                assert!((found - expected).abs() < 1e-12);
            }
        }
    }
    // The trunk leans by 15 degrees and the arm is flexed by as much, so upper arm and forearm hang vertically without torque.
    let lean_rad = 15_f64.to_radians();
    let hanging = [lean_rad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let torques = leaning(Hand::Right, 15.0).joint_torques(&hanging, &Pose::identity(), &Wrench::default());
    assert!(torques.gravity_nm.iter().all(|torque| torque.abs() < 1e-13), "{torques:?}");
}

#[test]
fn leaning_backward_or_too_far_is_an_error() {
    for lean_deg in [-1.0, 15.5, f64::NAN] {
        let person = Person { lean_deg, ..average_man() };
        let error = Human::new(&person, &default_tool(OperationKind::Drill)).unwrap_err();
        assert!(error.to_string().contains("lean_deg"), "{error}");
    }
}

#[test]
fn a_weaker_person_has_less_comfort_under_the_same_load() {
    let tool = default_tool(OperationKind::Drill);
    let x_wb = standing_pose_w(1.2, 0.0, PI, -0.9);
    let w = Wrench::from_force(Vector3::new(-15.0, 0.0, 0.0));
    let settings = ComfortSettings { muscular: MuscularMetric::Paper, ..Default::default() };
    let mut generator = generator(11);
    let man = Human::new(&average_man(), &tool).unwrap();
    let weak_man = Human::new(&Person { percentile: 5.0, ..average_man() }, &tool).unwrap();
    for _ in 0..100 {
        let q_rad = random_angles(man.arm(), &mut generator);
        let effort = |human: &Human| human.muscular(&q_rad, &x_wb, &w, &settings);
        let (strong, weak) = (effort(&man), effort(&weak_man));
        assert!(weak.printed < strong.printed);
        // z at 5 % is -1.644854: strengths fall to 1 - 0.277 x 1.644854 = 0.544375 in every joint.
        assert!((weak.printed / strong.printed / 0.544_375_f64.powi(2) - 1.0).abs() < 1e-5);
        assert!(strong.regularised < 100.0 && strong.regularised < strong.printed);
    }
}

#[test]
fn invalid_persons_and_tools_are_errors() {
    let tool = default_tool(OperationKind::Drill);
    let refused = |person: Person, tool: Tool| Human::new(&person, &tool).unwrap_err().to_string();
    let message = refused(Person { height_m: -1.75, ..average_man() }, tool);
    assert_eq!(message, "found -1.75 for the person's height_m, expected a positive number");
    assert!(refused(Person { mass_kg: f64::NAN, ..average_man() }, tool).contains("person's mass_kg"));
    for percentile in [0.0, 100.0, f64::NAN] {
        assert!(refused(Person { percentile, ..average_man() }, tool).contains("percentile"));
    }
    assert!(refused(average_man(), Tool { mass_kg: -0.1, ..tool }).contains("tool's mass_kg"));
    assert!(refused(average_man(), Tool { tip_h_m: [0.0, f64::INFINITY, 0.0], ..tool }).contains("tip_h_m"));
    assert!(refused(average_man(), Tool { rotation_xyzw: [0.0; 4], ..tool }).contains("unit length"));
    assert!(Human::new(&Person { sex: Sex::Female, ..average_man() }, &tool).is_ok());
}
