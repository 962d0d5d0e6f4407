//! Muscular comfort: joint torques of the working arm relative to its strength (docs/method.md#4-muscular-comfort).
//!
//! In the body's frame, for a right arm. A load is a wrench at the tool tip.

use nalgebra::{Matrix3, Vector3};

use super::{
    arm::{Arm, ArmFrames},
    body::Body,
    intrinsic::{self, CO_CONTRACTION, Shoulder},
    muscles::{ArmLoad, MuscleEffort, MuscleProgram, Muscles},
    ranges::ArmAngles,
    strength::{Sense, Strength},
};
use crate::model::{
    plan::ShoulderMoment,
    scenario::{ComfortSettings, MuscularMetric, StrengthDirection},
    wrench::Wrench,
};

/// Regularisation of the muscular comfort: the sum of squares of a resting co-contraction of 3.8 % in each of seven joints.
/// Bounds the comfort by 100 where gravity and load cancel.
pub(super) const RESTING: f64 = 0.01;

/// Sum of squares of a resting tone of 2 % in each of 50 muscles. Bounds the comfort by 50.
const MUSCLE_TONE: f64 = 0.02;

/// The muscular comfort of a metric in words, as in the title of a plot: `1 / (sum of squared activations + 0.0175)`.
#[must_use]
pub fn formula_in_words(metric: MuscularMetric) -> String {
    let (what, resting) = match metric {
        MuscularMetric::Paper => ("activations", RESTING),
        MuscularMetric::Intrinsic => ("activations", CO_CONTRACTION),
        MuscularMetric::Muscles => ("muscle activations", MUSCLE_TONE),
    };
    // Rounded, since 7 times 0.05 squared is not quite 0.0175.
    format!("1 / (sum of squared {what} + {})", (resting * 1e6).round() / 1e6)
}

/// Torques below this have no direction, since they are rounding errors, N m.
const NO_SENSE_NM: f64 = 1e-9;

/// What a person's arm can do.
#[derive(Clone, Debug)]
pub(super) struct Ability {
    /// Of its joints.
    pub strength: Strength,
    /// Of its muscles.
    pub muscles: Muscles,
}

/// The torques of the arm's joints, N m, positive towards larger angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTorques {
    /// `J' w`: torques that exert the operation's wrench at the tool tip.
    pub operation_nm: [f64; 7],
    /// `g(q)`: torques that hold upper arm, forearm, hand and tool against gravity.
    pub gravity_nm: [f64; 7],
    /// The whole moments about shoulder, elbow and wrist, of which the torques are parts: V axes, N m.
    pub moments_v_nm: [Vector3<f64>; 3],
}

/// The muscular comfort of a posture under a load, by one of the three metrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscular {
    /// What may be at most 1. Torque over strength, `alpha_i = |tau_i| / tau_max,i`: of each joint, or with the intrinsic metric
    /// of raising the upper arm, moving it horizontally, turning it about itself, and of the four joints beyond. With the
    /// muscles the moments that they cannot exert, over 0.1 N m: about x, y, z of V at the shoulder, then of elbow, pronation,
    /// deviation, flexion of the wrist.
    pub activations: [f64; 7],
    /// One over the effort, `||alpha||^2` or the muscles' sum of squares; infinite if that is zero.
    pub printed: f64,
    /// `1 / (effort + eps)`, eps = 0.01 (paper), 0.0175 (intrinsic) or 0.02 (muscles).
    pub regularised: f64,
}

/// The muscular comfort of a posture by the two metrics of joint strengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscularFigures {
    /// As printed in the paper.
    pub paper: Muscular,
    /// By the intrinsic metric.
    pub intrinsic: Muscular,
    /// The moment about the shoulder.
    pub shoulder: ShoulderMoment,
}

impl Muscular {
    /// The comfort of these activations with the resting co-contraction of a metric, a sum of squares.
    pub fn of(activations: [f64; 7], resting: f64) -> Self {
        Self::of_effort(activations, activations.iter().map(|alpha| alpha * alpha).sum(), resting)
    }

    /// The comfort of the muscles; none if there is no optimum, which finite numbers always have.
    pub fn of_muscles(effort: Option<&MuscleEffort>) -> Self {
        match effort {
            Some(effort) => Self::of_effort(effort.missing_shares(), effort.effort, MUSCLE_TONE),
            None => Self::of_effort([f64::INFINITY; 7], f64::INFINITY, MUSCLE_TONE),
        }
    }

    fn of_effort(activations: [f64; 7], effort: f64, resting: f64) -> Self {
        Self { activations, printed: 1.0 / effort, regularised: 1.0 / (effort + resting) }
    }
}

impl JointTorques {
    /// The total torque of each joint, `tau = J' w + g(q)`, N m.
    pub fn total_nm(&self) -> [f64; 7] {
        std::array::from_fn(|i| self.operation_nm[i] + self.gravity_nm[i])
    }

    /// The whole moment about the shoulder, V axes, N m.
    pub fn shoulder_v_nm(&self) -> Vector3<f64> {
        self.moments_v_nm[0]
    }

    /// Torque over strength of each joint. The strength is that in the sense of the operation's torque (`paper`) or of the
    /// total torque (`torque`), and the smaller of both if that torque is zero (docs/method.md#47-direction-of-motion).
    pub fn activations(&self, q_rad: &ArmAngles, strength: &Strength, direction: StrengthDirection) -> [f64; 7] {
        let (total_nm, senses) = (self.total_nm(), self.senses(q_rad, strength, direction));
        std::array::from_fn(|joint| total_nm[joint].abs() / strength.torque_nm(joint, q_rad[joint], senses[joint]))
    }

    /// The muscular comfort by the metric of the settings.
    pub(super) fn muscular(
        &self,
        q_rad: &ArmAngles,
        r_vu: &Matrix3<f64>,
        ability: &Ability,
        settings: &ComfortSettings,
    ) -> Muscular {
        let strength = &ability.strength;
        match settings.muscular {
            MuscularMetric::Paper => Muscular::of(self.activations(q_rad, strength, settings.direction), RESTING),
            MuscularMetric::Intrinsic => {
                Muscular::of(self.intrinsic_activations(q_rad, r_vu, strength), CO_CONTRACTION)
            }
            MuscularMetric::Muscles => {
                Muscular::of_muscles(self.muscle_program(q_rad, r_vu, &ability.muscles).solve().as_ref())
            }
        }
    }

    /// What the muscles can do and have to.
    pub(super) fn muscle_program(&self, q_rad: &ArmAngles, r_vu: &Matrix3<f64>, muscles: &Muscles) -> MuscleProgram {
        muscles.program(&ArmLoad { r_vu, q_rad, moments_nm: &self.moments_v_nm })
    }

    /// The moment about the shoulder and its parts.
    pub fn shoulder_moment(&self, r_vu: &Matrix3<f64>) -> ShoulderMoment {
        let moment_v_nm = self.shoulder_v_nm();
        let [raising_nm, horizontal_nm, axial_nm] = intrinsic::parts_nm(r_vu, &moment_v_nm);
        ShoulderMoment { moment_v_nm: moment_v_nm.into(), raising_nm, horizontal_nm, axial_nm }
    }

    /// The activations of the intrinsic metric: of the shoulder's three parts, then torque over strength of each joint beyond, the
    /// strength in the sense of the joint's own torque.
    pub fn intrinsic_activations(&self, q_rad: &ArmAngles, r_vu: &Matrix3<f64>, strength: &Strength) -> [f64; 7] {
        let (zero, moment_nm) = (Vector3::zeros(), self.shoulder_v_nm());
        let shoulder = Shoulder { r_vu, moment_nm, moment_slope: zero, turn: zero }.squares(strength);
        std::array::from_fn(|joint| match shoulder.get(joint) {
            Some(square) => square.value.sqrt(),
            None => self.intrinsic_activation(joint, q_rad, strength),
        })
    }

    /// The activation of a joint beyond the shoulder.
    pub(super) fn intrinsic_activation(&self, joint: usize, q_rad: &ArmAngles, strength: &Strength) -> f64 {
        let total_nm = self.operation_nm[joint] + self.gravity_nm[joint];
        total_nm.abs() / strength.torque_nm(joint, q_rad[joint], self.own_sense(joint))
    }

    /// The sense of a joint's total torque.
    pub(super) fn own_sense(&self, joint: usize) -> Sense {
        if self.operation_nm[joint] + self.gravity_nm[joint] >= 0.0 { Sense::Positive } else { Sense::Negative }
    }

    /// The sense of each joint's strength.
    pub(super) fn senses(&self, q_rad: &ArmAngles, strength: &Strength, direction: StrengthDirection) -> [Sense; 7] {
        let deciding_nm = match direction {
            StrengthDirection::Paper => self.operation_nm,
            StrengthDirection::Torque => self.total_nm(),
        };
        std::array::from_fn(|joint| {
            let limit_nm = |sense| strength.torque_nm(joint, q_rad[joint], sense);
            match deciding_nm[joint] {
                torque if torque > NO_SENSE_NM => Sense::Positive,
                torque if torque < -NO_SENSE_NM => Sense::Negative,
                _ if limit_nm(Sense::Positive) < limit_nm(Sense::Negative) => Sense::Positive,
                _ => Sense::Negative,
            }
        })
    }
}

/// Mass, kg, and centre of mass in B, m, of a part of the arm or the tool.
pub(super) type Weight = (f64, Vector3<f64>);

/// The joint torques for a wrench that the hand exerts at the tool tip (about the tip, B axes), with gravity `gravity_b`,
/// m/s^2, on the arm and on a tool of `tool_kg` in the palm (docs/method.md#45-joint-torques).
///
/// Each torque is the joint's axis times the moment about a point on it: of the wrench, and of the forces that hold all
/// weights beyond the joint.
pub fn joint_torques(
    arm: &Arm,
    body: &Body,
    tool_kg: f64,
    frames: &ArmFrames,
    wrench_b: &Wrench,
    gravity_b: &Vector3<f64>,
) -> JointTorques {
    let p_bt_m = frames.hand_point_b(&arm.x_ht.translation.vector);
    let weights = weights(body, tool_kg, frames);
    // The shoulder carries everything, the elbow all but the upper arm, the wrist hand and tool. The forearm's centre of mass
    // lies on the axis of pronation, so that axis is treated with the wrist.
    let (at_shoulder, at_elbow, at_wrist) = (&frames.p_bs_m, &frames.p_be_m, &frames.p_bw_m);
    let exerting = [at_shoulder, at_elbow, at_wrist].map(|origin| wrench_b.about(&(p_bt_m - origin)).moment_nm);
    let holding = [(at_shoulder, &weights[..]), (at_elbow, &weights[1..]), (at_wrist, &weights[2..])]
        .map(|(origin, carried)| holding_moment(carried, origin, gravity_b));
    let about_axes = |moments: &[Vector3<f64>; 3]| {
        let [shoulder, elbow, wrist] = moments;
        let by_joint = [shoulder, shoulder, shoulder, elbow, wrist, wrist, wrist];
        std::array::from_fn(|joint| frames.axes_b[joint].dot(by_joint[joint]))
    };
    JointTorques {
        operation_nm: about_axes(&exerting),
        gravity_nm: about_axes(&holding),
        moments_v_nm: std::array::from_fn(|joint| exerting[joint] + holding[joint]),
    }
}

/// Upper arm, forearm, hand, tool.
pub(super) fn weights(body: &Body, tool_kg: f64, frames: &ArmFrames) -> [Weight; 4] {
    let (upper_arm, forearm, hand) = (&body.upper_arm, &body.forearm, &body.hand);
    [
        (upper_arm.mass_kg, frames.p_bs_m - frames.r_bu.column(2) * upper_arm.com_m),
        (forearm.mass_kg, frames.p_be_m - frames.r_bf.column(2) * forearm.com_m),
        (hand.mass_kg, frames.p_bw_m - frames.r_bh.column(2) * hand.com_m),
        (tool_kg, frames.hand_point_b(&body.palm_h)),
    ]
}

/// The moment about `origin_b` that holds the weights: `sum (p - o) x (-m g)`.
fn holding_moment(weights: &[Weight], origin_b: &Vector3<f64>, gravity_b: &Vector3<f64>) -> Vector3<f64> {
    let first_moment: Vector3<f64> = weights.iter().map(|(mass_kg, p_b)| (p_b - origin_b) * *mass_kg).sum();
    gravity_b.cross(&first_moment)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::Isometry3;

    use super::*;
    use crate::{
        human::{
            Human, standing_pose_w,
            testing::{average_man, generator, random_angles, worker},
        },
        model::{
            GRAVITY_W,
            operation::OperationKind,
            scenario::{Hand, Sex, Tool},
        },
    };

    const NO_GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

    fn drill() -> Human {
        worker(Hand::Right, OperationKind::Drill)
    }

    fn torques(
        human: &Human,
        tool_kg: f64,
        q_rad: &ArmAngles,
        wrench: &Wrench,
        gravity: &Vector3<f64>,
    ) -> JointTorques {
        joint_torques(human.arm(), human.body(), tool_kg, &human.arm().frames(q_rad), wrench, gravity)
    }

    /// Height times weight of everything that the shoulder carries, J.
    fn potential_energy_j(human: &Human, tool_kg: f64, q_rad: &ArmAngles) -> f64 {
        let (body, frames) = (human.body(), human.arm().frames(q_rad));
        let between = |from: &Vector3<f64>, to: &Vector3<f64>, fraction: f64| from + (to - from) * fraction;
        let heights = [
            (body.upper_arm.mass_kg, between(&frames.p_bs_m, &frames.p_be_m, 0.5772)),
            (body.forearm.mass_kg, between(&frames.p_be_m, &frames.p_bw_m, 0.4574)),
            (body.hand.mass_kg, frames.hand_point_b(&Vector3::new(0.0, 0.0, -0.3624 * 0.108 * 1.75))),
            (tool_kg, frames.hand_point_b(&Vector3::new(0.0, 0.0, -0.05 * 1.75))),
        ];
        heights.iter().map(|(mass_kg, p)| 9.81 * mass_kg * p.z).sum()
    }

    #[test]
    fn a_straight_arm_held_out_carries_its_weight_and_that_of_the_tool() {
        let human = drill();
        let forward = [FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let torques = torques(&human, 1.3, &forward, &Wrench::default(), &GRAVITY_W);
        // By hand, for 75 kg and 1.75 m: masses 2.0325, 1.215, 0.4575, 1.3 kg.
        let hand = 0.4575 * 0.3624 * 0.189 + 1.3 * 0.0875;
        let elbow = 1.215 * 0.4574 * 0.2555 + 1.7575 * 0.2555 + hand;
        let shoulder = 2.0325 * 0.5772 * 0.3255 + (1.215 + 1.7575) * 0.3255 + elbow;
        // The arm and its weights lie in the vertical plane of flexion; the hand's ulnar side is down, and it hangs on the
        // radial deviators. Rounding of some ten products.
        let expected = [shoulder, 0.0, 0.0, elbow, 0.0, 0.0, -hand].map(|arm_kg_m| 9.81 * arm_kg_m);
        for (found, expected) in torques.gravity_nm.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13, "{torques:?}");
        }
        assert_eq!(torques.operation_nm, [0.0; 7]);
    }

    #[test]
    fn lifting_with_a_straight_arm_takes_force_times_lever() {
        let human = drill();
        let forward = [FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let lift = Wrench::from_force(Vector3::new(0.0, 0.0, 10.0));
        let torques = torques(&human, 1.3, &forward, &lift, &NO_GRAVITY);
        // The tip lies 0.26 m beyond the wrist, 0.05 m to the left (the palm's side).
        let expected = [8.41, 0.0, -0.5, 5.155, -0.5, 0.0, -2.6];
        for (joint, (found, expected)) in torques.operation_nm.iter().zip(expected).enumerate() {
            // About the forward line through the arm the lift takes 0.05 x 10 about +x_B; the axes of internal rotation and
            // pronation point to the shoulder, along -x_B.
            assert!((found - expected).abs() < 1e-13, "joint {joint}: {torques:?}");
        }
    }

    #[test]
    fn gravity_torques_are_the_slope_of_the_potential_energy() {
        let (human, mut generator) = (drill(), generator(5));
        let step = 1e-5;
        for _ in 0..200 {
            let q_rad = random_angles(human.arm(), &mut generator);
            let gravity_nm = torques(&human, 1.3, &q_rad, &Wrench::default(), &GRAVITY_W).gravity_nm;
            for joint in 0..7 {
                let energy = |by: f64| {
                    let mut q_rad = q_rad;
                    q_rad[joint] += by;
                    potential_energy_j(&human, 1.3, &q_rad)
                };
                let slope = (energy(step) - energy(-step)) / (2.0 * step);
                // Energies near 70 J: rounding 1e-14 / step, third derivative step^2.
                assert!((gravity_nm[joint] - slope).abs() < 1e-8, "joint {joint}");
            }
        }
    }

    #[test]
    fn the_torques_of_the_wrench_are_those_of_the_jacobian() {
        let (human, mut generator) = (drill(), generator(6));
        let wrench = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
        for _ in 0..200 {
            let q_rad = random_angles(human.arm(), &mut generator);
            let found = torques(&human, 1.3, &q_rad, &wrench, &GRAVITY_W).operation_nm;
            let expected = human.arm().jacobian_b(&q_rad).transpose() * wrench.to_vector();
            for (found, expected) in found.iter().zip(expected.iter()) {
                // Products of 20 N with levers under 1 m.
                assert!((found - expected).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn without_gravity_comfort_falls_with_the_square_of_the_force() {
        let (human, mut generator) = (drill(), generator(8));
        let wrench = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
        for direction in [StrengthDirection::Paper, StrengthDirection::Torque] {
            for _ in 0..100 {
                let q_rad = random_angles(human.arm(), &mut generator);
                let printed = |factor: f64| {
                    let torques = torques(&human, 1.3, &q_rad, &wrench.scaled(factor), &NO_GRAVITY);
                    Muscular::of(torques.activations(&q_rad, human.strength(), direction), RESTING).printed
                };
                assert!((printed(1.0) / printed(3.0) - 9.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_metric_by_hand() {
        let muscular = Muscular::of([0.1, 0.2, 0.0, 0.2, 0.0, 0.0, 0.0], RESTING);
        // 0.01 + 0.04 + 0.04 = 0.09
        assert!((muscular.printed - 1.0 / 0.09).abs() < 1e-14);
        assert!((muscular.regularised - 10.0).abs() < 1e-14);
        let idle = Muscular::of([0.0; 7], RESTING);
        assert_eq!((idle.printed, idle.regularised), (f64::INFINITY, 100.0));
        // A resting co-contraction of 5 % in seven terms.
        assert_eq!(formula_in_words(MuscularMetric::Paper), "1 / (sum of squared activations + 0.01)");
        assert_eq!(formula_in_words(MuscularMetric::Intrinsic), "1 / (sum of squared activations + 0.0175)");
        assert_eq!(formula_in_words(MuscularMetric::Muscles), "1 / (sum of squared muscle activations + 0.02)");
        let idle = Muscular::of([0.0; 7], CO_CONTRACTION);
        assert_eq!((idle.printed, idle.regularised), (f64::INFINITY, 1.0 / 0.0175));
    }

    #[test]
    fn the_direction_picks_the_strength() {
        // Elbow flexion (28.9 N m at 0) and extension (38.5 N m): lowering 2 N m of a load of 5 N m.
        let strength = Strength::new(Sex::Male, 50.0);
        let mut torques = JointTorques { operation_nm: [0.0; 7], gravity_nm: [0.0; 7], moments_v_nm: [NO_GRAVITY; 3] };
        (torques.operation_nm[3], torques.gravity_nm[3]) = (-2.0, 5.0);
        let elbow = |torques: &JointTorques, direction| torques.activations(&[0.0; 7], &strength, direction)[3];
        assert!((elbow(&torques, StrengthDirection::Paper) - 3.0 / 38.5230).abs() < 1e-15);
        assert!((elbow(&torques, StrengthDirection::Torque) - 3.0 / 28.9183).abs() < 1e-15);
        // No motion along the wrench, up to rounding: the smaller strength.
        torques.operation_nm[3] = -1e-12;
        assert!((elbow(&torques, StrengthDirection::Paper) - 5.0 / 28.9183).abs() < 1e-12);
    }

    #[test]
    fn the_person_adds_gravity_in_the_world() {
        let human = drill();
        let tool = Tool { mass_kg: 0.0, tip_h_m: [0.05, 0.05, -0.26], rotation_xyzw: [1.0, 0.0, 0.0, 0.0] };
        let empty_handed = Human::new(&average_man(), &tool).unwrap();
        let q_rad = [0.4, 0.2, 0.1, 1.0, 0.0, 0.1, 0.0];
        let x_wb = standing_pose_w(1.0, 0.0, 2.0, -0.9);
        let gravity_of = |human: &Human| human.joint_torques(&q_rad, &x_wb, &Wrench::default()).gravity_nm;
        assert_eq!(gravity_of(&empty_handed), torques(&human, 0.0, &q_rad, &Wrench::default(), &GRAVITY_W).gravity_nm);
        assert!(gravity_of(&human)[0] > gravity_of(&empty_handed)[0]);
    }

    #[test]
    fn gravity_pulls_along_the_world_whatever_the_body_does() {
        // On the back, x_B up, the arm along the trunk: the same load as the arm held out forward when standing. Either hand.
        let on_the_back = Isometry3::rotation(Vector3::new(0.0, -FRAC_PI_2, 0.0));
        let forward = [FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for hand in [Hand::Right, Hand::Left] {
            let human = worker(hand, OperationKind::Drill);
            let lying = human.joint_torques(&[0.0; 7], &on_the_back, &Wrench::default()).gravity_nm;
            let standing = human.joint_torques(&forward, &Isometry3::identity(), &Wrench::default()).gravity_nm;
            for (lying, standing) in lying.iter().zip(standing) {
                assert!((lying - standing).abs() < 1e-13);
            }
        }
        // On the right side, y_B up, the straight right arm would fall outward: the adductors hold it.
        let human = drill();
        let on_the_right = Isometry3::rotation(Vector3::new(FRAC_PI_2, 0.0, 0.0));
        let aside = human.joint_torques(&[0.0; 7], &on_the_right, &Wrench::default()).gravity_nm;
        let forward = human.joint_torques(&forward, &Isometry3::identity(), &Wrench::default()).gravity_nm;
        assert!((aside[1] + forward[0]).abs() < 1e-13 && aside[0].abs() < 1e-13);
    }
}
