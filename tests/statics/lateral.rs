//! Sideways pushes: closed forms, and what holds for any grasp.

use benchdog::{
    model::{
        lateral::LateralPush,
        load::Load,
        operation::{Operation, OperationKind},
        scenario::{Limits, StabilityKind},
        wrench::Wrench,
    },
    statics::{ContactModel, HandModel, LoadCases, LoadFactorOutcome, StabilityWorkspace},
};
use nalgebra::{DVector, Isometry3, Vector3};

use crate::fixtures::{limits, random_hold, strong_hand};

/// See `closed_forms`.
const TOLERANCE: f64 = 1e-5;

/// `1 / cos(pi / 16)`: how far the corners of the polygon are from the middle of a circle of radius 1.
fn outward() -> f64 {
    1.0 / (std::f64::consts::PI / 16.0).cos()
}

/// A force at a point of O.
fn operation(force_n: Vector3<f64>, p_ot: Vector3<f64>) -> Operation {
    Operation {
        kind: OperationKind::Wrench,
        wrench_o: Wrench::from_force(force_n),
        x_ot: Isometry3::from_parts(p_ot.into(), nalgebra::UnitQuaternion::identity()),
    }
}

/// The loads of a hold whose load is a force at its tool tip.
fn cases(hold: &ContactModel, lateral_share: f64) -> LoadCases {
    let load = Load { lateral_share, ..Load::default() };
    LoadCases::new(hold.clone(), &operation(hold.load.force_n, hold.p_ot), &load)
}

fn least(hold: &ContactModel, share: f64) -> f64 {
    match StabilityWorkspace::new().least_load_factor(&cases(hold, share)).unwrap().1 {
        LoadFactorOutcome::Solved(solved) => solved.load_factor,
        other => panic!("expected a load factor, found {other:?}"),
    }
}

/// A pinch of pads that face +-y, under a force along x at the grasp point.
fn pinch(force_n: f64, hand: HandModel) -> ContactModel {
    let load = Wrench::from_force(Vector3::x() * force_n);
    ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() }
}

fn hand() -> HandModel {
    strong_hand("left", Vector3::zeros(), Vector3::y(), Vector3::x(), 30.0, 0.6, 0.03)
}

/// Along the faces both pads give friction up to `2 mu F`, whatever the normal force, which the two only share. So the push that
/// counts is that along the faces: +-z, 90 or 270 degrees about x, as 0 is along z_O x x_O = y_O.
#[test]
fn a_pinch_is_worst_pushed_along_its_faces() {
    for share in [0.0, 0.13, 0.5, 1.0] {
        let (case, outcome) = StabilityWorkspace::new().least_load_factor(&cases(&pinch(1.0, hand()), share)).unwrap();
        let expected = 36.0 / (1.0_f64).hypot(share * outward());
        approx::assert_abs_diff_eq!(outcome.load_factor().unwrap(), expected, epsilon = 36.0 * TOLERANCE);
        let push = cases(&pinch(1.0, hand()), share).push(case);
        assert_eq!(push.is_some(), share > 0.0);
        if let Some(push) = push {
            assert!([90.0, 270.0].contains(&push.direction_deg), "{push}");
            // What is stated is the person's push, not the corner of the polygon.
            assert!((push.force_o_n[2].abs() - share).abs() < 1e-12, "{push}");
        }
    }
}

/// Springs along the axes: the deflection by forces f along x and g along z is `hypot(f / k_x, g / k_z)`, and the load factor ends
/// at its limit.
#[test]
fn welded_hands_are_worst_pushed_along_their_softest_axis() {
    let mut soft = hand();
    soft.stiffness_nm_rad = DVector::from_row_slice(&[1000.0, 1000.0, 250.0, 1e3, 1e3, 1e3]);
    let hold = pinch(2.0, soft);
    for share in [0.13, 0.5] {
        let found = StabilityWorkspace::new().predict(&cases(&hold, share), &limits()).unwrap().unwrap().stability;
        let deflection_mm = 2.0_f64.hypot(2.0 * share * outward() * 4.0);
        // The pads' compliance of 1e-10 m/N is 1e-7 of the springs'.
        approx::assert_relative_eq!(found.predicted_deflection_mm, deflection_mm, max_relative = 1e-6);
        let expected = limits().deflection_mm / deflection_mm;
        // It is found to a thousandth, from below.
        assert!((0.0..2e-3).contains(&(1.0 - found.compliant_load_factor / expected)), "{found:?} {expected}");
        assert!([90.0, 270.0].contains(&found.lateral.unwrap().direction_deg), "{found:?}");
    }
}

/// Random holds that carry their weight and some of the load with the largest push.
fn held() -> Vec<ContactModel> {
    let mut workspace = StabilityWorkspace::new();
    let mut carries = |hold: &ContactModel| {
        let idle = ContactModel { load: Wrench::default(), ..hold.clone() };
        let carried = workspace.load_factor(&idle).unwrap().load_factor().is_some();
        carried && workspace.load_factor(hold).unwrap().load_factor().is_some_and(|found| found > 0.05)
    };
    let holds: Vec<_> = (0..30).map(|seed| random_hold(seed, 1 + seed as usize % 3)).filter(&mut carries).collect();
    // Enough to say something about all kinds.
    assert!(holds.len() >= 10, "{}", holds.len());
    holds
}

/// The loads that are resisted at one factor are a convex set: the corners of a smaller polygon are mixtures of those of a larger.
#[test]
fn the_load_factor_falls_with_the_share() {
    for (number, hold) in held().iter().enumerate() {
        let factors = [0.0, 0.05, 0.13, 0.4, 1.0].map(|share| least(hold, share));
        let falls = factors.windows(2).all(|pair| pair[1] <= pair[0] + TOLERANCE * pair[0].max(1.0));
        assert!(falls, "{number}: {factors:?}");
        assert!(factors[4] < factors[0] - 1e-3 || factors[0] > 99.0, "{number}: {factors:?}");
    }
}

/// For the same reason no push of any direction in between is worse than the corners.
#[test]
fn no_direction_is_worse_than_predicted() {
    let mut workspace = StabilityWorkspace::new();
    for (number, hold) in held().iter().enumerate() {
        let predicted = least(hold, 0.3);
        let task = operation(hold.load.force_n, hold.p_ot);
        // The golden angle: directions that never repeat.
        for step in 0..10 {
            let push = LateralPush::new(&task, 0.3, 137.508 * f64::from(step) + number as f64).unwrap();
            let load = (task.wrench_o + push.wrench_o()).about(&hold.p_ot);
            let found = workspace.load_factor(&ContactModel { load, ..hold.clone() }).unwrap().load_factor().unwrap();
            assert!(found >= predicted - TOLERANCE * predicted.max(1.0), "{number} {push}: {found} {predicted}");
        }
    }
}

#[test]
fn a_scaled_load_has_a_scaled_push() {
    let hold = pinch(1.0, hand());
    let doubled = StabilityWorkspace::new().least_load_factor(&cases(&hold, 0.5).scaled(2.0)).unwrap().1;
    approx::assert_abs_diff_eq!(2.0 * doubled.load_factor().unwrap(), least(&hold, 0.5), epsilon = 36.0 * TOLERANCE);
}

/// A case is the operation's force and the push to a corner of the polygon about the circle of pushes.
#[test]
fn each_case_has_its_own_load() {
    let hold = pinch(10.0, hand());
    let cases = cases(&hold, 0.3);
    let mut found = 0;
    while let Some(push) = cases.push(found) {
        let load = cases.clone().into_case(found).load;
        let aside_n = load.force_n - hold.load.force_n;
        assert!((aside_n - Vector3::from(push.force_o_n) * outward()).norm() < 1e-12, "{push}");
        approx::assert_relative_eq!(Vector3::from(push.force_o_n).norm(), 3.0, max_relative = 1e-12);
        assert_eq!(cases.case_of(Some(&push)), found);
        found += 1;
    }
    assert_eq!(found, 16);
    assert_eq!(cases.case_of(None), 0);
    assert_eq!(cases.clone().into_case(found).load, cases.into_case(0).load);
}

/// The case that uses most of its limits is the worst of the cases alone, the first of equals.
#[test]
fn the_worst_case_is_that_of_all_cases_alone() {
    let mut workspace = StabilityWorkspace::new();
    let kinds = [StabilityKind::Paper, StabilityKind::Compliant];
    for (hold, kind) in held().into_iter().flat_map(|hold| kinds.map(|kind| (hold.clone(), kind))) {
        let cases = cases(&hold, 0.2);
        let of_case = |workspace: &mut StabilityWorkspace, case| {
            workspace.utilisation(&cases.clone().into_case(case), &limits(), kind).unwrap()
        };
        let alone: Vec<f64> = (0..16).map(|case| of_case(&mut workspace, case)).collect();
        let largest = alone.iter().copied().fold(0.0, f64::max);
        let found = workspace.assess(&cases, &limits(), kind).unwrap();
        assert_eq!(found.response.is_some(), kind == StabilityKind::Compliant && largest.is_finite());
        if largest.is_infinite() {
            assert_eq!(
                (found.utilisation, found.case),
                (largest, alone.iter().position(|of| of.is_infinite()).unwrap())
            );
        } else {
            // The solvers' last digits depend on what was solved before.
            approx::assert_relative_eq!(found.utilisation, largest, max_relative = 1e-6);
            approx::assert_relative_eq!(alone[found.case], largest, max_relative = 1e-6);
        }
    }
    let without_load = Limits { load_factor: 0.0, ..limits() };
    let found = workspace.assess(&cases(&pinch(1.0, hand()), 0.2), &without_load, StabilityKind::Paper).unwrap();
    assert_eq!((found.utilisation, found.case), (0.0, 0));
    // Nor do loads of nothing differ.
    let idle = cases(&pinch(1.0, hand()), 0.2).scaled(0.0);
    let (case, found) = workspace.least_compliant_load_factor(&idle, &limits()).unwrap();
    assert_eq!((case, found.load_factor, found.first_limit), (0, 100.0, None));
}
