//! Where the joints of the arm may be: anatomical limits, and those of a natural posture
//! (docs/method.md#41-arm-kinematics, docs/method.md#413-natural-postures).
//!
//! The upper arm's orientation is `R_VU = S(u) Rz(t)`: S is the smallest rotation that turns hanging into the direction u from
//! shoulder to elbow, t the twist. A shoulder is limited either by a box on q1, q2 and q3, or by the twist and the elevation
//! `angle(u, -z_V)`, which belong to the orientation and not to its three angles.

use std::f64::consts::{FRAC_PI_2, PI};

use arrayvec::ArrayVec;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::model::scenario::{PostureLimits, ShoulderKind};

/// Joint angles of the working arm, rad, positive towards: shoulder flexion, abduction, internal rotation, elbow flexion,
/// pronation, wrist flexion, ulnar deviation. For a left-handed person those of the mirrored right arm.
pub type ArmAngles = [f64; 7];

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
    // Straight up the twist has no value.
    (cos * (x.y - y.x) - sin * (x.x + y.y)) / (sin * sin + cos * cos).max(f64::MIN_POSITIVE)
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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::Unit;
    use rand::RngExt;
    use rand_pcg::Pcg64;

    use super::*;
    use crate::{
        human::{
            Human, HumanError, default_tool,
            testing::{average_man, generator, random_angles, random_shares, within},
        },
        model::{operation::OperationKind, scenario::Person},
    };

    const STEP: f64 = 1e-6;

    fn human(person: &Person) -> Result<Human, HumanError> {
        Human::new(person, &default_tool(OperationKind::Drill))
    }

    /// Swing-twist with and without limits of the posture, and a box with and without.
    fn humans() -> [Human; 4] {
        let box_within = |posture| human(&Person { posture, ..average_man() }).unwrap();
        let [natural, unrestricted] = [PostureLimits::NATURAL, PostureLimits::UNRESTRICTED];
        [within(natural), within(unrestricted), box_within(natural), box_within(unrestricted)]
    }

    /// Uniform on the sphere of quaternions but for the density of a cube.
    fn random_rotation(generator: &mut Pcg64) -> UnitQuaternion<f64> {
        let mut unit = || generator.random_range(-1.0..1.0_f64);
        UnitQuaternion::new_normalize(Quaternion::new(unit(), unit(), unit(), unit()))
    }

    #[test]
    fn twist_and_elevation_are_those_of_the_quaternions_swing_and_twist() {
        let mut generator = generator(51);
        for _ in 0..10_000 {
            let rotation = random_rotation(&mut generator);
            let r_vu = rotation.to_rotation_matrix().into_inner();
            // rotation = swing . twist, the twist about z, the swing about a horizontal axis.
            let twist = UnitQuaternion::new_normalize(Quaternion::new(rotation.w, 0.0, 0.0, rotation.k));
            let swing = rotation * twist.inverse();
            assert!(swing.k.abs() < 1e-14, "{swing}");
            let expected_rad = 2.0 * libm::atan2(twist.k, twist.w);
            let difference = (twist_rad(&r_vu) - expected_rad).rem_euclid(TAU);
            // Near 180 degrees of elevation w and z vanish, and the twist is good to the root of the rounding.
            assert!(difference.min(TAU - difference) < 1e-7, "{difference}");
            assert!((elevation_rad(&r_vu) - swing.angle()).abs() < 1e-7);
            let u = r_vu * -Vector3::z();
            assert!((libm::cos(elevation_rad(&r_vu)) + u.z).abs() < 1e-14);
        }
    }

    #[test]
    fn the_shoulders_angles_give_the_elevation_direction_and_twist_that_were_asked() {
        let (human, mut generator) = (within(PostureLimits::UNRESTRICTED), generator(52));
        for _ in 0..10_000 {
            let mut within = |low: f64, high: f64| generator.random_range(low..high);
            let (elevation, azimuth, twist) = (within(0.01, 3.1), within(-PI, PI), within(-PI, PI));
            let [q1, q2, q3] = shoulder_angles(elevation, azimuth, twist);
            assert!(q2.abs() <= FRAC_PI_2);
            let r_vu = human.arm().frames(&[q1, q2, q3, 0.0, 0.0, 0.0, 0.0]).r_bu;
            // 1e-16 over the horizontal part of u at 0.01, and over cos^2(elevation / 2) at 3.1.
            assert!((elevation_rad(&r_vu) - elevation).abs() < 1e-12);
            assert!((twist_rad(&r_vu) - twist).abs() < 1e-12, "{elevation} {azimuth} {twist}");
            let u = -r_vu.column(2);
            assert!((libm::atan2(u.y, u.x) - azimuth).abs() < 1e-12);
        }
        assert_eq!(shoulder_angles(0.0, 1.0, 0.0).map(f64::abs), [0.0; 3]);
    }

    #[test]
    fn the_twists_slope_is_its_derivative() {
        let mut generator = generator(53);
        for _ in 0..1_000 {
            let r_vu = random_rotation(&mut generator).to_rotation_matrix().into_inner();
            if elevation_rad(&r_vu) > 3.0 || twist_rad(&r_vu).abs() > 3.0 {
                continue; // there the slope runs to infinity, and the twist jumps by a full turn
            }
            let axis = Unit::new_normalize(Vector3::from_fn(|_, _| generator.random_range(-1.0..1.0)));
            let twist = |angle| twist_rad(&(UnitQuaternion::from_axis_angle(&axis, angle).to_rotation_matrix() * r_vu));
            let slope = (twist(STEP) - twist(-STEP)) / (2.0 * STEP);
            // 1 / cos^2(3.0 / 2) = 200: rounding 200 x 1e-16 / step, third derivative 200^3 step^2.
            assert!((twist_slope(&r_vu, &axis) - slope).abs() < 1e-4, "{slope}");
        }
    }

    #[test]
    fn shares_give_angles_inside_the_ranges_up_to_both_ends() {
        let mut generator = generator(54);
        for human in [within(PostureLimits::NATURAL), within(PostureLimits::UNRESTRICTED)] {
            let arm = human.arm();
            let highest = arm.ranges.elevation_rad.unwrap();
            let mut above = 0;
            for _ in 0..10_000 {
                let q_rad = random_shares(arm, &mut generator);
                let r_vu = arm.frames(&q_rad).r_bu;
                assert!(arm.ranges.margins(&q_rad, &r_vu).iter().all(|margin| *margin > -1e-12), "{q_rad:?}");
                above += usize::from(libm::cos(elevation_rad(&r_vu)) < (1.0 + libm::cos(highest)) / 2.0);
            }
            // Uniform on the sphere: the lower half of the height has half of the directions, 5,000 +- 3 x 50.
            assert!((4_850..5_150).contains(&above), "{above}");
            for share in [0.0, 1.0] {
                let q_rad = arm.ranges.at_shares([share; 7]);
                assert!(arm.permits_shoulder(&q_rad) && q_rad[3] == arm.ranges.joints_rad[3][share as usize]);
            }
        }
        let arm = human(&average_man()).unwrap().arm().clone();
        assert_eq!(arm.ranges.at_shares([0.0; 7]), arm.ranges.joints_rad.map(|[low, _]| low));
        for (q_rad, [_, high]) in arm.ranges.at_shares([1.0; 7]).into_iter().zip(arm.ranges.joints_rad) {
            assert!((q_rad - high).abs() < 1e-15);
        }
    }

    #[test]
    fn margins_are_positive_within_the_limits_and_their_gradients_are_derivatives() {
        for (number, human) in (0..).zip(humans()) {
            let (arm, mut generator) = (human.arm(), generator(55 + number));
            let margins = |q_rad: &ArmAngles| arm.ranges.margins(q_rad, &arm.frames(q_rad).r_bu);
            let mut inside = 0;
            for round in 0..1_000 {
                let q_rad: ArmAngles = if round % 2 == 0 {
                    random_shares(arm, &mut generator)
                } else {
                    // Beyond all limits, too.
                    random_angles(arm, &mut generator).map(|q| 1.2 * q)
                };
                let frames = arm.frames(&q_rad);
                let [other, last] = arm.ranges.margins_rad(&q_rad, &frames.r_bu);
                let within_shoulder = arm.ranges.twist_rad.is_none()
                    || arm.ranges.joints_rad[..3].iter().zip(q_rad).all(|([low, high], q)| (*low..=*high).contains(&q));
                if within_shoulder {
                    assert_eq!(margins(&q_rad).iter().all(|margin| *margin >= 0.0), arm.within_limits(&q_rad));
                    assert_eq!(other >= 0.0 && last >= 0.0, arm.within_limits(&q_rad));
                }
                inside += usize::from(arm.within_limits(&q_rad));
                if twist_rad(&frames.r_bu).abs() > 3.0 || elevation_rad(&frames.r_bu) > 3.0 {
                    continue; // as for the twist's slope
                }
                let gradients = arm.ranges.margin_gradients(&frames.r_bu, &frames.axes_b);
                assert_eq!(gradients.len(), margins(&q_rad).len());
                for joint in 0..7 {
                    let [back, forth] = [-STEP, STEP].map(|by| {
                        let mut q_rad = q_rad;
                        q_rad[joint] += by;
                        margins(&q_rad)
                    });
                    for ((gradient, back), forth) in gradients.iter().zip(back).zip(forth) {
                        let slope = (forth - back) / (2.0 * STEP);
                        // As for the twist's slope.
                        assert!((gradient[joint] - slope).abs() < 1e-4, "{joint}: {gradient:?} {slope}");
                    }
                }
            }
            assert!((100..900).contains(&inside), "{number}: {inside}");
        }
    }

    #[test]
    fn a_natural_posture_narrows_the_ranges() {
        let degrees = |range: [f64; 2]| range.map(|angle: f64| (angle.to_degrees() * 1e9).round() / 1e9);
        let [natural, unrestricted, natural_box, _] = humans();
        let anatomy = unrestricted.arm().ranges;
        assert_eq!((&anatomy, &anatomy), (unrestricted.anatomy(), natural.anatomy()));
        assert_eq!((degrees(anatomy.twist_rad.unwrap()), anatomy.elevation_rad), ([-90.0, 90.0], Some(TAU / 3.0)));
        let ranges = natural.arm().ranges;
        // The upper arm up to 60 degrees; 10 degrees from the twist's limits.
        assert_eq!(degrees([ranges.elevation_rad.unwrap(), 0.0])[0], 60.0);
        assert_eq!(degrees(ranges.twist_rad.unwrap()), [-80.0, 80.0]);
        // The law of cosines for 0.3255 m, 0.2555 m and 0.9 of their sum.
        let cosine = (0.5229_f64.powi(2) - 0.3255_f64.powi(2) - 0.2555_f64.powi(2)) / (2.0 * 0.3255 * 0.2555);
        let straightest_deg = cosine.acos().to_degrees();
        assert!((straightest_deg - 52.1).abs() < 0.05);
        assert!((ranges.joints_rad[3][0].to_degrees() - straightest_deg).abs() < 1e-9);
        assert_eq!(degrees(ranges.joints_rad[3])[1], 130.0);
        // 10 degrees from pronation's and flexion's, 5 from deviation's limits.
        assert_eq!(
            [4, 5, 6].map(|joint| degrees(ranges.joints_rad[joint])),
            [[-80.0, 80.0], [-60.0, 65.0], [-15.0, 35.0]]
        );
        let ranges = natural_box.arm().ranges;
        assert_eq!(
            [0, 1, 2].map(|joint| degrees(ranges.joints_rad[joint])),
            [[-50.0, 170.0], [-20.0, 110.0], [-80.0, 80.0]]
        );
        assert_eq!((ranges.twist_rad, degrees([ranges.elevation_rad.unwrap(), 0.0])[0]), (None, 60.0));
    }

    #[test]
    fn the_margins_of_an_arm_by_hand() {
        let [_, unrestricted, ..] = humans();
        let arm = unrestricted.arm();
        let at = |q_deg: [f64; 7]| {
            let q_rad = q_deg.map(f64::to_radians);
            arm.ranges
                .margins_rad(&q_rad, &arm.frames(&q_rad).r_bu)
                .map(|margin| (margin.to_degrees() * 1e9).round() / 1e9)
        };
        // Flexion of the wrist is 70 degrees from a limit, the elbow 55, deviation 20 degrees from radial deviation's.
        assert_eq!(at([0.0, 0.0, 0.0, 70.0, 0.0, 0.0, 0.0]), [70.0, 20.0]);
        assert_eq!(at([0.0, 0.0, 0.0, 90.0, 0.0, 0.0, 0.0]), [55.0, 20.0]);
        // The elevation has 120 degrees, the twist 90.
        assert_eq!(at([100.0, 0.0, 0.0, 90.0, 0.0, 0.0, 35.0]), [20.0, 5.0]);
        assert_eq!(at([0.0, 0.0, -95.0, 90.0, 0.0, 0.0, 45.0]), [-5.0, -5.0]);
    }

    #[test]
    fn limits_that_leave_no_range_are_an_error() {
        let of = |posture| human(&Person { posture, ..Person::default() }).err();
        let natural = PostureLimits::NATURAL;
        assert_eq!(of(natural), None);
        for posture in [
            PostureLimits { limit_margin_deg: 73.0, ..natural },
            PostureLimits { deviation_margin_deg: 31.0, ..natural },
            PostureLimits { elbow_deg: [100.0, 50.0], ..natural },
            // At 0.2 of its length the arm is bent by more than 130 degrees.
            PostureLimits { reach: 0.2, ..natural },
            PostureLimits { upper_arm_deg: 0.0, ..natural },
            PostureLimits { limit_margin_deg: f64::NAN, ..natural },
        ] {
            assert_eq!(of(posture), Some(HumanError::NoRange), "{posture:?}");
            let unrestricted = PostureLimits { kind: PostureLimits::UNRESTRICTED.kind, ..posture };
            assert_eq!(of(unrestricted), None);
        }
    }
}
