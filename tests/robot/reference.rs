//! The built-in Baxter against an independent rigid-body library, and laws that hold for every chain.

use benchdog::{
    model::GRAVITY_W,
    robot::{ArmState, Chain, Robot},
};
use nalgebra::{DVector, Matrix3, Matrix6xX, Point3, Vector3};
use proptest::prelude::*;
use serde::Deserialize;

use crate::{
    chains::{mirrored, posture},
    common::{baxter, root},
};

/// The file's numbers and ours are both rounded at 1e-16 of about 1 m; seven joints and the six digits less of the
/// source's quarter turns (5e-12) stay well below this.
const KINEMATIC_TOLERANCE: f64 = 1e-9;

/// The source's quarter turns (5e-12 rad) on 200 N of arm at 1 m, with room.
const GRAVITY_TOLERANCE_NM: f64 = 1e-6;

/// The inertias are written with six digits, 5e-8 kg m^2 for the largest, and up to seven add up.
const INERTIA_TOLERANCE_KG_M2: f64 = 2e-7;

#[derive(Deserialize)]
struct Reference {
    left: Vec<Sample>,
    right: Vec<Sample>,
}

#[derive(Deserialize)]
struct Sample {
    q_rad: Vec<f64>,
    p_m: [f64; 3],
    r: [[f64; 3]; 3],
    jacobian: Vec<Vec<f64>>,
    g_no_gripper_nm: Vec<f64>,
    m_diag_no_gripper: Vec<f64>,
}

fn chain(robot: &Robot, arm: &str) -> Chain {
    Chain::new(robot, robot.arm_index(arm).unwrap(), 0.0)
}

fn reference() -> [(&'static str, Vec<Sample>); 2] {
    let text = std::fs::read_to_string(root().join("tests/data/baxter_reference.json")).unwrap();
    let reference: Reference = serde_json::from_str(&text).unwrap();
    [("left", reference.left), ("right", reference.right)]
}

/// Baxter without the masses of its grippers: the `inertial` elements of all links of the grippers are cut out.
fn baxter_without_gripper_masses() -> Robot {
    let urdf = include_str!("../../assets/baxter.urdf");
    let mut stripped = String::new();
    let (mut in_gripper, mut in_inertial) = (false, false);
    for line in urdf.lines() {
        if line.contains("<link name=") {
            in_gripper = line.contains("gripper");
        }
        in_inertial |= line.contains("<inertial>");
        if !(in_gripper && in_inertial) {
            stripped += line;
            stripped += "\n";
        }
        in_inertial &= !line.contains("</inertial>");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("baxter.urdf"), stripped).unwrap();
    std::fs::write(folder.path().join("bare.toml"), include_str!("../../assets/baxter.toml")).unwrap();
    Robot::load("bare.toml", folder.path()).unwrap()
}

#[test]
fn kinematics_agree_with_the_reference() {
    let robot = baxter();
    for (arm, samples) in reference() {
        let chain = chain(robot, arm);
        assert_eq!(samples.len(), 20);
        for sample in samples {
            let x_wg = chain.gripper_pose(&sample.q_rad);
            assert!((x_wg.translation.vector - Vector3::from(sample.p_m)).amax() < KINEMATIC_TOLERANCE);
            let expected = Matrix3::from_fn(|row, column| sample.r[row][column]);
            assert!((x_wg.rotation.to_rotation_matrix().matrix() - expected).amax() < KINEMATIC_TOLERANCE);
            let expected = Matrix6xX::from_fn(7, |row, column| sample.jacobian[row][column]);
            assert!((chain.jacobian_w(&sample.q_rad) - expected).amax() < KINEMATIC_TOLERANCE);
        }
    }
}

#[test]
fn gravity_and_inertia_agree_with_the_reference() {
    let robot = &baxter_without_gripper_masses();
    for (arm, samples) in reference() {
        let chain = chain(robot, arm);
        for sample in samples {
            let expected = DVector::from_vec(sample.g_no_gripper_nm);
            assert!((chain.gravity_torque_nm(&sample.q_rad) - expected).amax() < GRAVITY_TOLERANCE_NM);
            let expected = DVector::from_vec(sample.m_diag_no_gripper);
            assert!((chain.mass_matrix(&sample.q_rad).diagonal() - expected).amax() < INERTIA_TOLERANCE_KG_M2);
        }
    }
}

#[test]
fn the_chain_agrees_with_the_tree() {
    let robot = baxter();
    for (arm, samples) in reference() {
        let arm_index = robot.arm_index(arm).unwrap();
        let chain = chain(robot, arm);
        for sample in samples {
            let state = ArmState { arm: arm_index, q_rad: &sample.q_rad, finger_travel_m: [0.0; 2] };
            let x_wl = robot.link_poses(&robot.positions(&[state]));
            let x_wg = x_wl[robot.arms[arm_index].gripper.frame_link];
            // The same products in another order: rounding only.
            assert!((x_wg.to_homogeneous() - chain.gripper_pose(&sample.q_rad).to_homogeneous()).amax() < 1e-13);
            for (joint, x_wj) in robot.arms[arm_index].joints.iter().zip(chain.joint_frames(&sample.q_rad)) {
                let x_wl = x_wl[robot.joints[*joint].child_link];
                assert!((x_wl.to_homogeneous() - x_wj.to_homogeneous()).amax() < 1e-13);
            }
        }
    }
}

#[test]
fn pads_meet_and_open_as_the_figures_say() {
    let robot = baxter();
    for (arm_index, arm) in robot.arms.iter().enumerate() {
        let gripper = &arm.gripper;
        for (number, finger) in gripper.fingers.iter().enumerate() {
            let name = if number == 0 { "l_finger" } else { "r_finger" };
            assert_eq!(finger.pad.name, name);
            // Pad face at y = +-(travel - 0.00185): sums of decimals, rounding only.
            assert!((finger.pad.offset_m + 0.00185).abs() < 1e-15);
            let side = if number == 0 { 1.0 } else { -1.0 };
            let travel_m = gripper.travel_for_gap_m(number, 0.030);
            assert!((travel_m - 0.01685).abs() < 1e-15);
            let state = ArmState { arm: arm_index, q_rad: &[0.0; 7], finger_travel_m: [travel_m; 2] };
            let x_wl = robot.link_poses(&robot.positions(&[state]));
            let x_gp = x_wl[gripper.frame_link].inverse() * x_wl[finger.pad.link];
            // The inner face of the tip is 8.1 mm inside the tip's frame.
            let face = x_gp * Point3::new(0.0, -0.0081 * side, 0.0);
            assert!((face.y - side * 0.015).abs() < 1e-12);
        }
    }
}

#[test]
fn heavy_hands_weigh_on_the_arm() {
    let (with, without) = (baxter(), &baxter_without_gripper_masses());
    for arm in ["left", "right"] {
        let q_rad = [0.0; 7];
        let (mass_with, _) = chain(with, arm).mass_and_moment_w(&q_rad);
        let (mass_without, _) = chain(without, arm).mass_and_moment_w(&q_rad);
        // The published masses of the arm with and without its gripper, in g as far as they are written.
        assert!((mass_with - 20.072).abs() < 5e-4, "{mass_with}");
        assert!((mass_without - 19.712).abs() < 5e-4, "{mass_without}");
    }
}

#[test]
fn body_points_lie_on_the_surface() {
    let robot = baxter();
    assert_eq!(robot.body_points.len(), 56);
    for point in &robot.body_points {
        let link = &robot.links[point.link];
        let nearest = link.shapes.iter().map(|placed| {
            let p_s = placed.x_ls.inverse() * point.p_l;
            surface_distance(&placed.shape, &p_s.coords).abs()
        });
        // Points lie on the middle plane of their link, the primitives up to 0.1 mm beside it.
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest < 2e-4, "{} at {}: {nearest}", link.name, point.p_l);
    }
}

/// Signed distance to the surface for points near a face; exact enough at edges for a bound of 0.2 mm.
fn surface_distance(shape: &benchdog::robot::Shape, p_s: &Vector3<f64>) -> f64 {
    use benchdog::robot::Shape;
    match *shape {
        Shape::Hull(_) => unreachable!("Baxter has primitives only"),
        Shape::Box { half_m } => (p_s.abs() - Vector3::from(half_m)).max(),
        Shape::Cylinder { radius_m, half_length_m } => (p_s.xy().norm() - radius_m).max(p_s.z.abs() - half_length_m),
        Shape::Sphere { radius_m } => p_s.norm() - radius_m,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_jacobian_is_the_derivative_of_the_pose(q_rad in posture()) {
        let robot = baxter();
        let chain = chain(robot, "right");
        let jacobian = chain.jacobian_w(&q_rad);
        let step = 1e-6;
        for joint in 0..7 {
            let (mut before, mut after) = (q_rad.clone(), q_rad.clone());
            before[joint] -= step;
            after[joint] += step;
            let (before, after) = (chain.gripper_pose(&before), chain.gripper_pose(&after));
            let linear = (after.translation.vector - before.translation.vector) / (2.0 * step);
            let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * step);
            // Central differences: step^2 from the third derivative, 1e-16 / step from rounding.
            prop_assert!((jacobian.fixed_view::<3, 1>(0, joint) - linear).amax() < 1e-8);
            prop_assert!((jacobian.fixed_view::<3, 1>(3, joint) - angular).amax() < 1e-8);
        }
    }

    #[test]
    fn gravity_is_the_gradient_of_the_potential_energy(q_rad in posture()) {
        let robot = baxter();
        let chain = chain(robot, "left");
        let energy_j = |q_rad: &[f64]| -chain.mass_and_moment_w(q_rad).1.dot(&GRAVITY_W);
        let gravity = chain.gravity_torque_nm(&q_rad);
        let step = 1e-5;
        for joint in 0..7 {
            let (mut before, mut after) = (q_rad.clone(), q_rad.clone());
            before[joint] -= step;
            after[joint] += step;
            let slope = (energy_j(&after) - energy_j(&before)) / (2.0 * step);
            // 60 N m x step^2 from the third derivative; 200 J x 1e-16 / step from rounding.
            prop_assert!((gravity[joint] - slope).abs() < 5e-8);
        }
    }

    #[test]
    fn the_arms_mirror_each_other(q_rad in posture()) {
        let robot = baxter();
        let (left, right) = (chain(robot, "left"), chain(robot, "right"));
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        let (x_wl, x_wr) = (left.gripper_pose(&q_rad), right.gripper_pose(&mirrored(&q_rad)));
        prop_assert!((mirror * x_wl.translation.vector - x_wr.translation.vector).amax() < 1e-12);
        let rotation = mirror * x_wl.rotation.to_rotation_matrix().matrix() * mirror;
        prop_assert!((rotation - x_wr.rotation.to_rotation_matrix().matrix()).amax() < 1e-12);
    }

    #[test]
    fn body_points_mirror_each_other(q_rad in posture()) {
        let robot = baxter();
        let right = mirrored(&q_rad);
        let travel = [0.01; 2];
        let states = [
            ArmState { arm: robot.arm_index("left").unwrap(), q_rad: &q_rad, finger_travel_m: travel },
            ArmState { arm: robot.arm_index("right").unwrap(), q_rad: &right, finger_travel_m: travel },
        ];
        let x_wl = robot.link_poses(&robot.positions(&states));
        let points: Vec<_> = robot.body_points.iter().map(|point| x_wl[point.link] * point.p_l).collect();
        for p_w in &points {
            let image = Point3::new(p_w.x, -p_w.y, p_w.z);
            let nearest = points.iter().map(|other| (other - image).norm()).fold(f64::INFINITY, f64::min);
            // Mirrored arms are exact images of each other, the mounts' 0.7854 included: rounding only.
            prop_assert!(nearest < 1e-9, "{nearest}");
        }
    }

    #[test]
    fn the_inertia_is_symmetric_and_positive(q_rad in posture()) {
        let robot = baxter();
        let mass = chain(robot, "left").mass_matrix(&q_rad);
        prop_assert!((&mass - mass.transpose()).amax() < 1e-14);
        prop_assert!(mass.cholesky().is_some());
    }
}
