//! How the regularised muscular comfort changes with the angles of the arm.
//!
//! The tool's wrench keeps its direction in the world, as it does when the board stays and the arm moves. With the load k
//! a force `F_k` at `p_k` (the tool's at the tip, with a moment `m`, and those that hold up the weights), joint i's axis
//! `a_i` through `o_i`, and `k > i` for the loads beyond joint i:
//!
//! ```text
//! tau_i = a_i . (m + sum_{k > i} (p_k - o_i) x F_k)
//! d tau_i / d q_j = a_i . sum_{k > j} (a_j x (p_k - o_j)) x F_k                                       for j >= i
//!                 = (a_j x a_i) . M_i + a_i . sum_{k > i} (a_j x (p_k - o_i)) x F_k                   for j < i
//! d (1 / (E + eps)) / d q_j = -(dE / d q_j) / (E + eps)^2,   E = sum alpha_i^2,   alpha_i = tau_i / tau_max,i(q_i)
//! ```
//!
//! It is not defined where a joint changes between its two strengths, and at the ends of their ranges; there it is that
//! of the strength which [`super::muscular`] picks.

use nalgebra::Vector3;

use super::{
    arm::{Arm, ArmAngles, ArmFrames},
    body::Body,
    muscular::{self, RESTING},
    strength::Strength,
};
use crate::model::{scenario::StrengthDirection, wrench::Wrench};

/// What the arm carries.
#[derive(Clone, Copy, Debug)]
pub struct Load<'a> {
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

/// The gradient of `1 / (||alpha||^2 + 0.01)` with respect to the angles of a right arm, 1/rad.
pub fn regularised_gradient(
    arm: &Arm,
    body: &Body,
    strength: &Strength,
    q_rad: &ArmAngles,
    load: &Load<'_>,
    direction: StrengthDirection,
) -> [f64; 7] {
    let torques = muscular::joint_torques(arm, body, load.tool_kg, q_rad, load.wrench_b, load.gravity_b);
    let (total_nm, senses) = (torques.total_nm(), torques.senses(q_rad, strength, direction));
    let frames = arm.frames(q_rad);
    let forces = forces(arm, body, &frames, load);
    let limits_nm: [f64; 7] = std::array::from_fn(|i| strength.torque_nm(i, q_rad[i], senses[i]));
    let effort: f64 = (0..7).map(|i| (total_nm[i] / limits_nm[i]).powi(2)).sum();
    let scale = -1.0 / (effort + RESTING).powi(2);
    std::array::from_fn(|j| {
        let by_torques: f64 = (0..7)
            .map(|i| {
                let slope = torque_slope(&frames, &forces, &load.wrench_b.moment_nm, i, j);
                2.0 * total_nm[i] * slope / limits_nm[i].powi(2)
            })
            .sum();
        let limit_slope = strength.slope_nm_rad(j, q_rad[j], senses[j]);
        let by_strength = -2.0 * total_nm[j].powi(2) * limit_slope / limits_nm[j].powi(3);
        scale * (by_torques + by_strength)
    })
}

/// The tool's force and those that hold up the weights, from the shoulder outward, the tool's last.
fn forces(arm: &Arm, body: &Body, frames: &ArmFrames, load: &Load<'_>) -> [Force; 5] {
    let [upper_arm, forearm, hand, tool] = muscular::weights(body, load.tool_kg, frames)
        .map(|(mass_kg, p_b_m)| Force { force_n: load.gravity_b * -mass_kg, p_b_m });
    let tip = Force { force_n: load.wrench_b.force_n, p_b_m: frames.hand_point_b(&arm.x_ht.translation.vector) };
    [upper_arm, forearm, hand, tool, tip]
}

/// The forces beyond a joint. The forearm's centre of mass lies on the axis of pronation.
fn beyond(forces: &[Force; 5], joint: usize) -> &[Force] {
    match joint {
        0..=2 => forces,
        3 => &forces[1..],
        _ => &forces[2..],
    }
}

/// `d tau_i / d q_j`, N m/rad: the module's text derives it.
fn torque_slope(frames: &ArmFrames, forces: &[Force; 5], moment: &Vector3<f64>, i: usize, j: usize) -> f64 {
    let (a_i, a_j) = (&frames.axes_b[i], &frames.axes_b[j]);
    // Only what is beyond both joints moves against joint i; it moves as if carried by the farther of the two.
    let farther = i.max(j);
    let origin = frames.joint_origin_m(farther);
    let moved: Vector3<f64> =
        beyond(forces, farther).iter().map(|f| a_j.cross(&(f.p_b_m - origin)).cross(&f.force_n)).sum();
    if j >= i {
        return a_i.dot(&moved);
    }
    let about_joint: Vector3<f64> = beyond(forces, i).iter().map(|f| (f.p_b_m - origin).cross(&f.force_n)).sum();
    a_j.cross(a_i).dot(&(moment + about_joint)) + a_i.dot(&moved)
}

#[cfg(test)]
mod tests {
    use crate::{
        human::{
            standing_pose_w,
            testing::{generator, random_angles, worker},
        },
        model::{
            operation::OperationKind,
            scenario::{Hand, StrengthDirection},
            wrench::Wrench,
        },
    };

    #[test]
    fn the_gradient_is_the_slope_of_the_comfort() {
        let step = 1e-6;
        let wrench = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
        let x_wb = standing_pose_w(1.0, 0.2, 2.5, -0.9);
        for hand in [Hand::Right, Hand::Left] {
            let (human, mut generator) = (worker(hand, OperationKind::Drill), generator(21));
            for direction in [StrengthDirection::Paper, StrengthDirection::Torque] {
                let mut compared = 0;
                for _ in 0..300 {
                    let q_rad = random_angles(human.arm(), &mut generator);
                    let gradient = human.regularised_gradient(&q_rad, &x_wb, &wrench, direction);
                    // Where a joint changes between its strengths the slope jumps: postures within a step of that are
                    // left out.
                    let torques = human.joint_torques(&q_rad, &x_wb, &wrench);
                    let deciding = match direction {
                        StrengthDirection::Paper => torques.operation_nm,
                        StrengthDirection::Torque => torques.total_nm(),
                    };
                    if deciding.iter().any(|torque| torque.abs() < 1e-3) {
                        continue;
                    }
                    let comfort = |joint: usize, by: f64| {
                        let mut q_rad = q_rad;
                        q_rad[joint] += by;
                        human.muscular(&q_rad, &x_wb, &wrench, direction).regularised
                    };
                    for (joint, found) in gradient.into_iter().enumerate() {
                        let slope = (comfort(joint, step) - comfort(joint, -step)) / (2.0 * step);
                        // Comforts up to 100: rounding 1e-14 x 100 / step = 1e-6, third derivative times step^2 less.
                        let apart = (found - slope).abs();
                        assert!(apart < 2e-6 * (1.0 + slope.abs()), "joint {joint}: {found} {slope}");
                    }
                    compared += 1;
                }
                assert!(compared > 250, "{compared}");
            }
        }
    }
}
