//! The equilibrium of a hold whose pads stay below their limits, in closed form.
//!
//! As long as every hand's wrench can be shared between its pads within their limits, the pads do not matter: the hands
//! are as good as welded to the board, and the least complementary energy is that of the welded hold. Whether the wrenches
//! can be shared is asked of one way to share them, half and half but for the normal forces; where that fails the cone
//! program must decide. The pads' own compliance, which only serves the program's uniqueness, is left out.

use nalgebra::Vector3;

use super::{
    compliance::{Twist, WeldedHold},
    contact::PadKind,
    equilibrium::Equilibrium,
    hold::{HandModel, Hold},
};
use crate::model::wrench::Wrench;

/// The share of a pad's limits up to which it surely stays below them.
const SURE: f64 = 0.99;
/// How far two pads' normals may be from opposite: rounding.
const OPPOSITE: f64 = 1e-9;

/// The equilibrium at a load factor when it is that of the welded hold and this can be shown cheaply.
pub(super) fn equilibrium(hold: &Hold, welded: &WeldedHold, load_factor: f64) -> Option<Equilibrium> {
    let outer = hold.weight + hold.load.scaled(load_factor);
    let wrenches = welded.hand_wrenches(&outer);
    let pads: Option<Vec<_>> = hold.hands.iter().zip(&wrenches).map(|(hand, wrench)| shared(hand, wrench)).collect();
    let board: Twist = welded.twist_at_tip(&outer).at(&-hold.p_ot);
    Some(Equilibrium::of_pads(hold, load_factor, pads?, board))
}

/// A hand's wrench about its grasp point, shared between its pads, when each stays surely below its limits: each about
/// its centre in pad axes.
fn shared(hand: &HandModel, wrench: &Wrench) -> Option<[Wrench; 2]> {
    if hand.wrench_limits.is_some() {
        return None;
    }
    let normals = hand.pads.each_ref().map(|pad| pad.x_op.rotation * Vector3::z());
    if (normals[0] + normals[1]).norm() > OPPOSITE {
        return None;
    }
    // fn_1 + fn_2 = 2 F, fn_1 - fn_2 = f . n_1; what is tangential by halves.
    let across_n = wrench.force_n.dot(&normals[0]);
    let tangential_n = wrench.force_n - normals[0] * across_n;
    let forces_n = [0, 1].map(|pad: usize| {
        let share = if pad == 0 { 0.5 } else { -0.5 };
        tangential_n / 2.0 + normals[pad] * (hand.grip_force_n + share * across_n)
    });
    let levers = hand.pads.each_ref().map(|pad| pad.x_op.translation.vector - hand.grasp_point_o);
    let carried_nm = levers[0].cross(&forces_n[0]) + levers[1].cross(&forces_n[1]);
    let rest_nm = (wrench.moment_nm - carried_nm) / 2.0;
    let pads = [0, 1].map(|pad: usize| {
        let to_pad = hand.pads[pad].x_op.rotation.inverse();
        Wrench::new(to_pad * forces_n[pad], to_pad * rest_nm)
    });
    let kept = hand.pads.iter().zip(&pads).all(|(pad, Wrench { force_n, moment_nm })| {
        let [a, b] = pad.half_sides_m;
        let tangential_n = force_n.x.hypot(force_n.y).hypot(moment_nm.z / pad.torsion_radius_m());
        pad.kind == PadKind::SoftFinger
            && tangential_n <= SURE * pad.friction * force_n.z
            && moment_nm.x.abs() <= SURE * b * force_n.z
            && moment_nm.y.abs() <= SURE * a * force_n.z
    });
    kept.then_some(pads)
}
