//! Properties of every contact model: monotonicity, invariance, duality, determinism. Random models have one to four
//! arms with seven random joints.

use benchdog::{
    model::frames::Pose,
    statics::{ContactModel, LoadFactorOutcome, StabilityWorkspace},
};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use crate::fixtures::{limits, moved, random_hold, stronger};

/// The solver's tolerance is 1e-7 of a load factor, absolute below 1 and relative above: two solves, and a margin.
const TOLERANCE: f64 = 1e-5;

fn load_factor(hold: &ContactModel) -> f64 {
    match StabilityWorkspace::new().load_factor(hold).unwrap() {
        LoadFactorOutcome::Solved(solved) => solved.load_factor,
        // Below every load factor.
        LoadFactorOutcome::GravityInfeasible { .. } => -1.0,
        LoadFactorOutcome::Unknown { status } => panic!("the solver stopped: {status}"),
    }
}

fn at_least(value: f64, reference: f64) -> bool {
    value >= reference - TOLERANCE * reference.abs().max(1.0)
}

proptest! {
    // Each case is a few solves of a millisecond.
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn more_friction_or_stronger_joints_never_hurt(seed in 0u64..1_000_000, hands in 1usize..=4, factor in 1.0..2.0) {
        let hold = random_hold(seed, hands);
        let reference = load_factor(&hold);
        let changed = |change: &dyn Fn(&mut ContactModel)| { let mut other = hold.clone(); change(&mut other); load_factor(&other) };
        let rougher = changed(&|hold| hold.hands.iter_mut().flat_map(benchdog::statics::HandModel::pads_mut).for_each(|pad| pad.friction *= factor));
        prop_assert!(at_least(rougher, reference), "friction: {rougher} after {reference}");
        let with_torque = changed(&|hold| hold.hands.iter_mut().for_each(|hand| hand.effort_nm *= factor));
        prop_assert!(at_least(with_torque, reference), "torque: {with_torque} after {reference}");
        // Nor does more grip: the surplus of fn_1 + fn_2 squeezes the board without load on the arm.
        let tighter = changed(&|hold| hold.hands.iter_mut().for_each(|hand| hand.scale_grip(factor)));
        prop_assert!(at_least(tighter, reference), "grip: {tighter} after {reference}");
    }

    #[test]
    fn the_frame_does_not_matter(seed in 0u64..1_000_000, hands in 1usize..=4, p in prop::array::uniform3(-0.5..0.5), r in prop::array::uniform3(-3.0..3.0)) {
        let hold = random_hold(seed, hands);
        let x: Pose = Isometry3::from_parts(Vector3::from(p).into(), UnitQuaternion::from_scaled_axis(Vector3::from(r)));
        let (here, there) = (load_factor(&hold), load_factor(&moved(&hold, &x)));
        prop_assert!((here - there).abs() <= TOLERANCE * here.abs().max(1.0), "{here} and {there}");
    }

    #[test]
    fn the_unit_of_force_does_not_matter(seed in 0u64..1_000_000, hands in 1usize..=4, exponent in -1.5..1.5) {
        let hold = random_hold(seed, hands);
        let (here, there) = (load_factor(&hold), load_factor(&stronger(&hold, 10f64.powf(exponent))));
        // The program's units are fixed, so forces thirty times larger reduce its accuracy by that factor.
        prop_assert!((here - there).abs() <= 30.0 * TOLERANCE * here.abs().max(1.0), "{here} and {there}");
    }

    #[test]
    fn half_the_load_is_held_twice(seed in 0u64..1_000_000, hands in 1usize..=4) {
        let mut hold = random_hold(seed, hands);
        let whole = load_factor(&hold);
        hold.load = hold.load.scaled(0.5);
        let half = load_factor(&hold);
        let expected = if whole < 0.0 { whole } else { (2.0 * whole).min(100.0) };
        prop_assert!((half - expected).abs() <= TOLERANCE * expected.abs().max(1.0), "{half} and {expected}");
    }

    #[test]
    fn every_outcome_has_a_valid_certificate(seed in 0u64..1_000_000, hands in 1usize..=4, heavier in 1.0..60.0) {
        let mut hold = random_hold(seed, hands);
        hold.weight = hold.weight.scaled(heavier);
        match StabilityWorkspace::new().load_factor(&hold).unwrap() {
            LoadFactorOutcome::Solved(solved) => {
                // Weak duality: above, up to the solver's tolerance; strong duality: tight.
                let bound = solved.dual.upper_bound(&hold).unwrap();
                prop_assert!(at_least(bound, solved.load_factor), "{bound} below {}", solved.load_factor);
                prop_assert!(bound <= solved.load_factor + 10.0 * TOLERANCE * solved.load_factor.max(1.0), "{bound} far above {}", solved.load_factor);
                check_primal(&hold, &solved)?;
                if solved.load_factor < 99.9 && solved.load_factor > 0.1 {
                    prop_assert!(!solved.binding.is_empty());
                }
            }
            LoadFactorOutcome::GravityInfeasible { certificate } => prop_assert!(certificate.proves_infeasible(&hold).unwrap()),
            LoadFactorOutcome::Unknown { status } => prop_assert!(false, "the solver stopped: {status}"),
        }
    }

    #[test]
    fn any_dual_vector_bounds_the_load_factor(seed in 0u64..1_000_000, hands in 1usize..=3, other in 0u64..1_000_000) {
        // The dual solution of one model bounds another one too, less tightly.
        let (hold, other) = (random_hold(seed, hands), random_hold(other, hands));
        if let LoadFactorOutcome::Solved(solved) = StabilityWorkspace::new().load_factor(&other).unwrap() {
            let bound = solved.dual.upper_bound(&hold).unwrap();
            let value = load_factor(&hold);
            prop_assert!(at_least(bound, value), "{bound} below {value}");
        }
    }

    #[test]
    fn the_necessary_test_rejects_only_infeasible_load_factors(seed in 0u64..1_000_000, hands in 1usize..=4, asked in 0.0..10.0) {
        let hold = random_hold(seed, hands);
        // A load that lifts a board which is too heavy may be held where less of it is not.
        let idle = ContactModel { load: Default::default(), ..hold.clone() };
        if let (Some(reason), true) = (hold.infeasibility(asked), load_factor(&idle) >= 0.0) {
            let value = load_factor(&hold);
            prop_assert!(value < asked + TOLERANCE, "{reason}, yet {value} of {asked}");
        }
    }

    #[test]
    fn the_order_of_calls_does_not_matter(seeds in prop::collection::vec((0u64..1_000_000, 1usize..=2), 1..6)) {
        let mut shared = StabilityWorkspace::new();
        for (seed, hands) in seeds {
            let hold = random_hold(seed, hands);
            let mut fresh = StabilityWorkspace::new();
            // Bit by bit.
            prop_assert_eq!(shared.load_factor(&hold), fresh.load_factor(&hold));
            prop_assert_eq!(shared.response(&hold, 0.5), fresh.response(&hold, 0.5));
            prop_assert_eq!(shared.compliant_load_factor(&hold, &limits()), fresh.compliant_load_factor(&hold, &limits()));
        }
    }
}

/// The forces are within every limit and balance the object. Scaled residuals of 1e-7 are 1e-6 N and less than 1e-6 N m
/// a row; summed over a few dozen terms they stay below 1e-4 N and N m, far below the effect of a wrong sign.
fn check_primal(hold: &ContactModel, solved: &benchdog::statics::LoadFactor) -> Result<(), TestCaseError> {
    const FORCE_TOLERANCE: f64 = 1e-4;
    let mut sum = hold.weight + hold.load.scaled(solved.load_factor);
    for ((hand, wrench), torque) in hold.hands.iter().zip(&solved.hand_wrenches).zip(&solved.joint_torque_nm) {
        let pads = wrench.of_pads();
        for (pad, wrench) in hand.pads().iter().zip(pads) {
            sum = sum + pad.wrench_about_object(wrench);
            let (force, moment) = (wrench.force_n, wrench.moment_nm);
            let [a, b] = pad.half_sides_m;
            let tangential = force.x.hypot(force.y).hypot(moment.z / pad.torsion_radius_m());
            prop_assert!(tangential <= pad.friction * force.z + FORCE_TOLERANCE);
            prop_assert!(moment.x.abs() <= b * force.z + FORCE_TOLERANCE);
            prop_assert!(moment.y.abs() <= a * force.z + FORCE_TOLERANCE);
        }
        let grip = pads[0].force_n.z + pads[1].force_n.z;
        prop_assert!((grip - 2.0 * hand.pad_pair().unwrap().grip_force_n).abs() <= FORCE_TOLERANCE);
        for joint in 0..hand.dof() {
            prop_assert!(torque[joint].abs() <= hand.effort_nm[joint] + FORCE_TOLERANCE);
        }
    }
    prop_assert!(
        sum.force_n.norm() <= FORCE_TOLERANCE && sum.moment_nm.norm() <= FORCE_TOLERANCE,
        "left over: {sum:?}"
    );
    Ok(())
}
