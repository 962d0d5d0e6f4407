//! Settings of the engine, from measurements (see the documentation of [`super`]).

use rapier3d_f64::prelude::{
    Group, IntegrationParameters, InteractionGroups, InteractionTestMode, PhysicsWorld, SpringCoefficients,
};

use super::convert;
use crate::model::{GRAVITY_W, plan::PlacedObject};

/// Substeps of the engine's solver per step. Every substep computes the mass matrices of the arms, which costs more than its
/// sweeps.
const SUBSTEPS: usize = 3;

/// Sweeps over all contacts in a substep, before positions change.
const SWEEPS: usize = 4;

/// Stabilisation sweeps over all contacts at the end of a substep.
const STABILISATION_SWEEPS: usize = 4;

/// Stiffness of the contacts as a frequency, Hz: the same for all time steps up to 2 ms, so that results do not depend
/// on them. Pads that tilt under small loads yield by up to 4 % more than rigid ones; with 1000, by 9 %. With 2000, or with
/// two substeps, one sliding hand in twenty moves too far at a time step of 2 ms, by up to a quarter.
const CONTACT_FREQUENCY_HZ: f64 = 1500.0;

/// The largest number of periods of a contact in a substep, reached at a time step of 2 ms. Longer steps get softer
/// contacts; otherwise they would oscillate.
const MAX_OSCILLATIONS: f64 = 1.0;

/// Damping of the contacts, as a multiple of the critical one.
const CONTACT_DAMPING_RATIO: f64 = 1.0;

/// The least inertia of a board in the engine, as a mass, kg. The engine scales a contact's stiffness with the effective
/// mass of the two bodies, and its sweeps converge slowly if one is much lighter than the other. With its own inertia
/// alone, a strip of 79 g and boards of 30 g rang between their hands, and their pads were up to thirty times as soft as
/// those on a board of 1 kg. See [`inertial_mass_kg`].
const LEAST_INERTIA_KG: f64 = 1.0;

/// The mass with which a board resists acceleration, kg: its own, or that of a heavier board of its shape. Its weight is
/// always its own.
///
/// The state of rest does not depend on inertia. Between two arms whose effective mass is several kilograms each, the
/// difference changes the frequency of their swing by a few per cent.
pub(super) fn inertial_mass_kg(object: &PlacedObject) -> f64 {
    object.mass_kg.max(LEAST_INERTIA_KG)
}

/// Distance below which points of a pad and a board count as contacts, m. The points of a pad's recessed face are
/// farther away until they carry load: as contacts they would cost a third of the sweeps and make light boards
/// oscillate.
const PREDICTION_M: f64 = 1e-6;

/// Share of the board's inertia that the drive of each finger adds to it.
const DRIVE_SHARE: f64 = 0.3;

/// The inertia that the drive adds to each finger on a board, kg, see `SimGripper::close`.
pub(super) fn drive_inertia_kg(object: &PlacedObject) -> f64 {
    DRIVE_SHARE * inertial_mass_kg(object)
}

/// An empty world under gravity, with contacts stiffer than the default by a factor.
pub(super) fn new_world(timestep_s: f64, contact_stiffness_scale: f64) -> PhysicsWorld {
    // A spring's frequency is proportional to the square root of its stiffness.
    let frequency_hz = contact_frequency_hz(timestep_s / SUBSTEPS as f64) * contact_stiffness_scale.sqrt();
    let softness = SpringCoefficients::new(frequency_hz, CONTACT_DAMPING_RATIO);
    PhysicsWorld {
        gravity: convert::to_engine_vector(&GRAVITY_W),
        integration_parameters: IntegrationParameters {
            dt: timestep_s,
            num_solver_iterations: SUBSTEPS,
            num_internal_pgs_iterations: SWEEPS,
            num_internal_stabilization_iterations: STABILISATION_SWEEPS,
            contact_softness: softness,
            static_contact_softness: softness,
            // A recycled contact outlives the geometry: a hand would stay attached to a board that it has left.
            contact_recycling: false,
            // Clustering would merge the parts of a pad into one box with four corners.
            contact_clustering: false,
            // Without friction in the position update, every change of the load slides the board by `change * substep^2
            // / mass`: 0.04 mm under 30 N with the foam board; a quarter of the substep would give a sixteenth.
            friction_in_bias_pass: true,
            normalized_prediction_distance: PREDICTION_M,
            ..IntegrationParameters::default()
        },
        ..PhysicsWorld::default()
    }
}

/// Sweeps over all constraints of a scene in which hands are joined to the board, before and after positions change. The
/// engine starts a joint of a multibody without the impulses of the last substep.
const JOINT_SWEEPS: usize = 40;

/// Gives a world enough sweeps for joints between arms and board.
pub(super) fn sweep_for_joints(world: &mut PhysicsWorld) {
    world.integration_parameters.num_internal_pgs_iterations = JOINT_SWEEPS;
    world.integration_parameters.num_internal_stabilization_iterations = JOINT_SWEEPS;
}

/// Length of a substep, s.
pub(super) fn substep_s(world: &PhysicsWorld) -> f64 {
    world.integration_parameters.dt / world.integration_parameters.num_solver_iterations as f64
}

/// Stiffness of the contacts as a frequency, Hz.
fn contact_frequency_hz(substep_s: f64) -> f64 {
    CONTACT_FREQUENCY_HZ.min(MAX_OSCILLATIONS / substep_s)
}

/// Softness of the contacts, `1 / omega^2` with `omega` their angular frequency, s^2: two bodies of the effective mass
/// `m` penetrate by `F / (m omega^2)`.
pub(super) fn contact_softness_s2(world: &PhysicsWorld) -> f64 {
    let omega_rad_s = std::f64::consts::TAU * world.integration_parameters.contact_softness.natural_frequency;
    1.0 / (omega_rad_s * omega_rad_s)
}

/// Pads collide with the collider of the board with this number alone, see `board::insert_board`.
pub(super) fn pad_groups(collider: usize) -> InteractionGroups {
    InteractionGroups::new(Group::GROUP_1, board_group(collider), InteractionTestMode::And)
}

/// A collider of the board collides with the pads of its hands alone.
pub(super) fn board_groups(collider: usize) -> InteractionGroups {
    InteractionGroups::new(board_group(collider), Group::GROUP_1, InteractionTestMode::And)
}

/// The group of a collider of the board: every bit but the first.
fn board_group(collider: usize) -> Group {
    Group::from_bits_truncate(1 << (1 + collider % 31))
}
