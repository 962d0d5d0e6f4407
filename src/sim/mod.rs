//! The rapier simulation of a hold: settle, ramp, hold, release.

mod arm;
mod bodies;
mod border;
mod chain;
mod check;
mod gripper;
mod load;
mod pad;
mod scene;
mod servo;

use load::LoadProfile;
pub use scene::Scene;

use crate::{
    model::{
        plan::Plan,
        scenario::SimulationSettings,
        trace::{ArmSample, ArmTrace, PadSample, Phase, Sample, Trace},
        wrench::Wrench,
    },
    robot::Robot,
};

/// Simulates a hold: settle, ramp, hold, release.
///
/// The board is held by the plan's arms, whose servos keep the planned angles against the torque limits of the
/// robot, under gravity and the operation's wrench. The wrench acts at the tool point and turns with the board: nothing
/// while settling, growing evenly in the ramp, whole in the hold, nothing after. `friction` is the Coulomb coefficient
/// between pads and board.
///
/// A simulation that breaks down is no error: its trace ends with the last state that can be believed and says why in
/// [`Trace::broke_down`]. Equal inputs give equal traces, bit by bit.
///
/// # Errors
/// [`SimError`] when the plan does not fit the robot or itself, or the settings make no sense.
pub fn simulate(robot: &Robot, plan: &Plan, friction: f64, settings: &SimulationSettings) -> Result<Trace, SimError> {
    let profile = LoadProfile::new(settings)?;
    let mut scene = Scene::new(robot, plan, friction, settings.timestep_s)?;
    let mut trace = empty_trace(robot, plan, profile.steps() + 1);
    for step in 0..=profile.steps() {
        let (phase, load_factor) = profile.at(step);
        if step > 0 {
            scene.step(load_factor);
        }
        let time_s = step as f64 * settings.timestep_s;
        if let Some(reason) = scene.breakdown() {
            trace.samples.truncate(step);
            trace.broke_down = Some(format!("at {time_s:.3} s {reason}"));
            break;
        }
        let sample = &mut trace.samples[step];
        (sample.time_s, sample.phase) = (time_s, phase);
        scene.observe(load_factor, sample);
    }
    Ok(trace)
}

/// A trace with room for every sample, so that the steps allocate nothing of ours.
fn empty_trace(robot: &Robot, plan: &Plan, samples: usize) -> Trace {
    let arms = plan.arms.iter().map(|hold| {
        let arm = robot.arms.iter().find(|arm| arm.name == hold.name);
        ArmTrace {
            name: hold.name.clone(),
            joints: hold.joints.clone(),
            effort_nm: arm.map(|arm| arm.effort_nm.clone()).unwrap_or_default(),
            pads: arm
                .map(|arm| [0, 1].map(|finger| arm.gripper.pad_name(finger, &hold.x_og).to_owned()).to_vec())
                .unwrap_or_default(),
            grip_force_n: hold.grip_force_n,
        }
    });
    Trace {
        arms: arms.collect(),
        p_ot_m: plan.operation.x_ot.translation.vector,
        samples: vec![blank_sample(plan); samples],
        broke_down: None,
    }
}

/// A sample of the right shape, with nothing observed yet.
pub fn blank_sample(plan: &Plan) -> Sample {
    let pad = PadSample { normal_force_n: 0.0, wrench_w: Wrench::default(), p_wp_m: nalgebra::Vector3::zeros() };
    let arms = plan.arms.iter().map(|hold| ArmSample {
        q_rad: hold.q_rad.clone(),
        finger_m: vec![0.0; 2],
        torque_demanded_nm: vec![0.0; hold.q_rad.len()],
        torque_applied_nm: vec![0.0; hold.q_rad.len()],
        x_oc: nalgebra::Isometry3::identity(),
        pads: vec![pad; 2],
    });
    Sample {
        time_s: 0.0,
        phase: Phase::Settle,
        load_factor: 0.0,
        tool_wrench_w: Wrench::default(),
        x_wo: plan.object.x_wo,
        arms: arms.collect(),
    }
}

/// Why a plan cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// A setting that makes no sense.
    #[error("found {key} = {found}, expected {expected}")]
    Settings {
        /// The setting.
        key: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A board without size or mass.
    #[error("found {key} = {found}, expected a positive number")]
    Board {
        /// The figure.
        key: &'static str,
        /// Its value.
        found: f64,
    },
    /// An operation that is not finite.
    #[error("found a wrench that is not finite, expected N and N m")]
    Wrench,
    /// Nothing holds the board.
    #[error("found no arm that holds the board, expected at least one")]
    NoArm,
    /// An arm that the robot has not.
    #[error("found arm \"{found}\", expected one of {expected}")]
    UnknownArm {
        /// The plan's name.
        found: String,
        /// The robot's names.
        expected: String,
    },
    /// An arm that holds twice.
    #[error("found arm \"{arm}\" twice, expected every arm at most once")]
    ArmTwice {
        /// The arm.
        arm: String,
    },
    /// Joints that are not those of the arm.
    #[error("arm \"{arm}\": found the joints [{found}], expected [{expected}]")]
    Joints {
        /// The arm.
        arm: String,
        /// The plan's joints.
        found: String,
        /// The robot's joints.
        expected: String,
    },
    /// The wrong number of angles, or angles that are not finite.
    #[error("arm \"{arm}\": found {found} angles, expected {expected} that are finite")]
    Angles {
        /// The arm.
        arm: String,
        /// How many the plan has.
        found: usize,
        /// How many joints the arm has.
        expected: usize,
    },
    /// A force that the gripper has not.
    #[error("arm \"{arm}\": found a grip force of {found_n} N, expected more than 0 and at most {max_n} N")]
    GripForce {
        /// The arm.
        arm: String,
        /// The plan's force, N.
        found_n: f64,
        /// The gripper's largest force, N.
        max_n: f64,
    },
    /// A board that does not fit between the pads.
    #[error(
        "arm \"{arm}\": found a board {:.1} mm thick, expected {:.1} to {:.1} mm, what the gripper closes on",
        thickness_m * 1e3, closed_m * 1e3, open_m * 1e3
    )]
    Opening {
        /// The arm.
        arm: String,
        /// Thickness of the board, m.
        thickness_m: f64,
        /// Gap between the pads when closed, m.
        closed_m: f64,
        /// Gap between the pads when open, m.
        open_m: f64,
    },
    /// Fingers that do not close on the board's faces.
    #[error(
        "arm \"{arm}\": found its fingers {off_mm:.3} mm and {off_deg:.3} degrees off the board's middle plane, expected \
         at most 1 mm and 0.1 degrees"
    )]
    Astride {
        /// The arm.
        arm: String,
        /// Distance of G from the middle plane of the board, mm.
        off_mm: f64,
        /// Angle between the finger axis and the board's normal, degrees.
        off_deg: f64,
    },
    /// Angles that put the gripper elsewhere than the plan says.
    #[error(
        "arm \"{arm}\": found its gripper {off_mm:.3} mm and {off_deg:.3} degrees from where it should hold the board, \
         expected at most 1 mm and 0.1 degrees"
    )]
    HandOff {
        /// The arm.
        arm: String,
        /// Distance, mm.
        off_mm: f64,
        /// Angle, degrees.
        off_deg: f64,
    },
    /// A part that moves without mass.
    #[error("found no mass on link \"{link}\" and what is fixed to it, expected a mass: it moves")]
    Massless {
        /// The link.
        link: String,
    },
    /// The engine refused a part of the scene.
    #[error("failed to build the scene: the robot's joints do not form a tree")]
    Engine,
}
