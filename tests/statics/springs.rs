//! The arms' springs in closed form: gravity stiffness, the weight that is fed forward, and pads that share a hand's wrench.

use benchdog::{
    model::wrench::Wrench,
    statics::{
        CompliantResponse, ContactModel, EquilibriumOutcome, EquilibriumSolver, HandWrench, ResponseOutcome,
        StabilityWorkspace,
    },
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::fixtures::{HALF_SIDES_M, two_strong_hands};

/// Friction and grip force of [`two_strong_hands`].
const FRICTION: f64 = 0.6;
const GRIP_N: f64 = 30.0;

/// Rounding of the closed form, whose numbers are below 100.
const ROUNDING: f64 = 1e-12;

fn response(hold: &ContactModel, load_factor: f64) -> CompliantResponse {
    match StabilityWorkspace::new().response(hold, load_factor).unwrap() {
        ResponseOutcome::Found(response) => *response,
        other => panic!("expected an equilibrium, found {other:?}"),
    }
}

/// What is missing from the balance of the board: the sum of all wrenches on it about O's origin.
fn unbalanced(hold: &ContactModel, hand_wrenches: &[HandWrench], load_factor: f64) -> f64 {
    let pads = hold.hands.iter().zip(hand_wrenches).flat_map(|(hand, wrench)| hand.pads().iter().zip(wrench.of_pads()));
    let outer = hold.weight + hold.load.scaled(load_factor);
    pads.fold(outer, |sum, (pad, wrench)| sum + pad.wrench_about_object(wrench)).to_vector().norm()
}

/// Control of 1000 N m/rad along x, `dg/dq` of 250 N m/rad and 3 N m of gravity torque.
const CONTROL: f64 = 1000.0;
const STIFFENED: f64 = CONTROL + 250.0;
const GRAVITY_NM: f64 = 3.0;

/// Two hands whose first joints move them along x, with half of 8 N of weight and of 10 N of load each.
fn stiffened() -> ContactModel {
    let along_x = |force_n: f64| Wrench::from_force(Vector3::x() * force_n);
    let mut hold = two_strong_hands(along_x(8.0), along_x(10.0));
    hold.p_ot = Vector3::zeros();
    for hand in &mut hold.hands {
        hand.gravity_stiffness_nm_rad[(0, 0)] = STIFFENED - CONTROL;
        hand.gravity_torque_nm[0] = GRAVITY_NM;
    }
    hold
}

/// The joints yield by `u / (K_q + dg/dq)`, and the motors' torque is `g + K_q (K_q + dg/dq)^-1 u`, `u = J' w`.
#[test]
fn a_joint_that_gravity_stiffens_yields_less_and_its_motor_gives_less() {
    let hold = stiffened();
    for solver in [EquilibriumSolver::InteriorPoint, EquilibriumSolver::Clarabel] {
        let outcome = StabilityWorkspace::new().equilibrium(&hold, 1.0, solver).unwrap();
        let EquilibriumOutcome::Found(found) = outcome else { panic!("{outcome:?}") };
        for (torque_nm, moved_rad) in found.joint_torque_nm.iter().zip(&found.joint_displacement_rad) {
            // A tolerance of the solvers; each hand pushes the board back with 9 N.
            approx::assert_abs_diff_eq!(moved_rad[0], 9.0 / STIFFENED, epsilon = 1e-6);
            approx::assert_abs_diff_eq!(torque_nm[0], GRAVITY_NM - 9.0 * CONTROL / STIFFENED, epsilon = 1e-3);
        }
    }
}

/// The weight is fed forward: it loads the motors in full and moves nothing. The load moves the joints.
#[test]
fn the_weight_is_fed_forward_and_the_load_is_not() {
    let found = response(&stiffened(), 2.0);
    for (torque_nm, moved_rad) in found.equilibrium.joint_torque_nm.iter().zip(&found.joints_rad) {
        approx::assert_abs_diff_eq!(moved_rad[0], 10.0 / STIFFENED, epsilon = ROUNDING);
        approx::assert_abs_diff_eq!(torque_nm[0], GRAVITY_NM - 4.0 - 10.0 * CONTROL / STIFFENED, epsilon = ROUNDING);
        assert!(torque_nm.iter().skip(1).all(|nm| nm.abs() < ROUNDING));
    }
    approx::assert_abs_diff_eq!(found.deflection_m.x, 10.0 / STIFFENED, epsilon = ROUNDING);
}

/// What a controller feeds forward is the share of the board's weight, without what holds the arm itself.
#[test]
fn arms_carry_the_board_with_half_of_its_weight_each() {
    let mut workspace = StabilityWorkspace::new();
    let carried = workspace.carrying_torque_nm(&stiffened()).unwrap().unwrap();
    assert_eq!(carried.len(), 2);
    for torque_nm in carried {
        approx::assert_abs_diff_eq!(torque_nm[0], -4.0, epsilon = ROUNDING);
        assert!(torque_nm.iter().skip(1).all(|nm| nm.abs() < ROUNDING));
    }
    let heavy = ContactModel { weight: Wrench::from_force(Vector3::x() * 80.0), ..stiffened() };
    // 72 N of friction.
    assert_eq!(workspace.carrying_torque_nm(&heavy).unwrap(), None);
}

/// Forces in all directions, and pads beside the grasp point and beside each other.
fn skew() -> ContactModel {
    let load = Wrench::from_force(Vector3::new(4.0, -3.0, 5.0)).about(&Vector3::new(0.1, 0.05, 0.015));
    let mut hold = two_strong_hands(Wrench::from_force(Vector3::new(0.5, 0.3, -2.0)), load);
    hold.hands[0].grasp_point_o += Vector3::new(0.01, -0.02, 0.004);
    hold.hands[1].pads_mut()[0].x_op.translation.vector += Vector3::new(-0.006, 0.003, 0.0);
    hold
}

#[test]
fn pads_that_share_a_wrench_balance_the_board() {
    let hold = skew();
    let found = response(&hold, 1.0);
    assert!(unbalanced(&hold, &found.equilibrium.hand_wrenches, 1.0) < ROUNDING);
    // The pads' forces along the normals add up to twice the grip force.
    for wrench in &found.equilibrium.hand_wrenches {
        let [one, other] = wrench.of_pads() else { panic!("{wrench:?}") };
        approx::assert_abs_diff_eq!(one.force_n.z + other.force_n.z, 2.0 * GRIP_N, epsilon = ROUNDING);
    }
}

/// Equal parts of a wrench balance only opposite pads; for others the program shares it.
#[test]
fn pads_that_are_not_opposite_balance_the_board() {
    let mut hold = skew();
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.1);
    hold.hands[1].pads_mut()[0].x_op.rotation = tilt * hold.hands[1].pads()[0].x_op.rotation;
    let found = response(&hold, 1.0);
    // 1e-9 of 10 N is the interior point's tolerance.
    assert!(unbalanced(&hold, &found.equilibrium.hand_wrenches, 1.0) < 1e-6);
}

/// From loads that any pad carries up to loads that no pad carries, along and about each axis.
#[test]
fn no_pad_is_loaded_beyond_its_limits() {
    let mut found = 0;
    let [a, b] = HALF_SIDES_M;
    for direction in 0..6 {
        for share in 1..=20 {
            let mut load = [0.0; 6];
            load[direction] = if direction < 3 { 4.0 } else { 0.4 } * f64::from(share);
            let hold = two_strong_hands(Wrench::default(), Wrench::from(load));
            let outcome = StabilityWorkspace::new().response(&hold, 1.0).unwrap();
            let ResponseOutcome::Found(response) = outcome else { continue };
            let wrenches = &response.equilibrium.hand_wrenches;
            // The solver's tolerance, as above.
            assert!(unbalanced(&hold, wrenches, 1.0) < 1e-6);
            for (hand, wrench) in hold.hands.iter().zip(wrenches) {
                for (pad, Wrench { force_n, moment_nm }) in hand.pads().iter().zip(wrench.of_pads()) {
                    let sliding_n = force_n.x.hypot(force_n.y).hypot(moment_nm.z / pad.torsion_radius_m());
                    assert!(sliding_n <= FRICTION * force_n.z + 1e-6, "{load:?}: {sliding_n} N");
                    assert!(moment_nm.x.abs() <= b * force_n.z + 1e-6, "{load:?}: {moment_nm}");
                    assert!(moment_nm.y.abs() <= a * force_n.z + 1e-6, "{load:?}: {moment_nm}");
                }
            }
            found += 1;
        }
    }
    // Some of the loads are too large for any distribution of forces.
    assert!((60..120).contains(&found), "{found}");
}
