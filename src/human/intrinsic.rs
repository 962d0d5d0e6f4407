//! The intrinsic muscular comfort: a function of the segments' orientations and of the load, not of the three angles that
//! describe the shoulder (docs/method.md#414-intrinsic-metric).
//!
//! In the axes of the upper body V, for a right arm, with the unit vector u from shoulder to elbow, theta its angle from hanging
//! and M the moment that the arm exerts about the shoulder:
//!
//! ```text
//! e_r = u x z / |u x z|   m_r = M . e_r    raising
//! e_h = e_r x u           m_h = M . e_h    towards the body's middle
//!                         m_a = M . (-u)   internal rotation
//! shoulder = (m_r / T_r)^2 + (m_h / T_h)^2 + (m_a / T_a)^2
//! ```
//!
//! `T_r` is between the strengths of abduction (sideways) and flexion (forward) by the azimuth of u, `T_a` the strength of
//! rotation at the twist of the upper arm. Every strength is that in the sense of its own moment. Near hanging, where `e_r` has
//! no direction, raising and horizontal are blended into flexion and abduction; beyond 150 degrees all three strengths go over
//! into constants, since the twist has no continuous value straight up.
//!
//! The value is continuous up to there, and differentiable where no strength is at the end of its range.

use std::f64::consts::PI;

use libm::{atan2, hypot};
use nalgebra::{Matrix3, Vector3};

use super::{
    ranges::{twist_rad, twist_slope},
    strength::{Sense, Strength},
};

/// Sum of squares of a resting co-contraction of 5 % in each of seven terms. Bounds the comfort by 57.
pub(super) const CO_CONTRACTION: f64 = 7.0 * 0.05 * 0.05;

/// Horizontal part of u below which raising and horizontal are blended into flexion and abduction: 11.5 degrees.
const HANGING: f64 = 0.2;

/// Elevations between which the strengths go over into constants, rad: 150 and 170 degrees.
const OVERHEAD_RAD: [f64; 2] = [150.0 * PI / 180.0, 170.0 * PI / 180.0];

/// A number and its derivative along one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rate {
    pub value: f64,
    pub slope: f64,
}

impl Rate {
    fn new(value: f64, slope: f64) -> Self {
        Self { value, slope }
    }

    fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    fn times(self, other: Self) -> Self {
        Self::new(self.value * other.value, self.slope * other.value + self.value * other.slope)
    }

    fn plus(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }

    /// `self` where `share` is 1, `other` where it is 0.
    fn blended(self, other: Self, share: Self) -> Self {
        self.times(share).plus(other.times(Self::new(1.0 - share.value, -share.slope)))
    }

    /// `(self / other)^2`.
    fn squared_ratio(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        Self::new(ratio * ratio, 2.0 * ratio * (self.slope - ratio * other.slope) / other.value)
    }
}

/// The upper arm, what it exerts, and how both change along one direction of motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shoulder<'a> {
    /// Orientation of the upper arm in V.
    pub r_vu: &'a Matrix3<f64>,
    /// The moment about the shoulder in V axes, N m.
    pub moment_nm: Vector3<f64>,
    /// Derivative of the moment, N m per unit.
    pub moment_slope: Vector3<f64>,
    /// Angular velocity of the upper arm in V axes, rad per unit.
    pub turn: Vector3<f64>,
}

/// The parts of the moment about the shoulder, N m: raising, horizontal, axial. The first two are zero where the upper arm is
/// vertical.
pub(super) fn parts_nm(r_vu: &Matrix3<f64>, moment_nm: &Vector3<f64>) -> [f64; 3] {
    let u = -r_vu.column(2);
    let horizontal = hypot(u.x, u.y);
    if horizontal == 0.0 {
        return [0.0, 0.0, -moment_nm.dot(&u)];
    }
    let e_r = Vector3::new(u.y, -u.x, 0.0) / horizontal;
    [moment_nm.dot(&e_r), moment_nm.dot(&e_r.cross(&u)), -moment_nm.dot(&u)]
}

impl Shoulder<'_> {
    /// The squares of the shoulder's three activations with their derivatives: raising, horizontal, axial. Near hanging the
    /// first two are those of flexion and abduction.
    pub fn squares(&self, strength: &Strength) -> [Rate; 3] {
        let u = -self.r_vu.column(2).into_owned();
        let du = self.turn.cross(&u);
        let (moment, slope) = (&self.moment_nm, &self.moment_slope);
        let s = hypot(u.x, u.y);
        let elevation = Elevation::new(&u, &du, s);
        let axial = Rate::new(-moment.dot(&u), -slope.dot(&u) - moment.dot(&du));
        let twist = Rate::new(twist_rad(self.r_vu), twist_slope(self.r_vu, &self.turn));
        let rotation = elevation.or_overhead(strength.at(2, twist, sense(axial)), strength.overhead_axial_nm());
        let axial = axial.squared_ratio(rotation);
        let blend = elevation.away_from_hanging(s);
        if blend.value == 0.0 {
            let [flexion, abduction] = self.hanging(strength, &u, &du);
            return [flexion, abduction, axial];
        }
        let ds = (u.x * du.x + u.y * du.y) / s;
        let e_r = Vector3::new(u.y, -u.x, 0.0) / s;
        let de_r = (Vector3::new(du.y, -du.x, 0.0) - e_r * ds) / s;
        let (e_h, de_h) = (e_r.cross(&u), de_r.cross(&u) + e_r.cross(&du));
        let raising = Rate::new(moment.dot(&e_r), slope.dot(&e_r) + moment.dot(&de_r));
        let horizontal = Rate::new(moment.dot(&e_h), slope.dot(&e_h) + moment.dot(&de_h));
        let overhead = strength.overhead_nm();
        let of_raising = elevation.or_overhead(elevation.raising_nm(strength, &u, &du, sense(raising)), overhead);
        let of_horizontal = Rate::constant(strength.horizontal_nm(sense(horizontal)));
        let raising = raising.squared_ratio(of_raising);
        let horizontal = horizontal.squared_ratio(elevation.or_overhead(of_horizontal, overhead));
        if blend.value == 1.0 {
            return [raising, horizontal, axial];
        }
        let [flexion, abduction] = self.hanging(strength, &u, &du);
        [raising.blended(flexion, blend), horizontal.blended(abduction, blend), axial]
    }

    /// The squares of the activations of flexion and abduction of a hanging arm.
    fn hanging(&self, strength: &Strength, u: &Vector3<f64>, du: &Vector3<f64>) -> [Rate; 2] {
        // The angle of u from hanging, projected to one vertical plane.
        let angle = |out: f64, slope: f64| {
            let (down, square) = (-u.z, out * out + u.z * u.z);
            Rate::new(atan2(out, down), (slope * down + out * du.z) / square)
        };
        let flexion = Rate::new(-self.moment_nm.y, -self.moment_slope.y);
        let abduction = Rate::new(-self.moment_nm.x, -self.moment_slope.x);
        let of_flexion = strength.at(0, angle(u.x, du.x), sense(flexion));
        let of_abduction = strength.at(1, angle(-u.y, -du.y), sense(abduction));
        [flexion.squared_ratio(of_flexion), abduction.squared_ratio(of_abduction)]
    }
}

/// The sense of a moment; that of zero does not matter.
fn sense(moment: Rate) -> Sense {
    if moment.value >= 0.0 { Sense::Positive } else { Sense::Negative }
}

/// The elevation of the upper arm.
struct Elevation {
    theta_rad: Rate,
    /// Derivative of the horizontal part of u.
    ds: f64,
    is_low: bool,
}

impl Elevation {
    fn new(u: &Vector3<f64>, du: &Vector3<f64>, s: f64) -> Self {
        let ds = if s > 0.0 { (u.x * du.x + u.y * du.y) / s } else { 0.0 };
        // theta = atan2(s, -u_z), and s^2 + u_z^2 = 1.
        Self { theta_rad: Rate::new(atan2(s, -u.z), -u.z * ds + s * du.z), ds, is_low: u.z < 0.0 }
    }

    /// 0 hanging, 1 from [`HANGING`] on.
    fn away_from_hanging(&self, s: f64) -> Rate {
        if self.is_low { smooth_step(Rate::new(s / HANGING, self.ds / HANGING)) } else { Rate::constant(1.0) }
    }

    /// A strength, which goes over into a constant overhead.
    fn or_overhead(&self, strength_nm: Rate, overhead_nm: f64) -> Rate {
        let [from, to] = OVERHEAD_RAD;
        if self.theta_rad.value <= from {
            return strength_nm;
        }
        let Rate { value, slope } = self.theta_rad;
        let share = smooth_step(Rate::new((value - from) / (to - from), slope / (to - from)));
        Rate::constant(overhead_nm).blended(strength_nm, share)
    }

    /// The strength of raising, N m: `cos^2(phi) T_abduction + sin^2(phi) T_flexion` with the azimuth phi of u, 0 sideways and 90
    /// degrees forward. Behind the body flexion, and across the body abduction, is that at `-theta` in the other sense.
    fn raising_nm(&self, strength: &Strength, u: &Vector3<f64>, du: &Vector3<f64>, sense: Sense) -> Rate {
        let square = u.x * u.x + u.y * u.y;
        let forward = u.x * u.x / square;
        // With x^2 / (x^2 + y^2) = f: f' = 2 x y (x' y - x y') / (x^2 + y^2)^2.
        let share = Rate::new(forward, 2.0 * u.x * u.y * (du.x * u.y - u.x * du.y) / (square * square));
        let row = |joint: usize, is_opposite: bool| {
            let Rate { value, slope } = self.theta_rad;
            if is_opposite {
                strength.at(joint, Rate::new(-value, -slope), sense.opposite())
            } else {
                strength.at(joint, self.theta_rad, sense)
            }
        };
        row(0, u.x < 0.0).blended(row(1, u.y > 0.0), share)
    }
}

/// 0 up to 0, 1 from 1 on, `x^2 (3 - 2 x)` between.
fn smooth_step(x: Rate) -> Rate {
    if x.value <= 0.0 {
        Rate::constant(0.0)
    } else if x.value >= 1.0 {
        Rate::constant(1.0)
    } else {
        Rate::new(x.value * x.value * (3.0 - 2.0 * x.value), 6.0 * x.value * (1.0 - x.value) * x.slope)
    }
}

impl Strength {
    /// The strength of a joint at a changing angle.
    fn at(&self, joint: usize, q_rad: Rate, sense: Sense) -> Rate {
        let value = self.torque_nm(joint, q_rad.value, sense);
        let slope = if q_rad.slope == 0.0 { 0.0 } else { self.slope_nm_rad(joint, q_rad.value, sense) * q_rad.slope };
        Rate::new(value, slope)
    }

    /// The constant of raising and horizontal motion straight up: the mean of the two horizontal strengths.
    fn overhead_nm(&self) -> f64 {
        (self.horizontal_nm(Sense::Positive) + self.horizontal_nm(Sense::Negative)) / 2.0
    }

    /// The constant of rotation straight up: the mean of both senses without twist.
    fn overhead_axial_nm(&self) -> f64 {
        (self.torque_nm(2, 0.0, Sense::Positive) + self.torque_nm(2, 0.0, Sense::Negative)) / 2.0
    }
}
