//! Contact models for the tests.

use std::path::Path;

use benchdog::{
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
        operation::Operation,
        plan::{ArmHold, PlacedObject},
        scenario::Limits,
        wrench::Wrench,
    },
    robot::{Chain, InverseKinematics, Robot},
    statics::{
        ContactModel, ContactModelError, HandModel, Hold, LoadFactor, LoadFactorOutcome, PadModel, PadPair,
        StabilityWorkspace, Twist,
    },
};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6xX, Rotation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Half sides of Baxter's pad, m.
pub const HALF_SIDES_M: [f64; 2] = [0.0202, 0.0180];

/// A pose with this z axis and the x axis closest to `x`.
pub fn facing(p: Vector3<f64>, z: Vector3<f64>, x: Vector3<f64>) -> Pose {
    let z = z.normalize();
    let x = (x - z * z.dot(&x)).normalize();
    let rotation = Rotation3::from_basis_unchecked(&[x, z.cross(&x), z]);
    Isometry3::from_parts(p.into(), UnitQuaternion::from_rotation_matrix(&rotation))
}

/// A hand at `p` whose pads press along `-axis` and `+axis`, `thickness_m` apart, x_P along `x`. Its arm has six joints
/// that move the grasp point along and about the axes of O, with stiffness 1000 N/m and 1000 N m/rad and torque limits
/// that no test reaches.
pub fn strong_hand(
    name: &str,
    p: Vector3<f64>,
    axis: Vector3<f64>,
    x: Vector3<f64>,
    grip_n: f64,
    friction: f64,
    thickness_m: f64,
) -> HandModel {
    let pad = |pad_name: &str, side: f64| PadModel {
        name: pad_name.into(),
        x_op: facing(p + axis * (side * thickness_m / 2.0), -axis * side, x),
        half_sides_m: HALF_SIDES_M,
        friction,
        stiffness_n_m: None,
    };
    HandModel {
        name: name.into(),
        joints: (0..6).map(|joint| format!("{name}_{joint}")).collect(),
        hold: Hold::Pads(PadPair { pads: [pad("upper", 1.0), pad("lower", -1.0)], grip_force_n: grip_n }),
        grasp_point_o: p,
        jacobian_o: Matrix6xX::identity(6),
        gravity_torque_nm: DVector::zeros(6),
        effort_nm: DVector::from_element(6, 1e4),
        stiffness_nm_rad: DVector::from_element(6, 1e3),
        gravity_stiffness_nm_rad: DMatrix::zeros(6, 6),
        offset: Twist::default(),
    }
}

/// Sets the grip force of a hand with pads, N.
pub fn set_grip(hand: &mut HandModel, force_n: f64) {
    let now_n = hand.pad_pair().unwrap().grip_force_n;
    hand.scale_grip(force_n / now_n);
}

/// A board of 0.5 x 0.4 x 0.03 m held on two opposite edges by strong hands, pads on its faces.
pub fn two_strong_hands(weight: Wrench, load: Wrench) -> ContactModel {
    let hand =
        |name: &str, x: f64| strong_hand(name, Vector3::new(x, 0.0, 0.0), Vector3::z(), Vector3::y(), 30.0, 0.6, 0.03);
    ContactModel {
        hands: vec![hand("left", 0.23), hand("right", -0.23)],
        weight,
        load,
        p_ot: Vector3::new(0.1, 0.1, 0.015),
    }
}

/// A board of 0.21 kg under a random load, held by `hands` arms with seven random joints at random places of its rim.
/// Torque limits and gravity torques are large enough to matter.
pub fn random_hold(seed: u64, hands: usize) -> ContactModel {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| rng.random_range(-size..size));
    let arms = (0..hands)
        .map(|number| {
            let angle = std::f64::consts::TAU * number as f64 / hands as f64;
            let p = Vector3::new(0.22 * angle.cos(), 0.18 * angle.sin(), 0.0)
                + vector(0.02).component_mul(&Vector3::new(1.0, 1.0, 0.0));
            let mut hand = strong_hand(&format!("hand{number}"), p, Vector3::z(), vector(1.0), 30.0, 0.6, 0.03);
            hand.joints = (0..7).map(|joint| format!("hand{number}_{joint}")).collect();
            hand.jacobian_o = Matrix6xX::zeros(7);
            hand.gravity_stiffness_nm_rad = DMatrix::zeros(7, 7);
            for joint in 0..7 {
                let axis = vector(1.0).normalize();
                // The first joints at arm's length, the last ones near the hand.
                let lever = vector(0.8 / (1.0 + joint as f64));
                let mut column = hand.jacobian_o.column_mut(joint);
                column.fixed_rows_mut::<3>(0).copy_from(&axis.cross(&lever));
                column.fixed_rows_mut::<3>(3).copy_from(&axis);
            }
            hand.gravity_torque_nm = DVector::from_fn(7, |joint, _| vector(6.0 / (1.0 + joint as f64)).x);
            hand.effort_nm = DVector::from_row_slice(&[50.0, 100.0, 50.0, 50.0, 15.0, 15.0, 15.0]);
            hand.stiffness_nm_rad = DVector::from_row_slice(&[843.0, 843.0, 843.0, 843.0, 250.0, 250.0, 250.0]);
            hand
        })
        .collect();
    let p_ot = Vector3::new(vector(0.12).x, vector(0.12).y, 0.015);
    let load = Wrench::from_force(vector(25.0)).about(&p_ot);
    ContactModel { hands: arms, weight: Wrench::from_force(vector(1.0).normalize() * 2.06), load, p_ot }
}

/// The load factor of a contact model that has one.
pub fn solved(hold: &ContactModel) -> LoadFactor {
    match StabilityWorkspace::new().load_factor(hold).unwrap() {
        LoadFactorOutcome::Solved(solved) => solved,
        other => panic!("expected a load factor, found {other:?}"),
    }
}

/// docs/method.md#810-default-limits.
pub fn limits() -> Limits {
    Limits::CUT
}

/// The same contact model in another frame O', `p_o' = x * p_o`.
pub fn moved(hold: &ContactModel, x: &Pose) -> ContactModel {
    let mut moved = hold.clone();
    for hand in &mut moved.hands {
        hand.grasp_point_o = (x * nalgebra::Point3::from(hand.grasp_point_o)).coords;
        hand.pads_mut().iter_mut().for_each(|pad| pad.x_op = x * pad.x_op);
        if let Hold::Measured(measured) = &mut hand.hold {
            measured.rotation_og = x.rotation * measured.rotation_og;
        }
        for mut column in hand.jacobian_o.column_iter_mut() {
            let linear = x.rotation * Vector3::new(column[0], column[1], column[2]);
            let angular = x.rotation * Vector3::new(column[3], column[4], column[5]);
            column.fixed_rows_mut::<3>(0).copy_from(&linear);
            column.fixed_rows_mut::<3>(3).copy_from(&angular);
        }
    }
    moved.weight = hold.weight.moved(x);
    moved.load = hold.load.moved(x);
    moved.p_ot = (x * nalgebra::Point3::from(hold.p_ot)).coords;
    moved
}

/// The same contact model with every force, moment, torque and stiffness times `factor`.
pub fn stronger(hold: &ContactModel, factor: f64) -> ContactModel {
    let mut stronger = hold.clone();
    for hand in &mut stronger.hands {
        hand.scale_grip(factor);
        hand.gravity_torque_nm *= factor;
        hand.effort_nm *= factor;
        hand.stiffness_nm_rad *= factor;
        hand.gravity_stiffness_nm_rad *= factor;
        hand.pads_mut()
            .iter_mut()
            .filter_map(|pad| pad.stiffness_n_m.as_mut())
            .for_each(|stiffness| *stiffness *= factor);
    }
    stronger.weight = hold.weight.scaled(factor);
    stronger.load = hold.load.scaled(factor);
    stronger
}

/// Grasps of a board by Baxter at poses that both arms reach: arms, board, operation.
pub fn baxter_holds(count: usize, seed: u64) -> (Robot, Vec<(Vec<ArmHold>, PlacedObject, Operation)>) {
    let robot = Robot::load("baxter", Path::new(".")).unwrap();
    let mut rng = Pcg64::seed_from_u64(seed);
    let size_m = [0.5, 0.4, 0.03];
    let chains: Vec<_> =
        (0..2).map(|arm| Chain::new(&robot, arm, robot.arms[arm].gripper.travel_for_gap_m(0, size_m[2]))).collect();
    let mut holds = Vec::new();
    while holds.len() < count {
        let turn = UnitQuaternion::from_euler_angles(
            rng.random_range(-0.6..0.6),
            std::f64::consts::FRAC_PI_2 + rng.random_range(-0.6..0.6),
            rng.random_range(-0.4..0.4),
        );
        let p = Vector3::new(rng.random_range(0.45..0.6), rng.random_range(-0.05..0.05), rng.random_range(0.1..0.5));
        let x_wo = Isometry3::from_parts(p.into(), turn);
        let along_m = rng.random_range(-0.1..0.1);
        let arms: Option<Vec<_>> = [("left", Edge::PLUS_Y), ("right", Edge::MINUS_Y)]
            .into_iter()
            .enumerate()
            .map(|(number, (name, edge))| {
                let grasp = EdgeGrasp { edge, along_m, depth_m: 0.035, angle_rad: 0.0, flipped: rng.random_bool(0.5) };
                let x_og = grasp.x_og(&BoardShape::cuboid(size_m));
                let chain = &chains[number];
                let q_rad = InverseKinematics::for_chain(chain).samples(&(x_wo * x_og), 16).into_iter().next()?;
                let joints = robot.arms[number].joints.iter().map(|&j| robot.joints[j].name.clone()).collect();
                Some(ArmHold { name: name.into(), joints, q_rad, x_og, grip_force_n: 30.0 })
            })
            .collect();
        let Some(arms) = arms else { continue };
        let object = PlacedObject::cuboid(size_m, 0.21, x_wo);
        let operation = if holds.len() % 2 == 0 {
            Operation::drill([rng.random_range(-0.1..0.1), rng.random_range(-0.1..0.1)], 15.0, size_m[2])
        } else {
            let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            let point = [0.12 * angle.cos(), 0.12 * angle.sin()];
            Operation::cut(point, Vector3::new(-angle.sin(), angle.cos(), 0.0), 30.0, size_m[2])
        };
        holds.push((arms, object, operation));
    }
    (robot, holds)
}

/// The contact model of arms that hold a board, without the check of a plan: grasps may be off the arms' kinematics.
pub fn contact_model(
    robot: &Robot,
    arms: &[ArmHold],
    object: &PlacedObject,
    operation: &Operation,
    friction: f64,
) -> Result<ContactModel, ContactModelError> {
    let hand = |hold: &ArmHold| {
        let index = robot.arm_index(&hold.name).unwrap();
        let arm = &robot.arms[index];
        let chain = Chain::new(robot, index, arm.gripper.travel_for_gap_m(0, object.size_m[2]));
        HandModel::new(arm, &chain, hold, object, friction)
    };
    let hands: Result<Vec<_>, _> = arms.iter().map(hand).collect();
    Ok(ContactModel::from_hands(hands?, object, operation))
}
