//! Where the joints of the arm may be: anatomical limits, and those of a natural posture
//! (docs/method.md#41-arm-kinematics, docs/method.md#413-natural-postures).
//!
//! The upper arm's orientation is `R_VU = S(u) Rz(t)`: S is the smallest rotation that turns hanging into the direction u from
//! shoulder to elbow, t the twist. A shoulder is limited either by a box on q1, q2 and q3, or by the twist and the elevation
//! `angle(u, -z_V)`, which belong to the orientation and not to its three angles.

use std::f64::consts::{FRAC_PI_2, PI};

use arrayvec::ArrayVec;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::arm::ArmAngles;
use crate::model::scenario::{PostureLimits, ShoulderKind};

/// Margins of an arm in its ranges: two per joint, or two of the twist in place of the shoulder's six, and the elevation's.
pub type Margins<T> = ArrayVec<T, 15>;

/// Ranges of the arm's joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmRanges {
    /// Range of each angle, rad. With a range of the twist the first three are not limited.
    pub joints_rad: [[f64; 2]; 7],
    /// Range of the upper arm's twist, rad; `None` for a shoulder with a box.
    pub twist_rad: Option<[f64; 2]>,
    /// Largest elevation of the upper arm, rad.
    pub elevation_rad: Option<f64>,
}

/// Ranges of the three angles that together give every orientation once.
const EVERY_ORIENTATION_RAD: [[f64; 2]; 3] = [[-PI, PI], [-FRAC_PI_2, FRAC_PI_2], [-PI, PI]];

/// The anatomical limits of the shoulder, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShoulderLimits {
    /// Range of the upper arm's twist.
    pub twist_rad: [f64; 2],
    /// Largest elevation of the upper arm.
    pub elevation_rad: f64,
}

/// Elevation of the upper arm from hanging, rad.
#[must_use]
pub fn elevation_rad(r_vu: &Matrix3<f64>) -> f64 {
    libm::atan2(libm::hypot(r_vu.m13, r_vu.m23), r_vu.m33)
}

/// Twist of the upper arm, rad, positive for internal rotation: of the quaternion of `R_VU` it is `2 atan2(z, w)`.
#[must_use]
pub fn twist_rad(r_vu: &Matrix3<f64>) -> f64 {
    libm::atan2(r_vu.m21 - r_vu.m12, r_vu.m11 + r_vu.m22)
}

/// Derivative of the twist if the upper arm turns about an axis in V, 1.
#[must_use]
pub fn twist_slope(r_vu: &Matrix3<f64>, axis_v: &Vector3<f64>) -> f64 {
    let [x, y] = [0, 1].map(|column| axis_v.cross(&r_vu.column(column)));
    let (sin, cos) = (r_vu.m21 - r_vu.m12, r_vu.m11 + r_vu.m22);
    (cos * (x.y - y.x) - sin * (x.x + y.y)) / (sin * sin + cos * cos)
}

/// The shoulder's angles for an upper arm at this elevation, in this direction (from x_V towards y_V) and with this twist, rad.
/// Abduction is within a right angle.
#[must_use]
pub fn shoulder_angles(elevation_rad: f64, azimuth_rad: f64, twist_rad: f64) -> [f64; 3] {
    let half = |angle_rad: f64| libm::sincos(angle_rad / 2.0);
    let ((swing_sin, swing_cos), (twist_sin, twist_cos)) = (half(elevation_rad), half(twist_rad));
    let (sin, cos) = libm::sincos(azimuth_rad);
    // From hanging, -z, towards u the arm turns about -z x u = (u_y, -u_x, 0).
    let swing = Quaternion::new(swing_cos, swing_sin * sin, -swing_sin * cos, 0.0);
    let twist = Quaternion::new(twist_cos, 0.0, 0.0, twist_sin);
    let r = UnitQuaternion::new_normalize(swing * twist).to_rotation_matrix().into_inner();
    let q1 = libm::atan2(-r.m13, r.m33);
    let (sin, cos) = libm::sincos(q1);
    let (x, y) = (r.m11 * cos + r.m31 * sin, r.m12 * cos + r.m32 * sin);
    [q1, libm::atan2(r.m23, libm::hypot(r.m13, r.m33)), libm::atan2(-y, x)]
}

impl ArmRanges {
    /// The anatomical ranges.
    pub(super) fn anatomical(mut joints_rad: [[f64; 2]; 7], limits: &ShoulderLimits, shoulder: ShoulderKind) -> Self {
        match shoulder {
            ShoulderKind::Box => Self { joints_rad, twist_rad: None, elevation_rad: None },
            ShoulderKind::SwingTwist => {
                joints_rad[..3].copy_from_slice(&EVERY_ORIENTATION_RAD);
                let ShoulderLimits { twist_rad, elevation_rad } = *limits;
                Self { joints_rad, twist_rad: Some(twist_rad), elevation_rad: Some(elevation_rad) }
            }
        }
    }

    /// These ranges within the limits of a natural posture. Reach is a limit of the elbow: `elbow_at` gives its flexion at a
    /// reach.
    pub(super) fn within_posture(&self, limits: &PostureLimits, elbow_at: impl Fn(f64) -> f64) -> Self {
        let (margin, of_deviation) = (limits.limit_margin_deg.to_radians(), limits.deviation_margin_deg.to_radians());
        let inside = |[low, high]: [f64; 2], margin: f64| [low + margin, high - margin];
        let mut joints_rad = self.joints_rad;
        let first = if self.twist_rad.is_some() { 3 } else { 0 };
        joints_rad[first..6].iter_mut().for_each(|range| *range = inside(*range, margin));
        joints_rad[6] = inside(joints_rad[6], of_deviation);
        let [straightest, most_bent] = limits.elbow_deg.map(f64::to_radians);
        joints_rad[3][0] = joints_rad[3][0].max(straightest).max(elbow_at(limits.reach));
        joints_rad[3][1] = joints_rad[3][1].min(most_bent);
        let raised = limits.upper_arm_deg.to_radians();
        Self {
            joints_rad,
            twist_rad: self.twist_rad.map(|range| inside(range, margin)),
            elevation_rad: Some(self.elevation_rad.map_or(raised, |highest| raised.min(highest - margin))),
        }
    }

    /// The arm at shares from 0 to 1 of its ranges. Uniform shares give uniform angles or, with a range of the twist, directions of
    /// the upper arm that are uniform on the sphere up to the largest elevation.
    #[must_use]
    pub fn at_shares(&self, shares: [f64; 7]) -> ArmAngles {
        let between = |[low, high]: [f64; 2], share: f64| low + (high - low) * share;
        let mut q_rad = std::array::from_fn(|joint| between(self.joints_rad[joint], shares[joint]));
        if let (Some(twist_rad), Some(highest_rad)) = (self.twist_rad, self.elevation_rad) {
            let cosine = between([1.0, libm::cos(highest_rad)], shares[0]);
            let azimuth_rad = between([-PI, PI], shares[1]);
            let angles = shoulder_angles(libm::acos(cosine), azimuth_rad, between(twist_rad, shares[2]));
            q_rad[..3].copy_from_slice(&angles);
        }
        q_rad
    }

    /// True if a range is empty.
    pub(super) fn is_empty(&self) -> bool {
        let empty = |&[low, high]: &[f64; 2]| low.is_nan() || high.is_nan() || low >= high;
        self.joints_rad.iter().any(empty)
            || self.twist_rad.iter().any(empty)
            || self.elevation_rad.is_some_and(|e| e <= 0.0)
    }

    /// True if the orientation of the upper arm is limited, and not only its angles.
    pub(super) fn limits_orientation(&self) -> bool {
        self.twist_rad.is_some() || self.elevation_rad.is_some()
    }

    /// True if twist and elevation are within their ranges, and up to `tolerance_rad` beyond.
    pub(super) fn permits_shoulder(&self, r_vu: &Matrix3<f64>, tolerance_rad: f64) -> bool {
        self.twist_rad.is_none_or(|[low, high]| {
            let twist = twist_rad(r_vu);
            low - tolerance_rad <= twist && twist <= high + tolerance_rad
        }) && self.elevation_rad.is_none_or(|highest| elevation_rad(r_vu) <= highest + tolerance_rad)
    }

    /// The smallest distance of a joint but the last from its limits, and that of the last, rad; negative beyond.
    pub(super) fn margins_rad(&self, q_rad: &ArmAngles, r_vu: &Matrix3<f64>) -> [f64; 2] {
        let between = |value: f64, [low, high]: [f64; 2]| (value - low).min(high - value);
        let first = if self.twist_rad.is_some() { 3 } else { 0 };
        let joints = (first..6).map(|joint| between(q_rad[joint], self.joints_rad[joint]));
        let twist = self.twist_rad.map(|range| between(twist_rad(r_vu), range));
        let elevation = self.elevation_rad.map(|highest| highest - elevation_rad(r_vu));
        let other = joints.chain(twist).chain(elevation).fold(f64::INFINITY, f64::min);
        [other, between(q_rad[6], self.joints_rad[6])]
    }

    /// How far the arm is inside each range: rad, of the elevation the difference of cosines; negative outside.
    pub fn margins(&self, q_rad: &ArmAngles, r_vu: &Matrix3<f64>) -> Margins<f64> {
        let mut margins = Margins::new();
        let between = |value: f64, [low, high]: [f64; 2]| [value - low, high - value];
        match self.twist_rad {
            Some(range) => margins.extend(between(twist_rad(r_vu), range)),
            None => (0..3).for_each(|joint| margins.extend(between(q_rad[joint], self.joints_rad[joint]))),
        }
        (3..7).for_each(|joint| margins.extend(between(q_rad[joint], self.joints_rad[joint])));
        margins.extend(self.elevation_rad.map(|highest| r_vu.m33 - libm::cos(highest)));
        margins
    }

    /// The gradients of [`ArmRanges::margins`] by the arm's angles; `axes_v` are the axes of its joints.
    pub fn margin_gradients(&self, r_vu: &Matrix3<f64>, axes_v: &[Vector3<f64>; 7]) -> Margins<[f64; 7]> {
        let single = |joint: usize| std::array::from_fn(|other| f64::from(u8::from(other == joint)));
        let of_shoulder = |slope: &dyn Fn(&Vector3<f64>) -> f64| {
            std::array::from_fn(|joint| if joint < 3 { slope(&axes_v[joint]) } else { 0.0 })
        };
        let mut gradients = Margins::new();
        let mut between = |gradient: [f64; 7]| gradients.extend([gradient, gradient.map(|slope| -slope)]);
        match self.twist_rad {
            Some(_) => between(of_shoulder(&|axis_v| twist_slope(r_vu, axis_v))),
            None => (0..3).for_each(|joint| between(single(joint))),
        }
        (3..7).for_each(|joint| between(single(joint)));
        if self.elevation_rad.is_some() {
            gradients.push(of_shoulder(&|axis_v| axis_v.cross(&r_vu.column(2)).z));
        }
        gradients
    }
}
