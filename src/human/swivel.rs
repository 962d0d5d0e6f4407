//! Closed-form inverse kinematics of the arm, and the intervals of its redundancy, the swivel angle
//! (docs/method.md#42-inverse-kinematics-of-the-arm).
//!
//! Shoulder and wrist are spherical, so the tool's pose determines the wrist, and the distance from shoulder to wrist the
//! elbow's angle. The elbow can move on a circle about the line from shoulder to wrist.
//!
//! # The swivel angle
//! `n` is the unit vector from shoulder to wrist. The reference direction `e1` is that of "down" (-z_B) made perpendicular
//! to `n`; if `n` is vertical (its horizontal part below 1e-9), "backward" (-x_B) replaces "down". The elbow is off the line
//! in the direction
//!
//! ```text
//! e(psi) = e1 cos(psi) + e2 sin(psi),    e2 = e1 x n
//! ```
//!
//! so at 0 the elbow is lowest, and a positive swivel lifts it outward, away from the trunk, when the arm reaches forward.
//! With a straight arm the elbow is on the line; `e` is then the direction in which it leaves the line.
//!
//! # Intervals
//! With the wrist fixed, every element of the shoulder's rotation R_BU and of the wrist's R_FH has the form
//! `a + b cos(psi) + c sin(psi)`. So has, as a combination of elements, the condition that a joint is at a limit. Each
//! condition has at most two roots, in closed form, and feasibility is constant between neighbouring roots. That holds for the
//! limits of the three shoulder angles and for those of twist and elevation ([`super::ranges`]).

use std::f64::consts::{PI, TAU};

use arrayvec::ArrayVec;
use libm::{acos, asin, atan2, cos, hypot, sincos};
use nalgebra::{Matrix3, Vector3};

use super::{
    arm::Arm,
    ranges::{ArmAngles, ArmRanges},
};
use crate::model::frames::Pose;

/// Tolerance of joint limits, rad: the error of angles at the end of a swivel interval. Angles beyond a limit by less are set
/// to the limit.
const LIMIT_TOLERANCE_RAD: f64 = 1e-9;

/// Tolerance of cosines outside [-1, 1] by rounding: at full reach, or where a joint just touches a limit.
const COSINE_TOLERANCE: f64 = 1e-12;

/// Sine of the angle between arm and vertical below which the reference direction of the swivel changes.
const VERTICAL: f64 = 1e-9;

/// Two limits of each joint but the elbow and one of the elevation, each with at most two roots, and both ends of the circle.
const MAX_BREAKS: usize = (6 * 2 + 1) * 2 + 2;

/// Both branches, each with at most every second interval between breaks.
const MAX_INTERVALS: usize = MAX_BREAKS;

/// One of the shoulder's two solutions for an orientation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShoulderBranch {
    /// Abduction of at most 90 degrees.
    Low,
    /// Abduction beyond 90 degrees.
    High,
}

impl ShoulderBranch {
    /// Both branches.
    pub const ALL: [Self; 2] = [Self::Low, Self::High];
}

/// An interval of swivel angles within the joint limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwivelInterval {
    /// The shoulder's branch.
    pub branch: ShoulderBranch,
    /// First angle, rad, in [-pi, pi].
    pub from_rad: f64,
    /// Last angle, rad, at least `from_rad`; beyond pi if the interval crosses pi.
    pub to_rad: f64,
}

/// At most one solution per branch: the wrist's second solution is outside human limits, and the elbow bends one way.
pub type ArmSolutions = ArrayVec<ArmAngles, 2>;

/// All intervals of both branches.
pub type SwivelIntervals = ArrayVec<SwivelInterval, MAX_INTERVALS>;

/// The solutions of the arm for one tool pose, as functions of the swivel.
#[derive(Clone, Debug)]
pub struct SwivelCircle {
    /// Elbow flexion, rad.
    elbow_rad: f64,
    /// R_BU over the swivel.
    shoulder: Harmonic,
    /// R_FH over the swivel.
    wrist: Harmonic,
    ranges: ArmRanges,
}

/// A rotation matrix over the swivel, `constant + cos C + sin S`.
#[derive(Clone, Debug)]
struct Harmonic {
    constant: Matrix3<f64>,
    cos: Matrix3<f64>,
    sin: Matrix3<f64>,
}

/// The reference directions of the swivel about a unit vector: e1 and e2 of the module documentation.
fn reference_directions(n: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let reference = if hypot(n.x, n.y) < VERTICAL { -Vector3::x() } else { -Vector3::z() };
    let e1 = (reference - n * n.dot(&reference)).normalize();
    (e1, e1.cross(n))
}

/// In the upper arm's frame U: direction from shoulder to wrist, and direction of the elbow off that line.
fn planar_directions(arm: &Arm, elbow_rad: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (sin, cos) = sincos(elbow_rad);
    let n_u = Vector3::new(arm.forearm_m * sin, 0.0, -arm.upper_arm_m - arm.forearm_m * cos).normalize();
    (n_u, Vector3::new(n_u.z, 0.0, -n_u.x))
}

impl Arm {
    /// The swivel angle of a posture, rad, in [-pi, pi].
    pub fn swivel_rad(&self, q_rad: &ArmAngles) -> f64 {
        let r_bu = self.frames(q_rad).r_bu;
        let (n_u, e_u) = planar_directions(self, q_rad[3]);
        let (e1, e2) = reference_directions(&(r_bu * n_u));
        let elbow = r_bu * e_u;
        atan2(elbow.dot(&e2), elbow.dot(&e1))
    }

    /// The solutions for the tool pose `x_bt`; `None` if the wrist is out of reach or the elbow out of its range.
    pub fn swivel_circle(&self, x_bt: &Pose) -> Option<SwivelCircle> {
        let x_bh = x_bt * self.x_ht.inverse();
        let line = x_bh.translation.vector - self.p_bs_m;
        let distance_m = line.norm();
        let elbow_rad = self.elbow_rad(distance_m)?;
        let n = line / distance_m;
        let (e1, e2) = reference_directions(&n);
        let (n_u, e_u) = planar_directions(self, elbow_rad);
        // R_BU takes n_U to n, e_U to e(psi) and their cross product y_U to n x e(psi) = e1 sin(psi) - e2 cos(psi).
        let y_u = Vector3::y().transpose();
        let shoulder = Harmonic {
            constant: n * n_u.transpose(),
            cos: e1 * e_u.transpose() - e2 * y_u,
            sin: e2 * e_u.transpose() + e1 * y_u,
        };
        let r_bh = x_bh.rotation.to_rotation_matrix().into_inner();
        let (sin, cos) = sincos(elbow_rad);
        let r_fu = Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos);
        let wrist = shoulder.map(|r_bu| r_fu * r_bu.transpose() * r_bh);
        Some(SwivelCircle { elbow_rad, shoulder, wrist, ranges: self.ranges })
    }

    /// Elbow flexion at this distance from shoulder to wrist, from the law of cosines.
    fn elbow_rad(&self, distance_m: f64) -> Option<f64> {
        let (upper, fore) = (self.upper_arm_m, self.forearm_m);
        let cosine = (distance_m * distance_m - upper * upper - fore * fore) / (2.0 * upper * fore);
        let in_reach = cosine.abs() <= 1.0 + COSINE_TOLERANCE;
        if in_reach { within(acos(cosine.clamp(-1.0, 1.0)), &self.ranges.joints_rad[3]) } else { None }
    }
}

impl Harmonic {
    fn map(&self, f: impl Fn(&Matrix3<f64>) -> Matrix3<f64>) -> Self {
        Self { constant: f(&self.constant), cos: f(&self.cos), sin: f(&self.sin) }
    }

    fn at(&self, swivel_rad: f64) -> Matrix3<f64> {
        let (sin, cos) = sincos(swivel_rad);
        self.constant + self.cos * cos + self.sin * sin
    }

    /// The swivel angles at which a linear function of the matrix, plus `offset`, is zero: with amplitude r and phase f,
    /// `a + r cos(psi - f) = 0`. A function that misses zero by rounding counts as touching it.
    fn roots(&self, offset: f64, function: impl Fn(&Matrix3<f64>) -> f64) -> ArrayVec<f64, 2> {
        let constant = function(&self.constant) + offset;
        let (cos, sin) = (function(&self.cos), function(&self.sin));
        let amplitude = hypot(cos, sin);
        if amplitude == 0.0 || constant.abs() > amplitude * (1.0 + COSINE_TOLERANCE) {
            return ArrayVec::new();
        }
        let (phase, half) = (atan2(sin, cos), acos((-constant / amplitude).clamp(-1.0, 1.0)));
        ArrayVec::from([wrapped(phase + half), wrapped(phase - half)])
    }
}

impl SwivelCircle {
    /// The solution of one branch at a swivel angle; `None` outside the joint limits.
    pub fn solution(&self, swivel_rad: f64, branch: ShoulderBranch) -> Option<ArmAngles> {
        let [q5, q6, q7] = self.wrist_angles(swivel_rad)?;
        let [q1, q2, q3] = self.shoulder_angles(&self.shoulder.at(swivel_rad), branch)?;
        Some([q1, q2, q3, self.elbow_rad, q5, q6, q7])
    }

    /// The solutions of both branches at a swivel angle, within the joint limits.
    pub fn solutions(&self, swivel_rad: f64) -> ArmSolutions {
        let Some([q5, q6, q7]) = self.wrist_angles(swivel_rad) else { return ArmSolutions::new() };
        let r_bu = self.shoulder.at(swivel_rad);
        let shoulders = ShoulderBranch::ALL.into_iter().filter_map(|branch| self.shoulder_angles(&r_bu, branch));
        shoulders.map(|[q1, q2, q3]| [q1, q2, q3, self.elbow_rad, q5, q6, q7]).collect()
    }

    /// The intervals of the swivel within all joint limits, low branch first, in ascending order, without isolated angles.
    pub fn intervals(&self) -> SwivelIntervals {
        let breaks = self.breaks();
        let mut intervals = SwivelIntervals::new();
        for branch in ShoulderBranch::ALL {
            let start = intervals.len();
            for pair in breaks.windows(2) {
                let (from_rad, to_rad) = (pair[0], pair[1]);
                if from_rad == to_rad || self.solution((from_rad + to_rad) / 2.0, branch).is_none() {
                    continue;
                }
                match intervals[start..].last_mut() {
                    Some(last) if last.to_rad == from_rad => last.to_rad = to_rad,
                    _ => intervals.push(SwivelInterval { branch, from_rad, to_rad }),
                }
            }
            join_across_the_end(&mut intervals, start);
        }
        intervals
    }

    /// Angles at which a joint is at a limit, and -pi and pi, in ascending order.
    fn breaks(&self) -> ArrayVec<f64, MAX_BREAKS> {
        let mut breaks = ArrayVec::from_iter([-PI, PI]);
        let ArmRanges { joints_rad, twist_rad, elevation_rad } = &self.ranges;
        let (r, w) = (&self.shoulder, &self.wrist);
        // The twist's sine is to its cosine as m21 - m12 to m11 + m22; the cosine of the elevation is m33.
        for (s, c) in twist_rad.iter().flatten().map(|&limit| sincos(limit)) {
            breaks.extend(r.roots(0.0, |r| (r.m21 - r.m12) * c - (r.m11 + r.m22) * s));
        }
        if let Some(highest) = elevation_rad {
            breaks.extend(r.roots(-cos(*highest), |r| r.m33));
        }
        for (joint, limits) in joints_rad.iter().enumerate().skip(if twist_rad.is_some() { 3 } else { 0 }) {
            for &limit in limits {
                let (s, c) = sincos(limit);
                // See `shoulder_angles` and `wrist_angles`. Roots at which the angle is off by pi only split an interval,
                // which is joined again.
                breaks.extend(match joint {
                    0 => r.roots(0.0, |r| r.m13 * c + r.m33 * s),
                    1 => r.roots(-s, |r| r.m23),
                    2 => r.roots(0.0, |r| r.m21 * c - r.m22 * s),
                    4 => w.roots(0.0, |w| w.m12 * c + w.m22 * s),
                    5 => w.roots(-s, |w| w.m32),
                    6 => w.roots(0.0, |w| w.m31 * c + w.m33 * s),
                    _ => ArrayVec::new(), // the elbow does not move with the swivel
                });
            }
        }
        breaks.sort_unstable_by(f64::total_cmp);
        breaks
    }

    /// The angles of `R_BU = Ry(-q1) Rx(-q2) Rz(q3)`: its middle row is `(cos q2 sin q3, cos q2 cos q3, sin q2)`, its last
    /// column `(-sin q1 cos q2, sin q2, cos q1 cos q2)`.
    fn shoulder_angles(&self, r_bu: &Matrix3<f64>, branch: ShoulderBranch) -> Option<[f64; 3]> {
        if branch == ShoulderBranch::High && self.ranges.twist_rad.is_some() {
            return None; // The low branch has every orientation.
        }
        if !self.ranges.permits_shoulder(r_bu, LIMIT_TOLERANCE_RAD) {
            return None;
        }
        // The arcsine of m23 would lose half of the digits at 90 degrees.
        let horizontal = hypot(r_bu.m13, r_bu.m33);
        let (cos_q2, sign) = match branch {
            ShoulderBranch::Low => (horizontal, 1.0),
            ShoulderBranch::High => (-horizontal, -1.0),
        };
        let q2 = within(atan2(r_bu.m23, cos_q2), &self.ranges.joints_rad[1])?;
        let flexion = atan2(-r_bu.m13 * sign, r_bu.m33 * sign);
        let q1 = within(flexion, &self.ranges.joints_rad[0])?;
        // q3 from the rotation that remains after q1, not from the middle row: at 90 degrees of abduction, where q1 and q3
        // have the same axis, their sum stays exact.
        let (sin, cos) = sincos(q1);
        let (x, y) = (r_bu.m11 * cos + r_bu.m31 * sin, r_bu.m12 * cos + r_bu.m32 * sin);
        let q3 = within(atan2(-y, x), &self.ranges.joints_rad[2])?;
        Some([q1, q2, q3])
    }

    /// The angles of `R_FH = Rz(q5) Rx(q6) Ry(q7)`: its last row is `(-cos q6 sin q7, sin q6, cos q6 cos q7)`, its middle
    /// column `(-sin q5 cos q6, cos q5 cos q6, sin q6)`. With |q6| < 90 degrees the solution is unique.
    fn wrist_angles(&self, swivel_rad: f64) -> Option<[f64; 3]> {
        let r_fh = self.wrist.at(swivel_rad);
        let q6 = within(asin(r_fh.m32.clamp(-1.0, 1.0)), &self.ranges.joints_rad[5])?;
        let q5 = within(atan2(-r_fh.m12, r_fh.m22), &self.ranges.joints_rad[4])?;
        let q7 = within(atan2(-r_fh.m31, r_fh.m33), &self.ranges.joints_rad[6])?;
        Some([q5, q6, q7])
    }
}

/// The angle modulo full turns within its range, and at the limit that it misses by rounding; `None` if outside.
fn within(angle_rad: f64, &[low, high]: &[f64; 2]) -> Option<f64> {
    let lowest = low - LIMIT_TOLERANCE_RAD;
    let angle = if angle_rad < lowest { angle_rad + TAU } else { angle_rad };
    let angle = if angle > high + LIMIT_TOLERANCE_RAD { angle - TAU } else { angle };
    (lowest <= angle).then(|| angle.clamp(low, high))
}

/// The angle, in [-pi, pi], for angles in (-3 pi, 3 pi).
fn wrapped(angle_rad: f64) -> f64 {
    let angle = if angle_rad > PI { angle_rad - TAU } else { angle_rad };
    let angle = if angle < -PI { angle + TAU } else { angle };
    angle.clamp(-PI, PI)
}

/// Joins the two intervals from index `start` on that meet at pi.
fn join_across_the_end(intervals: &mut SwivelIntervals, start: usize) {
    let several = intervals.len() > start + 1;
    if several && intervals[start].from_rad == -PI && intervals[intervals.len() - 1].to_rad == PI {
        let first = intervals.remove(start);
        if let Some(last) = intervals.last_mut() {
            last.to_rad = first.to_rad + TAU;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use approx::assert_abs_diff_eq;
    use nalgebra::{Isometry3, UnitQuaternion};
    use rand::RngExt;

    use super::*;
    use crate::{
        human::{
            Human, paper_tool,
            testing::{generator, random_angles, random_shares, within as within_posture, worker},
        },
        model::{
            operation::OperationKind,
            scenario::{Hand, Person, PostureLimits},
        },
    };

    fn arm() -> Arm {
        worker(Hand::Right, OperationKind::Drill).arm().clone()
    }

    /// A tool pose about the shoulder, in reach or just out of it.
    fn random_pose(arm: &Arm, generator: &mut impl RngExt) -> Pose {
        let mut unit = || generator.random_range(-1.0..1.0_f64);
        let p_bt = arm.p_bs_m + Vector3::new(unit(), unit(), unit()) * 0.6;
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::new(unit(), unit(), unit()) * PI);
        Isometry3::from_parts(p_bt.into(), rotation)
    }

    fn largest_difference(a: &ArmAngles, b: &ArmAngles) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn every_posture_is_found_again_by_its_swivel() {
        let (arm, mut generator) = (arm(), generator(1));
        let mut found = [0; 2];
        for _ in 0..10_000 {
            let q_rad = random_angles(&arm, &mut generator);
            let branch = if q_rad[1] <= FRAC_PI_2 { ShoulderBranch::Low } else { ShoulderBranch::High };
            let circle = arm.swivel_circle(&arm.tool_pose_b(&q_rad)).unwrap();
            let again = circle.solution(arm.swivel_rad(&q_rad), branch).unwrap();
            // Rounding grows by 1 / sin(q4) in the elbow and 1 / cos(q2) in the shoulder; of 10,000 postures the closest
            // come within 1e-4 of either.
            assert!(largest_difference(&again, &q_rad) < 1e-10, "{q_rad:?} {again:?}");
            found[branch as usize] += 1;
        }
        // The high branch has 30 of the 150 degrees of abduction.
        assert!(found[1] > 1_500, "{found:?}");
    }

    #[test]
    fn every_posture_lies_in_a_returned_interval() {
        let (arm, mut generator) = (arm(), generator(5));
        for _ in 0..10_000 {
            let q_rad = random_angles(&arm, &mut generator);
            let swivel_rad = arm.swivel_rad(&q_rad);
            let branch = if q_rad[1] <= FRAC_PI_2 { ShoulderBranch::Low } else { ShoulderBranch::High };
            let intervals = arm.swivel_circle(&arm.tool_pose_b(&q_rad)).unwrap().intervals();
            // The swivel of a nearly straight arm is good to 1e-16 / sin(q4) only, and so are the ends.
            let slack_rad = 1e-9;
            let covered = intervals.iter().filter(|interval| interval.branch == branch).any(|interval| {
                let turn = (swivel_rad - interval.from_rad + slack_rad).rem_euclid(TAU);
                turn <= interval.to_rad - interval.from_rad + 2.0 * slack_rad
            });
            assert!(covered, "{q_rad:?} at {swivel_rad}: {intervals:?}");
        }
    }

    #[test]
    fn solutions_put_the_tool_where_it_was_asked() {
        let (arm, mut generator) = (arm(), generator(2));
        let mut found = 0;
        for _ in 0..10_000 {
            let x_bt = arm.tool_pose_b(&random_angles(&arm, &mut generator));
            let swivel_rad = generator.random_range(-PI..PI);
            for q_rad in arm.swivel_circle(&x_bt).unwrap().solutions(swivel_rad) {
                assert!(arm.within_limits(&q_rad));
                // A dozen rotations of order one; docs/method.md#42-inverse-kinematics-of-the-arm requires 1e-9.
                assert_abs_diff_eq!(arm.tool_pose_b(&q_rad), x_bt, epsilon = 1e-13);
                let turned = (arm.swivel_rad(&q_rad) - swivel_rad).rem_euclid(TAU);
                assert!(turned.min(TAU - turned) < 1e-9, "{turned}");
                found += 1;
            }
        }
        assert!(found > 1_000, "{found}");
    }

    /// In even rounds the tool pose of a posture, in odd ones any.
    fn reached_or_random_pose(round: usize, arm: &Arm, generator: &mut rand_pcg::Pcg64) -> Pose {
        if round.is_multiple_of(2) {
            arm.tool_pose_b(&random_shares(arm, generator))
        } else {
            random_pose(arm, generator)
        }
    }

    #[test]
    fn intervals_agree_with_a_scan_of_the_circle() {
        for arm in arms() {
            let mut generator = generator(3);
            let mut inside = 0;
            for round in 0..1_000 {
                let x_bt = reached_or_random_pose(round, &arm, &mut generator);
                let Some(circle) = arm.swivel_circle(&x_bt) else { continue };
                let intervals = circle.intervals();
                for swivel_rad in (-180..180).map(|degree| f64::from(degree).to_radians()) {
                    for branch in ShoulderBranch::ALL {
                        let mut of_branch = intervals.iter().filter(|interval| interval.branch == branch);
                        let covered = of_branch.any(|interval| {
                            let turn = (swivel_rad - interval.from_rad).rem_euclid(TAU);
                            turn <= interval.to_rad - interval.from_rad
                        });
                        let found = circle.solution(swivel_rad, branch);
                        assert_eq!(covered, found.is_some(), "{swivel_rad} {intervals:?}");
                        inside += usize::from(covered);
                    }
                }
            }
            assert!(inside > 5_000, "{inside}");
        }
    }

    #[test]
    fn the_ends_of_intervals_lie_on_limits() {
        let (arm, mut generator) = (arm(), generator(4));
        let mut ends = 0;
        for _ in 0..1_000 {
            let circle = arm.swivel_circle(&arm.tool_pose_b(&random_angles(&arm, &mut generator))).unwrap();
            for SwivelInterval { branch, from_rad, to_rad } in circle.intervals() {
                assert!((-PI..=PI).contains(&from_rad) && from_rad < to_rad && to_rad <= from_rad + TAU);
                if to_rad - from_rad == TAU {
                    continue;
                }
                // Some joint that swivels stands at a limit: within 1e-6, for one whose angle runs fast where the
                // abduction passes 90 degrees.
                for end_rad in [from_rad, to_rad] {
                    let q_rad = circle.solution(end_rad, branch).unwrap();
                    let margin =
                        |i: usize| (q_rad[i] - arm.ranges.joints_rad[i][0]).min(arm.ranges.joints_rad[i][1] - q_rad[i]);
                    let least = [0, 1, 2, 4, 5, 6].map(margin).into_iter().fold(f64::INFINITY, f64::min);
                    assert!(least.abs() < 1e-6, "{least} {q_rad:?}");
                    ends += 1;
                }
            }
        }
        assert!(ends > 1_000, "{ends}");
    }

    #[test]
    fn the_swivel_is_zero_at_the_lowest_elbow_and_lifts_it_outward() {
        let arm = arm();
        let bent = [30.0, 0.0, 0.0, 80.0, 0.0, 0.0, 0.0].map(f64::to_radians);
        // The arm bends in the vertical plane, the elbow below the line from shoulder to wrist.
        assert_abs_diff_eq!(arm.swivel_rad(&bent), 0.0, epsilon = 1e-15);
        let circle = arm.swivel_circle(&arm.tool_pose_b(&bent)).unwrap();
        let raised = circle.solution(0.3, ShoulderBranch::Low).unwrap();
        let (below, outward) = (arm.frames(&bent).p_be_m, arm.frames(&raised).p_be_m);
        // The right arm's outward side is -y.
        assert!(outward.y < below.y && outward.z > below.z);
    }

    #[test]
    fn degenerate_postures_have_solutions() {
        let arm = arm();
        // Hanging straight (a vertical line, the elbow on it), full abduction of a bent arm (q1 and q3 about one axis), a
        // bent arm with the wrist below the shoulder.
        let below = -(arm.forearm_m * 1_f64.sin()).atan2(arm.upper_arm_m + arm.forearm_m * 1_f64.cos());
        for q_rad in [[0.0; 7], [0.3, FRAC_PI_2, -0.4, 1.0, 0.2, 0.1, 0.0], [below, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]] {
            let x_bt = arm.tool_pose_b(&q_rad);
            let circle = arm.swivel_circle(&x_bt).unwrap();
            let solutions = circle.solutions(arm.swivel_rad(&q_rad));
            assert!(!solutions.is_empty(), "{q_rad:?}");
            for solution in solutions {
                // The elbow's angle near full reach is good to the root of the rounding, its effect on the tool is not
                // felt.
                assert_abs_diff_eq!(arm.tool_pose_b(&solution), x_bt, epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn nothing_is_found_out_of_reach() {
        let arm = arm();
        let mut x_bt = arm.tool_pose_b(&[0.0; 7]);
        x_bt.translation.vector.z -= 1e-6;
        assert!(arm.swivel_circle(&x_bt).is_none());
        let at_shoulder = Isometry3::from_parts(arm.p_bs_m.into(), UnitQuaternion::identity()) * arm.x_ht;
        assert!(arm.swivel_circle(&at_shoulder).is_none());
    }

    /// The drill in the hand of a person with a swing-twist shoulder.
    fn swing_twist(posture: PostureLimits) -> Arm {
        within_posture(posture).arm().clone()
    }

    /// Arms with all kinds of limits.
    fn arms() -> [Arm; 4] {
        let [natural, unrestricted] = [PostureLimits::NATURAL, PostureLimits::UNRESTRICTED];
        let natural_box = Person { posture: natural, ..Person::PAPER };
        let natural_box = Human::new(&natural_box, &paper_tool(OperationKind::Drill)).unwrap();
        [arm(), natural_box.arm().clone(), swing_twist(unrestricted), swing_twist(natural)]
    }

    #[test]
    fn every_posture_of_a_swing_twist_shoulder_is_found_again_by_its_swivel() {
        for posture in [PostureLimits::UNRESTRICTED, PostureLimits::NATURAL] {
            let (arm, mut generator) = (swing_twist(posture), generator(6));
            for _ in 0..10_000 {
                let q_rad = random_shares(&arm, &mut generator);
                let circle = arm.swivel_circle(&arm.tool_pose_b(&q_rad)).unwrap();
                let swivel_rad = arm.swivel_rad(&q_rad);
                let again = circle.solution(swivel_rad, ShoulderBranch::Low).unwrap();
                // At 90 degrees of abduction only the sum of the first and the third angle is given, so orientations are
                // compared; the bound is that of the box.
                let [found, expected] = [again, q_rad].map(|q_rad| arm.frames(&q_rad).r_bu);
                assert!((found - expected).norm() < 1e-10, "{q_rad:?} {again:?}");
                assert!(again[3..].iter().zip(&q_rad[3..]).all(|(a, b)| (a - b).abs() < 1e-10), "{q_rad:?} {again:?}");
                assert!(again[1].abs() <= FRAC_PI_2);
                // Every orientation is in the low branch.
                assert_eq!(circle.solution(swivel_rad, ShoulderBranch::High), None);
            }
        }
    }

    /// The arm without limits of its shoulder and its wrist.
    fn without_limits(arm: &Arm) -> Arm {
        let mut ranges = arm.ranges;
        for joint in [0, 2, 4, 6] {
            ranges.joints_rad[joint] = [-PI, PI];
        }
        for joint in [1, 5] {
            ranges.joints_rad[joint] = [-FRAC_PI_2, FRAC_PI_2];
        }
        Arm { ranges: ArmRanges { twist_rad: Some([-PI, PI]), elevation_rad: None, ..ranges }, ..arm.clone() }
    }

    #[test]
    fn the_arm_is_within_its_ranges_inside_the_intervals_and_nowhere_else() {
        for posture in [PostureLimits::UNRESTRICTED, PostureLimits::NATURAL] {
            let (arm, mut generator) = (swing_twist(posture), generator(7));
            let free = without_limits(&arm);
            let (mut inside, mut outside) = (0, 0);
            for round in 0..1_000 {
                let x_bt = reached_or_random_pose(round, &arm, &mut generator);
                let Some(circle) = arm.swivel_circle(&x_bt) else { continue };
                let (intervals, free) = (circle.intervals(), free.swivel_circle(&x_bt).unwrap());
                for swivel_rad in (0..120).map(|_| generator.random_range(-PI..PI)) {
                    let turns = intervals.iter().map(|interval| {
                        let length_rad = interval.to_rad - interval.from_rad;
                        ((swivel_rad - interval.from_rad).rem_euclid(TAU), length_rad)
                    });
                    // The tolerance of the limits is 1e-9; near an end an angle may run fast or touch its limit.
                    let is_near_end = |(turn, length): (f64, f64)| turn < 1e-6 || (turn - length).abs() < 1e-6;
                    if turns.clone().any(is_near_end) {
                        continue;
                    }
                    let covered = turns.clone().any(|(turn, length)| turn < length);
                    let q_rad = free.solution(swivel_rad, ShoulderBranch::Low).unwrap();
                    assert_eq!(covered, arm.within_limits(&q_rad), "{swivel_rad} {q_rad:?} {intervals:?}");
                    *if covered { &mut inside } else { &mut outside } += 1;
                }
            }
            assert!(inside > 10_000 && outside > 10_000, "{inside} {outside}");
        }
    }

    #[test]
    fn the_intervals_of_random_poses_have_room() {
        for arm in arms() {
            let (mut generator, mut most) = (generator(8), 0);
            for round in 0..10_000 {
                let x_bt = reached_or_random_pose(round, &arm, &mut generator);
                // More breaks or intervals than room for them would be a panic.
                most = most.max(arm.swivel_circle(&x_bt).map_or(0, |circle| circle.intervals().len()));
            }
            assert!((2..MAX_INTERVALS).contains(&most), "{most}");
        }
    }
}
