//! The rapier simulation of a hold: settle, ramp, hold, release.

mod arm;
mod bodies;
mod body_chain;
mod border;
mod check;
mod error;
mod gripper;
mod load;
mod pad;
mod scene;
mod servo;
mod world;

pub use error::SimError;
use load::LoadProfile;
pub use scene::{Scene, blank_sample};

use crate::{
    model::{
        plan::Plan,
        scenario::SimulationSettings,
        trace::{ArmTrace, Trace},
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
        scene.observe(sample);
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
