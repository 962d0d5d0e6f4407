//! A fast necessary test that rejects infeasible grasps before any program is solved.
//!
//! For any virtual twist `y` of the board, the work of weight and load is at most what the hands can resist: `(weight +
//! lambda load) . y <= sum_i h_i(-y)`, with `h_i(-y)` the largest work of hand i on the twist `-y`. This is the
//! kinematic bound of limit analysis: weak duality of the load program (docs/method.md#66-certificate) with a dual
//! vector made from `y`. A few likely mechanisms are tried.
//!
//! Only the limits of pads and of measured grippers are used, for these the support function of the limits. For pads `h_i = 2 F max_c (v_n + mu |(v_t1, v_t2, e w_n)| + b |w_t1| + a |w_t2|)`, with `(v, w)`
//! the twist at pad c in pad axes. Torque limits are left to the program: a twist that they reject and the pads do not
//! is rare.

use nalgebra::Vector3;

use super::{contact_model::ContactModel, hand::HandModel, hold::Hold, pad_model::PadModel, twist::Twist};
use crate::model::wrench::Wrench;

/// Relative excess of demand over capacity above which a mechanism counts: rounding only.
const ROUNDING_MARGIN: f64 = 1e-9;

/// A mechanism that proves a load factor infeasible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Infeasibility {
    /// How the board moves.
    pub mechanism: Mechanism,
    /// Work of weight and load on the mechanism's twist, J; the twist's size is arbitrary.
    pub demand_j: f64,
    /// The largest work with which the hands can resist the same twist, J.
    pub capacity_j: f64,
}

/// A rigid motion of the board relative to the hands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Translation along the applied force.
    Slide,
    /// Rotation about a grasp point.
    Turn,
    /// Rotation about the line through two grasp points.
    Hinge,
}

impl std::fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let motion = match self.mechanism {
            Mechanism::Slide => "slides along the applied force",
            Mechanism::Turn => "turns about a hand",
            Mechanism::Hinge => "turns about the line through two hands",
        };
        let percent = 100.0 * self.capacity_j / self.demand_j;
        write!(f, "the board {motion}: the hands resist at most {percent:.0} % of weight and load")
    }
}

impl ContactModel {
    /// A mechanism that proves a load factor infeasible; `None` if none is found, in which case the load factor may
    /// still be infeasible. Takes about two microseconds. Whatever it rejects,
    /// [`StabilityWorkspace::load_factor`](super::StabilityWorkspace::load_factor) rejects too, except a board that is
    /// too heavy for its hands but lifted by a larger load.
    #[must_use]
    pub fn infeasibility(&self, load_factor: f64) -> Option<Infeasibility> {
        let outer = self.weight + self.load.scaled(load_factor);
        // Computed once for all mechanisms: they would take most of the time.
        let radii_m: Vec<_> = self.hands.iter().map(radii_m).collect();
        let proof = |(mechanism, twist): (Mechanism, Twist)| {
            let (demand_j, capacity_j) = self.work(&radii_m, &outer, &twist);
            is_excess(demand_j, capacity_j).then_some(Infeasibility { mechanism, demand_j, capacity_j })
        };
        mechanisms(self, &outer).into_iter().find_map(proof)
    }

    /// True if the hands cannot resist a wrench on the board along this twist of it, which proves that there is no equilibrium.
    pub(super) fn is_moved(&self, outer: &Wrench, twist: &Twist) -> bool {
        let radii_m: Vec<_> = self.hands.iter().map(radii_m).collect();
        let (demand_j, capacity_j) = self.work(&radii_m, outer, twist);
        is_excess(demand_j, capacity_j)
    }

    /// The work of a wrench on a twist of the board, and the largest with which the hands can resist it, J.
    fn work(&self, radii_m: &[[f64; 2]], outer: &Wrench, twist: &Twist) -> (f64, f64) {
        let back = Twist { linear: -twist.linear, angular: -twist.angular };
        let of_hands = self.hands.iter().zip(radii_m).map(|(hand, radii_m)| work_of_hand(hand, radii_m, &back));
        (twist.work(outer), of_hands.sum())
    }
}

fn is_excess(demand_j: f64, capacity_j: f64) -> bool {
    demand_j > capacity_j + ROUNDING_MARGIN * demand_j.abs()
}

/// The mechanisms tried, as twists at O's origin.
fn mechanisms(model: &ContactModel, outer: &Wrench) -> Vec<(Mechanism, Twist)> {
    let turn_about = |point: &Vector3<f64>, axis: Vector3<f64>| Twist { linear: -axis.cross(point), angular: axis };
    let mut motions = vec![(Mechanism::Slide, Twist { linear: outer.force_n, angular: Vector3::zeros() })];
    for (number, hand) in model.hands.iter().enumerate() {
        let point = &hand.grasp_point_o;
        let moment = outer.about(&-point).moment_nm;
        motions.push((Mechanism::Turn, turn_about(point, moment)));
        for other in &model.hands[..number] {
            let line = point - other.grasp_point_o;
            // In the direction that the moment drives.
            let axis = line * line.dot(&moment).signum();
            motions.push((Mechanism::Hinge, turn_about(point, axis)));
        }
    }
    motions
}

/// The torsion radii of a hand's pads, m; of no use for a measured gripper.
fn radii_m(hand: &HandModel) -> [f64; 2] {
    hand.pad_pair().map_or([0.0; 2], |pair| pair.pads.each_ref().map(PadModel::torsion_radius_m))
}

/// The largest work with which a hand resists a twist at O's origin, J.
fn work_of_hand(hand: &HandModel, radii_m: &[f64; 2], twist: &Twist) -> f64 {
    match &hand.hold {
        Hold::Pads(pair) => {
            let per_force = pair.pads.iter().zip(radii_m);
            let per_force = per_force.map(|(pad, radius_m)| work_per_normal_force(pad, *radius_m, twist));
            2.0 * pair.grip_force_n * per_force.fold(f64::NEG_INFINITY, f64::max)
        }
        Hold::Measured(measured) => {
            let at_grasp = twist.at(&hand.grasp_point_o);
            // A twist turns like a wrench.
            let twist_g = measured.in_g(&Wrench::new(at_grasp.linear, at_grasp.angular));
            measured.limits.largest_work(&twist_g.into())
        }
    }
}

/// The largest work of a pad per newton of normal force, m. `radius_m` is the torsion radius of its patch.
fn work_per_normal_force(pad: &PadModel, radius_m: f64, twist: &Twist) -> f64 {
    let at_pad = twist.at(&pad.x_op.translation.vector);
    let v = pad.x_op.rotation.inverse() * at_pad.linear;
    let w = pad.x_op.rotation.inverse() * at_pad.angular;
    let [a, b] = pad.half_sides_m;
    let friction = v.x.hypot(v.y).hypot(radius_m * w.z);
    v.z + pad.friction * friction + b * w.x.abs() + a * w.y.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A margin for rounding only: a demand that is met proves nothing, whatever its size.
    #[test]
    fn a_demand_that_is_met_is_no_excess() {
        for size_j in [0.0, 1.0, 1e6] {
            assert!(!is_excess(size_j, size_j));
            assert!(!is_excess(size_j * (1.0 + 1e-10), size_j));
        }
        for size_j in [1e-3, 1.0, 1e6] {
            assert!(is_excess(size_j * (1.0 + 1e-8), size_j));
        }
    }
}
