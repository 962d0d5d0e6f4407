//! Load factors with closed forms.
//!
//! The solver's tolerance is 1e-7 in units of 10 N, 2 N m and 1 of the load factor; comparisons at 1e-5 leave a factor
//! of a hundred for the conversion.

use benchdog::{
    model::wrench::Wrench,
    statics::{ContactModel, HandModel, LoadFactorOutcome, StabilityWorkspace, mean_distance_from_centre_m},
};
use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};

use crate::fixtures::{HALF_SIDES_M, solved, strong_hand, two_strong_hands};

const TOLERANCE: f64 = 1e-5;

/// One hand of the torsion and tilt examples: N = 30 N a pad, mu = 0.6, pads facing +-y.
fn one_hand(load: Wrench) -> ContactModel {
    let hand = strong_hand("left", Vector3::zeros(), Vector3::y(), Vector3::x(), 30.0, 0.6, 0.03);
    ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() }
}

fn names(binding: &[String]) -> Vec<&str> {
    binding.iter().map(String::as_str).collect()
}

#[test]
fn two_grippers_carry_a_board_under_a_downward_load() {
    // (4 pads x mu x F - weight) / load.
    let hand =
        |name: &str, x: f64| strong_hand(name, Vector3::new(x, 0.0, 0.0), Vector3::y(), Vector3::x(), 35.0, 0.05, 0.03);
    let weight = Wrench::from_force(Vector3::new(0.0, 0.0, -2.943));
    let load = Wrench::from_force(Vector3::new(0.0, 0.0, -30.0));
    let hold =
        ContactModel { hands: vec![hand("left", 0.2), hand("right", -0.2)], weight, load, p_ot: Vector3::zeros() };
    let found = solved(&hold);
    approx::assert_abs_diff_eq!(found.load_factor, (4.0 * 0.05 * 35.0 - 2.943) / 30.0, epsilon = TOLERANCE);
    let mut binding = names(&found.binding);
    binding.sort_unstable();
    let expected = [
        "left lower pad: friction",
        "left upper pad: friction",
        "right lower pad: friction",
        "right upper pad: friction",
    ];
    assert_eq!(binding, expected);
}

#[test]
fn a_pinch_slides_along_its_faces() {
    // Both pads at mu F, in any direction of the face.
    for angle in [0.0_f64, 0.4, 2.0] {
        let found = solved(&one_hand(Wrench::from_force(Vector3::new(angle.cos(), 0.0, angle.sin()))));
        approx::assert_abs_diff_eq!(found.load_factor, 2.0 * 0.6 * 30.0, epsilon = 36.0 * TOLERANCE);
    }
}

#[test]
fn a_pinch_opens_along_its_normals_at_twice_the_grip() {
    // The fingers are coupled: one pad takes 2 F, the other opens.
    let found = solved(&one_hand(Wrench::from_force(Vector3::new(0.0, 1.0, 0.0))));
    approx::assert_abs_diff_eq!(found.load_factor, 60.0, epsilon = 60.0 * TOLERANCE);
    assert_eq!(names(&found.binding), ["left lower pad: grip"]);
}

#[test]
fn a_pad_pair_holds_the_torsion_of_two_uniform_patches() {
    let found = solved(&one_hand(Wrench::new(Vector3::zeros(), Vector3::new(0.0, 1.0, 0.0))));
    let by_formula = 2.0 * 0.6 * 30.0 * mean_distance_from_centre_m(HALF_SIDES_M);
    approx::assert_abs_diff_eq!(found.load_factor, by_formula, epsilon = TOLERANCE);
    // A figure of four digits, truncated.
    approx::assert_abs_diff_eq!(found.load_factor, 0.5266, epsilon = 1e-4);
    let mut binding = names(&found.binding);
    binding.sort_unstable();
    assert_eq!(binding, ["left lower pad: torsion", "left upper pad: torsion"]);
}

#[test]
fn a_pad_pair_holds_the_tilt_of_both_rims_and_the_friction_couple() {
    // N (2 b + mu t) about x: the pressure moves to the rims, and friction pulls opposite ways on the two faces.
    let found = solved(&one_hand(Wrench::new(Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0))));
    let by_formula = 30.0 * (2.0 * HALF_SIDES_M[1] + 0.6 * 0.03);
    approx::assert_abs_diff_eq!(by_formula, 1.62, epsilon = 1e-12);
    approx::assert_abs_diff_eq!(found.load_factor, by_formula, epsilon = TOLERANCE);
    assert!(found.binding.iter().any(|name| name == "left upper pad: tilt"), "{:?}", found.binding);
    assert!(found.binding.iter().any(|name| name == "left upper pad: friction"), "{:?}", found.binding);
}

#[test]
fn sliding_and_torsion_share_one_circle() {
    // (f / (2 mu F))^2 + (m / (2 mu F e))^2 = 1 on the ray m = e f.
    let e = mean_distance_from_centre_m(HALF_SIDES_M);
    let found = solved(&one_hand(Wrench::new(Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, e, 0.0))));
    approx::assert_abs_diff_eq!(found.load_factor, 36.0 / 2.0_f64.sqrt(), epsilon = 36.0 * TOLERANCE);
}

#[test]
fn a_lever_on_one_gripper_is_held_by_torsion_and_friction_together() {
    // A force f along z at the distance l along x, both in the pads' plane: f^2 + (f l / e)^2 = (2 mu F)^2.
    let (lever_m, e) = (0.1, mean_distance_from_centre_m(HALF_SIDES_M));
    let load = Wrench::from_force(Vector3::z()).about(&Vector3::new(lever_m, 0.0, 0.0));
    let expected = 36.0 / 1.0_f64.hypot(lever_m / e);
    approx::assert_abs_diff_eq!(solved(&one_hand(load)).load_factor, expected, epsilon = TOLERANCE * expected);
}

/// A planar arm of two links in the x-y plane, its hand pinching along z, the second link along x and the first along
/// y.
fn planar_arm(lengths_m: [f64; 2], effort_nm: [f64; 2], gravity_nm: [f64; 2]) -> HandModel {
    let mut hand = strong_hand("left", Vector3::zeros(), Vector3::z(), Vector3::x(), 1e3, 1.0, 0.03);
    let [first, second] = lengths_m;
    // The base is at (-second, -first), the elbow at (-second, 0), the hand at the origin.
    let mut jacobian = Matrix6xX::zeros(2);
    jacobian.column_mut(0).copy_from_slice(&[-first, second, 0.0, 0.0, 0.0, 1.0]);
    jacobian.column_mut(1).copy_from_slice(&[0.0, second, 0.0, 0.0, 0.0, 1.0]);
    hand.joints = vec!["left_shoulder".into(), "left_elbow".into()];
    hand.jacobian_o = jacobian;
    hand.effort_nm = DVector::from_row_slice(&effort_nm);
    hand.gravity_torque_nm = DVector::from_row_slice(&gravity_nm);
    hand.stiffness_nm_rad = DVector::from_element(2, 100.0);
    hand.gravity_stiffness_nm_rad = DMatrix::zeros(2, 2);
    hand
}

#[test]
fn a_planar_arm_is_limited_by_the_joint_that_the_load_acts_on() {
    let lengths_m = [0.4, 0.3];
    let cases = [
        // Along -x the load acts on the shoulder alone, at its lever of 0.4 m. The hand exerts +x: torque -0.4.
        (Vector3::new(-1.0, 0.0, 0.0), [10.0, 8.0], [0.0, 0.0], 10.0 / 0.4, "left_shoulder: torque"),
        // Along -y both, at 0.3 m: the elbow is weaker.
        (Vector3::new(0.0, -1.0, 0.0), [10.0, 8.0], [0.0, 0.0], 8.0 / 0.3, "left_elbow: torque"),
        // Gravity takes 3 N m of the elbow in one direction and adds them in the other.
        (Vector3::new(0.0, -1.0, 0.0), [10.0, 8.0], [0.0, 3.0], 5.0 / 0.3, "left_elbow: torque"),
        (Vector3::new(0.0, 1.0, 0.0), [20.0, 8.0], [0.0, 3.0], 11.0 / 0.3, "left_elbow: torque"),
    ];
    for (force, effort, gravity, expected, binding) in cases {
        let hand = planar_arm(lengths_m, effort, gravity);
        let hold = ContactModel {
            hands: vec![hand],
            weight: Wrench::default(),
            load: Wrench::from_force(force),
            p_ot: Vector3::zeros(),
        };
        let found = solved(&hold);
        approx::assert_abs_diff_eq!(found.load_factor, expected, epsilon = TOLERANCE * expected);
        assert_eq!(names(&found.binding), [binding]);
    }
}

#[test]
fn internal_forces_do_not_load_the_balance() {
    // Two hands with strong joints: they may push against each other, and friction alone limits the load factor.
    let weight = Wrench::from_force(Vector3::new(0.0, 0.0, -1.0));
    let hold = two_strong_hands(weight, Wrench::from_force(Vector3::new(1.0, 0.0, 0.0)));
    // Along x all four pads slide at mu F = 18 N, in a plane that the weight, along the normal, is not in.
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 72.0, epsilon = 72.0 * TOLERANCE);
}

#[test]
fn without_a_load_the_cap_is_reached_and_nothing_binds() {
    let found = solved(&one_hand(Wrench::default()));
    approx::assert_abs_diff_eq!(found.load_factor, 100.0, epsilon = 1e-4);
    assert!(found.binding.is_empty(), "{:?}", found.binding);
    let found = solved(&one_hand(Wrench::from_force(Vector3::new(1e-3, 0.0, 0.0))));
    approx::assert_abs_diff_eq!(found.load_factor, 100.0, epsilon = 1e-4);
    assert!(found.binding.is_empty(), "{:?}", found.binding);
}

#[test]
fn a_board_that_is_too_heavy_is_infeasible_with_a_certificate() {
    let load = Wrench::from_force(Vector3::new(0.0, 0.0, -1.0));
    let mut hold = one_hand(load);
    hold.weight = Wrench::from_force(Vector3::new(0.0, 0.0, -37.0));
    let outcome = StabilityWorkspace::new().load_factor(&hold).unwrap();
    let LoadFactorOutcome::GravityInfeasible { certificate } = outcome else { panic!("found {outcome:?}") };
    assert!(certificate.proves_infeasible(&hold).unwrap());
    // The certificate is of this model and does not refute a board that can be held.
    hold.weight = Wrench::from_force(Vector3::new(0.0, 0.0, -35.0));
    assert!(!certificate.proves_infeasible(&hold).unwrap());
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 1.0, epsilon = TOLERANCE);
}

#[test]
fn an_arm_that_cannot_carry_itself_is_infeasible_with_a_certificate() {
    // The elbow needs 9 N m for gravity and has 8. With 1000 N of grip the board could carry the arm, but nothing else
    // holds the board.
    let hand = planar_arm([0.4, 0.3], [10.0, 8.0], [0.0, 9.0]);
    let load = Wrench::from_force(Vector3::new(-1.0, 0.0, 0.0));
    let hold = ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() };
    let outcome = StabilityWorkspace::new().load_factor(&hold).unwrap();
    let LoadFactorOutcome::GravityInfeasible { certificate } = outcome else { panic!("found {outcome:?}") };
    assert!(certificate.proves_infeasible(&hold).unwrap());
}

#[test]
fn errors_of_invalid_models_name_the_place() {
    let mut workspace = StabilityWorkspace::new();
    let good = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::x()));
    let message = |change: &dyn Fn(&mut ContactModel)| {
        let mut hold = good.clone();
        change(&mut hold);
        StabilityWorkspace::new().load_factor(&hold).unwrap_err().to_string()
    };
    assert!(workspace.load_factor(&good).is_ok());
    assert_eq!(message(&|hold| hold.hands.clear()), "found 0 hands, expected 1 to 4");
    assert_eq!(
        message(&|hold| hold.hands[1].pads_mut()[0].half_sides_m[1] = 0.0),
        "right upper pad: found half side 0, expected more than 0 m"
    );
    assert_eq!(
        message(&|hold| hold.hands[0].pads_mut()[1].friction = -0.1),
        "left lower pad: found friction -0.1, expected 0 or more"
    );
    assert_eq!(message(&|hold| hold.load.force_n.x = f64::NAN), "object: found a load that is not finite");
    assert_eq!(
        message(&|hold| hold.hands[0].effort_nm = DVector::zeros(3)),
        "left hand: found 3 entries of effort, expected one for each of 6 joints"
    );
    for (value, shown) in [(0.0, "0"), (-1.0, "-1"), (f64::INFINITY, "inf"), (f64::NAN, "NaN")] {
        let effort = message(&|hold| hold.hands[0].effort_nm[2] = value);
        assert_eq!(effort, format!("left hand: found effort {shown}, expected more than 0"));
        let stiffness = message(&|hold| hold.hands[1].stiffness_nm_rad[5] = value);
        assert_eq!(stiffness, format!("right hand: found stiffness {shown}, expected more than 0"));
    }
    let soft = message(&|hold| hold.hands[0].gravity_stiffness_nm_rad[(2, 2)] = -1e3);
    assert_eq!(soft, "left hand: the joints' springs are too soft for the arm's own weight");
}

#[test]
fn without_friction_a_pinch_holds_only_along_its_normals() {
    let mut hold = one_hand(Wrench::from_force(Vector3::y()));
    hold.hands[0].pads_mut().iter_mut().for_each(|pad| pad.friction = 0.0);
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 60.0, epsilon = 60.0 * TOLERANCE);
    hold.load = Wrench::from_force(Vector3::x());
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 0.0, epsilon = TOLERANCE);
}
