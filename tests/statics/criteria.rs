//! The criteria of stability, from load factors and deflections in closed form.

use benchdog::{
    model::{
        load::Load,
        operation::{Operation, OperationKind},
        scenario::{Limits, StabilityKind},
        wrench::Wrench,
    },
    statics::{ContactModel, LoadCases, StabilityWorkspace},
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::fixtures::{limits, two_strong_hands};

/// Accuracy of a load factor, relative, see `properties`.
const TOLERANCE: f64 = 1e-5;

fn utilisation(hold: &ContactModel, limits: &Limits, kind: StabilityKind) -> f64 {
    StabilityWorkspace::new().utilisation(hold, limits, kind).unwrap()
}

/// Two hands under 10 N along x: 5 N m on the first joint of each and 5 mm a load factor, and 72 N of friction.
fn pushed() -> ContactModel {
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::x() * 10.0));
    hold.p_ot = Vector3::zeros();
    hold
}

#[test]
fn the_criterion_of_the_paper_is_the_share_of_the_load_factor() {
    let at = |load_factor: f64| utilisation(&pushed(), &Limits { load_factor, ..limits() }, StabilityKind::Paper);
    // lambda* is 7.2.
    approx::assert_relative_eq!(at(1.1), 1.1 / 7.2, max_relative = TOLERANCE);
    approx::assert_relative_eq!(at(3.6), 0.5, max_relative = TOLERANCE);
    assert_eq!(at(0.0), 0.0);
    // Above lambda* it is at least 1, and infinite where a mechanism proves it.
    assert_eq!(at(7.3), f64::INFINITY);
}

#[test]
fn the_compliant_criterion_is_the_largest_share_of_a_limit() {
    let limits = Limits { deflection_mm: 15.0, torque_ratio: 1.0, ..limits() };
    let at = |hold: &ContactModel, load_factor: f64| {
        utilisation(hold, &Limits { load_factor, ..limits }, StabilityKind::Compliant)
    };
    let mut hold = pushed();
    approx::assert_relative_eq!(at(&hold, 1.5), 7.5 / 15.0, max_relative = 1e-9);
    // The deflection counts at the full load at least.
    approx::assert_relative_eq!(at(&hold, 0.5), 5.0 / 15.0, max_relative = 1e-9);
    for hand in &mut hold.hands {
        hand.effort_nm[0] = 10.0;
    }
    approx::assert_relative_eq!(at(&hold, 1.5), 7.5 / 10.0, max_relative = 1e-9);
}

/// The figures of a plan: load factors, the deflection at load 1, and the torques there by the hand's name.
#[test]
fn a_prediction_has_the_figures_of_the_closed_forms() {
    let hold = pushed();
    let operation = Operation {
        kind: OperationKind::Wrench,
        wrench_o: hold.load,
        x_ot: Isometry3::from_parts(hold.p_ot.into(), UnitQuaternion::identity()),
    };
    let cases = LoadCases::new(hold, &operation, &Load { lateral_share: 0.0, ..Load::default() });
    let limits = Limits { deflection_mm: 15.0, ..limits() };
    let found = StabilityWorkspace::new().predict(&cases, &limits).unwrap().unwrap().stability;
    approx::assert_relative_eq!(found.load_factor, 7.2, max_relative = TOLERANCE);
    // From below, to a thousandth.
    approx::assert_relative_eq!(found.compliant_load_factor, 3.0, max_relative = 1e-3);
    approx::assert_relative_eq!(found.predicted_deflection_mm, 5.0, max_relative = 1e-9);
    let names: Vec<_> = found.joint_torque_nm.keys().map(String::as_str).collect();
    assert_eq!(names, ["left", "right"]);
    for torque_nm in found.joint_torque_nm.values() {
        approx::assert_relative_eq!(torque_nm[0], -5.0, max_relative = 1e-9);
    }
}

/// With a torque ratio above 1 the compliant equilibrium may need more than the torque limits, so lambda* is asked for as well.
#[test]
fn a_torque_ratio_above_one_does_not_raise_the_load_factor() {
    let mut hold = pushed();
    for hand in &mut hold.hands {
        hand.effort_nm[0] = 5.0;
    }
    let at = |torque_ratio: f64| {
        let limits = Limits { load_factor: 1.5, torque_ratio, deflection_mm: 1e3, ..limits() };
        utilisation(&hold, &limits, StabilityKind::Compliant)
    };
    // Of the torque limit, 7.5 of 5 N m; twice that is allowed, but lambda* is 1.
    approx::assert_relative_eq!(at(1.0), 1.5, max_relative = 1e-9);
    approx::assert_relative_eq!(at(2.0), 1.5, max_relative = TOLERANCE);
    approx::assert_relative_eq!(at(0.5), 3.0, max_relative = 1e-9);
}
