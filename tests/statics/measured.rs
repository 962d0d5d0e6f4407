//! Hands with measured wrench limits (docs/method.md#613-measured-grippers): closed forms, invariances, certificates.

use benchdog::{
    model::{
        frames::Pose,
        scenario::Limits,
        wrench::Wrench,
        wrench_limits::{LimitShape, WrenchLimits},
    },
    statics::{
        ContactModel, EquilibriumOutcome, EquilibriumSolver, HandModel, HandWrench, Hold, LimitCrossing,
        LoadFactorOutcome, MeasuredHold, ResponseOutcome, StabilityWorkspace, WeldedStiffness,
    },
};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6xX, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

use crate::fixtures::{limits as limits_of_cut, moved, random_hold, solved, strong_hand, stronger, two_strong_hands};

/// The solver's tolerance is 1e-7 in units of 10 N, 2 N m and 1; a factor of a hundred is left for the conversion.
const TOLERANCE: f64 = 1e-5;

/// Limits drawn as the sizes of the lower and the upper ones: N, and N m that are a tenth of it.
fn drawn_limits(shape: LimitShape, numbers: &[f64; 12]) -> WrenchLimits {
    let of = |first: usize, sign: f64| {
        let at = |i: usize| sign * numbers[first + i];
        Wrench::from([at(0), at(1), at(2), at(3) / 10.0, at(4) / 10.0, at(5) / 10.0])
    };
    WrenchLimits { shape, low: of(0, -1.0), high: of(6, 1.0) }
}

fn shape_of(is_box: bool) -> LimitShape {
    if is_box { LimitShape::Box } else { LimitShape::Ellipsoid }
}

/// The hand with measured limits in place of its pads.
fn measured(mut hand: HandModel, rotation_og: UnitQuaternion<f64>, limits: WrenchLimits) -> HandModel {
    hand.hold = Hold::Measured(MeasuredHold { rotation_og, limits, stiffness: None });
    hand
}

/// A random contact model whose hands have these limits, all of them or the first alone.
fn random_measured(seed: u64, limits: WrenchLimits, all: bool) -> ContactModel {
    let mut hold = random_hold(seed, 2);
    let count = if all { 2 } else { 1 };
    for (number, hand) in hold.hands.iter_mut().take(count).enumerate() {
        let turn = UnitQuaternion::from_euler_angles(0.3 + seed as f64, -0.7, 0.4 * number as f64);
        *hand = measured(hand.clone(), turn, limits);
    }
    hold
}

/// One hand at `p` with limits and no pads.
fn one_hand(p: Vector3<f64>, turn: UnitQuaternion<f64>, limits: WrenchLimits, load: Wrench) -> ContactModel {
    let hand = strong_hand("left", p, Vector3::z(), Vector3::x(), 30.0, 0.6, 0.03);
    ContactModel { hands: vec![measured(hand, turn, limits)], weight: Wrench::default(), load, p_ot: Vector3::zeros() }
}

/// The wrench that the hand of [`one_hand`] exerts under a wrench on the board, in G axes.
fn reaction_g(hold: &ContactModel, outer: &Wrench) -> Wrench {
    let hand = &hold.hands[0];
    hand.measured().unwrap().in_g(&outer.about(&-hand.grasp_point_o).scaled(-1.0))
}

fn huge() -> WrenchLimits {
    WrenchLimits::symmetric(LimitShape::Box, Wrench::from([1e4, 1e4, 1e4, 1e3, 1e3, 1e3]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// One hand carries the whole load, so the load factor is the inverse of its ratio to the limits.
    #[test]
    fn one_hand_holds_the_load_up_to_its_limits(
        numbers in prop::array::uniform12(5.0..50.0_f64),
        load in prop::array::uniform6(-3.0..3.0_f64),
        p in prop::array::uniform3(-0.2..0.2_f64),
        angles in prop::array::uniform3(-1.5..1.5_f64),
        is_box in any::<bool>(),
    ) {
        let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let limits = drawn_limits(shape_of(is_box), &numbers);
        let hold = one_hand(p.into(), turn, limits, load.into());
        let reaction_g = reaction_g(&hold, &hold.load);
        let expected = 1.0 / limits.ratio(&reaction_g);
        prop_assume!(expected < 90.0);
        let found = solved(&hold);
        prop_assert!((found.load_factor - expected).abs() < TOLERANCE * expected.max(1.0), "{} {expected}", found.load_factor);
        let shares = limits.shares(&reaction_g);
        let most = (0..6).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap();
        let name = if is_box { benchdog::model::wrench_limits::COMPONENTS[most] } else { "wrench" };
        prop_assert_eq!(&found.binding[0], &format!("left gripper: {name}"));
        // All limits times s: the load factor times s.
        prop_assert!((found.sensitivity.hands[0].per_measured_limits - expected).abs() < 1e-3 * expected.max(1.0));
    }

    /// The first crossing of the compliant arms is that of the welded board's reaction, with the weight in it.
    #[test]
    fn a_hand_lets_go_where_its_reaction_leaves_the_limits(
        numbers in prop::array::uniform12(20.0..80.0_f64),
        load in prop::array::uniform6(-3.0..3.0_f64),
        is_box in any::<bool>(),
    ) {
        let limits = drawn_limits(shape_of(is_box), &numbers);
        let mut hold = one_hand(Vector3::new(0.02, -0.03, 0.01), UnitQuaternion::identity(), limits, load.into());
        hold.weight = Wrench::from_force(Vector3::new(0.5, 1.0, -2.0));
        let ratio = |lambda: f64| limits.ratio(&reaction_g(&hold, &(hold.weight + hold.load.scaled(lambda))));
        prop_assume!(ratio(0.0) < 1.0 && ratio(90.0) > 1.0);
        let (mut low, mut high) = (0.0, 90.0);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            *(if ratio(middle) <= 1.0 { &mut low } else { &mut high }) = middle;
        }
        let wide = Limits { deflection_mm: 1e9, slip_mm: 1e9, slip_deg: 1e9, torque_ratio: 1e9, ..limits_of_cut() };
        let found = StabilityWorkspace::new().compliant_load_factor(&hold, &wide).unwrap();
        // The accuracy of the search, a thousandth, from below.
        prop_assert!(found.load_factor <= low + 1e-9 && found.load_factor > low - 1.1e-3 * low.max(1.0));
        let first = found.first_limit.unwrap().to_string();
        prop_assert!(first.starts_with("left gripper: "), "{}", first);
    }

    #[test]
    fn frames_units_certificates_and_mechanisms_agree(
        numbers in prop::array::uniform12(5.0..100.0_f64),
        seed in 0..1000_u64,
        is_box in any::<bool>(),
        all in any::<bool>(),
    ) {
        let hold = random_measured(seed, drawn_limits(shape_of(is_box), &numbers), all);
        let mut workspace = StabilityWorkspace::new();
        let found = match workspace.load_factor(&hold).unwrap() {
            LoadFactorOutcome::Solved(found) => found,
            LoadFactorOutcome::GravityInfeasible { certificate } => {
                prop_assert!(certificate.proves_infeasible(&hold).unwrap());
                return Ok(());
            }
            LoadFactorOutcome::Unknown { .. } => return Ok(()),
        };
        let size = found.load_factor.max(1.0);
        let bound = found.dual.upper_bound(&hold).unwrap();
        prop_assert!(bound >= found.load_factor - TOLERANCE * size && bound < found.load_factor + 1e-3 * size, "{bound}");
        let turned = moved(&hold, &Isometry3::new(Vector3::new(0.1, -0.2, 0.3), Vector3::new(0.4, 0.5, -0.6)));
        prop_assert!((solved(&turned).load_factor - found.load_factor).abs() < 1e-4 * size);
        prop_assert!((solved(&stronger(&hold, 2.0)).load_factor - found.load_factor).abs() < 1e-4 * size);
        // The wrenches keep the limits and balance the board.
        let wrenches: Vec<_> = hold.hands.iter().zip(&found.hand_wrenches).collect();
        for (hand, wrench) in &wrenches {
            prop_assert!(hand.grip_ratio(wrench) <= 1.0 + TOLERANCE);
        }
        let sum = wrenches.iter().map(|(hand, wrench)| hand.wrench_about_grasp_point(wrench).about(&hand.grasp_point_o));
        let rest = sum.fold(hold.weight + hold.load.scaled(found.load_factor), |sum, wrench| sum + wrench);
        prop_assert!(rest.to_vector().norm() < 1e-4, "{rest:?}");
        // Whatever a mechanism refutes is beyond the load factor.
        for share in [0.3, 0.9, 1.1, 2.0] {
            let at = share * found.load_factor;
            prop_assert!(share > 1.0 || hold.infeasibility(at).is_none());
        }
    }

    /// Clarabel's equilibrium of measured hands, which have no limits in it, is the closed form of welded ones.
    #[test]
    fn both_ways_to_the_equilibrium_agree(seed in 0..200_u64, all in any::<bool>()) {
        let mut hold = random_measured(seed, huge(), all);
        for hand in &mut hold.hands {
            if let Hold::Measured(measured) = &mut hand.hold {
                measured.stiffness = (seed % 2 == 0).then(|| Vector6::new(3e4, 2e4, 5e4, 40.0, 30.0, 60.0));
            } else {
                hand.scale_grip(30.0);
            }
        }
        let mut workspace = StabilityWorkspace::new();
        let ResponseOutcome::Found(closed) = workspace.response(&hold, 1.0).unwrap() else { panic!("seed {seed}") };
        let welded = WeldedStiffness::new(&hold).unwrap();
        let expected_m = welded.twist_at_tip(&hold.load).linear;
        prop_assert!((closed.deflection_m - expected_m).norm() < 1e-12 + 1e-9 * expected_m.norm());
        let mut at = |lambda: f64| match workspace.equilibrium(&hold, lambda, EquilibriumSolver::Clarabel).unwrap() {
            EquilibriumOutcome::Found(found) => found.board.at(&hold.p_ot).linear,
            other => panic!("seed {seed}: {other:?}"),
        };
        let by_cones_m = at(1.0) - at(0.0);
        // The solver's tolerance along the flattest directions, as in tests/statics/compliance.rs.
        prop_assert!((by_cones_m - expected_m).norm() < 1e-3 * expected_m.norm() + 1e-9);
    }
}

#[test]
fn a_hand_with_pads_and_a_measured_one_share_a_load() {
    // Along x, the line through both grasp points: friction of two pads, 2 x 0.6 x 30 N, and 25 N in the direction of +x.
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::new(-1.0, 0.0, 0.0)));
    let mut limits = WrenchLimits::symmetric(LimitShape::Box, Wrench::from([25.0, 40.0, 40.0, 4.0, 4.0, 4.0]));
    limits.low.force_n.x = -10.0;
    hold.hands[1] = measured(hold.hands[1].clone(), UnitQuaternion::identity(), limits);
    let found = solved(&hold);
    approx::assert_abs_diff_eq!(found.load_factor, 36.0 + 25.0, epsilon = 61.0 * TOLERANCE);
    for name in ["right gripper: force x", "left upper pad: friction", "left lower pad: friction"] {
        assert!(found.binding.iter().any(|found| found == name), "{:?}", found.binding);
    }
    assert!(matches!(found.hand_wrenches[0], HandWrench::Pads(_)));
    let HandWrench::Measured(wrench) = found.hand_wrenches[1] else { panic!("{:?}", found.hand_wrenches) };
    approx::assert_abs_diff_eq!(wrench.force_n.x, 25.0, epsilon = 1e-3);
    // The other way the hand pulls with 10 N only.
    hold.load = hold.load.scaled(-1.0);
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 46.0, epsilon = 46.0 * TOLERANCE);
}

#[test]
fn an_elastic_grip_yields_by_its_stiffness_in_its_own_axes() {
    // An arm without joints: only the grip yields.
    let turn = UnitQuaternion::from_euler_angles(0.4, -0.3, 1.1);
    let p = Vector3::new(0.2, 0.1, 0.0);
    let load = Wrench::new(Vector3::new(3.0, -2.0, 5.0), Vector3::new(0.2, 0.1, -0.3)).about(&p);
    let mut hold = one_hand(p, turn, huge(), load);
    let hand = &mut hold.hands[0];
    hand.joints.clear();
    hand.jacobian_o = Matrix6xX::zeros(0);
    for vector in [&mut hand.gravity_torque_nm, &mut hand.effort_nm, &mut hand.stiffness_nm_rad] {
        *vector = DVector::zeros(0);
    }
    hand.gravity_stiffness_nm_rad = DMatrix::zeros(0, 0);
    let stiffness = Vector6::new(1e4, 2e4, 5e4, 40.0, 30.0, 60.0);
    let Hold::Measured(held) = &mut hand.hold else { panic!() };
    held.stiffness = Some(stiffness);
    hold.p_ot = p;
    let ResponseOutcome::Found(found) = StabilityWorkspace::new().response(&hold, 1.0).unwrap() else { panic!() };
    let push_g = turn.inverse() * Vector3::new(3.0, -2.0, 5.0);
    let expected_m = turn * push_g.component_div(&stiffness.fixed_rows::<3>(0).into_owned());
    approx::assert_relative_eq!(found.deflection_m, expected_m, max_relative = 1e-9);
    // The yielding of the grip is no slip.
    assert!(found.slip[0].linear.norm() < 1e-12 && found.slip[0].angular.norm() < 1e-12);
    let (x_od, springs) = hold.hands[0].springs().unwrap();
    assert_eq!((x_od, springs), (Pose::from_parts(p.into(), turn), stiffness));
}

#[test]
fn a_board_that_is_too_heavy_is_refuted_with_a_certificate() {
    let limits = WrenchLimits::symmetric(LimitShape::Ellipsoid, Wrench::from([20.0, 20.0, 20.0, 2.0, 2.0, 2.0]));
    let mut hold = one_hand(
        Vector3::zeros(),
        UnitQuaternion::identity(),
        limits,
        Wrench::from_force(Vector3::new(0.0, 0.0, -1.0)),
    );
    hold.weight = Wrench::from_force(Vector3::new(0.0, 0.0, -21.0));
    let outcome = StabilityWorkspace::new().load_factor(&hold).unwrap();
    let LoadFactorOutcome::GravityInfeasible { certificate } = outcome else { panic!("found {outcome:?}") };
    assert!(certificate.proves_infeasible(&hold).unwrap());
    assert!(hold.infeasibility(0.0).is_some());
    let found = StabilityWorkspace::new().compliant_load_factor(&hold, &limits_of_cut()).unwrap();
    assert_eq!(found.first_limit, Some(LimitCrossing::NoEquilibrium { binding: Vec::new() }));
    hold.hands[0].scale_grip(1.1);
    assert!(!certificate.proves_infeasible(&hold).unwrap());
    approx::assert_abs_diff_eq!(solved(&hold).load_factor, 1.0, epsilon = 22.0 * TOLERANCE);
}

#[test]
fn invalid_limits_and_stiffnesses_are_told() {
    let message = |change: &dyn Fn(&mut MeasuredHold)| {
        let mut hold = one_hand(Vector3::zeros(), UnitQuaternion::identity(), huge(), Wrench::default());
        let Hold::Measured(measured) = &mut hold.hands[0].hold else { panic!() };
        change(measured);
        StabilityWorkspace::new().load_factor(&hold).unwrap_err().to_string()
    };
    let enclosing = "left gripper: found wrench limits that do not enclose 0, expected finite ones below and above it";
    assert_eq!(message(&|measured| measured.limits.low.force_n.y = 0.0), enclosing);
    assert_eq!(message(&|measured| measured.limits.high.moment_nm.z = f64::INFINITY), enclosing);
    assert_eq!(
        message(&|measured| measured.stiffness = Some(Vector6::repeat(-1.0))),
        "left gripper: found stiffness -1, expected more than 0"
    );
    assert_eq!(
        message(&|measured| measured.stiffness = Some(Vector6::new(1.0, 1.0, 1.0, 1.0, 1.0, 0.0))),
        "left gripper: found stiffness 0, expected more than 0"
    );
}

/// The ratio is that of the largest component to its limit, in the gripper's axes; pads have none.
#[test]
fn a_measured_hand_knows_its_share_of_the_limits() {
    let mut limits = WrenchLimits::symmetric(LimitShape::Box, Wrench::from([100.0, 50.0, 20.0, 10.0, 5.0, 2.0]));
    limits.low.force_n.z = -10.0;
    // z_G is along x_O.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    let hold = one_hand(Vector3::zeros(), turn, limits, Wrench::default());
    let ratio = |wrench: [f64; 6]| hold.hands[0].grip_ratio(&HandWrench::Measured(Wrench::from(wrench)));
    for (wrench, expected) in [
        ([5.0, 0.0, 0.0, 0.0, 0.0, 0.0], 5.0 / 20.0),
        ([-5.0, 0.0, 0.0, 0.0, 0.0, 0.0], 5.0 / 10.0),
        ([0.0, 30.0, 40.0, 0.0, 0.0, 0.0], 30.0 / 50.0),
        ([5.0, 0.0, 0.0, 1.5, 0.0, 0.0], 1.5 / 2.0),
    ] {
        approx::assert_relative_eq!(ratio(wrench), expected, max_relative = 1e-12);
    }
    let pads = strong_hand("left", Vector3::zeros(), Vector3::z(), Vector3::x(), 30.0, 0.6, 0.03);
    assert_eq!(pads.grip_ratio(&HandWrench::Pads([Wrench::from([1e3; 6]); 2])), 0.0);
}
