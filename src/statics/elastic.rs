//! The equilibrium of a hold whose pads stay below their limits, in closed form.
//!
//! As long as every hand's wrench can be shared between its pads within their limits, the pads do not matter: the hands
//! are as good as welded to the board, and the least complementary energy is that of the welded hold. Whether the wrenches
//! can be shared is asked of one way to share them, half and half but for the normal forces; where that fails the cone
//! program must decide. The pads' own compliance, which only serves the program's uniqueness, is left out.

use nalgebra::Vector3;

use super::{
    compliance::{Twist, WeldedStiffness},
    contact_model::{ContactModel, HandModel},
    equilibrium::Equilibrium,
};
use crate::model::wrench::Wrench;

/// The share of a pad's limits up to which it surely stays below them.
const SURE: f64 = 0.99;
/// How far two pads' normals may be from opposite: rounding.
const OPPOSITE: f64 = 1e-9;

/// The equilibrium at a load factor when it is that of the welded hold and this can be shown cheaply.
pub(super) fn equilibrium(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<Equilibrium> {
    let pads = shared(model, welded, load_factor)?;
    model.hands.iter().zip(&pads).all(|(hand, pads)| is_kept(hand, pads)).then(|| {
        let board = board(model, welded, load_factor);
        Equilibrium::of_pads(model, load_factor, pads, board)
    })
}

/// The equilibrium of a hold that differs a little from one whose equilibrium is that of the welded hold: its pads are
/// below their limits too, or by a hair beyond.
pub(super) fn first_order(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<Equilibrium> {
    let pads = shared(model, welded, load_factor)?;
    Some(Equilibrium::of_pads(model, load_factor, pads, board(model, welded, load_factor)))
}

fn board(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Twist {
    welded.twist_at_tip(&outer(model, load_factor)).at(&-model.p_ot)
}

fn outer(model: &ContactModel, load_factor: f64) -> Wrench {
    model.weight + model.load.scaled(load_factor)
}

/// The hands' wrenches when all are welded to the board, shared between their pads: each about its centre in pad axes. None
/// where a hand has no such pads.
fn shared(model: &ContactModel, welded: &WeldedStiffness, load_factor: f64) -> Option<Vec<[Wrench; 2]>> {
    let wrenches = welded.hand_wrenches(&outer(model, load_factor));
    model.hands.iter().zip(&wrenches).map(|(hand, wrench)| shared_by_pads(hand, wrench)).collect()
}

/// A hand's wrench about its grasp point, shared between its pads: `fn_1 + fn_2 = 2 F`, what is tangential by halves.
fn shared_by_pads(hand: &HandModel, wrench: &Wrench) -> Option<[Wrench; 2]> {
    let normals = hand.pads.each_ref().map(|pad| pad.x_op.rotation * Vector3::z());
    if (normals[0] + normals[1]).norm() > OPPOSITE {
        return None;
    }
    let across_n = wrench.force_n.dot(&normals[0]);
    let tangential_n = wrench.force_n - normals[0] * across_n;
    let forces_n = [0, 1].map(|pad: usize| {
        let share = if pad == 0 { 0.5 } else { -0.5 };
        tangential_n / 2.0 + normals[pad] * (hand.grip_force_n + share * across_n)
    });
    let levers = hand.pads.each_ref().map(|pad| pad.x_op.translation.vector - hand.grasp_point_o);
    let carried_nm = levers[0].cross(&forces_n[0]) + levers[1].cross(&forces_n[1]);
    let rest_nm = (wrench.moment_nm - carried_nm) / 2.0;
    Some([0, 1].map(|pad: usize| {
        let to_pad = hand.pads[pad].x_op.rotation.inverse();
        Wrench::new(to_pad * forces_n[pad], to_pad * rest_nm)
    }))
}

/// True when each pad stays surely below its limits.
fn is_kept(hand: &HandModel, pads: &[Wrench; 2]) -> bool {
    hand.pads.iter().zip(pads).all(|(pad, Wrench { force_n, moment_nm })| {
        let [a, b] = pad.half_sides_m;
        let tangential_n = force_n.x.hypot(force_n.y).hypot(moment_nm.z / pad.torsion_radius_m());
        tangential_n <= SURE * pad.friction * force_n.z
            && moment_nm.x.abs() <= SURE * b * force_n.z
            && moment_nm.y.abs() <= SURE * a * force_n.z
    })
}
