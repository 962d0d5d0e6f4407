//! The settings of the engine, each measured (the figures stand in the documentation of [`super`]).

use rapier3d_f64::prelude::{
    Group, IntegrationParameters, InteractionGroups, InteractionTestMode, PhysicsWorld, SpringCoefficients,
};

use super::border;
use crate::model::GRAVITY_W;

/// Substeps of the engine's solver in a step.
const SUBSTEPS: usize = 4;

/// Sweeps over all contacts that end a substep. With one of them a change of load slides light boards a little, and at
/// this stiffness they ring between their hands; with six no board of 0.03 to 2 kg does, at time steps of 1, 2 and
/// 4 ms.
const STABILISATION_SWEEPS: usize = 6;

/// Stiffness of the contacts: oscillations in a substep. Measured with one, light boards sit twice as soft in their
/// hands; with three, some boards ring.
const CONTACT_OSCILLATIONS: f64 = 1.5;

/// Damping of the contacts, as a multiple of the critical one.
const CONTACT_DAMPING_RATIO: f64 = 10.0;

/// A world under gravity with nothing in it, its contacts stiffer by a factor than they are as a rule.
pub(super) fn new_world(timestep_s: f64, contact_stiffness_scale: f64) -> PhysicsWorld {
    // A spring's frequency goes with the root of its stiffness.
    let frequency_hz = contact_frequency_hz(timestep_s / SUBSTEPS as f64) * contact_stiffness_scale.sqrt();
    let softness = SpringCoefficients::new(frequency_hz, CONTACT_DAMPING_RATIO);
    PhysicsWorld {
        gravity: border::vector(&GRAVITY_W),
        integration_parameters: IntegrationParameters {
            dt: timestep_s,
            num_solver_iterations: SUBSTEPS,
            num_internal_pgs_iterations: 1,
            num_internal_stabilization_iterations: STABILISATION_SWEEPS,
            contact_softness: softness,
            static_contact_softness: softness,
            // A recycled contact outlives the geometry: a hand would hold on to a board that it has left.
            contact_recycling: false,
            // Clustering would merge the two boxes of a pad into one with four corners.
            contact_clustering: false,
            // Friction that answers the solver's corrections of penetration too makes some boards ring.
            friction_in_bias_pass: false,
            normalized_prediction_distance: 0.002,
            ..IntegrationParameters::default()
        },
        ..PhysicsWorld::default()
    }
}

/// Length of a substep, s.
pub(super) fn substep_s(world: &PhysicsWorld) -> f64 {
    world.integration_parameters.dt / world.integration_parameters.num_solver_iterations as f64
}

/// Stiffness of the contacts as a frequency, Hz.
fn contact_frequency_hz(substep_s: f64) -> f64 {
    CONTACT_OSCILLATIONS / substep_s
}

/// How deep contacts sink that press a free body of this mass with this force, m: `F / (m omega^2)`, with
/// `omega` the contacts' angular frequency.
pub(super) fn penetration_m(world: &PhysicsWorld, force_n: f64, mass_kg: f64) -> f64 {
    let omega_rad_s = std::f64::consts::TAU * world.integration_parameters.contact_softness.natural_frequency;
    force_n / (mass_kg * omega_rad_s * omega_rad_s)
}

/// Pads touch the board and nothing else.
pub(super) fn pad_groups() -> InteractionGroups {
    InteractionGroups::new(Group::GROUP_1, Group::GROUP_2, InteractionTestMode::And)
}

/// The board touches the pads and nothing else.
pub(super) fn board_groups() -> InteractionGroups {
    InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And)
}
