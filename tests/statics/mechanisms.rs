//! The mechanisms that prove a load factor infeasible, against capacities in closed form.

use benchdog::{
    model::wrench::Wrench,
    statics::{ContactModel, Infeasibility, Mechanism, mean_distance_from_centre_m},
};
use nalgebra::Vector3;

use crate::fixtures::{HALF_SIDES_M, strong_hand};

/// Grip force and friction of every hand, and the distance of its pads, m.
const GRIP_N: f64 = 30.0;
const FRICTION: f64 = 0.6;
const GAP_M: f64 = 0.03;

/// Hands at these places whose pads press along z, under a load alone.
fn hold(places: &[Vector3<f64>], load: Wrench) -> ContactModel {
    let hand = |p: &Vector3<f64>| strong_hand("hand", *p, Vector3::z(), Vector3::y(), GRIP_N, FRICTION, GAP_M);
    ContactModel { hands: places.iter().map(hand).collect(), weight: Wrench::default(), load, p_ot: Vector3::zeros() }
}

fn proof(hold: &ContactModel) -> Infeasibility {
    hold.infeasibility(1.0).unwrap_or_else(|| panic!("no proof for {:?}", hold.load))
}

#[test]
fn a_hand_slides_under_twice_its_friction() {
    // Both pads together hold `2 mu F`.
    let capacity_n = 2.0 * FRICTION * GRIP_N;
    let sliding = |force_n: f64| hold(&[Vector3::zeros()], Wrench::from_force(Vector3::x() * force_n));
    let found = proof(&sliding(2.0 * capacity_n));
    assert_eq!(found.mechanism, Mechanism::Slide);
    // The twist is along the force and as large.
    approx::assert_relative_eq!(found.demand_j, (2.0 * capacity_n).powi(2), max_relative = 1e-12);
    approx::assert_relative_eq!(found.capacity_j, 2.0 * capacity_n.powi(2), max_relative = 1e-12);
    let expected = "the board slides along the applied force: the hands resist at most 50 % of weight and load";
    assert_eq!(found.to_string(), expected);
    assert_eq!(sliding(0.999 * capacity_n).infeasibility(1.0), None);
    // Without a load nothing moves the board.
    assert_eq!(sliding(0.0).infeasibility(1.0), None);
}

/// A force through the grasp point does not turn the hand, wherever that is; a moment about its normal turns it beyond `2 mu e F`.
#[test]
fn a_hand_turns_about_its_own_place() {
    let place = Vector3::new(0.23, -0.1, 0.0);
    let capacity_nm = 2.0 * FRICTION * GRIP_N * mean_distance_from_centre_m(HALF_SIDES_M);
    let turning = |moment_nm: f64| {
        let at_hand = Wrench::new(Vector3::new(2.0, -1.0, 0.0), Vector3::z() * moment_nm);
        hold(&[place], at_hand.about(&place))
    };
    let found = proof(&turning(2.0 * capacity_nm));
    assert_eq!(found.mechanism, Mechanism::Turn);
    approx::assert_relative_eq!(found.demand_j, (2.0 * capacity_nm).powi(2), max_relative = 1e-12);
    approx::assert_relative_eq!(found.capacity_j, 2.0 * capacity_nm.powi(2), max_relative = 1e-12);
    let expected = "the board turns about a hand: the hands resist at most 50 % of weight and load";
    assert_eq!(found.to_string(), expected);
    assert_eq!(turning(0.999 * capacity_nm).infeasibility(1.0), None);
}

/// About the line through two hands each pad slides by half the gap and tilts about one of its sides; across the line the hands
/// hold a moment with a long lever, so that neither turns by itself.
#[test]
fn two_hands_turn_about_the_line_through_them() {
    let places = [Vector3::new(0.2, 0.14, 0.0), Vector3::new(-0.2, 0.14, 0.0)];
    // The line is along x; a pad's y axis is along it, and its side a across it.
    let capacity_nm = 2.0 * 2.0 * GRIP_N * (FRICTION * GAP_M / 2.0 + HALF_SIDES_M[0]);
    let hinged = |moment_nm: f64| hold(&places, Wrench::new(Vector3::zeros(), Vector3::new(moment_nm, 0.0, 4.0)));
    for sign in [1.0, -1.0] {
        let found = proof(&hinged(2.0 * capacity_nm * sign));
        assert_eq!(found.mechanism, Mechanism::Hinge);
        approx::assert_relative_eq!(found.demand_j / found.capacity_j, 2.0, max_relative = 1e-12);
        let expected =
            "the board turns about the line through two hands: the hands resist at most 50 % of weight and load";
        assert_eq!(found.to_string(), expected);
        assert_eq!(hinged(0.999 * capacity_nm * sign).infeasibility(1.0), None);
    }
}
