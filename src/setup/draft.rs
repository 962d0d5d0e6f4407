//! The draft of a description: what was found, and the figures that are assumed.

use super::{
    hand::{Hand, hand},
    skeleton::{self, Run},
};
use crate::robot::{JointKind, Robot};

/// Stiffness of a joint over its effort, 1/rad: that of Baxter's joints with 50 N m, 843 N m/rad.
const STIFFNESS_PER_EFFORT: f64 = 17.0;

/// The same for prismatic joints, 1/m: 0.3 m from the axis, the lever of half a small arm.
const STIFFNESS_PER_FORCE: f64 = 55.0;

/// Damping over stiffness, s: that of the same joints.
const DAMPING_S: f64 = 0.036;

/// Efforts of joints for which the URDF has none, N m: those of the first joints, and of the last three.
const ASSUMED_EFFORT_NM: [f64; 2] = [50.0, 15.0];

/// Largest force of a finger, N: assumed.
pub(super) const ASSUMED_FORCE_N: f64 = 60.0;

/// Force with which a scenario closes the gripper, N, and friction of pads on a board: assumed.
pub(super) const ASSUMED_GRIP_N: f64 = 45.0;
pub(super) const ASSUMED_FRICTION: f64 = 0.6;

/// An arm of the draft.
pub(super) struct ArmDraft {
    pub name: String,
    pub run: Run,
    pub hand: Hand,
    pub effort_nm: Vec<f64>,
    /// True if the URDF has no effort for one of them.
    pub effort_is_assumed: bool,
    pub stiffness_nm_rad: Vec<f64>,
    pub damping_nm_s_rad: Vec<f64>,
}

/// The arms of a robot without arms; `effort` is that of the URDF's joints.
pub(super) fn arms(robot: &Robot, effort: &[f64]) -> Vec<ArmDraft> {
    let runs = skeleton::arms(robot);
    let names = skeleton::names(robot, &runs);
    let mut named: Vec<(Run, String)> = runs.into_iter().zip(names).collect();
    named.sort_by(|a, b| a.1.cmp(&b.1));
    let draft = |(run, name): (Run, String)| {
        let hand = hand(robot, &run);
        let given = run.joints.iter().map(|&joint| effort[joint]);
        let is_usable = |effort: &f64| effort.is_finite() && *effort > 0.0;
        let effort_is_assumed = !given.clone().all(|effort| is_usable(&effort));
        let count = run.joints.len();
        let effort_nm: Vec<f64> = given
            .enumerate()
            .map(|(place, effort)| {
                let [first, last] = ASSUMED_EFFORT_NM;
                if is_usable(&effort) {
                    effort
                } else if place + 3 < count {
                    first
                } else {
                    last
                }
            })
            .collect();
        let stiffness = run.joints.iter().zip(&effort_nm).map(|(&joint, effort)| {
            let slides = robot.joints[joint].kind == JointKind::Prismatic;
            (effort * if slides { STIFFNESS_PER_FORCE } else { STIFFNESS_PER_EFFORT }).round()
        });
        let stiffness_nm_rad: Vec<f64> = stiffness.map(|stiffness| stiffness.max(1.0)).collect();
        let damping = stiffness_nm_rad.iter().map(|stiffness| (stiffness * DAMPING_S * 10.0).round().max(1.0) / 10.0);
        ArmDraft {
            damping_nm_s_rad: damping.collect(),
            name,
            run,
            hand,
            effort_nm,
            effort_is_assumed,
            stiffness_nm_rad,
        }
    };
    named.into_iter().map(draft).collect()
}
