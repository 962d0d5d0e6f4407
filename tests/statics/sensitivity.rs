//! The derivatives of the load factor against finite differences and closed forms.

use benchdog::{
    model::wrench::Wrench,
    statics::{ContactModel, LoadFactorOutcome, StabilityWorkspace},
};
use nalgebra::{DVector, Vector3};

use crate::fixtures::{baxter_holds, contact_model, random_hold, solved, strong_hand};

/// Relative change of a limit: the solver's tolerance of 1e-7 then changes a relative derivative by 1e-4 of the load
/// factor, and curvature by about a thousandth of itself.
const STEP: f64 = 1e-3;

/// Multiplies one limit of a hold.
type Change = Box<dyn Fn(&mut ContactModel, f64)>;

/// A derivative with its name and limit.
struct Derivative {
    name: String,
    found: f64,
    limit: f64,
    scale: Change,
}

fn derivatives(hold: &ContactModel) -> Vec<Derivative> {
    let sensitivity = solved(hold).sensitivity;
    let mut all = Vec::new();
    for (number, (hand, found)) in hold.hands.iter().zip(&sensitivity.hands).enumerate() {
        all.push(Derivative {
            name: format!("{} grip", hand.name),
            found: found.per_grip_force_n,
            limit: hand.pad_pair().unwrap().grip_force_n,
            scale: Box::new(move |hold, by| hold.hands[number].scale_grip(by)),
        });
        for pad in 0..2 {
            all.push(Derivative {
                name: format!("{} {} friction", hand.name, hand.pads()[pad].name),
                found: found.per_friction[pad],
                limit: hand.pads()[pad].friction,
                scale: Box::new(move |hold, by| hold.hands[number].pads_mut()[pad].friction *= by),
            });
        }
        for joint in 0..hand.dof() {
            all.push(Derivative {
                name: format!("{} torque", hand.joints[joint]),
                found: found.per_effort_nm[joint],
                limit: hand.effort_nm[joint],
                scale: Box::new(move |hold, by| hold.hands[number].effort_nm[joint] *= by),
            });
        }
    }
    all
}

/// Compares every derivative with the differences on both sides; at a kink it is between them. Returns the number of
/// significant ones.
fn agrees_with_differences(hold: &ContactModel) -> usize {
    let load_factor = |by: f64, scale: &dyn Fn(&mut ContactModel, f64)| {
        let mut hold = hold.clone();
        scale(&mut hold, by);
        solved(&hold).load_factor
    };
    let here = solved(hold).load_factor;
    let mut compared = 0;
    for Derivative { name, found, limit, scale } in derivatives(hold) {
        let right = (load_factor(1.0 + STEP, &scale) - here) / (STEP * limit);
        let left = (here - load_factor(1.0 - STEP, &scale)) / (STEP * limit);
        // 1 %, and what the solver's tolerance leaves of either difference.
        let margin = 0.01 * found.abs() + 5e-4 * here.max(1.0) / limit;
        let (low, high) = (left.min(right) - margin, left.max(right) + margin);
        assert!(found >= low && found <= high, "{name}: {found}, by differences {left} and {right}");
        compared += usize::from(found * limit > 0.05 * here && (right - left).abs() < margin);
    }
    compared
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let mut compared = 0;
    for seed in 0..24 {
        let hold = random_hold(seed, 1 + seed as usize % 3);
        if let LoadFactorOutcome::Solved(found) = StabilityWorkspace::new().load_factor(&hold).unwrap()
            && found.load_factor > 0.1
        {
            compared += agrees_with_differences(&hold);
        }
    }
    assert!(compared >= 40, "only {compared} derivatives of random holds matter");
}

#[test]
fn derivatives_of_baxters_grasps_agree_with_finite_differences() {
    let (robot, plans) = baxter_holds(6, 11);
    let holds = plans.iter().map(|(arms, object, operation)| contact_model(&robot, arms, object, operation, 0.6));
    let compared: usize = holds.map(|hold| agrees_with_differences(&hold.unwrap())).sum();
    assert!(compared >= 12, "only {compared} derivatives matter");
}

#[test]
fn derivatives_of_a_carried_board_are_those_of_the_formula() {
    // lambda* = (4 mu F - weight) / load: a hand carries half of 4 mu F, a pad a quarter.
    let hand =
        |name: &str, x: f64| strong_hand(name, Vector3::new(x, 0.0, 0.0), Vector3::y(), Vector3::x(), 35.0, 0.05, 0.03);
    let hold = ContactModel {
        hands: vec![hand("left", 0.2), hand("right", -0.2)],
        weight: Wrench::from_force(Vector3::new(0.0, 0.0, -2.943)),
        load: Wrench::from_force(Vector3::new(0.0, 0.0, -30.0)),
        p_ot: Vector3::zeros(),
    };
    // The solver's tolerance of 1e-7, divided by the unit of 10 N and the friction of 0.05.
    for hand in solved(&hold).sensitivity.hands {
        approx::assert_abs_diff_eq!(hand.per_grip_force_n, 2.0 * 0.05 / 30.0, epsilon = 1e-6);
        // How the pads of a hand share the normal force is free, so only their sum is determined.
        approx::assert_abs_diff_eq!(hand.per_friction[0] + hand.per_friction[1], 2.0 * 35.0 / 30.0, epsilon = 1e-4);
        approx::assert_abs_diff_eq!(hand.per_effort_nm, DVector::zeros(6), epsilon = 1e-6);
    }
}

#[test]
fn at_the_cap_all_derivatives_are_zero() {
    let hand = strong_hand("left", Vector3::zeros(), Vector3::y(), Vector3::x(), 30.0, 0.6, 0.03);
    let load = Wrench::from_force(Vector3::new(0.01, 0.0, 0.0));
    let hold = ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() };
    let found = solved(&hold).sensitivity;
    assert!(found.hands[0].per_grip_force_n.abs() < 1e-4 && found.hands[0].per_friction[0].abs() < 1e-4, "{found:?}");
}
