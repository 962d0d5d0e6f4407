//! The equilibrium in closed form, for pads below their limits and measured grippers, whose limits are checked afterwards.
//!
//! If every hand's wrench can be shared between its pads within their limits, the hands are as good as welded to the
//! board, and the minimum of the complementary energy is that of the welded board. One way of sharing is tried, equal
//! except for the normal forces; if it fails, the equilibrium program decides. The pads' own compliance, which only
//! makes that program's solution unique, is left out.

use nalgebra::Vector3;

use super::{
    contact_model::ContactModel,
    equilibrium::Equilibrium,
    hand::HandModel,
    hold::{HandWrench, Hold, PadPair},
    twist::Twist,
    welded::WeldedStiffness,
};
use crate::model::wrench::Wrench;

/// Share of a pad's limits below which it is taken to be within them.
const LIMIT_SHARE: f64 = 0.99;
/// Tolerance of two pads' normals from opposite: rounding.
const OPPOSITE_TOLERANCE: f64 = 1e-9;

/// The equilibrium at a load factor if it is that of the welded board and one way of sharing the wrenches proves it.
pub(super) fn equilibrium(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<Equilibrium> {
    let (wrenches, board) = shared(model, welded, load_factor)?;
    let within = model.hands.iter().zip(&wrenches).all(|(hand, wrench)| is_within_limits(hand, wrench));
    within.then(|| Equilibrium::of_hands(model, load_factor, wrenches, board))
}

/// The same for a contact model that differs slightly from one whose equilibrium is that of the welded board: its pads
/// are within their limits too, up to first order.
pub(super) fn first_order(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<Equilibrium> {
    let (wrenches, board) = shared(model, welded, load_factor)?;
    Some(Equilibrium::of_hands(model, load_factor, wrenches, board))
}

/// The welded hands' wrenches, shared between their pads, and the board's displacement at O. `None` if a hand's pads are not
/// opposite.
fn shared(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<(Vec<HandWrench>, Twist)> {
    let (at_tip, wrenches) = welded.equilibrium(&(model.weight + model.load.scaled(load_factor)));
    let of_hand = |(hand, wrench): (&HandModel, &Wrench)| match &hand.hold {
        Hold::Pads(pair) => shared_by_pads(hand, pair, wrench).map(HandWrench::Pads),
        Hold::Measured(_) => Some(HandWrench::Measured(*wrench)),
    };
    let shared: Option<Vec<_>> = model.hands.iter().zip(&wrenches).map(of_hand).collect();
    Some((shared?, at_tip.at(&-model.p_ot)))
}

/// A hand's wrench about its grasp point, shared between its pads: `fn_1 + fn_2 = 2 F`, tangential parts equal.
fn shared_by_pads(hand: &HandModel, pair: &PadPair, wrench: &Wrench) -> Option<[Wrench; 2]> {
    let normals = pair.pads.each_ref().map(|pad| pad.x_op.rotation * Vector3::z());
    if (normals[0] + normals[1]).norm() > OPPOSITE_TOLERANCE {
        return None;
    }
    let across_n = wrench.force_n.dot(&normals[0]);
    let tangential_n = wrench.force_n - normals[0] * across_n;
    let forces_n = [0, 1].map(|pad: usize| {
        let share = if pad == 0 { 0.5 } else { -0.5 };
        tangential_n / 2.0 + normals[pad] * (pair.grip_force_n + share * across_n)
    });
    let levers = pair.pads.each_ref().map(|pad| pad.x_op.translation.vector - hand.grasp_point_o);
    let carried_nm = levers[0].cross(&forces_n[0]) + levers[1].cross(&forces_n[1]);
    let rest_nm = (wrench.moment_nm - carried_nm) / 2.0;
    Some([0, 1].map(|pad: usize| {
        let to_pad = pair.pads[pad].x_op.rotation.inverse();
        Wrench::new(to_pad * forces_n[pad], to_pad * rest_nm)
    }))
}

/// True if each pad is below its limits by the margin of [`LIMIT_SHARE`].
fn is_within_limits(hand: &HandModel, wrench: &HandWrench) -> bool {
    hand.pads().iter().zip(wrench.of_pads()).all(|(pad, Wrench { force_n, moment_nm })| {
        let [a, b] = pad.half_sides_m;
        let tangential_n = force_n.x.hypot(force_n.y).hypot(moment_nm.z / pad.torsion_radius_m());
        tangential_n <= LIMIT_SHARE * pad.friction * force_n.z
            && moment_nm.x.abs() <= LIMIT_SHARE * b * force_n.z
            && moment_nm.y.abs() <= LIMIT_SHARE * a * force_n.z
    })
}
