//! The robust load factor against enumeration and closed forms.

use benchdog::{
    model::wrench::Wrench,
    statics::{
        ContactModel, InternalForces, LoadFactorOutcome, RobustLoadFactor, RobustOutcome, StabilityWorkspace,
        Variation, WeldedStiffness,
    },
};
use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::fixtures::{random_hold, two_strong_hands};

/// See `properties`.
const TOLERANCE: f64 = 1e-5;

fn robust(hold: &ContactModel, variations: &[Variation], internal_forces: InternalForces) -> RobustLoadFactor {
    match StabilityWorkspace::new().robust_load_factor(hold, variations, internal_forces).unwrap() {
        RobustOutcome::Solved(found) => found,
        other => panic!("expected a load factor, found {other:?}"),
    }
}

/// The load slightly changed, at frictions from 0.7 to 1.1 of the nominal one.
fn variations(hold: &ContactModel, seed: u64) -> Vec<Variation> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut around = |size: f64| Vector3::from_fn(|_, _| rng.random_range(-size..size));
    let size_n = hold.load.force_n.norm();
    (0..5)
        .map(|_| Variation {
            load: hold.load + Wrench::new(around(0.3 * size_n), around(0.02 * size_n)),
            friction_ratio: 0.9 + around(0.2).x,
            grip_force_ratio: 1.0,
        })
        .collect()
}

fn varied(hold: &ContactModel, variation: &Variation) -> ContactModel {
    let mut varied = ContactModel { load: variation.load, ..hold.clone() };
    varied
        .hands
        .iter_mut()
        .flat_map(benchdog::statics::HandModel::pads_mut)
        .for_each(|pad| pad.friction *= variation.friction_ratio);
    varied
}

/// Random contact models that carry their weight in every variation.
fn cases() -> Vec<(ContactModel, Vec<Variation>)> {
    let mut workspace = StabilityWorkspace::new();
    let all = (0..30).map(|seed| {
        let hold = random_hold(seed, 1 + seed as usize % 3);
        let variations = variations(&hold, seed);
        (hold, variations)
    });
    let mut carries_all = |(hold, variations): &(ContactModel, Vec<Variation>)| {
        let mut held = |hold: &ContactModel, least| {
            workspace.load_factor(hold).unwrap().load_factor().is_some_and(|found| found > least)
        };
        variations.iter().map(|variation| varied(hold, variation)).all(|hold| {
            let idle = ContactModel { load: Wrench::default(), ..hold.clone() };
            held(&hold, 0.05) && held(&idle, 0.0)
        })
    };
    let cases: Vec<_> = all.filter(|case| carries_all(case)).collect();
    assert!(cases.len() >= 12, "only {} cases", cases.len());
    cases
}

#[test]
fn adapting_forces_give_the_minimum_over_the_variations() {
    let mut workspace = StabilityWorkspace::new();
    for (hold, variations) in cases() {
        let each: Vec<f64> = variations
            .iter()
            .map(|variation| workspace.load_factor(&varied(&hold, variation)).unwrap().load_factor().unwrap())
            .collect();
        let found = robust(&hold, &variations, InternalForces::Adapt);
        let least = each.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(found.load_factor, least);
        assert_eq!(each[found.limiting[0]], least);
    }
}

#[test]
fn the_vertices_bound_every_convex_combination() {
    let mut workspace = StabilityWorkspace::new();
    let mut rng = Pcg64::seed_from_u64(3);
    for (hold, variations) in cases() {
        let found = robust(&hold, &variations, InternalForces::Adapt).load_factor;
        let lowest = variations.iter().map(|variation| variation.friction_ratio).fold(f64::INFINITY, f64::min);
        let vertices: Vec<_> = variations.iter().map(|v| Variation { friction_ratio: lowest, ..*v }).collect();
        let at_lowest = robust(&hold, &vertices, InternalForces::Adapt).load_factor;
        assert!(at_lowest <= found + TOLERANCE * found.max(1.0));
        let mut weights: Vec<f64> = variations.iter().map(|_| rng.random_range(0.0..1.0)).collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let mixed = variations.iter().zip(&weights).fold(Wrench::default(), |w, (v, share)| w + v.load.scaled(*share));
        let mixture = Variation { load: mixed, friction_ratio: lowest + 0.05, grip_force_ratio: 1.0 };
        let of_mixture = workspace.load_factor(&varied(&hold, &mixture)).unwrap().load_factor().unwrap();
        assert!(of_mixture >= at_lowest - TOLERANCE * at_lowest.max(1.0), "{of_mixture} below {at_lowest}");
    }
}

#[test]
fn fixed_internal_forces_are_feasible_in_every_variation() {
    let mut smaller = 0;
    for (hold, variations) in cases() {
        let adapting = robust(&hold, &variations, InternalForces::Adapt).load_factor;
        let found = robust(&hold, &variations, InternalForces::Fixed);
        let margin = 10.0 * TOLERANCE * adapting.max(1.0);
        assert!(found.load_factor <= adapting + margin, "{} above {adapting}", found.load_factor);
        if hold.hands.len() == 1 {
            assert!((found.load_factor - adapting).abs() <= margin);
            continue;
        }
        smaller += usize::from(found.load_factor < 0.999 * adapting);
        assert!(!found.limiting.is_empty());
        check_vertices(&hold, &variations, &found);
    }
    assert!(smaller >= 5, "only {smaller} holds where it matters");
}

/// In every variation the wrenches balance, differ as the stiffness requires, and each hand can exert its own.
fn check_vertices(hold: &ContactModel, variations: &[Variation], found: &RobustLoadFactor) {
    // N and N m: residuals of 1e-7 in units of 10 N, times some ten terms and a margin.
    const MARGIN: f64 = 1e-3;
    let welded = WeldedStiffness::new(hold).unwrap();
    let first_share = welded.hand_wrenches(&variations[0].load);
    for (variation, wrenches) in variations.iter().zip(&found.hand_wrenches) {
        let varied = varied(hold, variation);
        let shares = welded.hand_wrenches(&variation.load);
        let mut rest = varied.weight + varied.load.scaled(found.load_factor);
        for (number, hand) in varied.hands.iter().enumerate() {
            let wrench = wrenches[number];
            rest = rest + wrench.about(&hand.grasp_point_o);
            let expected = found.hand_wrenches[0][number].to_vector()
                + (shares[number].to_vector() - first_share[number].to_vector()) * found.load_factor;
            assert!((wrench.to_vector() - expected).norm() < MARGIN, "{wrench:?}, expected {expected}");
            // The hand alone under its wrench: are its pads and torques sufficient?
            let alone = ContactModel {
                hands: vec![hand.clone()],
                weight: Wrench::default(),
                load: wrench.scaled(-1.0).about(&hand.grasp_point_o),
                p_ot: Vector3::zeros(),
            };
            let LoadFactorOutcome::Solved(held) = StabilityWorkspace::new().load_factor(&alone).unwrap() else {
                // This arm needs the board's support against gravity.
                continue;
            };
            assert!(held.load_factor > 1.0 - 1e-4, "{} of its wrench", held.load_factor);
        }
        assert!(rest.force_n.norm() < MARGIN && rest.moment_nm.norm() < MARGIN, "left over: {rest:?}");
    }
}

#[test]
fn hands_share_an_alternating_load_by_their_stiffness() {
    // In line with both hands, +-1 N; each hand slides at 2 mu F = 36 N. The one that is three times as stiff takes 3/4
    // of the load. An internal force helps in one direction as much as it hurts in the other.
    let alternating = [1.0, -1.0].map(|side| Variation {
        load: Wrench::from_force(Vector3::new(side, 0.0, 0.0)),
        friction_ratio: 1.0,
        grip_force_ratio: 1.0,
    });
    let mut hold = two_strong_hands(Wrench::default(), alternating[0].load);
    hold.p_ot = Vector3::zeros();
    hold.hands[0].stiffness_nm_rad *= 3.0;
    let adapting = robust(&hold, &alternating, InternalForces::Adapt);
    approx::assert_relative_eq!(adapting.load_factor, 72.0, max_relative = TOLERANCE);
    let fixed = robust(&hold, &alternating, InternalForces::Fixed);
    approx::assert_relative_eq!(fixed.load_factor, 36.0 / 0.75, max_relative = TOLERANCE);
    assert_eq!(fixed.limiting, [0, 1]);
    // In one direction alone, the internal force adapts to it.
    let one_way = robust(&hold, &alternating[..1], InternalForces::Fixed);
    approx::assert_relative_eq!(one_way.load_factor, 72.0, max_relative = TOLERANCE);
    // Half the friction, half the load factor; the easier variation does not limit.
    let slippery = [alternating[0], Variation { friction_ratio: 0.5, ..alternating[1] }];
    let found = robust(&hold, &slippery, InternalForces::Adapt);
    approx::assert_relative_eq!(found.load_factor, 36.0, max_relative = TOLERANCE);
    assert_eq!(found.limiting, [1]);
    // Likewise half the grip force.
    let loose = [alternating[0], Variation { grip_force_ratio: 0.5, ..alternating[1] }];
    let found = robust(&hold, &loose, InternalForces::Adapt);
    approx::assert_relative_eq!(found.load_factor, 36.0, max_relative = TOLERANCE);
    assert_eq!(found.limiting, [1]);
}

#[test]
fn at_the_cap_no_variation_limits() {
    let hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::x() * 0.1));
    let idle = Variation { load: Wrench::default(), friction_ratio: 1.0, grip_force_ratio: 1.0 };
    let light = Variation { load: hold.load, ..idle };
    for internal_forces in [InternalForces::Adapt, InternalForces::Fixed] {
        // 72 N of friction are 720 times the load.
        let found = robust(&hold, &[idle, light], internal_forces);
        approx::assert_relative_eq!(found.load_factor, 100.0, max_relative = TOLERANCE);
        assert_eq!(found.limiting, [] as [usize; 0]);
        // A hundredth of the friction is 7.2 times it.
        let slippery = Variation { friction_ratio: 0.01, ..light };
        let found = robust(&hold, &[idle, slippery, light], internal_forces);
        approx::assert_relative_eq!(found.load_factor, 7.2, max_relative = 1e2 * TOLERANCE);
        assert_eq!(found.limiting, [1]);
    }
    // The first of two that are the same.
    let twice = [Variation { friction_ratio: 0.01, ..light }; 2];
    assert_eq!(robust(&hold, &twice, InternalForces::Adapt).limiting, [0]);
}

/// One hand has no internal force that could be fixed, so its stiffness does not matter.
#[test]
fn one_hand_that_is_rigid_has_a_robust_load_factor() {
    let mut hold = two_strong_hands(Wrench::default(), Wrench::from_force(Vector3::x()));
    hold.hands.truncate(1);
    for hand in &mut hold.hands {
        hand.joints.truncate(2);
        hand.jacobian_o = hand.jacobian_o.columns(0, 2).into_owned();
        for values in [&mut hand.gravity_torque_nm, &mut hand.effort_nm, &mut hand.stiffness_nm_rad] {
            *values = values.rows(0, 2).into_owned();
        }
        hand.gravity_stiffness_nm_rad = DMatrix::zeros(2, 2);
    }
    let planned = Variation { load: hold.load, friction_ratio: 1.0, grip_force_ratio: 1.0 };
    // 36 N of friction at the hand, whose torsion holds no lever.
    hold.load = Wrench::from_force(Vector3::x()).about(&hold.hands[0].grasp_point_o);
    let at_hand = Variation { load: hold.load, ..planned };
    for internal_forces in [InternalForces::Adapt, InternalForces::Fixed] {
        let found = robust(&hold, &[at_hand], internal_forces);
        approx::assert_relative_eq!(found.load_factor, 36.0, max_relative = TOLERANCE);
    }
}

#[test]
fn a_variation_in_which_the_weight_is_not_held_is_named() {
    let hold = two_strong_hands(Wrench::from_force(Vector3::new(0.0, -20.0, 0.0)), Wrench::from_force(Vector3::x()));
    let friction = |friction_ratio| Variation { load: hold.load, friction_ratio, grip_force_ratio: 1.0 };
    let mut workspace = StabilityWorkspace::new();
    for internal_forces in [InternalForces::Adapt, InternalForces::Fixed] {
        // 72 N of friction at most for 20 N of weight.
        let found = workspace.robust_load_factor(&hold, &[friction(1.0), friction(0.2)], internal_forces).unwrap();
        assert_eq!(found, RobustOutcome::GravityInfeasible { variation: 1 });
    }
    // A load that lifts a board which is too heavy for the hands.
    let heavy = two_strong_hands(Wrench::from_force(Vector3::new(0.0, -80.0, 0.0)), Wrench::from_force(Vector3::y()));
    let lifting = [Variation { load: heavy.load, friction_ratio: 1.0, grip_force_ratio: 1.0 }];
    assert!(workspace.load_factor(&heavy).unwrap().load_factor().is_some_and(|found| found > 99.0));
    let found = workspace.robust_load_factor(&heavy, &lifting, InternalForces::Adapt).unwrap();
    assert_eq!(found, RobustOutcome::GravityInfeasible { variation: 0 });
    let loose = Variation { grip_force_ratio: 0.0, ..friction(1.0) };
    let message = |variations: &[Variation]| {
        StabilityWorkspace::new().robust_load_factor(&hold, variations, InternalForces::Adapt).unwrap_err().to_string()
    };
    assert_eq!(message(&[]), "found no variations, expected at least one");
    assert_eq!(message(&[friction(-1.0)]), "variation 0: found friction ratio -1, expected 0 or more");
    assert_eq!(message(&[loose]), "variation 0: found grip force ratio 0, expected more than 0");
}
