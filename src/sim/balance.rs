//! Balance of momentum and energy, computed beside the engine in every step (docs/method.md#75-self-checks).
//!
//! It uses only poses, velocities and forces of the engine, so it detects errors of the engine's solver. It must not
//! change the simulation.

use nalgebra::{UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{PhysicsWorld, RigidBody, RigidBodyHandle};

use super::convert;
use crate::model::{GRAVITY_W, frames::Pose, wrench::Wrench};

/// State of a joint, for the work of its drive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct JointState {
    /// Position, rad or m.
    pub position: f64,
    /// Velocity, rad/s or m/s.
    pub velocity: f64,
}

/// Work of a drive between two states, J: the mean of its effort `stiffness (rest - q) - damping q'` times the
/// displacement (trapezoid rule).
pub(super) fn drive_work_j(stiffness: f64, damping: f64, rest: f64, states: [JointState; 2]) -> f64 {
    let [before, after] =
        states.map(|JointState { position, velocity }| stiffness * (rest - position) - damping * velocity);
    (before + after) / 2.0 * (states[1].position - states[0].position)
}

/// Weight of a body, N. The board's is not its inertia times gravity, see `world::inertial_mass_kg`.
pub(super) fn weight_n(body: &RigidBody) -> Vector3<f64> {
    GRAVITY_W * (body.mass() * body.gravity_scale())
}

/// Kinetic and gravitational energy of a body, J.
pub(super) fn mechanical_energy_j(body: &RigidBody) -> f64 {
    body.kinetic_energy() - weight_n(body).dot(&convert::from_engine_vector(body.center_of_mass()))
}

/// State of the board and energy of the scene before a step.
pub(super) struct Balance {
    board: RigidBodyHandle,
    x_wo: Pose,
    com_w: Vector3<f64>,
    velocity_m_s: Vector3<f64>,
    energy_j: f64,
    /// The tool's wrench on the board in the step, about its centre of mass, world axes.
    tool_w: Wrench,
    /// Energy added by contacts and integration so far, J.
    pub contact_energy_j: f64,
}

impl Balance {
    /// The balance of a scene that starts with this energy.
    pub fn new(world: &PhysicsWorld, board: RigidBodyHandle, energy_j: f64) -> Self {
        let body = &world.bodies[board];
        Self {
            board,
            x_wo: convert::from_engine_pose(body.position()),
            com_w: convert::from_engine_vector(body.center_of_mass()),
            velocity_m_s: convert::from_engine_vector(body.linvel()),
            energy_j,
            tool_w: Wrench::default(),
            contact_energy_j: 0.0,
        }
    }

    /// Records the state before a step and the tool's wrench in it, about a point, world axes.
    pub fn begin_step(&mut self, world: &PhysicsWorld, tool_w: &Wrench, p_wt_m: &Vector3<f64>) {
        let body = &world.bodies[self.board];
        self.x_wo = convert::from_engine_pose(body.position());
        self.com_w = convert::from_engine_vector(body.center_of_mass());
        self.velocity_m_s = convert::from_engine_vector(body.linvel());
        self.tool_w = tool_w.about(&(p_wt_m - self.com_w));
    }

    /// Updates the balance after a step, from the scene's energy and the work of servos and fingers in the step.
    pub fn end_step(&mut self, world: &PhysicsWorld, energy_j: f64, drives_j: f64) {
        let body = &world.bodies[self.board];
        let moved_m = convert::from_engine_vector(body.center_of_mass()) - self.com_w;
        let turned: UnitQuaternion<f64> =
            convert::from_engine_pose(body.position()).rotation * self.x_wo.rotation.inverse();
        let tool_j = self.tool_w.force_n.dot(&moved_m) + self.tool_w.moment_nm.dot(&turned.scaled_axis());
        self.contact_energy_j += energy_j - self.energy_j - drives_j - tool_j;
        self.energy_j = energy_j;
    }

    /// Residual of the board's momentum balance in the last step with these pad forces, N.
    pub fn force_residual_n(&self, world: &PhysicsWorld, pads_w_n: &Vector3<f64>) -> f64 {
        let body = &world.bodies[self.board];
        let change_n = (convert::from_engine_vector(body.linvel()) - self.velocity_m_s)
            * (body.mass() / world.integration_parameters.dt);
        (change_n - pads_w_n - self.tool_w.force_n - weight_n(body)).norm()
    }
}
