//! The rapier simulation of a grasp under load: a [`CheckedPlan`] in, a [`Trace`] out (docs/method.md#7-simulation).
//!
//! It shows what no static formula does: whether the hands keep their grip while compliant, position-controlled arms
//! deflect. It must not judge the trace, nor depend on how the plan was found.
//!
//! # The scene
//! - The arms of the plan, each a chain of rigid bodies on a fixed root; links without a joint between them are one
//!   body. Each joint has a servo: an implicit spring and damper about the planned angle, the torque that holds the arm and
//!   its share of the board fed forward, and the torque limit by moving the rest angle of the spring.
//! - Grippers: two fingers, coupled to open equally, each pushed with a constant force that reacts on the palm. With
//!   elastic pads the hand is on six springs (`pad_springs.rs`). A measured gripper is joined to the board until its wrench
//!   leaves the limits (`joined_hand.rs`).
//! - The board, a free body under gravity and the tool's wrench over time (`tool_load.rs`). Only pads and board
//!   collide. Joint limits are not modelled: the planned angles are inside them, and servos deflect by milliradians.
//! - The person of the plan stands still and is not part of the dynamics: the trace records their distance from robot
//!   and board, and that of the robot from itself and from the board (`distance_monitor.rs`).
//!
//! # The pads
//! The engine connects two flat boxes at four corner contacts, whose resistance to rotation depends on their distance
//! from the centre. Load capacity of several pads of 40.4 x 36.0 mm, relative to the closed forms (slip `2 mu N - m g`;
//! torsion `2 mu N e`, `e` the mean radius of the face; tilt `N (2 b + mu t)`), all with contacts of 1000 Hz and one
//! stabilisation sweep:
//!
//! | pad | slip | torsion | tilt | creep at 90 % of slip |
//! |---|---|---|---|---|
//! | one box | 0.995..1.000 | 1.85 | 1.01 | 0 |
//! | 2 x 2 boxes | 0.999..1.000 | 1.02 | 1.01 | 4e-6 mm/s |
//! | 2 x 4 boxes | 0.985..0.999 | 1.01 | 1.01 | 7e-4 mm/s |
//! | 4 x 4 boxes | 0.953..0.988 | 0.80 | 1.01 | 5e-2 mm/s |
//! | a core with corners at the mean radius before the whole face | 1.000 | 1.000 | 1.01 | 1e-12 mm/s |
//!
//! The last one holds 9 % too little if force and torsion act together along its diagonals: four corners resist less
//! than a face if the centre of rotation is at one of them. The pads here therefore have a fifth contact at their
//! centre and the corners farther out (`pad_shape.rs`): -4.5 to +3.9 % in every direction.
//!
//! # Accuracy
//! `tests/pinch` compares the simulation with closed forms. Results with the settings of `world.rs` at time steps of 2
//! ms:
//!
//! | what | against | off by |
//! |---|---|---|
//! | slip, five pairs of force and friction | `2 mu N - m g` | less than 0.5 % |
//! | torsion | `2 mu N e` | less than 3 % |
//! | tilt about either axis of the pad | `N (2 b + mu t)` | less than 2 % |
//! | creep at 50 % and 90 % of the slip load | 0 | less than 1e-6 mm/s |
//! | a free arm under 0.5 N | `J (K + dg/dq)^-1 J' f` | less than 0.5 % |
//! | two arms and a board of 0.5 kg, of 0.21 kg, a tenth of the load | `K_O^-1 w` | 4.4 %, 3.0 % (0.006 mm) |
//! | drift without a load in the last 1.7 s of 5 s | 0 | less than 1e-8 m |
//! | slip at 0 to 90 degrees in the pad's plane | Coulomb cone | 0.2 % (the bisection's width) |
//! | force and torsion together, in five directions | limit surface of a uniform patch | -4.5 to +4 % |
//! | shares of two hands in a load of 3 N, their squeeze included | welded hands | 0.01 N |
//! | slip left after a release from 80 % of the slip load | 0 | 6e-4 mm |
//! | drift in 60 s without a load | 0 | 1e-4 mm |
//! | deflection of ten holds, time steps of 2 ms | of 0.5 ms | -0.12 to +0.05 % |
//! | largest rotation of their hands | | -0.2 to +0.1 %, 0.001 degrees where they stick |
//! | largest translation of their hands | | -1.6 to +1.5 %, 0.001 mm where they stick |
//!
//! # The hand-over
//! The grippers close over 0.05 s on a supported board, then the board's weight is applied to the arms, and to their
//! feed-forward, over 0.15 s (`hand_over.rs`). A weight applied at once makes the arms overshoot; hands that slide then keep
//! an offset and rotate less under the load than hands that were loaded slowly. This, and not the pads, explained the
//! difference from the statics. Grippers that close at once knock light boards and small pads.
//!
//! # Time steps
//! The engine scales a contact's stiffness with the effective mass of the two bodies, and its sweeps converge slowly
//! between bodies of very different mass. Boards of 30 to 120 g rang between the hands. What was tried on a strip of 79 g,
//! a board of 31 g, a hand that slides and a Panda's hand of small pads, at steps of 2, 1 and 0.5 ms:
//!
//! | change | effect |
//! |---|---|
//! | inertia of the board of at least 0.2, 0.5, 1, 2 kg, weight unchanged | ringing ends with 0.2; pads on light boards are as stiff as on heavy ones with 1 |
//! | four sweeps in the biased part of a substep in place of one | the slip of a hand at its limit, 0.88 mm at 2 ms and 0.40 at 0.5, becomes 0.35 and 0.33 |
//! | three substeps in place of four | three quarters of the time; with two, one sliding hand in twenty moves too far at 2 ms, with one slips are three times too large |
//! | critical damping of contacts in place of ten times that | hands at their limit converge from 5 % to 2 % between the steps |
//! | drives of the fingers of 0.3 of the board's inertia in place of 1 | light hands do not shake; with 4, they lose the board |
//! | closing over 0.05 s | no knock: penetration in the first 20 ms from 0.6 to 0.01 mm |
//! | softer contacts (500 Hz), fewer stabilisation sweeps (2) | small pads yield by 10 % more; self-checks fail |
//!
//! # Performance
//! Nearly all of a step is the engine's: mass matrices and Coriolis terms with their factorisation in each of the three
//! substeps, contact rows and sweeps, forward kinematics. Reading the state and the balance take below 1 %, the person's
//! distance at most 1 %, the robot's from itself about 3 %. `benches/sim.rs` measures it.

mod arm;
mod balance;
mod board;
mod bodies;
mod body_chain;
mod conditions;
mod convert;
mod distance_monitor;
mod error;
mod feed_forward;
mod gripper;
mod hand;
mod hand_over;
mod joined_hand;
mod mjcf;
mod pad;
mod pad_shape;
mod pad_springs;
mod phases;
mod scene;
mod servo;
mod staged;
mod tool_load;
mod world;

pub use conditions::{Conditions, LateralDirection};
use distance_monitor::DistanceMonitor;
pub use error::SimError;
pub use mjcf::mjcf;
pub use scene::{SimScene, blank_sample};
pub use staged::{simulate_staged, step_back_w};
use tool_load::ToolLoad;

use crate::{
    check::{CheckedArm, CheckedPlan},
    model::{
        stop::{Never, Stop},
        trace::{ArmTrace, Trace},
    },
    robot::Holding,
};

/// Time without any contact after which the board counts as lost, s: it has then fallen by 5 cm.
const LOST_AFTER_S: f64 = 0.1;

/// Simulates a plan: settle, ramp, hold, release.
///
/// The plan's arms hold the board under gravity and the tool's wrench; their servos keep the planned angles within the
/// robot's torque limits. The wrench acts at the tool tip: zero while settling, increasing in the ramp, full in the
/// hold and zero after it, see [`crate::model::load::Load`].
///
/// The trace ends early if no pad has touched the board for a tenth of a second: the board is lost.
///
/// A simulation that breaks down is not an error: its trace ends with the last valid state, and [`Trace::broke_down`]
/// says why. Equal inputs give equal traces, bit for bit.
///
/// # Errors
/// If the settings or the load over time are invalid, or a moving part of the robot has no mass.
pub fn simulate(checked: &CheckedPlan<'_>, conditions: &Conditions) -> Result<Trace, SimError> {
    simulate_until(checked, conditions, &Never)
}

/// As [`simulate`], until a stop, which is asked for in every step.
///
/// # Errors
/// As [`simulate`], and [`SimError::Stopped`] after a stop.
pub fn simulate_until(checked: &CheckedPlan<'_>, conditions: &Conditions, stop: &dyn Stop) -> Result<Trace, SimError> {
    let tool = ToolLoad::new(checked, conditions)?;
    let timestep_s = conditions.settings.timestep_s;
    let mut scene = SimScene::new(checked, conditions)?;
    let mut distances = DistanceMonitor::of(checked, conditions);
    let mut trace = Trace { p_ot_m: tool.at(0).1.p_ot_m, ..empty_trace(checked, conditions, tool.steps() + 1) };
    let mut untouched_s = 0.0;
    tracing::info!(plan = checked.plan().name, steps = tool.steps(), timestep_s, "simulating");
    for step in 0..=tool.steps() {
        if stop.is_stopped() {
            return Err(SimError::Stopped);
        }
        let (phase, state) = tool.at(step);
        if step > 0 {
            scene.step_under(state);
        }
        let time_s = step as f64 * timestep_s;
        if step == 0 || tool.at(step - 1).0 != phase {
            tracing::debug!(time_s, phase = phase.name(), "a phase begins");
        }
        if let Some(reason) = scene.breakdown() {
            trace.samples.truncate(step);
            trace.broke_down = Some(format!("at {time_s:.3} s {reason}"));
            break;
        }
        let sample = &mut trace.samples[step];
        (sample.time_s, sample.phase) = (time_s, phase);
        scene.observe(sample);
        distances.observe(step, sample);
        // There are no forces before the first step.
        untouched_s = if step == 0 || sample.has_contact() { 0.0 } else { untouched_s + timestep_s };
        if untouched_s > LOST_AFTER_S {
            trace.samples.truncate(step + 1);
            break;
        }
    }
    distances.enter(&mut trace);
    Ok(trace)
}

/// A trace with room for every sample, so that steps do not allocate.
fn empty_trace(checked: &CheckedPlan<'_>, conditions: &Conditions, samples: usize) -> Trace {
    let plan = checked.plan();
    let arms = checked.arms().iter().enumerate().map(|(number, CheckedArm { index, hold, .. })| {
        let grip_scale = conditions.uncertainty.grip_force_scale_of(number);
        let arm = &checked.robot().arms[*index];
        ArmTrace {
            name: hold.name.clone(),
            joints: hold.joints.clone(),
            effort_nm: arm.effort_nm.clone(),
            pads: match &arm.gripper.holding {
                Holding::Pads(_) => [0, 1].map(|finger| arm.gripper.pad_name(finger, &hold.x_og).to_owned()).to_vec(),
                Holding::Measured(_) => Vec::new(),
            },
            grip_force_n: hold.grip_force_n * grip_scale,
            wrench_limits: arm.gripper.holding.measured().map(|measured| measured.limits.scaled(grip_scale)),
        }
    });
    Trace {
        arms: arms.collect(),
        p_ot_m: plan.operation.x_ot.translation.vector,
        samples: vec![blank_sample(checked); samples],
        broke_down: None,
        person_touch: None,
        robot_touch: None,
    }
}
