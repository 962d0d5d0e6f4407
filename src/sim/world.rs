//! The settings of the engine, each measured (the figures stand in the documentation of [`super`]).

use rapier3d_f64::prelude::{
    Group, IntegrationParameters, InteractionGroups, InteractionTestMode, PhysicsWorld, SpringCoefficients,
};

use super::convert;
use crate::model::GRAVITY_W;

/// Substeps of the engine's solver in a step.
const SUBSTEPS: usize = 4;

/// Sweeps over all contacts that end a substep. With these no board of 0.03 to 2 kg rings between its hands at time
/// steps of 0.5, 1 and 2 ms; with five, boards of 0.1 kg do.
const STABILISATION_SWEEPS: usize = 6;

/// Stiffness of the contacts as a frequency, Hz: the same for all time steps up to 2 ms, so that a hold does not depend
/// on them. Measured with 1500, pads that tilt give way by 2 % more under small loads; with 2500, slip at time steps of
/// 2 and 0.5 ms differs by up to 10 % where it is more than 0.01 mm, with 3000 by 15 %.
const CONTACT_FREQUENCY_HZ: f64 = 2000.0;

/// Mass of the lightest board that contacts of that frequency hold, kg. Lighter ones, between arms a hundred times as
/// heavy, would ring: theirs falls with the root of the mass.
const NOMINAL_BOARD_KG: f64 = 0.1;

/// The largest number of a contact's oscillations in a substep: reached at a time step of 2 ms. Longer steps get softer
/// contacts, for they would ring too.
const MAX_OSCILLATIONS: f64 = 1.0;

/// Damping of the contacts, as a multiple of the critical one.
const CONTACT_DAMPING_RATIO: f64 = 10.0;

/// How near points of a pad and a board must come to count as contacts, m. The points of a pad's recessed face lie
/// farther off as long as they do not bear: as contacts they would cost a third of the sweeps, and make light boards
/// ring.
const PREDICTION_M: f64 = 1e-6;

/// A world under gravity with nothing in it, for a board of this mass, its contacts stiffer by a factor than they are
/// as a rule.
pub(super) fn new_world(timestep_s: f64, contact_stiffness_scale: f64, board_kg: f64) -> PhysicsWorld {
    // A spring's frequency goes with the root of its stiffness.
    let frequency_hz = contact_frequency_hz(timestep_s / SUBSTEPS as f64, board_kg) * contact_stiffness_scale.sqrt();
    let softness = SpringCoefficients::new(frequency_hz, CONTACT_DAMPING_RATIO);
    PhysicsWorld {
        gravity: convert::to_engine_vector(&GRAVITY_W),
        integration_parameters: IntegrationParameters {
            dt: timestep_s,
            num_solver_iterations: SUBSTEPS,
            num_internal_pgs_iterations: 1,
            num_internal_stabilization_iterations: STABILISATION_SWEEPS,
            contact_softness: softness,
            static_contact_softness: softness,
            // A recycled contact outlives the geometry: a hand would hold on to a board that it has left.
            contact_recycling: false,
            // Clustering would merge the parts of a pad into one with four corners.
            contact_clustering: false,
            // Without friction before the positions move on, every change of a load slides a board by
            // `change * substep^2 / mass`: 0.04 mm under 30 N with the foam board, a quarter of the substep a sixteenth.
            friction_in_bias_pass: true,
            normalized_prediction_distance: PREDICTION_M,
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
fn contact_frequency_hz(substep_s: f64, board_kg: f64) -> f64 {
    let of_board_hz = CONTACT_FREQUENCY_HZ * (board_kg / NOMINAL_BOARD_KG).sqrt().min(1.0);
    of_board_hz.min(MAX_OSCILLATIONS / substep_s)
}

/// Softness of the contacts, `1 / omega^2` with `omega` their angular frequency, s^2: two bodies that oppose the mass
/// `m` to a push sink in by `F / (m omega^2)`.
pub(super) fn contact_softness_s2(world: &PhysicsWorld) -> f64 {
    let omega_rad_s = std::f64::consts::TAU * world.integration_parameters.contact_softness.natural_frequency;
    1.0 / (omega_rad_s * omega_rad_s)
}

/// Pads touch the board and nothing else.
pub(super) fn pad_groups() -> InteractionGroups {
    InteractionGroups::new(Group::GROUP_1, Group::GROUP_2, InteractionTestMode::And)
}

/// The board touches the pads and nothing else.
pub(super) fn board_groups() -> InteractionGroups {
    InteractionGroups::new(Group::GROUP_2, Group::GROUP_1, InteractionTestMode::And)
}
