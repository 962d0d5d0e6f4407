//! The compliant equilibrium against the welded stiffness, closed forms, the energy theorem and a scan.

use benchdog::{
    model::{scenario::Limits, wrench::Wrench},
    statics::{
        CompliantResponse, ContactModel, EquilibriumOutcome, EquilibriumSolver, LimitCrossing, LoadFactorOutcome,
        ResponseOutcome, StabilityWorkspace, WeldedStiffness,
    },
};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::fixtures::{limits, random_hold, set_grip, strong_hand, two_strong_hands};

fn response(hold: &ContactModel, load_factor: f64) -> CompliantResponse {
    match StabilityWorkspace::new().response(hold, load_factor).unwrap() {
        ResponseOutcome::Found(response) => *response,
        other => panic!("expected an equilibrium, found {other:?}"),
    }
}

/// A random contact model with pads far from their limits.
fn elastic_hold(seed: u64) -> ContactModel {
    let mut hold = random_hold(seed, 2);
    hold.hands.iter_mut().for_each(|hand| set_grip(hand, 1e3));
    hold
}

/// No limits except those of the pads.
fn no_limits() -> Limits {
    Limits {
        slip_mm: 1e9,
        slip_deg: 1e9,
        deflection_mm: 1e9,
        sag_mm: 1e9,
        creep_mm_s: 1e9,
        torque_ratio: 1e9,
        load_factor: 1.0,
        clearance_mm: 0.0,
        rula: None,
        rula_arm: None,
        reba: None,
    }
}

/// The pads' own compliance, two in parallel: 1e-10/(2 e^2) = 2.3e-7 rad/(N m) beside an arm's 1e-3 about an axis, and
/// less along one. With moments that levers raise, below a thousandth.
const PAD_SHARE: f64 = 1e-3;

/// Without slip `C_i w_i + Ad_i d = t_i` for each hand and the wrenches balance the object: the closed form, the interior point
/// and clarabel.
#[test]
fn offsets_of_the_joints_strain_the_closed_chain() {
    for seed in 0..20 {
        let mut hold = elastic_hold(seed);
        for (number, hand) in hold.hands.iter_mut().enumerate() {
            let side = if number == 0 { 1.0 } else { -0.5 };
            hand.offset.linear = Vector3::new(1e-3, -2e-3, 1.5e-3) * side;
            hand.offset.angular = Vector3::new(-2e-3, 1e-3, 3e-3) * side;
        }
        for solver in [EquilibriumSolver::InteriorPoint, EquilibriumSolver::Clarabel] {
            let found = StabilityWorkspace::new().equilibrium(&hold, 1.0, solver).unwrap();
            let EquilibriumOutcome::Found(found) = found else { panic!("seed {seed}: {found:?}") };
            let mut total = hold.weight + hold.load;
            for (hand, wrench) in hold.hands.iter().zip(&found.hand_wrenches) {
                let wrench = hand.wrench_about_grasp_point(wrench);
                total = total + wrench.about(&hand.grasp_point_o);
                let moved = hand.compliance() * wrench.to_vector();
                let board = found.board.at(&hand.grasp_point_o);
                let off_m = (board.linear + moved.fixed_rows::<3>(0) - hand.offset.linear).norm();
                let off_rad = (board.angular + moved.fixed_rows::<3>(3) - hand.offset.angular).norm();
                // The pads' own compliance, see PAD_SHARE: of displacements of 2 mm and 4 mrad.
                assert!(
                    off_m < 2e-3 * PAD_SHARE && off_rad < 1e-2 * PAD_SHARE,
                    "{seed} {solver:?}: {off_m:e} m, {off_rad:e}"
                );
            }
            assert!(total.to_vector().norm() < 1e-5, "{seed} {solver:?}: {total:?}");
        }
        // The same motion of all hands is a motion of the board, and strains nothing.
        let unstrained = response(&hold, 0.0).equilibrium;
        for hand in &mut hold.hands {
            let carried = benchdog::statics::Twist { linear: Vector3::x() * 2e-3, angular: Vector3::z() * 1e-3 };
            let at_hand = carried.at(&hand.grasp_point_o);
            hand.offset.linear += at_hand.linear;
            hand.offset.angular += at_hand.angular;
        }
        for (one, other) in unstrained.joint_torque_nm.iter().zip(&response(&hold, 0.0).equilibrium.joint_torque_nm) {
            assert!((one - other).amax() < 1e-6 * (1.0 + one.amax()), "{seed}");
        }
    }
}

#[test]
fn without_slip_the_board_moves_as_if_welded() {
    for seed in 0..20 {
        let hold = elastic_hold(seed);
        let welded = WeldedStiffness::new(&hold).unwrap();
        let expected = welded.twist_at_tip(&hold.load);
        let found = response(&hold, 1.0);
        approx::assert_relative_eq!(found.deflection_m, expected.linear, epsilon = PAD_SHARE * expected.linear.norm());
        for (hand, slip) in found.slip.iter().enumerate() {
            // A pad's own compliance: 1e-10 m/N times about 30 N; for moments of 3 N m, 1e-6 rad.
            assert!(slip.linear.norm() < 1e-7 && slip.angular.norm() < 5e-6, "hand {hand}: {slip:?}");
        }
        let unloaded = response(&hold, 0.0);
        for ((hand, wrench), (loaded, unloaded)) in hold
            .hands
            .iter()
            .zip(welded.hand_wrenches(&hold.load))
            .zip(found.equilibrium.joint_torque_nm.iter().zip(&unloaded.equilibrium.joint_torque_nm))
        {
            let expected = hand.jacobian_o.tr_mul(&wrench.to_vector());
            let largest = expected.amax();
            approx::assert_relative_eq!(
                loaded - unloaded,
                DVector::from(expected.as_slice().to_vec()),
                epsilon = 5.0 * PAD_SHARE * largest
            );
        }
    }
}

#[test]
fn without_slip_pads_do_not_matter() {
    for seed in 0..10 {
        let hold = elastic_hold(seed);
        let reference = response(&hold, 1.0).deflection_m;
        let mut other = hold.clone();
        for hand in &mut other.hands {
            hand.scale_grip(1.7);
            hand.pads_mut()[0].friction *= 1.5;
            hand.pads_mut()[1].half_sides_m[0] *= 0.7;
            hand.pads_mut()[1].x_op.translation.vector.x += 0.005;
        }
        approx::assert_relative_eq!(
            response(&other, 1.0).deflection_m,
            reference,
            epsilon = PAD_SHARE * reference.norm()
        );
    }
}

#[test]
fn welded_hands_are_springs_in_parallel() {
    // Two hands of 1000 N/m and 1000 N m/rad at x = +-0.23 m.
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::new(1.0, 0.0, 0.0)));
    hold.p_ot = Vector3::zeros();
    let welded = WeldedStiffness::new(&hold).unwrap();
    let about_z = 2.0 * (1000.0 + 1000.0 * 0.23 * 0.23);
    let along_x = welded.twist_at_tip(&Wrench::from_force(Vector3::x()));
    let turned = welded.twist_at_tip(&Wrench::new(Vector3::zeros(), Vector3::z()));
    approx::assert_relative_eq!(1.0 / along_x.linear.x, 2000.0, epsilon = 1e-9);
    approx::assert_relative_eq!(1.0 / turned.angular.z, about_z, epsilon = 1e-9);
    // Twice 1000 N/m: half a millimetre per newton.
    approx::assert_relative_eq!(response(&hold, 1.0).deflection_m.x, 5e-4, max_relative = 1e-5);
    // Under a moment about z, each hand is pushed along y as well.
    hold.load = Wrench::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0));
    hold.p_ot = Vector3::new(0.1, 0.0, 0.0);
    approx::assert_relative_eq!(response(&hold, 0.2).deflection_m.y, 0.1 * 0.2 / about_z, max_relative = PAD_SHARE);
}

#[test]
fn the_welded_stiffness_does_not_depend_on_the_unit_of_force() {
    for scale in [1e-9, 1.0, 1e9] {
        let mut hold = two_strong_hands(Wrench::default(), Wrench::default());
        hold.hands.iter_mut().for_each(|hand| hand.stiffness_nm_rad *= scale);
        let welded = WeldedStiffness::new(&hold).unwrap_or_else(|| panic!("rigid at {scale}"));
        let twist = welded.twist_at_tip(&Wrench::from_force(Vector3::new(0.0, 0.0, 10.0 * scale)).about(&hold.p_ot));
        // Two springs of 1000 N/m; the tip is 0.1 m beside the line between them, which turns about x by 2000 N m/rad, and about y
        // with 0.23 m as lever.
        let expected_m = 10.0 / 2000.0 + 10.0 * 0.1 * 0.1 / 2000.0 + 10.0 * 0.1 * 0.1 / (2000.0 + 2000.0 * 0.23 * 0.23);
        approx::assert_relative_eq!(twist.linear.z, expected_m, max_relative = 1e-9);
    }
}

#[test]
fn a_sliding_hand_leaves_the_rest_of_the_load_to_the_other() {
    // Along x, in line with both hands: each takes half until the weak one slides at 2 mu F = 12 N.
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::new(30.0, 0.0, 0.0)));
    hold.p_ot = Vector3::zeros();
    set_grip(&mut hold.hands[1], 10.0);
    let compliance = 1e-3;
    let elastic = response(&hold, 0.5);
    approx::assert_relative_eq!(elastic.deflection_m.x, 7.5 * compliance, max_relative = 1e-4);
    let sliding = response(&hold, 1.0);
    // The strong hand takes 30 - 12 N; the weak one is displaced as by 12 N, the board as by 18 N.
    approx::assert_relative_eq!(sliding.deflection_m.x, 18.0 * compliance, max_relative = 1e-4);
    approx::assert_relative_eq!(sliding.slip[1].linear.x, 6.0 * compliance, max_relative = 1e-4);
    assert!(sliding.slip[0].linear.norm() < 1e-6);
    let (ratio, crossing) = sliding.worst_limit(&hold, &limits());
    assert!(ratio > 1.0);
    assert_eq!(crossing, LimitCrossing::Slip { hand: "right".into() });
    // Slip of 1 mm at 12 + 12 + 1 N, in units of 30 N.
    let found = StabilityWorkspace::new().compliant_load_factor(&hold, &limits()).unwrap();
    approx::assert_abs_diff_eq!(found.load_factor, 25.0 / 30.0, epsilon = 1.1e-3);
    assert_eq!(found.first_limit, Some(LimitCrossing::Slip { hand: "right".into() }));
}

#[test]
fn a_hand_that_turns_becomes_a_hinge() {
    // A moment about the pads' normal on two hands, one with a weak grip. Its pads turn at 2 mu e F, and the other hand
    // takes the rest.
    let hand = |name: &str, grip_n: f64| {
        let mut hand = strong_hand(name, Vector3::zeros(), Vector3::z(), Vector3::x(), grip_n, 0.6, 0.03);
        hand.stiffness_nm_rad = DVector::from_element(6, 100.0);
        hand
    };
    let load = Wrench::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 1.0));
    let hold = ContactModel {
        hands: vec![hand("left", 100.0), hand("right", 10.0)],
        weight: Wrench::default(),
        load,
        p_ot: Vector3::zeros(),
    };
    let held_nm = 2.0 * 0.6 * 10.0 * hold.hands[1].pads()[0].torsion_radius_m();
    let found = response(&hold, 1.0);
    let turned_rad = (1.0 - held_nm) / 100.0;
    let slip_rad = turned_rad - held_nm / 100.0;
    approx::assert_relative_eq!(found.slip[1].angular.z, slip_rad, max_relative = PAD_SHARE);
    approx::assert_relative_eq!(found.equilibrium.board.angular.z, turned_rad, max_relative = PAD_SHARE);
}

#[test]
fn the_work_of_the_load_is_the_slope_of_the_energy() {
    // d(energy)/d(lambda) = load . d(lambda), slip or no slip: energy by the joints' springs, displacement by duality.
    let mut workspace = StabilityWorkspace::new();
    let mut compared = 0;
    for seed in 0..40 {
        let hold = random_hold(seed, 1 + seed as usize % 3);
        let Some(last) = workspace.friction_load_factor(&hold).unwrap().load_factor() else { continue };
        let at = 0.8 * last.min(5.0);
        let step = 1e-3 * at;
        let energy = |load_factor: f64| {
            let torques = response(&hold, load_factor).equilibrium.joint_torque_nm;
            let of_hand = |(hand, torque): (&benchdog::statics::HandModel, &DVector<f64>)| {
                let spring = torque - &hand.gravity_torque_nm;
                spring.component_mul(&spring).component_div(&hand.stiffness_nm_rad).sum() / 2.0
            };
            hold.hands.iter().zip(&torques).map(of_hand).sum::<f64>()
        };
        let slope = (energy(at + step) - energy(at - step)) / (2.0 * step);
        let work = response(&hold, at).equilibrium.board.work(&hold.load);
        // The energy's third derivative jumps where a pad starts to slip; the difference quotient is then good to the
        // step, 1e-3. The pads' own energy is another thousandth.
        approx::assert_relative_eq!(work, slope, max_relative = 5e-3, epsilon = 1e-6);
        compared += 1;
    }
    assert!(compared >= 20, "only {compared} of 40 random holds carry their weight");
}

#[test]
fn one_hand_alone_is_limited_by_its_pads() {
    // Statically determinate: the equilibrium ends at the friction limit for any joint stiffness.
    let hand = strong_hand("left", Vector3::zeros(), Vector3::y(), Vector3::x(), 30.0, 0.6, 0.03);
    let load = Wrench::from_force(Vector3::new(0.0, 0.0, -10.0));
    let hold = ContactModel { hands: vec![hand], weight: Wrench::default(), load, p_ot: Vector3::zeros() };
    let mut workspace = StabilityWorkspace::new();
    let found = workspace.compliant_load_factor(&hold, &no_limits()).unwrap();
    // Half of the tolerance of a thousandth below the end, where the program still has an interior.
    approx::assert_relative_eq!(found.load_factor, 3.6 * (1.0 - 0.5e-3), max_relative = 1e-5);
    let Some(LimitCrossing::NoEquilibrium { binding }) = &found.first_limit else { panic!("{:?}", found.first_limit) };
    assert!(binding.contains(&"left upper pad: friction".into()), "{binding:?}");
    // Beyond there is no equilibrium; a board that is too heavy has none at all.
    assert!(matches!(workspace.response(&hold, 3.7).unwrap(), ResponseOutcome::NoEquilibrium { load_factor: 3.7 }));
    let mut heavy = hold.clone();
    heavy.weight = Wrench::from_force(Vector3::new(0.0, 0.0, -40.0));
    assert!(matches!(workspace.response(&heavy, 1.0).unwrap(), ResponseOutcome::NoEquilibrium { load_factor: 0.0 }));
    let found = workspace.compliant_load_factor(&heavy, &no_limits()).unwrap();
    assert_eq!(
        (found.load_factor, found.first_limit),
        (0.0, Some(LimitCrossing::NoEquilibrium { binding: Vec::new() }))
    );
    let crossing = LimitCrossing::NoEquilibrium { binding: Vec::new() };
    assert_eq!(crossing.to_string(), "weight: no equilibrium");
}

#[test]
fn elastic_limits_are_found_where_the_springs_put_them() {
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::new(10.0, 0.0, 0.0)));
    hold.p_ot = Vector3::zeros();
    let mut workspace = StabilityWorkspace::new();
    // 5 mm a load factor: 15 mm at 3. The lower probe is a third of the tolerance, a thousandth, below the prediction.
    let found = workspace.compliant_load_factor(&hold, &limits()).unwrap();
    approx::assert_relative_eq!(found.load_factor, 3.0 * (1.0 - 1e-3 / 3.0), max_relative = 1e-9);
    assert_eq!(found.first_limit, Some(LimitCrossing::Deflection));
    // Both probes are at the welded prediction.
    assert_eq!(found.equilibria, 3);
    // The first joint of each hand moves along x and takes 5 N m a load factor on top of 4.
    for hand in &mut hold.hands {
        hand.effort_nm[0] = 14.0;
        hand.gravity_torque_nm[0] = -4.0;
    }
    let found = workspace.compliant_load_factor(&hold, &limits()).unwrap();
    approx::assert_abs_diff_eq!(found.load_factor, 2.0, epsilon = 2.1e-3);
    assert_eq!(found.first_limit.unwrap().to_string(), "left_0: torque");
    assert_eq!(found.equilibria, 3);
    // A joint beyond its torque limit under gravity alone.
    hold.hands[1].gravity_torque_nm[0] = -15.0;
    let found = workspace.compliant_load_factor(&hold, &limits()).unwrap();
    assert_eq!(found.load_factor, 0.0);
    assert_eq!(found.first_limit.unwrap().to_string(), "right_0: torque");
    // Without a load: the cap.
    let idle = two_strong_hands(Wrench::default(), Wrench::default());
    let found = workspace.compliant_load_factor(&idle, &limits()).unwrap();
    assert_eq!((found.load_factor, found.first_limit), (100.0, None));
}

#[test]
fn the_search_finds_the_first_crossing_of_a_scan() {
    let mut workspace = StabilityWorkspace::new();
    let mut crossings = 0;
    for seed in 0..40 {
        let hold = random_hold(seed, 1 + seed as usize % 2);
        let found = workspace.compliant_load_factor(&hold, &limits()).unwrap();
        let kept = |workspace: &mut StabilityWorkspace, load_factor: f64| {
            let outcome = workspace.response(&hold, load_factor).unwrap();
            matches!(outcome, ResponseOutcome::Found(response) if response.utilisation(&hold, &limits()) <= 1.0)
        };
        if found.load_factor > 0.0 {
            for step in 0..=20 {
                let load_factor = found.load_factor * f64::from(step) / 20.0;
                assert!(kept(&mut workspace, load_factor), "seed {seed}: crossed at {load_factor} before {found:?}");
            }
        }
        if found.load_factor < 100.0 {
            // The search's tolerance is a thousandth.
            let beyond = found.load_factor + 1.1e-3 * found.load_factor.max(1.0);
            assert!(!kept(&mut workspace, beyond), "seed {seed}: nothing crossed at {beyond} after {found:?}");
            crossings += 1;
        }
    }
    assert!(crossings >= 30, "only {crossings} of 40");
}

#[test]
fn the_compliant_load_factor_is_never_above_the_best_case() {
    let mut workspace = StabilityWorkspace::new();
    for seed in 0..60 {
        let hold = random_hold(seed, 1 + seed as usize % 4);
        let best = match workspace.load_factor(&hold).unwrap() {
            LoadFactorOutcome::Solved(solved) => solved.load_factor,
            LoadFactorOutcome::GravityInfeasible { .. } => 0.0,
            LoadFactorOutcome::Unknown { status } => panic!("seed {seed}: {status}"),
        };
        let found = workspace.compliant_load_factor(&hold, &limits()).unwrap();
        assert!(found.load_factor <= best + 1e-4 * best.max(1.0), "seed {seed}: {found:?} above {best}");
    }
}

#[test]
fn arms_that_are_rigid_in_some_direction_have_no_welded_stiffness() {
    // Two joints leave four directions rigid.
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::x()));
    for hand in &mut hold.hands {
        hand.joints.truncate(2);
        hand.jacobian_o = hand.jacobian_o.columns(0, 2).into_owned();
        for values in [&mut hand.gravity_torque_nm, &mut hand.effort_nm, &mut hand.stiffness_nm_rad] {
            *values = values.rows(0, 2).into_owned();
        }
        hand.gravity_stiffness_nm_rad = DMatrix::zeros(2, 2);
    }
    assert!(WeldedStiffness::new(&hold).is_none());
    // The equilibrium does not need it: both first joints are springs of 1000 N/m along x.
    approx::assert_relative_eq!(response(&hold, 1.0).deflection_m.x, 5e-4, max_relative = 1e-3);
}

/// Rotations are measured at a lever of 0.2 m: a joint of 0.04 k N m/rad is as stiff as one of k N/m.
#[test]
fn a_joint_that_is_ten_orders_stiffer_than_the_others_counts_as_rigid() {
    let with_joint = |nm_rad: f64| {
        let mut hold = two_strong_hands(Wrench::default(), Wrench::default());
        hold.hands.iter_mut().for_each(|hand| {
            hand.stiffness_nm_rad.fill(0.04e6);
            hand.stiffness_nm_rad.rows_mut(0, 3).fill(1e3);
            hand.stiffness_nm_rad[5] = nm_rad;
        });
        WeldedStiffness::new(&hold)
    };
    assert!(with_joint(0.5 * 0.04e13).is_some());
    assert!(with_joint(2.0 * 0.04e13).is_none());
}

#[test]
fn a_closed_form_below_every_limit_agrees_with_the_cone_program() {
    // If no limit binds both methods minimise the same energy; the pads' own compliance, which the closed form leaves
    // out, moves the board by less than a ten-thousandth.
    let mut workspace = StabilityWorkspace::new();
    for seed in 0..40 {
        let hold = random_hold(seed, 2);
        for load_factor in [0.02, 0.1, 0.5] {
            let by_cones = |workspace: &mut StabilityWorkspace, load_factor| {
                let EquilibriumOutcome::Found(found) =
                    workspace.equilibrium(&hold, load_factor, EquilibriumSolver::Clarabel).unwrap()
                else {
                    return None;
                };
                Some(found.board.at(&hold.p_ot).linear)
            };
            let Some(unloaded_m) = by_cones(&mut workspace, 0.0) else { continue };
            let Some(loaded_m) = by_cones(&mut workspace, load_factor) else { continue };
            let ResponseOutcome::Found(response) = workspace.response(&hold, load_factor).unwrap() else {
                panic!("seed {seed}: the cone program has an equilibrium")
            };
            let expected_m = loaded_m - unloaded_m;
            let off_m = (response.deflection_m - expected_m).norm();
            assert!(
                off_m <= 1e-3 * expected_m.norm() + 1e-9,
                "seed {seed} at {load_factor}: {off_m} of {expected_m:?}"
            );
        }
    }
}
