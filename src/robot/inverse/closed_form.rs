//! The closed form for seven joints whose axes intersect in pairs.
//!
//! The joints S0 S1 E0 E1 W0 W1 W2 have axes z, a1, f, y, d, a, Z, each normal to the next; S1 meets E0, E1 meets W0,
//! W1 meets W2. With three offsets, shoulder, elbow and wrist are not spherical:
//!
//! ```text
//! r_E = A u + r,   r = L1 f + B x_E       the elbow from the shoulder's axis z, at the height of a1
//! r_M = r_E + L2 d + C (a x d)            the wrist, where W1 meets W2
//! ```
//!
//! with `u = a1 x z` and `x_E = y x f`. The target determines the wrist `r_M` and the axes `X, Y, Z` of its frame M. One joint
//! is free; for a given W1, one equation relates W2 and S0, the length of the upper arm:
//!
//! ```text
//! c0 = r_M - (C sin w1 + L2 cos w1) Z     k = C cos w1 - L2 sin w1     b(w2) = X cos w2 - Y sin w2
//! |q - k b(w2)|^2 = L1^2 + B^2,  q(s0) = c0 - A u(s0)
//! ```
//!
//! Each S0 has at most two W2, in closed form. They give `r = q - k b`, the forearm's direction `d`, and the elbow's axis, one
//! of `+-(r x d) / |r x d|`. The zeros along S0 of the remaining residual `f . a1 = 0` are the solutions of the slice. The
//! angles follow by `atan2`.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{
    general::General,
    geometry::Geometry,
    manifold::{SelfMotion, Sliced, branches},
    slice::{Slice, Zero},
    solution::{contains, is_finite, turned_into},
    trace::Angles,
};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Tolerance of limits for angles of the closed form before Newton's method clamps them, rad: rounding.
const LIMIT_TOLERANCE_RAD: f64 = 1e-9;

/// Fraction of the arm's length beyond which the arm counts as nearly stretched.
const NEARLY_STRETCHED: f64 = 0.93;

/// The free joint: W1.
const FREE_JOINT: usize = 5;

/// Number of stretched postures per configuration of shoulder and wrist that seed curves between two slices. With this number, and
/// the postures over the joint ranges, 1 of 20,000 random postures was on no branch; with slices alone 28 of 1,000.
const STRETCHED_TURNS: usize = 4;

/// The inverse kinematics of a chain of this structure.
#[derive(Clone, Debug)]
pub struct ClosedForm {
    general: General,
    geometry: Geometry,
}

impl ClosedForm {
    /// The closed form of a chain; `None` if the chain does not have the structure.
    pub fn new(chain: &Chain) -> Option<Self> {
        Some(Self { general: General::new(chain), geometry: Geometry::new(chain)? })
    }

    /// The general solver of the same chain.
    pub(super) fn general(&self) -> &General {
        &self.general
    }

    /// The range of S0 within its limits, at most one turn, rad.
    pub(super) fn s0_range(&self) -> [f64; 2] {
        let chain = self.general.chain();
        [chain.lower()[0], chain.upper()[0].min(chain.lower()[0] + std::f64::consts::TAU)]
    }

    /// Samples of the self-motion: the solutions at `slices` angles of the joint W1, evenly spread over its range, in order.
    pub fn manifold(&self, target: &Pose, slices: usize) -> Vec<Vec<f64>> {
        let (lower, upper) = (self.general.chain().lower()[FREE_JOINT], self.general.chain().upper()[FREE_JOINT]);
        let angle = |number: usize| lower + (upper - lower) * (number as f64 + 0.5) / slices as f64;
        (0..slices).flat_map(|number| self.slice(target, angle(number))).collect()
    }

    /// All solutions within limits with the joint W1 at `w1_rad`. May miss pairs that nearly coincide, which
    /// [`ClosedForm::branches`] finds. Empty if there are none, if the target is not finite, and at the one angle (k = 0) at
    /// which W2 does not move the elbow.
    pub fn slice(&self, target: &Pose, w1_rad: f64) -> Vec<Vec<f64>> {
        if !is_finite(target) || !w1_rad.is_finite() {
            return Vec::new();
        }
        let slice = Slice::new(&self.geometry, target, w1_rad);
        let mut solutions: Vec<Vec<f64>> = Vec::new();
        for zero in slice.zeros(self.s0_range()) {
            let polished = self.angles(&slice, &zero).and_then(|q_rad| self.general.polished(target, q_rad));
            solutions.extend(polished.filter(|q_rad| !contains(&solutions, q_rad)));
        }
        solutions
    }

    /// All branches of solutions within the joint limits, longest first. Of a joint range wider than one turn only the first turn
    /// is searched.
    pub fn branches(&self, target: &Pose) -> SelfMotion {
        branches(self, target)
    }

    /// The joint angles at a zero of the residual; `None` if one is beyond its limits.
    fn angles(&self, slice: &Slice, zero: &Zero) -> Option<Vec<f64>> {
        let chain = self.general.chain();
        let limits = chain.lower().iter().zip(chain.upper());
        let angles = self.unlimited_angles(slice, zero)?;
        angles
            .iter()
            .zip(limits)
            .map(|(angle, (lower, upper))| turned_into(*angle, [*lower, *upper], LIMIT_TOLERANCE_RAD))
            .collect()
    }

    /// The joint angles at a zero of the residual, modulo full turns.
    fn unlimited_angles(&self, slice: &Slice, zero: &Zero) -> Option<Angles> {
        let at = slice.elbow(zero.s0, zero.w2_sign);
        let m = at.r.cross(&at.d).norm();
        // At m = 0 the arm is stretched and the elbow's axis undefined. Neighbouring slices cover this case.
        let y = at.r.cross(&at.d) * (zero.elbow_sign / (m > 0.0).then_some(m)?);
        Some(self.angles_at(slice, zero.s0, [slice.w1, at.w2()], [&at.r, &at.d, &y]))
    }

    /// The joint angles from S0, the wrist (W1 and W2), r, d and the elbow's axis y.
    fn angles_at(&self, slice: &Slice, s0: f64, [w1, w2]: [f64; 2], [r, d, y]: [&Vector3<f64>; 3]) -> Angles {
        let (u, a1) = (Vector3::new(s0.cos(), s0.sin(), 0.0), Vector3::new(-s0.sin(), s0.cos(), 0.0));
        let [l1, b] = self.geometry.upper_arm_m;
        let f = (r * l1 - y.cross(r) * b).normalize();
        let x_e = y.cross(&f);
        let s1 = (-f.z).atan2(f.dot(&u));
        let down = -u * s1.sin() - Vector3::z() * s1.cos();
        let e1 = d.dot(&x_e).atan2(d.dot(&f));
        let across = x_e * e1.cos() - f * e1.sin();
        let a = slice.x * w2.sin() + slice.y * w2.cos();
        let e0 = x_e.dot(&a1).atan2(x_e.dot(&down));
        let w0 = (-a.dot(&across)).atan2(a.dot(y));
        Angles::from([s0, s1, e0, e1, w0, w1, w2]) - Angles::from(self.geometry.offset_rad)
    }

    /// Stretched postures (r along d) near a far target. There the upper arm rotates about r while W1 hardly moves, so slices may
    /// miss the curve. `turns` postures per configuration of shoulder and wrist.
    fn stretched(&self, target: &Pose, turns: usize) -> Vec<Angles> {
        let frame = Slice::new(&self.geometry, target, 0.0);
        let wrist = frame.wrist();
        let length_m = self.geometry.upper_arm_m[0].hypot(self.geometry.upper_arm_m[1])
            + self.geometry.forearm_m[0].hypot(self.geometry.forearm_m[1]);
        let mut postures = Vec::new();
        for s0 in [wrist.y.atan2(wrist.x), (-wrist.y).atan2(-wrist.x)] {
            let to_wrist = wrist - Vector3::new(s0.cos(), s0.sin(), 0.0) * self.geometry.shoulder_m;
            if to_wrist.norm() < NEARLY_STRETCHED * length_m {
                continue;
            }
            let d = to_wrist.normalize();
            let r = d * self.geometry.upper_arm_m[0].hypot(self.geometry.upper_arm_m[1]);
            let Some(a) = d.cross(&frame.z).try_normalize(f64::EPSILON) else { continue };
            for a in [a, -a] {
                let wrist =
                    [(-d.dot(&a.cross(&frame.z))).atan2(d.dot(&frame.z)), a.dot(&frame.x).atan2(a.dot(&frame.y))];
                for turn in 0..turns {
                    let angle = TAU * turn as f64 / turns as f64;
                    let y = a * angle.cos() + d.cross(&a) * angle.sin();
                    postures.push(self.angles_at(&frame, s0, wrist, [&r, &d, &y]));
                }
            }
        }
        postures
    }
}

impl Sliced for ClosedForm {
    fn general(&self) -> &General {
        &self.general
    }

    fn free_joint(&self) -> usize {
        FREE_JOINT
    }

    /// The solutions to about 1e-4 rad.
    fn unlimited_slice(&self, target: &Pose, w1_rad: f64) -> Vec<Angles> {
        let slice = Slice::new(&self.geometry, target, w1_rad);
        let zeros = slice.zeros([-std::f64::consts::PI, std::f64::consts::PI]);
        zeros.iter().filter_map(|zero| self.unlimited_angles(&slice, zero)).collect()
    }

    fn further_seeds(&self, target: &Pose) -> Vec<Angles> {
        self.stretched(target, STRETCHED_TURNS)
    }
}
