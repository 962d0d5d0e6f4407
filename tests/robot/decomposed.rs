//! The closed form of arms that decompose into position and rotation.

use std::f64::consts::{PI, TAU};

use benchdog::robot::{
    Chain, InverseKinematics,
    inverse::{Decomposed, General},
};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use crate::{
    chains::{assert_solves, distance_rad},
    serial::{IIWA, INDUSTRIAL, Line, PANDA, UR5, chain},
};

const AT_ORIGIN: [[f64; 3]; 2] = [[0.0; 3]; 2];

/// Just below half a turn, so that every posture has one representation.
const LIMIT_RAD: f64 = 3.1;

/// The same arm from gripper to base.
fn reversed<const N: usize>(axes: &[Line; N]) -> [Line; N] {
    let mut axes = *axes;
    axes.reverse();
    axes
}

/// Arms of six joints, each also from the gripper to the base.
fn six_joints() -> Vec<(&'static str, [Line; 6])> {
    vec![
        ("ur5", UR5),
        ("ur5 reversed", reversed(&UR5)),
        ("industrial", INDUSTRIAL),
        ("industrial reversed", reversed(&INDUSTRIAL)),
    ]
}

fn seven_joints() -> Vec<(&'static str, [Line; 7])> {
    vec![("panda", PANDA), ("panda reversed", reversed(&PANDA)), ("iiwa", IIWA)]
}

fn random_posture(chain: &Chain, generator: &mut rand_pcg::Pcg64) -> Vec<f64> {
    let limits = chain.lower().iter().zip(chain.upper());
    limits.map(|(lower, upper)| generator.random_range(*lower..*upper)).collect()
}

/// The free joint's angle in a posture; any number without a free joint.
fn free_rad(arm: &Decomposed, q_rad: &[f64]) -> f64 {
    arm.free_joint().map_or(0.0, |joint| q_rad[joint])
}

/// The distance of a posture from the nearest of some, rad.
fn nearest_rad(solutions: &[Vec<f64>], q_rad: &[f64]) -> f64 {
    solutions.iter().map(|found| distance_rad(found, q_rad)).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_closed_form_is_chosen_by_geometry() {
    let free_joint = |axes: &[Line]| {
        let chain = chain(axes, AT_ORIGIN, LIMIT_RAD);
        match InverseKinematics::for_chain(&chain) {
            InverseKinematics::Decomposed(arm) => Some(arm.free_joint()),
            InverseKinematics::ClosedForm(_) | InverseKinematics::General(_) => None,
        }
    };
    for (name, axes) in six_joints() {
        assert_eq!(free_joint(&axes), Some(None), "{name}");
    }
    assert_eq!([free_joint(&PANDA), free_joint(&IIWA)], [Some(Some(6)); 2]);
    assert_eq!(free_joint(&reversed(&PANDA)), Some(Some(0)));
    // An axis of the wrist that passes 1 mm beside the others, and five joints.
    let mut beside = INDUSTRIAL;
    beside[4].0[2] += 1e-3;
    assert_eq!([free_joint(&beside), free_joint(&UR5[..5])], [None; 2]);
}

/// Solutions of poses of drawn postures: the drawn one is among them, and all are solutions within the limits.
#[test]
fn the_drawn_posture_is_among_the_solutions() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(5);
    let six = six_joints().into_iter().map(|(name, axes)| (name, axes.to_vec()));
    let seven = seven_joints().into_iter().map(|(name, axes)| (name, axes.to_vec()));
    for (name, axes) in six.chain(seven) {
        let chain = chain(&axes, AT_ORIGIN, LIMIT_RAD);
        let arm = Decomposed::new(&chain).unwrap();
        for number in 0..300 {
            let q_rad = random_posture(&chain, &mut generator);
            let target = chain.gripper_pose(&q_rad);
            let solutions = arm.slice(&target, free_rad(&arm, &q_rad));
            // A residual of 1e-9 over the smallest singular value, rarely below 1e-4.
            let distance = nearest_rad(&solutions, &q_rad);
            assert!(distance < 1e-5, "{name} {number}: {distance} {q_rad:?}");
            assert!(solutions.len() <= 8, "{name}: at most two solutions of each of three equations");
            solutions.iter().for_each(|found| assert_solves(&chain, &target, found));
        }
    }
}

/// Damped least squares from many starts finds no solution that the closed form misses.
#[test]
fn no_branch_is_missed() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(6);
    for (name, axes) in six_joints() {
        let chain = chain(&axes, AT_ORIGIN, LIMIT_RAD);
        let (arm, general) = (Decomposed::new(&chain).unwrap(), General::new(&chain));
        let mut most = 0;
        for _ in 0..12 {
            let target = chain.gripper_pose(&random_posture(&chain, &mut generator));
            let solutions = arm.slice(&target, 0.0);
            for found in general.solutions(&target, 150) {
                assert!(nearest_rad(&solutions, &found) < 1e-5, "{name}: {found:?}");
            }
            most = most.max(solutions.len());
        }
        assert!(most >= 4, "{name}: {most}");
    }
}

/// The branches of seven joints contain drawn postures, and what other solvers find.
#[test]
fn drawn_postures_are_on_the_branches() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(7);
    for (name, axes) in seven_joints() {
        let chain = chain(&axes, AT_ORIGIN, 2.8);
        let inverse = InverseKinematics::for_chain(&chain);
        let arm = Decomposed::new(&chain).unwrap();
        for number in 0..20 {
            let q_rad = random_posture(&chain, &mut generator);
            let target = chain.gripper_pose(&q_rad);
            let motion = arm.branches(&target).unwrap();
            let holds = |q_rad: &[f64]| motion.branches().iter().any(|branch| branch.contains(q_rad, 1e-5));
            assert!(holds(&q_rad), "{name} {number}: {q_rad:?}");
            for found in arm.samples(&target, 5) {
                assert_solves(&chain, &target, &found);
                assert!(holds(&found), "{name} {number}: {found:?}");
            }
            inverse.all(&target, 0).iter().for_each(|found| assert_solves(&chain, &target, found));
        }
    }
}

#[test]
fn the_place_of_the_base_does_not_matter() {
    let base = [[0.3, -0.2, 0.5], [0.4, -0.7, 2.0]];
    let x_wb = Isometry3::from_parts(
        Translation3::from(Vector3::from(base[0])),
        UnitQuaternion::from_euler_angles(base[1][0], base[1][1], base[1][2]),
    );
    let mut generator = rand_pcg::Pcg64::seed_from_u64(8);
    for axes in [&UR5[..], &INDUSTRIAL, &PANDA] {
        let [here, there] = [AT_ORIGIN, base].map(|base| chain(axes, base, LIMIT_RAD));
        let [of_here, of_there] = [&here, &there].map(|chain| Decomposed::new(chain).unwrap());
        for _ in 0..50 {
            let q_rad = random_posture(&here, &mut generator);
            let target = here.gripper_pose(&q_rad);
            let free_rad = free_rad(&of_here, &q_rad);
            let [here, there] = [of_here.slice(&target, free_rad), of_there.slice(&(x_wb * target), free_rad)];
            assert_eq!(here.len(), there.len());
            here.iter().for_each(|found| assert!(nearest_rad(&there, found) < 1e-5));
        }
    }
}

/// Straight wrists and elbows, folded elbows, a wrist above the first axis: a solution is found, though some are not isolated.
#[test]
fn singular_postures_have_a_solution() {
    let straight = |axes: &[Line], q_rad: &[f64]| {
        let chain = chain(axes, AT_ORIGIN, LIMIT_RAD);
        let arm = Decomposed::new(&chain).unwrap();
        let target = chain.gripper_pose(q_rad);
        let solutions = arm.slice(&target, free_rad(&arm, q_rad));
        assert!(!solutions.is_empty(), "{q_rad:?}");
        solutions.iter().for_each(|found| assert_solves(&chain, &target, found));
    };
    straight(&INDUSTRIAL, &[0.4, 0.5, 0.3, 0.7, 0.0, 0.2]);
    straight(&UR5, &[0.4, -0.9, 1.2, 0.3, 0.0, 0.6]);
    straight(&UR5, &[0.4, -0.9, 0.0, 0.3, 1.1, 0.6]);
    straight(&PANDA, &[0.4, 0.0, 0.3, -1.2, 0.5, 1.3, 0.2]);
    straight(&IIWA, &[0.4, 0.6, 0.3, -1.2, 0.5, 0.0, 0.2]);
    // Nearly so: the angles are still those of the posture, as far as they are determined.
    straight(&INDUSTRIAL, &[0.4, 0.5, 0.3, 0.7, 1e-7, 0.2]);
    straight(&UR5, &[0.4, -0.9, 1e-7, 0.3, 1.1, 0.6]);
}

#[test]
fn limits_hold_and_include_their_ends() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(9);
    for axes in [&UR5[..], &INDUSTRIAL, &PANDA] {
        let chain = chain(axes, AT_ORIGIN, 1.5);
        let arm = Decomposed::new(&chain).unwrap();
        for number in 0..60 {
            let mut q_rad = random_posture(&chain, &mut generator);
            let joint = number % q_rad.len();
            q_rad[joint] = if number % 2 == 0 { chain.lower()[joint] } else { chain.upper()[joint] };
            let target = chain.gripper_pose(&q_rad);
            let solutions = arm.slice(&target, free_rad(&arm, &q_rad));
            assert!(nearest_rad(&solutions, &q_rad) < 1e-5, "{number}");
            solutions.iter().for_each(|found| assert_solves(&chain, &target, found));
        }
    }
    // Of joints that turn twice, the turn about the middle.
    let wide = chain(&UR5, AT_ORIGIN, TAU);
    let target = wide.gripper_pose(&[0.3, -1.0, 1.4, -0.8, 1.2, 0.5]);
    let solutions = Decomposed::new(&wide).unwrap().slice(&target, 0.0);
    assert!(solutions.len() >= 4);
    assert!(solutions.iter().flatten().all(|q| q.abs() <= PI));
}

#[test]
fn what_has_no_solution_has_none() {
    for axes in [&UR5[..], &INDUSTRIAL, &PANDA] {
        let chain = chain(axes, AT_ORIGIN, LIMIT_RAD);
        let arm = Decomposed::new(&chain).unwrap();
        assert!(arm.samples(&Isometry3::translation(5.0, 0.0, 0.0), 8).is_empty());
        assert!(arm.samples(&Isometry3::translation(f64::NAN, 0.0, 0.0), 8).is_empty());
        assert!(arm.slice(&chain.gripper_pose(&vec![0.5; axes.len()]), f64::NAN).is_empty());
        let none = arm.branches(&Isometry3::translation(5.0, 0.0, 0.0));
        assert!(none.is_none_or(|motion| motion.branches().is_empty()));
    }
}

/// A direction.
fn direction() -> impl Strategy<Value = [f64; 3]> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_filter_map("long enough to normalise", |v| {
        let v = Vector3::from(v);
        (v.norm() > 0.3).then(|| v.normalize().into())
    })
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [-0.4..0.4, -0.4..0.4, -0.4..0.4_f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Drawn arms of every kind, with axes at any angles, and drawn postures: where the posture is not singular it is found.
    #[test]
    fn drawn_arms_are_solved(
        points in [point(), point(), point(), point()],
        along in [direction(), direction(), direction(), direction(), direction(), direction()],
        kind in 0..5_usize, backward in any::<bool>(), q_rad in prop::array::uniform6(-3.0..3.0_f64),
    ) {
        let [a, b, c, centre] = points;
        let wrist = [(centre, along[3]), (centre, along[4]), (centre, along[5])];
        let mut axes = match kind {
            0 => [(a, along[0]), (a, along[1]), (b, along[2]), wrist[0], wrist[1], wrist[2]],
            1 => [(a, along[0]), (b, along[1]), (b, along[2]), wrist[0], wrist[1], wrist[2]],
            2 => [(a, along[0]), (b, along[0]), (c, along[2]), wrist[0], wrist[1], wrist[2]],
            3 => [(a, along[0]), (b, along[1]), (c, along[1].map(|v| -v)), wrist[0], wrist[1], wrist[2]],
            _ => {
                let [p, q, _] = wrist;
                [(a, along[0]), (b, along[1]), (c, along[1].map(|v| -v)), ([0.3; 3], along[1]), p, q]
            }
        };
        if backward {
            axes.reverse();
        }
        let chain = chain(&axes, AT_ORIGIN, LIMIT_RAD);
        let arm = Decomposed::new(&chain).expect("its structure");
        let singular_values = chain.jacobian_w(&q_rad).singular_values();
        // Two solutions merge there, or Newton's method does not settle.
        prop_assume!(singular_values.min() > 5e-3);
        let target = chain.gripper_pose(&q_rad);
        let solutions = arm.slice(&target, 0.0);
        prop_assert!(nearest_rad(&solutions, &q_rad) < 1e-5, "{:?}", solutions);
        for found in &solutions {
            assert_solves(&chain, &target, found);
        }
    }
}

/// A quarter turn with five decimals moves the axes by 4e-6: the solutions are exact all the same.
#[test]
fn axes_that_meet_only_to_five_decimals_are_polished() {
    let mut axes = PANDA;
    let tilt = 4e-6;
    axes[2].1 = [tilt, 0.0, 1.0];
    axes[5].1 = [0.0, -1.0, tilt];
    let chain = chain(&axes, AT_ORIGIN, LIMIT_RAD);
    let arm = Decomposed::new(&chain).unwrap();
    let mut generator = rand_pcg::Pcg64::seed_from_u64(10);
    let mut tested = 0;
    for _ in 0..100 {
        let q_rad = random_posture(&chain, &mut generator);
        // Next to a singularity an error of the axes moves the angles by its square root, so Newton's method may settle elsewhere.
        if chain.jacobian_w(&q_rad).columns(0, 6).singular_values().min() < 1e-2 {
            continue;
        }
        tested += 1;
        let target = chain.gripper_pose(&q_rad);
        let solutions = arm.slice(&target, q_rad[6]);
        assert!(solutions.iter().any(|found| distance_rad(found, &q_rad) < 1e-2), "{q_rad:?}");
        solutions.iter().for_each(|found| assert_solves(&chain, &target, found));
    }
    assert!(tested > 60, "{tested}");
}
