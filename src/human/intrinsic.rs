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
        // Straight up, where all strengths are constant, e_r may be any direction.
        let s = s.max(f64::MIN_POSITIVE);
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

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use nalgebra::Rotation3;
    use rand::RngExt;

    use super::*;
    use crate::{
        human::{
            ArmAngles, Human, Muscular,
            ranges::{elevation_rad, shoulder_angles},
            standing_pose_w,
            testing::{HANDS, generator, leaning, random_wrench, worker},
        },
        model::{
            frames::Pose,
            operation::OperationKind,
            scenario::{ComfortSettings, Hand, MuscularMetric, Sex},
            wrench::Wrench,
        },
    };

    fn settings() -> ComfortSettings {
        ComfortSettings { muscular: MuscularMetric::Intrinsic, ..ComfortSettings::default() }
    }

    fn man() -> Strength {
        Strength::new(Sex::Male, 50.0)
    }

    /// The squares of the shoulder's activations of a man.
    fn squares(r_vu: &Matrix3<f64>, moment_nm: Vector3<f64>, strength: &Strength) -> [f64; 3] {
        let zero = Vector3::zeros();
        Shoulder { r_vu, moment_nm, moment_slope: zero, turn: zero }.squares(strength).map(|square| square.value)
    }

    /// The upper arm with this elevation, azimuth from x_V towards y_V, and twist.
    fn upper_arm(elevation_deg: f64, azimuth_deg: f64, twist_deg: f64) -> Matrix3<f64> {
        let [q1, q2, q3] =
            shoulder_angles(elevation_deg.to_radians(), azimuth_deg.to_radians(), twist_deg.to_radians());
        worker(Hand::Right, OperationKind::Drill).arm().frames(&[q1, q2, q3, 0.0, 0.0, 0.0, 0.0]).r_bu
    }

    /// The angles of an orientation of the upper arm.
    fn angles_of(r_vu: &Matrix3<f64>) -> [f64; 3] {
        let azimuth_rad = atan2(-r_vu.m23, -r_vu.m13);
        shoulder_angles(elevation_rad(r_vu), azimuth_rad, twist_rad(r_vu))
    }

    #[test]
    fn angles_of_the_same_orientations_give_the_same_value() {
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        for hand in HANDS {
            let (human, mut generator) = (leaning(hand, 8.0), generator(41));
            for round in 0..5_000 {
                let mut angle_rad = || generator.random_range(-PI..PI);
                let q_rad: ArmAngles = std::array::from_fn(|_| angle_rad());
                let ([q1, q2, q3, ..], turn) = (q_rad, angle_rad());
                // The other branch; and at 90 degrees of abduction q1 and q3 turn the arm about one axis.
                let (one, other) = match round % 3 {
                    0 => ([q1, q2, q3], [q1 + PI, PI - q2, q3 + PI]),
                    1 => ([q1, FRAC_PI_2, q3], [q1 + turn, FRAC_PI_2, q3 + turn]),
                    _ => ([q1, -FRAC_PI_2, q3], [q1 + turn, -FRAC_PI_2, q3 - turn]),
                };
                let with = |shoulder: [f64; 3]| {
                    let mut q_rad = q_rad;
                    q_rad[..3].copy_from_slice(&shoulder);
                    q_rad
                };
                let (one, other) = (with(one), with(other));
                let frames = [one, other].map(|q_rad| human.arm().frames(&q_rad));
                // Rounding of angles up to 2 pi in seven turns.
                assert!((frames[0].r_bu - frames[1].r_bu).norm() < 1e-14);
                assert!((frames[0].r_bh - frames[1].r_bh).norm() < 1e-14);
                let wrench_w = random_wrench(&mut generator);
                let [one, other] = [one, other].map(|q_rad| human.muscular(&q_rad, &x_wb, &wrench_w, &settings()));
                for (a, b) in one.activations.iter().zip(other.activations) {
                    // The azimuth loses digits by 1 / 0.2 and the twist by 1 / cos^2(85 degrees), activations are up to 20.
                    assert!((a - b).abs() < 1e-9, "{one:?} {other:?}");
                }
                assert!((one.regularised - other.regularised).abs() < 1e-9, "{one:?} {other:?}");
            }
        }
    }

    /// The posture that the comfort planner finds for `drill-5` with the metric as printed (docs/reproduction.md), a thrust of 15 N
    /// along the drill, as it is planned and written with q1 = 0: the arm is the same, the printed metric is not.
    #[test]
    fn the_printed_optimum_of_a_hole_is_one_of_coordinates() {
        let human = worker(Hand::Right, OperationKind::Drill);
        let planned: ArmAngles = [1.563389, 1.565469, -1.559490, 0.001189, 0.913945, -0.465875, 0.567736];
        let mut other = planned;
        (other[0], other[1], other[2]) = (0.0, FRAC_PI_2, planned[2] - planned[0]);
        let frames = [planned, other].map(|q_rad| human.arm().frames(&q_rad));
        let turned_rad = Rotation3::from_matrix_unchecked(frames[0].r_bu.transpose() * frames[1].r_bu).angle();
        assert!(turned_rad.to_degrees() < 0.5, "{}", turned_rad.to_degrees());
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        let [[printed, other_printed], [intrinsic, other_intrinsic]] =
            [MuscularMetric::Paper, MuscularMetric::Intrinsic].map(|muscular| {
                [planned, other].map(|q_rad| {
                    let thrust_w = x_wb * human.tool_pose_b(&q_rad) * Vector3::new(0.0, 0.0, 15.0);
                    let wrench_w = Wrench { force_n: thrust_w, moment_nm: Vector3::zeros() };
                    human.muscular(&q_rad, &x_wb, &wrench_w, &ComfortSettings { muscular, ..settings() }).printed
                })
            });
        assert!(printed > 100_000.0 && other_printed < 50.0, "{printed} and {other_printed}");
        assert!((intrinsic / other_intrinsic - 1.0).abs() < 0.02, "{intrinsic} and {other_intrinsic}");
    }

    /// Largest slope of an activation of the shoulder if it turns, 1/rad. The moment is up to 70 N m (52 N at 0.95 m, and the
    /// weights), the smallest strength 18 N m, so the activation is up to 4. Its slope is 4 by the moment, 4 / s by the moment's
    /// direction with the horizontal part s = 0.2 of u, 4 x 1.7 tan(75 degrees) by the strength over the twist (the steepest is
    /// external rotation at -90 degrees, and the twist runs fastest at 150 degrees of elevation), 4 x 2 x 5 / 2 by the azimuth
    /// between two strengths, and 4 x sqrt(3) / 0.2 by the blend near hanging.
    const STEEPEST: f64 = 4.0 + 20.0 + 25.0 + 20.0 + 35.0;

    /// Largest slope of the comfort `1 / (a^2 + eps)` by the norm a of the activations: at `a^2 = eps / 3`.
    const STEEPEST_COMFORT: f64 = 280.0;

    #[test]
    fn the_value_has_no_jumps_on_paths_of_the_shoulder() {
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        for hand in HANDS {
            let (human, mut generator) = (leaning(hand, 8.0), generator(42));
            for round in 0..5_000 {
                let mut within = |low: f64, high: f64| generator.random_range(low..=high);
                let (azimuth, twist) = (within(-180.0, 180.0), within(-85.0, 85.0));
                // Through hanging, through the end of the blend near it, through 90 degrees of abduction to either side,
                // through the ends of abduction and flexion on the far side, anywhere up to 150 degrees.
                let middle = match round % 8 {
                    0 => upper_arm(0.0, azimuth, twist),
                    1 => upper_arm(HANGING.asin().to_degrees(), azimuth, twist),
                    2 => upper_arm(90.0, -90.0, twist),
                    3 => upper_arm(90.0, 90.0, twist),
                    4 => upper_arm(30.0, azimuth, twist),
                    5 => upper_arm(60.0, azimuth, twist),
                    6 => upper_arm(within(0.0, 12.0), azimuth, twist),
                    _ => upper_arm(within(0.0, 146.0), azimuth, twist),
                };
                let axis = Vector3::from_fn(|_, _| within(-1.0, 1.0)).normalize();
                let beyond = [within(0.0, 2.0), within(-1.5, 1.5), within(-1.2, 1.3), within(-0.3, 0.6)];
                let wrench_w = random_wrench(&mut generator);
                let at = |turn_rad: f64| -> Muscular {
                    let r_vu = Rotation3::new(axis * turn_rad).matrix() * middle;
                    let [q1, q2, q3] = angles_of(&r_vu);
                    let [q4, q5, q6, q7] = beyond;
                    human.muscular(&[q1, q2, q3, q4, q5, q6, q7], &x_wb, &wrench_w, &settings())
                };
                // Six points about the middle; on some paths also 3 degrees to either side, for jumps anywhere.
                let paths = if round % 10 < 9 { vec![(1e-6, 5)] } else { vec![(1e-6, 5), (1e-4, 1_001)] };
                for (step_rad, steps) in paths {
                    let mut last = at(-0.5 * f64::from(steps) * step_rad);
                    for step in 1..=steps {
                        let next = at((f64::from(step) - 0.5 * f64::from(steps)) * step_rad);
                        let of = |part: usize| (next.activations[part] - last.activations[part]).abs();
                        assert!((0..3).all(|part| of(part) < STEEPEST * step_rad), "{middle} {last:?} {next:?}");
                        let change = (next.regularised - last.regularised).abs();
                        // All seven activations together are no steeper than the sum of the shoulder's three.
                        assert!(change < STEEPEST_COMFORT * 3.0 * STEEPEST * step_rad, "{middle} {last:?} {next:?}");
                        last = next;
                    }
                }
            }
        }
    }

    #[test]
    fn raising_a_horizontal_arm_takes_flexion_abduction_or_the_mean_of_both() {
        let strength = man();
        let of = |joint, sense| strength.torque_nm(joint, FRAC_PI_2, sense);
        let at_end = |joint, degrees: f64, sense| strength.torque_nm(joint, degrees.to_radians(), sense);
        use Sense::{Negative, Positive};
        let mean = |sense| (of(0, sense) + of(1, sense)) / 2.0;
        // Behind the body raising is extension at its end of -60 degrees, across it adduction at -30 degrees.
        let expected = [
            (0.0, of(0, Positive), of(0, Negative)),
            (-90.0, of(1, Positive), of(1, Negative)),
            (-45.0, mean(Positive), mean(Negative)),
            (180.0, at_end(0, -60.0, Negative), at_end(0, -60.0, Positive)),
            (90.0, at_end(1, -30.0, Negative), at_end(1, -30.0, Positive)),
        ];
        for (azimuth_deg, up_nm, down_nm) in expected {
            let r_vu = upper_arm(90.0, azimuth_deg, 20.0);
            let (sin, cos) = libm::sincos(azimuth_deg.to_radians());
            // u x z, the axis about which u rises.
            let axis = Vector3::new(sin, -cos, 0.0);
            for (moment_nm, limit_nm) in [(10.0, up_nm), (-10.0, down_nm)] {
                let found = squares(&r_vu, axis * moment_nm, &strength);
                // Rounding of the azimuth.
                assert!((found[0] - (10.0 / limit_nm).powi(2)).abs() < 1e-14, "{azimuth_deg}: {found:?}");
                assert!(found[1] < 1e-28 && found[2] < 1e-28, "{azimuth_deg}: {found:?}");
            }
        }
    }

    #[test]
    fn moving_a_raised_arm_sideways_and_turning_it_take_their_own_strengths() {
        let strength = man();
        // Straight ahead: about z the arm goes to the left, to the middle of the body. Tabulated: 92 and 67 N m.
        let r_vu = upper_arm(90.0, 0.0, 30.0);
        for (moment_nm, limit_nm) in [(10.0, 92.0_f64), (-10.0, 67.0)] {
            let found = squares(&r_vu, Vector3::z() * moment_nm, &strength);
            assert!((found[1] - (10.0 / limit_nm).powi(2)).abs() < 1e-14, "{found:?}");
        }
        // Internal rotation is about the axis from elbow to shoulder, here backward.
        for (moment_nm, sense) in [(10.0, Sense::Positive), (-10.0, Sense::Negative)] {
            let found = squares(&r_vu, Vector3::x() * -moment_nm, &strength);
            let limit_nm = strength.torque_nm(2, 30_f64.to_radians(), sense);
            assert!((found[2] - (10.0 / limit_nm).powi(2)).abs() < 1e-14, "{found:?}");
        }
    }

    #[test]
    fn a_hanging_arm_has_the_activations_of_flexion_abduction_and_rotation() {
        use Sense::{Negative, Positive};
        let strength = man();
        let r_vu = upper_arm(0.0, 0.0, -25.0);
        let at = |joint, q_deg: f64, sense| strength.torque_nm(joint, q_deg.to_radians(), sense);
        // Flexion is about -y, abduction of the right arm about -x, internal rotation about z.
        let moment_nm = Vector3::new(-3.0, -7.0, 4.0);
        let expected = [7.0 / at(0, 0.0, Positive), 3.0 / at(1, 0.0, Positive), 4.0 / at(2, -25.0, Positive)];
        let opposite = [7.0 / at(0, 0.0, Negative), 3.0 / at(1, 0.0, Negative), 4.0 / at(2, -25.0, Negative)];
        for (moment_nm, expected) in [(moment_nm, expected), (-moment_nm, opposite)] {
            for (found, expected) in squares(&r_vu, moment_nm, &strength).into_iter().zip(expected) {
                assert!((found.sqrt() - expected).abs() < 1e-14, "{found} {expected}");
            }
        }
    }

    #[test]
    fn straight_up_the_strengths_are_means_without_direction() {
        let strength = man();
        let r_vu = upper_arm(175.0, 10.0, 60.0);
        let moment_nm = Vector3::new(5.0, -8.0, 3.0);
        let parts = parts_nm(&r_vu, &moment_nm);
        let rotation_nm = [Sense::Positive, Sense::Negative].map(|sense| strength.torque_nm(2, 0.0, sense));
        let limits_nm = [79.5, 79.5, (rotation_nm[0] + rotation_nm[1]) / 2.0];
        for ((found, part), limit_nm) in squares(&r_vu, moment_nm, &strength).iter().zip(parts).zip(limits_nm) {
            assert!((found.sqrt() - part.abs() / limit_nm).abs() < 1e-13, "{found} {part} {limit_nm}");
        }
    }

    #[test]
    fn parts_of_simple_moments() {
        let near = |found: [f64; 3], expected: [f64; 3]| {
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14), "{found:?} {expected:?}");
        };
        let ahead = upper_arm(90.0, 0.0, 0.0);
        near(parts_nm(&ahead, &-Vector3::y()), [1.0, 0.0, 0.0]);
        near(parts_nm(&ahead, &Vector3::z()), [0.0, 1.0, 0.0]);
        near(parts_nm(&ahead, &-Vector3::x()), [0.0, 0.0, 1.0]);
        let aside = upper_arm(90.0, -90.0, 0.0);
        near(parts_nm(&aside, &-Vector3::x()), [1.0, 0.0, 0.0]);
        near(parts_nm(&aside, &Vector3::z()), [0.0, 1.0, 0.0]);
        near(parts_nm(&aside, &Vector3::y()), [0.0, 0.0, 1.0]);
        // A vertical upper arm has no direction of raising.
        assert_eq!(parts_nm(&Matrix3::identity(), &Vector3::new(3.0, 4.0, 5.0)), [0.0, 0.0, 5.0]);
        // The three directions are perpendicular.
        let parts = parts_nm(&upper_arm(50.0, -30.0, 40.0), &Vector3::new(3.0, 4.0, 5.0));
        assert!((parts.iter().map(|part| part * part).sum::<f64>() - 50.0).abs() < 1e-13);
    }

    #[test]
    fn a_straight_arm_held_out_is_as_hard_as_its_weight_in_every_direction() {
        let human = worker(Hand::Right, OperationKind::Drill);
        // As for the paper's metric by hand: masses 2.0325, 1.215, 0.4575 kg and the drill's 1.3 kg.
        let hand = 0.4575 * 0.3624 * 0.189 + 1.3 * 0.0875;
        let elbow = 1.215 * 0.4574 * 0.2555 + 1.7575 * 0.2555 + hand;
        let shoulder_nm = 9.81 * (2.0325 * 0.5772 * 0.3255 + (1.215 + 1.7575) * 0.3255 + elbow);
        let strength = man();
        let [flexion_nm, abduction_nm] = [0, 1].map(|joint| strength.torque_nm(joint, FRAC_PI_2, Sense::Positive));
        let limits_nm =
            [(0.0, flexion_nm), (-FRAC_PI_4, (flexion_nm + abduction_nm) / 2.0), (-FRAC_PI_2, abduction_nm)];
        for (azimuth_rad, limit_nm) in limits_nm {
            let [q1, q2, q3] = shoulder_angles(FRAC_PI_2, azimuth_rad, 0.0);
            let q_rad = [q1, q2, q3, 0.0, 0.0, 0.0, 0.0];
            let found = human.muscular(&q_rad, &Pose::identity(), &Wrench::default(), &settings());
            // Rounding of some ten products.
            assert!((found.activations[0] - shoulder_nm / limit_nm).abs() < 1e-13, "{found:?}");
            assert!(found.activations[1..3].iter().all(|activation| activation.abs() < 1e-13), "{found:?}");
            let figures = human.muscular_figures(&q_rad, &Pose::identity(), &Wrench::default(), &settings());
            assert_eq!(figures.intrinsic, found);
            assert!((figures.shoulder.raising_nm - shoulder_nm).abs() < 1e-13, "{figures:?}");
        }
    }

    #[test]
    fn a_womans_arm_is_weaker_and_the_percentile_scales_every_part() {
        let woman = Strength::new(Sex::Female, 50.0);
        let (man, weak_man, mut generator) = (man(), Strength::new(Sex::Male, 5.0), generator(43));
        for _ in 0..1_000 {
            let mut within = |low: f64, high: f64| generator.random_range(low..=high);
            let r_vu = upper_arm(within(0.0, 180.0), within(-180.0, 180.0), within(-90.0, 90.0));
            let moment_nm = Vector3::from_fn(|_, _| within(-30.0, 30.0));
            let of = |strength: &Strength| squares(&r_vu, moment_nm, strength);
            for ((his, hers), weak) in of(&man).into_iter().zip(of(&woman)).zip(of(&weak_man)) {
                assert!(hers > his, "{hers} {his}");
                // z at 5 % is -1.644854: strengths are 1 - 0.277 x 1.644854 = 0.544375 of the median.
                assert!((his / weak / 0.544_375_f64.powi(2) - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn the_comfort_is_bounded_by_the_resting_co_contraction() {
        let (human, mut generator): (Human, _) = (worker(Hand::Right, OperationKind::Drill), generator(44));
        for _ in 0..1_000 {
            let q_rad = std::array::from_fn(|_| generator.random_range(-PI..PI));
            let wrench_w = random_wrench(&mut generator);
            let found = human.muscular(&q_rad, &Pose::identity(), &wrench_w, &settings());
            let effort: f64 = found.activations.iter().map(|activation| activation * activation).sum();
            assert!((found.regularised * (effort + 0.0175) - 1.0).abs() < 1e-14);
            assert!(found.regularised > 0.0 && found.regularised <= 1.0 / 0.0175);
        }
    }
}
