//! A quick test that rejects hopeless holds.
//!
//! For any twist `y` of the board, what weight and load do is at most what the hands can undo:
//! `(weight + lambda load) . y <= sum_i h_i(-y)`, `h_i(-y)` the largest work of hand i on the twist `-y`. That is weak
//! duality of the load program with a dual vector made from `y`; a few twists that loads tend to drive are tried.
//!
//! Only the pads are asked: the largest work of a hand is `2 F max_c (v_n + mu |(v_t1, v_t2, e w_n)| + b |w_t1| +
//! a |w_t2|)`, with `(v, w)` the twist at pad c in pad axes. Torque limits are left to the program: twists that they
//! reject and the pads do not are too rare to look for here.

use nalgebra::Vector3;

use super::{
    compliance::Twist,
    contact_model::{ContactModel, HandModel, PadModel},
};
use crate::model::wrench::Wrench;

/// How much more than the hands can undo a twist must ask for, relative, before it counts: rounding only.
const ROUNDING_MARGIN: f64 = 1e-9;

/// Why a hold cannot stand a load factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Infeasibility {
    /// The way the board goes.
    pub motion: Mechanism,
    /// Work of weight and load on that twist, J, for a twist of arbitrary size.
    pub demand_j: f64,
    /// The most that the hands can undo, J, for the same twist.
    pub capacity_j: f64,
}

/// A way in which a board gets away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Along the force on it.
    Slide,
    /// About a grasp point.
    Turn,
    /// About the line through two grasp points.
    Hinge,
}

impl std::fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let motion = match self.motion {
            Mechanism::Slide => "slides along the force on it",
            Mechanism::Turn => "turns about a hand",
            Mechanism::Hinge => "turns about the line through two hands",
        };
        let percent = 100.0 * self.capacity_j / self.demand_j;
        write!(f, "the board {motion}: the hands can undo at most {percent:.0} % of weight and load")
    }
}

impl ContactModel {
    /// A reason why this hold cannot stand a load factor; none means that it may or may not. A necessary test of two
    /// microseconds: what it rejects, [`StabilityWorkspace::load_factor`](super::StabilityWorkspace::load_factor)
    /// rejects, but for a board that is too heavy by itself and held by a larger load that lifts it.
    pub fn infeasibility(&self, load_factor: f64) -> Option<Infeasibility> {
        let outer = self.weight + self.load.scaled(load_factor);
        // Once for all twists: most of the test's time otherwise.
        let radii_m: Vec<_> =
            self.hands.iter().map(|hand| hand.pads.each_ref().map(PadModel::torsion_radius_m)).collect();
        let lost = |(motion, twist): (Mechanism, Twist)| {
            let back = Twist { linear: -twist.linear, angular: -twist.angular };
            let demand_j = twist.work(&outer);
            let capacity_j: f64 =
                self.hands.iter().zip(&radii_m).map(|(hand, radii_m)| work_of_hand(hand, radii_m, &back)).sum();
            let is_lost = demand_j > capacity_j + ROUNDING_MARGIN * demand_j.abs();
            is_lost.then_some(Infeasibility { motion, demand_j, capacity_j })
        };
        rigid_motions(self, &outer).into_iter().find_map(lost)
    }
}

/// The twists that are tried, stated for O's origin.
fn rigid_motions(model: &ContactModel, outer: &Wrench) -> Vec<(Mechanism, Twist)> {
    let turn_about = |point: &Vector3<f64>, axis: Vector3<f64>| Twist { linear: -axis.cross(point), angular: axis };
    let mut motions = vec![(Mechanism::Slide, Twist { linear: outer.force_n, angular: Vector3::zeros() })];
    for (number, hand) in model.hands.iter().enumerate() {
        let point = &hand.grasp_point_o;
        let moment = outer.about(&-point).moment_nm;
        motions.push((Mechanism::Turn, turn_about(point, moment)));
        for other in &model.hands[..number] {
            let line = point - other.grasp_point_o;
            // Which way round: the way that the moment drives.
            let axis = line * line.dot(&moment).signum();
            motions.push((Mechanism::Hinge, turn_about(point, axis)));
        }
    }
    motions
}

fn work_of_hand(hand: &HandModel, radii_m: &[f64; 2], twist: &Twist) -> f64 {
    let largest = hand
        .pads
        .iter()
        .zip(radii_m)
        .map(|(pad, radius_m)| work_per_normal_force(pad, *radius_m, twist))
        .fold(f64::NEG_INFINITY, f64::max);
    2.0 * hand.grip_force_n * largest
}

/// The most work of a pad per newton of normal force, m, for the torsion radius of its patch.
fn work_per_normal_force(pad: &PadModel, radius_m: f64, twist: &Twist) -> f64 {
    let at_pad = twist.at(&pad.x_op.translation.vector);
    let v = pad.x_op.rotation.inverse() * at_pad.linear;
    let w = pad.x_op.rotation.inverse() * at_pad.angular;
    let [a, b] = pad.half_sides_m;
    let friction = v.x.hypot(v.y).hypot(radius_m * w.z);
    v.z + pad.friction * friction + b * w.x.abs() + a * w.y.abs()
}
