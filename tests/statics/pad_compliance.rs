//! Elastic pads (docs/method.md#612-pad-compliance): closed forms, invariances and two solvers.

use benchdog::{
    model::{frames::Pose, wrench::Wrench},
    statics::{
        CompliantResponse, ContactModel, EquilibriumOutcome, EquilibriumSolver, ResponseOutcome, StabilityWorkspace,
        WeldedStiffness,
    },
};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6xX, UnitQuaternion, Vector3};

use crate::fixtures::{HALF_SIDES_M, baxter_holds, contact_model, moved, random_hold, set_grip, strong_hand};

/// Stiffness of a pad, N/m.
const STIFFNESS_N_M: f64 = 8e5;

/// Half the distance between the pads of a hand, m.
const HALF_GAP_M: f64 = 0.015;

fn with_pads(mut hold: ContactModel, stiffness_n_m: f64) -> ContactModel {
    hold.hands
        .iter_mut()
        .flat_map(benchdog::statics::HandModel::pads_mut)
        .for_each(|pad| pad.stiffness_n_m = Some(stiffness_n_m));
    hold
}

fn response(hold: &ContactModel, load_factor: f64) -> CompliantResponse {
    match StabilityWorkspace::new().response(hold, load_factor).unwrap() {
        ResponseOutcome::Found(response) => *response,
        other => panic!("expected an equilibrium, found {other:?}"),
    }
}

/// One hand whose arm has no joints: pads normal to z, x_P along y.
fn fixed_hand(load: Wrench) -> ContactModel {
    let mut hand = strong_hand("hand", Vector3::zeros(), Vector3::z(), Vector3::y(), 1e3, 0.6, 2.0 * HALF_GAP_M);
    hand.joints.clear();
    hand.jacobian_o = Matrix6xX::zeros(0);
    let empty = DVector::zeros(0);
    hand.gravity_torque_nm = empty.clone();
    hand.effort_nm = empty.clone();
    hand.stiffness_nm_rad = empty;
    hand.gravity_stiffness_nm_rad = DMatrix::zeros(0, 0);
    with_pads(
        ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() },
        STIFFNESS_N_M,
    )
}

#[test]
fn a_board_between_pads_of_a_fixed_hand_yields_as_in_closed_form() {
    let (k, along) = (STIFFNESS_N_M, 2.0 / 3.0 * STIFFNESS_N_M);
    let [a, b] = HALF_SIDES_M;
    // Two pads: twice the stiffness of one; about an axis of the face they also shear at the lever of half the gap.
    let shear = along * HALF_GAP_M * HALF_GAP_M;
    let forces = [(Vector3::x(), 2.0 * along), (Vector3::y(), 2.0 * along), (Vector3::z(), 2.0 * k)];
    // x_P is y, so the half side a is along y and b along x.
    let moments = [
        (Vector3::x(), 2.0 * (k * a * a / 3.0 + shear)),
        (Vector3::y(), 2.0 * (k * b * b / 3.0 + shear)),
        (Vector3::z(), 2.0 * along * (a * a + b * b) / 3.0),
    ];
    // The regularising compliance of the equilibrium program, 1e-10 m/N, is 8e-5 of the pads'; sums of products round.
    for (axis, stiffness_n_m) in forces {
        let found = response(&fixed_hand(Wrench::from_force(axis * 20.0)), 1.0);
        approx::assert_relative_eq!(found.board.linear, axis * (20.0 / stiffness_n_m), max_relative = 1e-4);
    }
    for (axis, stiffness_nm_rad) in moments {
        let found = response(&fixed_hand(Wrench::new(Vector3::zeros(), axis * 2.0)), 1.0);
        approx::assert_relative_eq!(found.board.angular, axis * (2.0 / stiffness_nm_rad), max_relative = 1e-4);
    }
}

#[test]
fn a_hand_off_its_grasp_point_is_as_stiff_as_its_pads() {
    // The pads are 5 mm beside the grasp point: pushed there the board does not turn.
    let lever = Vector3::new(0.005, 0.0, 0.0);
    let mut hold = fixed_hand(Wrench::from_force(Vector3::z() * 20.0).about(&lever));
    hold.hands[0].pads_mut().iter_mut().for_each(|pad| pad.x_op.translation.vector += lever);
    let found = response(&hold, 1.0).board;
    // Rounding beside 1.25e-5 m.
    assert!(found.angular.norm() < 1e-12 && (found.linear.z - 20.0 / (2.0 * STIFFNESS_N_M)).abs() < 1e-9, "{found:?}");
}

#[test]
fn elastic_pads_add_to_the_arms_compliance_and_do_not_slip() {
    for seed in 0..10 {
        let mut rigid = random_hold(seed, 2);
        rigid.hands.iter_mut().for_each(|hand| set_grip(hand, 1e3));
        let hold = with_pads(rigid.clone(), STIFFNESS_N_M);
        for (hand, rigid) in hold.hands.iter().zip(&rigid.hands) {
            let added = hand.compliance() - rigid.compliance();
            let stiffness = hand.pad_stiffness(&Isometry3::from(hand.grasp_point_o)).unwrap();
            // Rounding of an inverse whose entries are 1e-6 to 1e-2.
            assert!((added * stiffness - nalgebra::Matrix6::identity()).amax() < 1e-6, "{added}");
        }
        let found = response(&hold, 1.0);
        let expected = WeldedStiffness::new(&hold).unwrap().twist_at_tip(&hold.load).linear;
        // A thousandth: the regularising compliance, see `compliance.rs`.
        approx::assert_relative_eq!(found.deflection_m, expected, epsilon = 1e-3 * expected.norm());
        assert!(found.deflection_mm() > response(&rigid, 1.0).deflection_mm());
        // Slip is relative to the faces of the pads, which move with the board: 1e-10 m/N times 30 N, 3 N m at 14 mm.
        for slip in &found.slip {
            assert!(slip.linear.norm() < 1e-7 && slip.angular.norm() < 5e-6, "{slip:?}");
        }
    }
}

#[test]
fn very_stiff_pads_are_rigid() {
    for seed in 0..5 {
        let rigid = random_hold(seed, 2);
        let deflection_mm = response(&rigid, 0.2).deflection_mm();
        // Arms yield by 1e-4 m/N, these pads by 1e-9 m/N and, at the lever of half a pad, 1e-5 rad/(N m) of an arm's 1e-3.
        let stiff_mm = response(&with_pads(rigid, 1e9), 0.2).deflection_mm();
        approx::assert_relative_eq!(stiff_mm, deflection_mm, max_relative = 2e-2);
    }
}

#[test]
fn both_solvers_agree_on_sliding_hands_with_elastic_pads() {
    let mut compared = 0;
    for seed in 0..10 {
        let hold = with_pads(random_hold(seed, 2), 5e4);
        for load_factor in [0.02, 0.1, 0.5] {
            let board = |solver| match StabilityWorkspace::new().equilibrium(&hold, load_factor, solver).unwrap() {
                EquilibriumOutcome::Found(found) => Some(found.board.at(&hold.p_ot).linear),
                EquilibriumOutcome::NoEquilibrium | EquilibriumOutcome::Unknown { .. } => None,
            };
            let Some(clarabel) = board(EquilibriumSolver::Clarabel) else { continue };
            let Some(ours) = board(EquilibriumSolver::InteriorPoint) else { panic!("seed {seed}: clarabel found one") };
            // The accuracy of either solver, in units of 1 mm.
            assert!((ours - clarabel).norm() < 1e-6 + 2e-3 * clarabel.norm(), "{ours} {clarabel}");
            compared += 1;
        }
    }
    assert!(compared > 10, "{compared}");
}

#[test]
fn the_choice_of_frame_does_not_matter() {
    let hold = with_pads(random_hold(3, 2), 1e5);
    let x: Pose =
        Isometry3::from_parts(Vector3::new(0.3, -0.2, 0.1).into(), UnitQuaternion::from_euler_angles(0.4, -1.1, 2.0));
    let (here, there) = (response(&hold, 0.3), response(&moved(&hold, &x), 0.3));
    // The solver's accuracy.
    approx::assert_relative_eq!(here.deflection_mm(), there.deflection_mm(), max_relative = 1e-4);
}

#[test]
fn a_pad_half_on_the_board_is_half_as_stiff() {
    let (mut robot, holds) = baxter_holds(1, 5);
    robot
        .arms
        .iter_mut()
        .for_each(|arm| arm.gripper.holding.pads_mut().unwrap().pad_stiffness_n_m = Some(STIFFNESS_N_M));
    let (mut arms, object, operation) = holds[0].clone();
    let model = |arms: &_| contact_model(&robot, arms, &object, &operation, 0.6).unwrap();
    assert_eq!(model(&arms).hands[0].pads()[0].stiffness_n_m, Some(STIFFNESS_N_M));
    // G's origin is 14.9 mm in front of the pad's centre and 35 mm inside the edge: 20.1 mm out, the centre is on the edge.
    arms[0].x_og *= Isometry3::translation(0.0, 0.0, -0.0201);
    let clipped = model(&arms).hands[0].pad_pair().unwrap().pads.clone().map(|pad| pad.stiffness_n_m.unwrap());
    // Rounding of places of some decimetres.
    clipped.iter().for_each(|found| approx::assert_relative_eq!(*found, STIFFNESS_N_M / 2.0, max_relative = 1e-9));
}

#[test]
fn the_stiffness_is_diagonal_between_the_pads_of_a_plan() {
    let (mut robot, holds) = baxter_holds(6, 9);
    robot
        .arms
        .iter_mut()
        .for_each(|arm| arm.gripper.holding.pads_mut().unwrap().pad_stiffness_n_m = Some(STIFFNESS_N_M));
    for (arms, object, operation) in &holds {
        for hand in contact_model(&robot, arms, object, operation, 0.6).unwrap().hands {
            let stiffness = hand.pad_stiffness(&hand.springs().unwrap().0).unwrap();
            let rest = stiffness - nalgebra::Matrix6::from_diagonal(&stiffness.diagonal());
            // Rounding beside 1e6 N/m.
            assert!(rest.amax() < 1e-6, "{rest}");
        }
    }
}

#[test]
fn stiffnesses_that_are_not_positive_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = with_pads(random_hold(1, 2), bad).check().unwrap_err().to_string();
        assert!(error.contains("upper pad: found stiffness") && error.contains("more than 0 N/m"), "{error}");
    }
}
