//! A quick test that rejects hopeless holds.
//!
//! For any twist `y` of the board, what weight and load do is at most what the hands can undo:
//! `(weight + lambda load) . y <= sum_i h_i(-y)`, `h_i(-y)` the largest work of hand i on the twist `-y`. That is weak
//! duality of the load program with a dual vector made from `y`; a few twists that loads tend to drive are tried.
//!
//! The largest work of a hand is the smaller of two bounds. Of its pads, `2 F max_c (v_n + mu |(v_t1, v_t2, e w_n)| +
//! b |w_t1| + a |w_t2|)`, with `(v, w)` the twist at the pad in pad axes. Of its motors, `sum_k |a_k| tau_max,k - a_k
//! g_k`, with `a` any joint motion that gives the hand that twist, `J a = -y`.

use nalgebra::{Matrix6, Vector3};

use super::{
    compliance::{Twist, inverse},
    hold::{HandModel, Hold, PadModel},
};

/// How much more than the hands can undo a twist must ask for, relative, before it counts: rounding only.
const ROUNDING_MARGIN: f64 = 1e-9;

/// Why a hold cannot stand a load factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CannotHold {
    /// The way the board goes.
    pub motion: LostMotion,
    /// Work of weight and load on that twist, J, for a twist of arbitrary size.
    pub demand_j: f64,
    /// The most that the hands can undo, J, for the same twist.
    pub capacity_j: f64,
}

/// A way in which a board gets away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LostMotion {
    /// Along the force on it.
    Slide,
    /// About a grasp point.
    Turn,
    /// About the line through two grasp points.
    Hinge,
    /// The way the arms' springs would let it go.
    GiveWay,
}

impl std::fmt::Display for CannotHold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let motion = match self.motion {
            LostMotion::Slide => "slides along the force on it",
            LostMotion::Turn => "turns about a hand",
            LostMotion::Hinge => "turns about the line through two hands",
            LostMotion::GiveWay => "goes the way the arms give",
        };
        let percent = 100.0 * self.capacity_j / self.demand_j;
        write!(f, "the board {motion}: the hands can undo at most {percent:.0} % of weight and load")
    }
}

/// The first of the tried twists whose demand is more than the hands can undo.
pub(super) fn cannot_hold(hold: &Hold, load_factor: f64) -> Option<CannotHold> {
    let outer = hold.weight + hold.load.scaled(load_factor);
    let exceeds = |motion: LostMotion, twist: &Twist, undo: &dyn Fn(usize, &Twist) -> f64| {
        let back = Twist { linear: -twist.linear, angular: -twist.angular };
        let demand_j = twist.work(&outer);
        let capacity_j: f64 = (0..hold.hands.len()).map(|hand| undo(hand, &back)).sum();
        let lost = demand_j > capacity_j + ROUNDING_MARGIN * demand_j.abs();
        lost.then_some(CannotHold { motion, demand_j, capacity_j })
    };
    let of_pads = |hand: usize, back: &Twist| work_of_pads(&hold.hands[hand], back);
    let rigid = rigid_motions(hold, load_factor);
    if let Some(reason) = rigid.iter().find_map(|(motion, twist)| exceeds(*motion, twist, &of_pads)) {
        return Some(reason);
    }
    let springs: Option<Vec<Matrix6<f64>>> = hold.hands.iter().map(|hand| inverse(&hand.compliance())).collect();
    let springs = springs?;
    let of_hand = |hand: usize, back: &Twist| {
        let model = &hold.hands[hand];
        work_of_pads(model, back).min(work_of_motors(model, &springs[hand], back))
    };
    let welded = super::WeldedHold::from_stiffness(hold, &springs)?;
    let gives = welded.twist_at_tip(&outer).at(&-hold.p_ot);
    let all = rigid.iter().copied().chain([(LostMotion::GiveWay, gives)]);
    all.into_iter().find_map(|(motion, twist)| exceeds(motion, &twist, &of_hand))
}

/// The twists that are tried, stated for O's origin.
fn rigid_motions(hold: &Hold, load_factor: f64) -> Vec<(LostMotion, Twist)> {
    let outer = hold.weight + hold.load.scaled(load_factor);
    let turn_about = |point: &Vector3<f64>, axis: Vector3<f64>| Twist { linear: -axis.cross(point), angular: axis };
    let mut motions = vec![(LostMotion::Slide, Twist { linear: outer.force_n, angular: Vector3::zeros() })];
    for (number, hand) in hold.hands.iter().enumerate() {
        let point = &hand.grasp_point_o;
        let moment = outer.about(&-point).moment_nm;
        motions.push((LostMotion::Turn, turn_about(point, moment)));
        for other in &hold.hands[..number] {
            let line = point - other.grasp_point_o;
            // Which way round: the way that the moment drives.
            let axis = line * line.dot(&moment).signum();
            motions.push((LostMotion::Hinge, turn_about(point, axis)));
        }
    }
    motions
}

fn work_of_pads(hand: &HandModel, twist: &Twist) -> f64 {
    let largest = hand.pads.iter().map(|pad| work_per_normal_force(pad, twist)).fold(f64::NEG_INFINITY, f64::max);
    2.0 * hand.grip_force_n * largest
}

/// The most work of a pad per newton of normal force, m.
fn work_per_normal_force(pad: &PadModel, twist: &Twist) -> f64 {
    let at_pad = twist.at(&pad.x_op.translation.vector);
    let v = pad.x_op.rotation.inverse() * at_pad.linear;
    let w = pad.x_op.rotation.inverse() * at_pad.angular;
    let [a, b] = pad.half_sides_m;
    let friction = v.x.hypot(v.y).hypot(pad.torsion_radius_m() * w.z);
    v.z + pad.friction * friction + b * w.x.abs() + a * w.y.abs()
}

/// The most work of an arm's motors; its joints move as its springs would, `a = K_q^-1 J' C^-1 twist`.
fn work_of_motors(hand: &HandModel, stiffness: &Matrix6<f64>, twist: &Twist) -> f64 {
    let at_hand = twist.at(&hand.grasp_point_o).to_vector();
    let motion = hand.jacobian_o.tr_mul(&(stiffness * at_hand)).component_div(&hand.stiffness_nm_rad);
    let joints = motion.iter().zip(hand.effort_nm.iter()).zip(hand.gravity_torque_nm.iter());
    joints.map(|((motion, effort), gravity)| motion.abs() * effort - motion * gravity).sum()
}
