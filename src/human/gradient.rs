//! Derivatives of the muscular comfort and of points of the working arm by the arm's angles.
//!
//! The operation's wrench is fixed in the tool's axes, so it turns with the hand. With the wrench's force `F` and moment
//! `m` at the tool tip `p`, the weights' holding forces `F_k` at `p_k`, and the axis `a_i` of joint i through `o_i`:
//!
//! ```text
//! tau_i = a_i . (m + (p - o_i) x F) + a_i . sum_{k > i} (p_k - o_i) x F_k
//! d tau_i / d q_j, wrench  = a_i . (a_j x m + (a_j x (p - o_j)) x F + (p - o_i) x (a_j x F))          for j >= i
//!                          = 0: arm and wrench turn together                                          for j < i
//! d tau_i / d q_j, weights = a_i . sum_{k > j} (a_j x (p_k - o_j)) x F_k                              for j >= i
//!                          = sum_{k > i} (a_j x a_i) . (p_k - o_i) x F_k + a_i . (a_j x (p_k - o_i)) x F_k  for j < i
//! alpha_i = |tau_i| / tau_max,i(q_i),   C = 1 / (sum alpha_i^2 + eps),   dC = -C^2 sum 2 alpha_i d alpha_i
//! ```
//!
//! `k > i` are the weights beyond joint i. Of the intrinsic metric the shoulder's part is that of `human::intrinsic`
//! along each joint, by the derivatives of the whole moment about the shoulder. The derivatives are undefined where a joint's
//! torque changes sign, where a joint changes between its two strengths, and at the ends of the strengths' ranges. There they
//! are those of the strength that [`super::muscular`] uses.

use nalgebra::{Point3, Vector3};

use super::{
    arm::{Arm, ArmFrames},
    body::Body,
    intrinsic::Shoulder,
    muscles::{ArmLoad, Muscles},
    muscular::{self, Ability, JointTorques, Muscular},
    ranges::ArmAngles,
    strength::{Sense, Strength},
};
use crate::model::{
    scenario::{ComfortSettings, MuscularMetric},
    wrench::Wrench,
};

/// The muscular comfort of a posture and its derivatives by the arm's angles.
#[derive(Clone, Copy, Debug)]
pub struct MuscularGradient {
    /// The comfort and the activations.
    pub muscular: Muscular,
    /// Gradient of the regularised comfort, 1/rad.
    pub regularised: [f64; 7],
    /// Jacobian of the activations, 1/rad: one row per activation, one column per joint.
    pub activations: [[f64; 7]; 7],
}

/// The axes of the working arm's joints in W.
#[derive(Clone, Copy, Debug)]
pub struct ArmAxes {
    /// A point on each axis, m.
    pub origins_w: [Point3<f64>; 7],
    /// Direction of each axis, unit vectors.
    pub axes_w: [Vector3<f64>; 7],
}

impl ArmAxes {
    /// Derivative of a point by a joint (counted from 0) that moves it, m/rad.
    #[must_use]
    pub fn velocity_w(&self, joint: usize, p_w: &Point3<f64>) -> Vector3<f64> {
        self.axes_w[joint].cross(&(p_w - self.origins_w[joint]))
    }
}

/// What the arm carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load<'a> {
    /// Mass of the tool, kg.
    pub tool_kg: f64,
    /// What the hand exerts at the tool's tip: about the tip, B axes.
    pub wrench_b: &'a Wrench,
    /// Gravity in B axes, m/s^2.
    pub gravity_b: &'a Vector3<f64>,
}

/// A force at a point, in B: N and m.
struct Force {
    force_n: Vector3<f64>,
    p_b_m: Vector3<f64>,
}

/// The muscular comfort of a right arm and its derivatives.
pub(super) fn muscular_gradient(
    arm: &Arm,
    body: &Body,
    ability: &Ability,
    q_rad: &ArmAngles,
    load: &Load<'_>,
    settings: &ComfortSettings,
) -> MuscularGradient {
    let frames = arm.frames(q_rad);
    let torques = muscular::joint_torques(arm, body, load.tool_kg, &frames, load.wrench_b, load.gravity_b);
    let point = Point {
        p_bt_m: frames.hand_point_b(&arm.x_ht.translation.vector),
        weights: holding_forces(body, &frames, load),
        frames,
        wrench_b: load.wrench_b,
    };
    match settings.muscular {
        MuscularMetric::Muscles => point.gradient_of_muscles(&torques, q_rad, &ability.muscles),
        MuscularMetric::Paper | MuscularMetric::Intrinsic => {
            let muscular = torques.muscular(q_rad, &point.frames.r_bu, ability, settings);
            point.gradient_of_strengths(&torques, q_rad, &ability.strength, muscular, settings)
        }
    }
}

/// A posture under a load.
struct Point<'a> {
    frames: ArmFrames,
    p_bt_m: Vector3<f64>,
    weights: [Force; 4],
    wrench_b: &'a Wrench,
}

impl Point<'_> {
    /// The comfort by one of the metrics of joint strengths and its derivatives by all joints.
    fn gradient_of_strengths(
        &self,
        torques: &JointTorques,
        q_rad: &ArmAngles,
        strength: &Strength,
        muscular: Muscular,
        settings: &ComfortSettings,
    ) -> MuscularGradient {
        let of_joint = |joint: usize, sense: Sense| {
            let (total_nm, activation) = (torques.total_nm()[joint], muscular.activations[joint]);
            self.activation_slopes(joint, q_rad[joint], total_nm, activation, strength, sense)
        };
        let activations: [[f64; 7]; 7] = if settings.muscular == MuscularMetric::Intrinsic {
            let shoulder = self.shoulder_slopes(torques, strength);
            std::array::from_fn(|row| match shoulder.get(row) {
                Some(slopes) => *slopes,
                None => of_joint(row, torques.own_sense(row)),
            })
        } else {
            let senses = torques.senses(q_rad, strength, settings.direction);
            std::array::from_fn(|joint| of_joint(joint, senses[joint]))
        };
        let regularised = std::array::from_fn(|j| {
            let effort_slope: f64 = (0..7).map(|i| 2.0 * muscular.activations[i] * activations[i][j]).sum();
            -muscular.regularised.powi(2) * effort_slope
        });
        MuscularGradient { muscular, regularised, activations }
    }

    /// Derivatives of a joint's activation `|tau| / tau_max(q)` by all joints, 1/rad.
    fn activation_slopes(
        &self,
        i: usize,
        q_rad: f64,
        total_nm: f64,
        activation: f64,
        strength: &Strength,
        sense: Sense,
    ) -> [f64; 7] {
        let limit_nm = strength.torque_nm(i, q_rad, sense);
        let strength_slope = strength.slope_nm_rad(i, q_rad, sense);
        let Self { frames, p_bt_m, weights, wrench_b } = self;
        std::array::from_fn(|j| {
            let slope = wrench_slope(frames, p_bt_m, wrench_b, i, j) + weight_slope(frames, weights, i, j);
            let by_torque = total_nm.signum() * slope / limit_nm;
            if i == j { by_torque - activation * strength_slope / limit_nm } else { by_torque }
        })
    }

    /// Derivatives of the shoulder's three intrinsic activations by all joints, 1/rad.
    fn shoulder_slopes(&self, torques: &JointTorques, strength: &Strength) -> [[f64; 7]; 3] {
        let mut slopes = [[0.0; 7]; 3];
        for (joint, axis_b) in self.frames.axes_b.iter().enumerate() {
            let turn = if joint < 3 { *axis_b } else { Vector3::zeros() };
            let shoulder = Shoulder {
                r_vu: &self.frames.r_bu,
                moment_nm: torques.shoulder_v_nm(),
                moment_slope: self.moment_slope(0, joint),
                turn,
            };
            for (row, square) in shoulder.squares(strength).into_iter().enumerate() {
                // Of a square root, which has no derivative at zero.
                let activation = square.value.sqrt();
                slopes[row][joint] = if activation > 0.0 { square.slope / (2.0 * activation) } else { 0.0 };
            }
        }
        slopes
    }

    /// The comfort of the muscles and its derivatives by all joints.
    fn gradient_of_muscles(&self, torques: &JointTorques, q_rad: &ArmAngles, muscles: &Muscles) -> MuscularGradient {
        let ArmFrames { axes_b, r_bu, .. } = &self.frames;
        let load = ArmLoad { r_vu: r_bu, q_rad, moments_nm: &torques.moments_v_nm };
        let slopes_nm = std::array::from_fn(|joint| [0, 1, 2].map(|centre| self.moment_slope(centre, joint)));
        let found = muscles.effort_slopes(&load, [&axes_b[0], &axes_b[1], &axes_b[2]], &slopes_nm);
        let muscular = Muscular::of_muscles(found.as_ref().map(|found| &found.effort));
        found.map_or(MuscularGradient { muscular, regularised: [0.0; 7], activations: [[0.0; 7]; 7] }, |found| {
            let regularised = found.effort_slopes.map(|slope| -muscular.regularised.powi(2) * slope);
            MuscularGradient { muscular, regularised, activations: found.missing_slopes }
        })
    }

    /// Derivative of the moment about the shoulder (0), the elbow (1) or the wrist (2) by a joint, N m/rad.
    fn moment_slope(&self, centre: usize, joint: usize) -> Vector3<f64> {
        let Self { frames, p_bt_m, weights, wrench_b } = self;
        let (axis, origin) = (&frames.axes_b[joint], frames.joint_origin_m(joint));
        let Wrench { force_n, moment_nm } = wrench_b;
        // The centre itself moves with the joints before it.
        let (p_bc_m, first_beyond) = match centre {
            0 => (&frames.p_bs_m, 0),
            1 => (&frames.p_be_m, 3),
            _ => (&frames.p_bw_m, 4),
        };
        let moved = if joint < first_beyond { p_bc_m } else { origin };
        let of_wrench = axis.cross(moment_nm)
            + axis.cross(&(p_bt_m - moved)).cross(force_n)
            + (p_bt_m - p_bc_m).cross(&axis.cross(force_n));
        let of_weight = |force: &Force| axis.cross(&(force.p_b_m - moved)).cross(&force.force_n);
        let turned = beyond(weights, joint.max(first_beyond));
        of_wrench + turned.iter().map(of_weight).sum::<Vector3<f64>>()
    }
}

/// The forces that hold upper arm, forearm, hand and tool against gravity.
fn holding_forces(body: &Body, frames: &ArmFrames, load: &Load<'_>) -> [Force; 4] {
    muscular::weights(body, load.tool_kg, frames)
        .map(|(mass_kg, p_b_m)| Force { force_n: load.gravity_b * -mass_kg, p_b_m })
}

/// The forces beyond a joint. The forearm's centre of mass lies on the axis of pronation.
fn beyond(forces: &[Force; 4], joint: usize) -> &[Force] {
    match joint {
        0..=2 => forces,
        3 => &forces[1..],
        _ => &forces[2..],
    }
}

/// Derivative of joint i's torque from the wrench by joint j, N m/rad.
fn wrench_slope(frames: &ArmFrames, p_bt_m: &Vector3<f64>, wrench_b: &Wrench, i: usize, j: usize) -> f64 {
    if j < i {
        return 0.0;
    }
    let (a_i, a_j) = (&frames.axes_b[i], &frames.axes_b[j]);
    let Wrench { force_n, moment_nm } = wrench_b;
    let moved = a_j.cross(&(p_bt_m - frames.joint_origin_m(j))).cross(force_n);
    let turned = (p_bt_m - frames.joint_origin_m(i)).cross(&a_j.cross(force_n));
    a_i.dot(&(a_j.cross(moment_nm) + moved + turned))
}

/// Derivative of joint i's torque from the weights by joint j, N m/rad.
fn weight_slope(frames: &ArmFrames, forces: &[Force; 4], i: usize, j: usize) -> f64 {
    let (a_i, a_j) = (&frames.axes_b[i], &frames.axes_b[j]);
    // Only the weights beyond both joints move relative to joint i, as if carried by the farther joint.
    let farther = i.max(j);
    let origin = frames.joint_origin_m(farther);
    let moved: Vector3<f64> =
        beyond(forces, farther).iter().map(|f| a_j.cross(&(f.p_b_m - origin)).cross(&f.force_n)).sum();
    if j >= i {
        return a_i.dot(&moved);
    }
    let about_joint: Vector3<f64> = beyond(forces, i).iter().map(|f| (f.p_b_m - origin).cross(&f.force_n)).sum();
    a_j.cross(a_i).dot(&about_joint) + a_i.dot(&moved)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rand::RngExt;

    use super::MuscularGradient;
    use crate::{
        human::{
            ArmAngles, BodyPart, Human, Muscular, body_point_joints,
            ranges::{elevation_rad, shoulder_angles, twist_rad},
            standing_pose_w,
            testing::{HANDS, generator, leaning, random_angles},
        },
        model::{
            frames::Pose,
            scenario::{ComfortSettings, MuscularMetric, StrengthDirection},
            wrench::Wrench,
        },
    };

    const STEP: f64 = 1e-6;

    /// The wrench of the tool, in the axes of the body.
    fn wrench_b(human: &Human, q_rad: &ArmAngles, wrench_t: &Wrench) -> Wrench {
        let r_bt = human.tool_pose_b(q_rad).rotation;
        Wrench::new(r_bt * wrench_t.force_n, r_bt * wrench_t.moment_nm)
    }

    fn moved(q_rad: &ArmAngles, joint: usize, by: f64) -> ArmAngles {
        let mut q_rad = *q_rad;
        q_rad[joint] += by;
        q_rad
    }

    #[test]
    fn the_gradient_equals_central_differences() {
        let wrench_t = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
        for hand in HANDS {
            let (human, mut generator) = (leaning(hand, 8.0), generator(21));
            for direction in [StrengthDirection::Paper, StrengthDirection::Torque] {
                let settings = ComfortSettings { muscular: MuscularMetric::Paper, direction, ..Default::default() };
                let muscular = |q_rad: &ArmAngles| {
                    human.muscular(q_rad, &Pose::identity(), &wrench_b(&human, q_rad, &wrench_t), &settings)
                };
                let mut compared = 0;
                for _ in 0..300 {
                    let q_rad = random_angles(human.arm(), &mut generator);
                    // Where a torque changes its sign or a joint its strength, the slope jumps: postures within a step of
                    // that are left out.
                    let torques = human.joint_torques(&q_rad, &Pose::identity(), &wrench_b(&human, &q_rad, &wrench_t));
                    if torques.operation_nm.iter().chain(&torques.total_nm()).any(|torque| torque.abs() < 1e-3) {
                        continue;
                    }
                    let found = human.muscular_gradient(&q_rad, &wrench_t, &settings);
                    assert_eq!(found.muscular, muscular(&q_rad));
                    for joint in 0..7 {
                        let (back, forth) = (moved(&q_rad, joint, -STEP), moved(&q_rad, joint, STEP));
                        compare(&found, joint, |pick| {
                            (pick(&muscular(&forth)) - pick(&muscular(&back))) / (2.0 * STEP)
                        });
                    }
                    compared += 1;
                }
                assert!(compared > 250, "{compared}");
            }
        }
    }

    /// Angles that are within a step of a value, or a number within a step of zero.
    const KINK: f64 = 1e-4;

    /// True if the intrinsic metric is not smooth within a step of the posture: where a part or a torque changes its sign, where a
    /// strength ends (of the joints beyond the shoulder that is at the limits, which random angles do not reach), and where one
    /// formula follows another.
    fn is_near_kink(human: &Human, q_rad: &ArmAngles, wrench_w: &Wrench) -> bool {
        let torques = human.joint_torques(q_rad, &Pose::identity(), wrench_w);
        let r_vu = human.arm().frames(q_rad).r_bu;
        let shoulder = torques.shoulder_moment(&r_vu);
        let [m_x, m_y, _] = shoulder.moment_v_nm;
        let parts_nm = [shoulder.raising_nm, shoulder.horizontal_nm, shoulder.axial_nm, m_x, m_y];
        let elevation_deg = elevation_rad(&r_vu).to_degrees();
        // Ends of abduction and flexion across and behind the body, of the blend near hanging and of that overhead.
        let ends_deg = [30.0, 60.0, 0.2_f64.asin().to_degrees(), 150.0, 170.0].map(|end_deg| elevation_deg - end_deg);
        let twist_ends_deg = [-90.0, 90.0].map(|end_deg| twist_rad(&r_vu).to_degrees() - end_deg);
        let zeros = [r_vu.m13, r_vu.m23];
        parts_nm
            .iter()
            .chain(&torques.total_nm()[3..])
            .chain(&ends_deg)
            .chain(&twist_ends_deg)
            .chain(&zeros)
            .any(|value| value.abs() < KINK)
    }

    #[test]
    fn the_intrinsic_gradient_equals_central_differences() {
        let wrench_t = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
        let settings = ComfortSettings { muscular: MuscularMetric::Intrinsic, ..Default::default() };
        for hand in HANDS {
            let (human, mut generator) = (leaning(hand, 8.0), generator(23));
            let wrench_w = |q_rad: &ArmAngles| wrench_b(&human, q_rad, &wrench_t);
            let muscular = |q_rad: &ArmAngles| human.muscular(q_rad, &Pose::identity(), &wrench_w(q_rad), &settings);
            let mut compared = [0; 2];
            for round in 0..2_000 {
                let mut q_rad = random_angles(human.arm(), &mut generator);
                let is_hanging = round % 2 == 0;
                if is_hanging {
                    // Up to 11.5 degrees, where raising is blended into flexion and abduction.
                    let mut within = |low: f64, high: f64| generator.random_range(low..high);
                    let shoulder = shoulder_angles(within(0.002, 0.2), within(-PI, PI), within(-1.5, 1.5));
                    q_rad[..3].copy_from_slice(&shoulder);
                }
                if is_near_kink(&human, &q_rad, &wrench_w(&q_rad)) {
                    continue;
                }
                let found = human.muscular_gradient(&q_rad, &wrench_t, &settings);
                assert_eq!(found.muscular, muscular(&q_rad));
                for joint in 0..7 {
                    let [back, forth] = [-STEP, STEP].map(|by| muscular(&moved(&q_rad, joint, by)));
                    compare_squares(&found, joint, &[back, forth], &q_rad);
                }
                compared[usize::from(is_hanging)] += 1;
            }
            assert!(compared.iter().all(|count| *count > 950), "{compared:?}");
        }
    }

    /// Compares the slopes of the squares of activations, since near hanging an activation is the root of a sum.
    fn compare_squares(found: &MuscularGradient, joint: usize, around: &[Muscular; 2], q_rad: &ArmAngles) {
        let slope = |of: &dyn Fn(&Muscular) -> f64| (of(&around[1]) - of(&around[0])) / (2.0 * STEP);
        let expected = slope(&|muscular| muscular.regularised);
        // As for the paper's metric.
        let error = (found.regularised[joint] - expected).abs();
        assert!(error < 2e-6 * (1.0 + expected.abs()), "{joint}: {} {expected} {q_rad:?}", found.regularised[joint]);
        for (i, row) in found.activations.iter().enumerate() {
            let square = 2.0 * found.muscular.activations[i] * row[joint];
            let expected = slope(&|muscular| muscular.activations[i].powi(2));
            // Squares of order one: rounding 1e-15 / step; the azimuth's third derivative is 1 / 0.002^3 with a weight of
            // 3 (0.002 / 0.2)^2 times step^2.
            assert!(
                (square - expected).abs() < 1e-7 * (1.0 + expected.abs()),
                "{i} {joint}: {square} {expected} {q_rad:?}"
            );
        }
    }

    fn compare(found: &MuscularGradient, joint: usize, slope: impl Fn(&dyn Fn(&Muscular) -> f64) -> f64) {
        // Comforts up to 100: rounding 1e-14 x 100 / step = 1e-6, third derivative times step^2 less.
        let expected = slope(&|muscular| muscular.regularised);
        let error = (found.regularised[joint] - expected).abs();
        assert!(error < 2e-6 * (1.0 + expected.abs()), "joint {joint}: {} {expected}", found.regularised[joint]);
        for (i, row) in found.activations.iter().enumerate() {
            let expected = slope(&|muscular| muscular.activations[i]);
            assert!((row[joint] - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{i} {joint}: {row:?} {expected}");
        }
    }

    #[test]
    fn points_of_the_arm_move_as_the_axes_say() {
        let x_wb = standing_pose_w(1.0, 0.2, 2.5, -0.9);
        for hand in HANDS {
            let (human, mut generator) = (leaning(hand, 8.0), generator(22));
            for _ in 0..100 {
                let q_rad = random_angles(human.arm(), &mut generator);
                let axes = human.arm_axes_w(&x_wb, &q_rad);
                let (points, capsules) = (human.body_points_w(&x_wb, &q_rad), human.capsules_w(&x_wb, &q_rad));
                for joint in 0..7 {
                    let [back, forth] = [-STEP, STEP].map(|by| moved(&q_rad, joint, by));
                    let velocity =
                        |moves: bool, p_w| if moves { axes.velocity_w(joint, p_w) } else { Default::default() };
                    // Positions of order one: rounding 1e-16 / step.
                    let near = |found: nalgebra::Vector3<f64>, slope: nalgebra::Vector3<f64>| {
                        assert!((found - slope * 0.5 / STEP).norm() < 1e-8)
                    };
                    let there = [&back, &forth].map(|q_rad| human.body_points_w(&x_wb, q_rad));
                    for (number, p_w) in points.iter().enumerate() {
                        near(velocity(joint < body_point_joints(number), p_w), there[1][number] - there[0][number]);
                    }
                    let there = [&back, &forth].map(|q_rad| human.capsules_w(&x_wb, q_rad));
                    for (number, capsule) in capsules.iter().enumerate() {
                        let moves = joint < BodyPart::joints(capsule.name);
                        near(velocity(moves, &capsule.p0_w), there[1][number].p0_w - there[0][number].p0_w);
                        near(velocity(moves, &capsule.p1_w), there[1][number].p1_w - there[0][number].p1_w);
                    }
                }
            }
        }
    }
}
