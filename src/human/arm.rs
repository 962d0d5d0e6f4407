//! The working arm as a chain of seven joints: forward kinematics and the Jacobian.
//!
//! Always a right arm; [`Human`](super::Human) mirrors it for a left-handed person. Source: docs/method.md#41-arm-kinematics.
//! At zero the arm hangs (S shoulder, U upper arm, F forearm, H hand):
//!
//! ```text
//! X_SH = Ry(-q1) Rx(-q2) Rz(q3) . Tz(-L_u) . Ry(-q4) Rz(q5) . Tz(-L_f) . Rx(q6) Ry(q7)
//!        \______ R_SU ________/
//! ```

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{
    body::Body,
    ranges::{ArmAngles, ArmRanges},
};
use crate::model::frames::Pose;

/// Rounding of twist and elevation, rad.
const ORIENTATION_TOLERANCE_RAD: f64 = 1e-9;

/// A right arm that holds a tool.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Shoulder centre in B, m.
    pub p_bs_m: Vector3<f64>,
    /// Shoulder to elbow, m.
    pub upper_arm_m: f64,
    /// Elbow to wrist, m.
    pub forearm_m: f64,
    /// The tool tip's frame in the hand.
    pub x_ht: Pose,
    /// Where its joints may be.
    pub ranges: ArmRanges,
}

/// Positions and orientations of the parts of an arm in the body's frame B.
#[derive(Clone, Copy, Debug)]
pub struct ArmFrames {
    /// Shoulder centre, m.
    pub p_bs_m: Vector3<f64>,
    /// Elbow centre, m.
    pub p_be_m: Vector3<f64>,
    /// Wrist centre, m.
    pub p_bw_m: Vector3<f64>,
    /// Orientation of the upper arm: z from elbow to shoulder.
    pub r_bu: Matrix3<f64>,
    /// Orientation of the forearm before it turns about itself: z from wrist to elbow.
    pub r_bf: Matrix3<f64>,
    /// Orientation of the hand.
    pub r_bh: Matrix3<f64>,
    /// Axis of each joint, unit vectors. The first three pass through S, the fourth through E, the others through W.
    pub axes_b: [Vector3<f64>; 7],
}

impl ArmFrames {
    /// A point on the axis of a joint (counted from 0), m.
    pub fn joint_origin_m(&self, joint: usize) -> &Vector3<f64> {
        match joint {
            0..=2 => &self.p_bs_m,
            3 => &self.p_be_m,
            _ => &self.p_bw_m,
        }
    }

    /// A point that is given in the hand's frame, in B, m.
    pub fn hand_point_b(&self, p_h_m: &Vector3<f64>) -> Vector3<f64> {
        self.p_bw_m + self.r_bh * p_h_m
    }
}

impl Arm {
    /// The right arm of a body with a tool whose tip lies at `x_ht` in the hand.
    pub fn new(body: &Body, x_ht: Pose, ranges: ArmRanges) -> Self {
        let (upper_arm_m, forearm_m) = (body.upper_arm.length_m, body.forearm.length_m);
        Self { p_bs_m: body.p_bs_m, upper_arm_m, forearm_m, x_ht, ranges }
    }

    /// Shoulder to wrist of the straight arm, m.
    pub fn reach_m(&self) -> f64 {
        self.upper_arm_m + self.forearm_m
    }

    /// Elbow flexion at which the distance from shoulder to wrist is this share of the straight arm, rad; the law of cosines.
    pub fn elbow_at_reach(&self, share: f64) -> f64 {
        let (upper, fore, reached) = (self.upper_arm_m, self.forearm_m, share * self.reach_m());
        libm::acos(((reached * reached - upper * upper - fore * fore) / (2.0 * upper * fore)).clamp(-1.0, 1.0))
    }

    /// True if the arm is within its ranges.
    pub fn within_limits(&self, q_rad: &ArmAngles) -> bool {
        q_rad.iter().zip(&self.ranges.joints_rad).all(|(q, [low, high])| (low..=high).contains(&q))
            && self.ranges.permits_shoulder(&self.frames(q_rad).r_bu, 0.0)
    }

    /// True if twist and elevation of the upper arm are within their ranges, but for rounding.
    pub fn permits_shoulder(&self, q_rad: &ArmAngles) -> bool {
        !self.ranges.limits_orientation()
            || self.ranges.permits_shoulder(&self.frames(q_rad).r_bu, ORIENTATION_TOLERANCE_RAD)
    }

    /// Positions and orientations of the parts of the arm.
    pub fn frames(&self, q_rad: &ArmAngles) -> ArmFrames {
        let [q1, q2, q3, q4, q5, q6, q7] = *q_rad;
        let mut moving = Triad::of_body();
        let flexion = -moving.y;
        moving.turn_about_y(-q1);
        let abduction = -moving.x;
        moving.turn_about_x(-q2);
        moving.turn_about_z(q3);
        let r_bu = moving.matrix();
        let p_be_m = self.p_bs_m - moving.z * self.upper_arm_m;
        let internal_rotation = moving.z;
        let elbow = -moving.y;
        moving.turn_about_y(-q4);
        let r_bf = moving.matrix();
        let p_bw_m = p_be_m - moving.z * self.forearm_m;
        let pronation = moving.z;
        moving.turn_about_z(q5);
        let wrist_flexion = moving.x;
        moving.turn_about_x(q6);
        let ulnar_deviation = moving.y;
        moving.turn_about_y(q7);
        ArmFrames {
            p_bs_m: self.p_bs_m,
            p_be_m,
            p_bw_m,
            r_bu,
            r_bf,
            r_bh: moving.matrix(),
            axes_b: [flexion, abduction, internal_rotation, elbow, pronation, wrist_flexion, ulnar_deviation],
        }
    }

    /// The hand's frame in the body's, X_BH.
    pub fn hand_pose_b(&self, q_rad: &ArmAngles) -> Pose {
        let frames = self.frames(q_rad);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frames.r_bh));
        Isometry3::from_parts(frames.p_bw_m.into(), rotation)
    }

    /// The tool tip's frame in the body's, X_BT.
    pub fn tool_pose_b(&self, q_rad: &ArmAngles) -> Pose {
        self.hand_pose_b(q_rad) * self.x_ht
    }
}

/// The axes of a frame that is rotated about its own axes in sequence; cheaper than matrix products.
#[derive(Clone, Copy)]
struct Triad {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
}

impl Triad {
    fn of_body() -> Self {
        Self { x: Vector3::x(), y: Vector3::y(), z: Vector3::z() }
    }

    fn turn_about_x(&mut self, angle_rad: f64) {
        (self.y, self.z) = turned(&self.y, &self.z, angle_rad);
    }

    fn turn_about_y(&mut self, angle_rad: f64) {
        (self.z, self.x) = turned(&self.z, &self.x, angle_rad);
    }

    fn turn_about_z(&mut self, angle_rad: f64) {
        (self.x, self.y) = turned(&self.x, &self.y, angle_rad);
    }

    fn matrix(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&[self.x, self.y, self.z])
    }
}

/// Two axes of a right-handed frame after a turn about the third, `first x second`.
fn turned(first: &Vector3<f64>, second: &Vector3<f64>, angle_rad: f64) -> (Vector3<f64>, Vector3<f64>) {
    // libm, not std: the same bits on every platform.
    let (sin, cos) = libm::sincos(angle_rad);
    (first * cos + second * sin, second * cos - first * sin)
}

#[cfg(test)]
impl Arm {
    /// Geometric Jacobian at the tool tip in B axes: column i is `(a_i x (p_T - o_i); a_i)` with the joint's axis `a_i`
    /// through `o_i`.
    pub(super) fn jacobian_b(&self, q_rad: &ArmAngles) -> nalgebra::SMatrix<f64, 6, 7> {
        let frames = self.frames(q_rad);
        let p_bt_m = frames.hand_point_b(&self.x_ht.translation.vector);
        let mut jacobian = nalgebra::SMatrix::<f64, 6, 7>::zeros();
        for (joint, axis) in frames.axes_b.iter().enumerate() {
            let linear = axis.cross(&(p_bt_m - frames.joint_origin_m(joint)));
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&linear);
            jacobian.fixed_view_mut::<3, 1>(3, joint).copy_from(axis);
        }
        jacobian
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use approx::assert_abs_diff_eq;
    use nalgebra::{Translation3, Unit};

    use super::*;
    use crate::{
        human::testing::{generator, random_angles, worker},
        model::{operation::OperationKind, scenario::Hand},
    };

    fn arm() -> Arm {
        worker(Hand::Right, OperationKind::Drill).arm().clone()
    }

    /// The chain of docs/method.md#41-arm-kinematics, factor by factor.
    fn printed_chain(arm: &Arm, q: &ArmAngles) -> Pose {
        let turn = |axis: Unit<Vector3<f64>>, angle: f64| {
            Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, angle))
        };
        let along_z = |z: f64| Isometry3::translation(0.0, 0.0, z);
        let (x, y, z) = (Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis());
        let x_bs = Isometry3::translation(arm.p_bs_m.x, arm.p_bs_m.y, arm.p_bs_m.z);
        let to_elbow = turn(y, -q[0]) * turn(x, -q[1]) * turn(z, q[2]) * along_z(-arm.upper_arm_m);
        let to_wrist = turn(y, -q[3]) * turn(z, q[4]) * along_z(-arm.forearm_m);
        x_bs * to_elbow * to_wrist * turn(x, q[5]) * turn(y, q[6])
    }

    #[test]
    fn the_hand_pose_equals_the_product_of_the_chain() {
        let (arm, mut generator) = (arm(), generator(1));
        for _ in 0..1_000 {
            let q_rad = random_angles(&arm, &mut generator);
            // Seven rotations on lengths of order one: some ten roundings.
            assert_abs_diff_eq!(arm.hand_pose_b(&q_rad), printed_chain(&arm, &q_rad), epsilon = 1e-14);
        }
    }

    #[test]
    fn each_joint_moves_the_way_its_name_says() {
        let arm = arm();
        let hand_after = |joint: usize, angle: f64| {
            let mut q_rad = [0.0; 7];
            q_rad[joint] = angle;
            arm.hand_pose_b(&q_rad)
        };
        let hanging = arm.hand_pose_b(&[0.0; 7]);
        let shift = |joint| hand_after(joint, 0.5).translation.vector - hanging.translation.vector;
        assert!(shift(0).x > 0.0, "flexion lifts the hand forward");
        assert!(shift(1).y < 0.0, "abduction lifts the right hand to the right");
        assert!(shift(3).x > 0.0, "elbow flexion lifts the hand forward");
        let thumb = |joint| hand_after(joint, 0.5).rotation * Vector3::x();
        assert!(thumb(2).y > 0.0, "internal rotation turns the thumb to the left");
        assert!(thumb(4).y > 0.0, "pronation turns the thumb to the left");
        let fingers = |joint| hand_after(joint, 0.5).rotation * -Vector3::z();
        assert!(fingers(5).y > 0.0, "wrist flexion turns the fingers to the palm's side");
        assert!(fingers(6).x < 0.0, "ulnar deviation turns the fingers away from the thumb's side");
    }

    #[test]
    fn a_right_angle_at_the_elbow_puts_the_wrist_in_front_of_it() {
        let arm = arm();
        let frames = arm.frames(&[0.0, 0.0, 0.0, FRAC_PI_2, 0.0, 0.0, 0.0]);
        assert_abs_diff_eq!(frames.p_be_m, arm.p_bs_m - Vector3::z() * 0.3255, epsilon = 1e-15);
        assert_abs_diff_eq!(frames.p_bw_m, frames.p_be_m + Vector3::x() * 0.2555, epsilon = 1e-15);
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_tool_pose() {
        let (arm, mut generator) = (arm(), generator(2));
        let step = 1e-6;
        for _ in 0..200 {
            let q_rad = random_angles(&arm, &mut generator);
            let jacobian = arm.jacobian_b(&q_rad);
            for joint in 0..7 {
                let moved = |by: f64| {
                    let mut q_rad = q_rad;
                    q_rad[joint] += by;
                    arm.tool_pose_b(&q_rad)
                };
                let (before, after) = (moved(-step), moved(step));
                let linear = (after.translation.vector - before.translation.vector) / (2.0 * step);
                let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * step);
                // Central differences: step^2 from the third derivative, 1e-16 / step from rounding.
                assert_abs_diff_eq!(jacobian.fixed_view::<3, 1>(0, joint).into_owned(), linear, epsilon = 1e-9);
                assert_abs_diff_eq!(jacobian.fixed_view::<3, 1>(3, joint).into_owned(), angular, epsilon = 1e-9);
            }
        }
    }
}
