//! The pads in the engine and their forces on the board.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{
    CoefficientCombineRule, ColliderBuilder, ColliderHandle, ContactManifold, NEW_CONTACT_BIT, PhysicsWorld,
    RigidBodyHandle,
};

use super::{
    convert,
    pad_shape::{PadLoading, PadPart, Solid, pad_parts},
    world::{pad_groups, substep_s},
};
use crate::{
    model::{frames::Pose, trace::PadSample, wrench::Wrench},
    robot::Pad,
};

/// Handles of the board in the engine.
#[derive(Clone, Copy)]
pub(super) struct BoardHandles {
    /// The body.
    pub body: RigidBodyHandle,
    /// Its collider.
    pub collider: ColliderHandle,
}

/// How a pad touches the board.
#[derive(Clone, Copy)]
pub(super) struct PadContact {
    /// Coulomb coefficient.
    pub friction: f64,
    /// The load on it and the compliance of its contacts.
    pub loading: PadLoading,
    /// The number of the board's collider that it touches.
    pub collider: usize,
}

/// X_GP of the pad of finger `k` (0 on the +y_G side) at zero travel: x_P along x_G, z_P into the object.
pub(super) fn x_gp(pad: &Pad, k: usize) -> Pose {
    let side = if k == 0 { 1.0 } else { -1.0 };
    let z_p = Vector3::y() * -side;
    let axes = Matrix3::from_columns(&[Vector3::x(), z_p.cross(&Vector3::x()), z_p]);
    Isometry3::from_parts(
        Vector3::new(pad.centre_m[0], side * pad.offset_m, pad.centre_m[1]).into(),
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)),
    )
}

/// A pad of the scene.
pub(super) struct SimPad {
    finger: RigidBodyHandle,
    /// P in the finger's body: at the centre of the face, x_P along x_G, z_P into the board.
    x_fp: Pose,
    /// One for each part.
    colliders: [ColliderHandle; 3],
}

impl SimPad {
    /// The pad of finger `k` (0 on the +y_G side), whose body is at `x_gf` at zero travel.
    pub fn new(
        world: &mut PhysicsWorld,
        pad: &Pad,
        k: usize,
        finger: RigidBodyHandle,
        x_gf: &Pose,
        contact: PadContact,
    ) -> Self {
        let x_fp = x_gf.inverse() * x_gp(pad, k);
        Self { finger, x_fp, colliders: insert_parts(world, pad, finger, &x_fp, contact) }
    }

    /// Replaces the contacts, as those of another grasp.
    pub fn replace(&mut self, world: &mut PhysicsWorld, pad: &Pad, contact: PadContact) {
        for collider in self.colliders {
            world.remove_collider(collider);
        }
        self.colliders = insert_parts(world, pad, self.finger, &self.x_fp, contact);
    }

    /// Largest penetration of the pad's contacts with the board before the last step, m; 0 without contact.
    pub fn penetration_m(&self, world: &PhysicsWorld, board: BoardHandles) -> f64 {
        let pairs = self.colliders.iter().filter_map(|part| world.narrow_phase.contact_pair(*part, board.collider));
        let points = pairs.flat_map(|pair| pair.solver_manifolds()).flat_map(|manifold| &manifold.points);
        points.map(|point| -point.dist).fold(0.0, f64::max)
    }

    /// The pad's wrench on the board in the last substep; the engine keeps friction impulses of that one only.
    pub fn observe(&self, world: &PhysicsWorld, board: BoardHandles) -> PadSample {
        let x_wp = convert::from_engine_pose(world.bodies[self.finger].position()) * self.x_fp;
        let p_wp_m = x_wp.translation.vector;
        let mut wrench_w = Wrench::default();
        for collider in &self.colliders {
            let Some(pair) = world.narrow_phase.contact_pair(*collider, board.collider) else { continue };
            for manifold in pair.solver_manifolds() {
                wrench_w =
                    wrench_w + impulse_on_board(world, manifold, board.body, &p_wp_m).scaled(1.0 / substep_s(world));
            }
        }
        PadSample { normal_force_n: wrench_w.force_n.dot(&(x_wp.rotation * Vector3::z())), wrench_w, p_wp_m }
    }
}

/// Inserts the solids of a pad's face.
fn insert_parts(
    world: &mut PhysicsWorld,
    pad: &Pad,
    finger: RigidBodyHandle,
    x_fp: &Pose,
    contact: PadContact,
) -> [ColliderHandle; 3] {
    pad_parts(pad, &contact.loading).map(|PadPart { solid, x_pc, .. }| {
        let collider = match solid {
            Solid::Box { half_m: [x, y, z] } => ColliderBuilder::cuboid(x, y, z),
            Solid::Ball { radius_m } => ColliderBuilder::ball(radius_m),
        };
        let collider = collider
            .density(0.0)
            .friction(contact.friction)
            .friction_combine_rule(CoefficientCombineRule::Multiply)
            .position(convert::to_engine_pose(&(x_fp * x_pc)))
            .collision_groups(pad_groups(contact.collider));
        world.colliders.insert_with_parent(collider, finger, &mut world.bodies)
    })
}

/// Impulse, with its moment about a point, of a manifold's contacts on the board in the last substep, world axes.
fn impulse_on_board(
    world: &PhysicsWorld,
    manifold: &ContactManifold,
    board: RigidBodyHandle,
    about_w: &Vector3<f64>,
) -> Wrench {
    let data = &manifold.data;
    let board_is_first = data.rigid_body1 == Some(board);
    let com_w = world.bodies[board].center_of_mass();
    let mut total = Wrench::default();
    // A point that is not in the solver keeps an old impulse, so only the solver's contacts are read.
    for contact in &data.solver_contacts {
        let Some(point) = manifold.points.get((contact.contact_id[0] & !NEW_CONTACT_BIT) as usize) else { continue };
        let on_first = point.data.warmstart_tangent_world - data.normal * point.data.warmstart_impulse;
        let (impulse, arm) =
            if board_is_first { (on_first, point.data.solver_dp1) } else { (-on_first, point.data.solver_dp2) };
        let p_w = convert::from_engine_vector(com_w + arm);
        total = total + Wrench::from_force(convert::from_engine_vector(impulse)).about(&(p_w - about_w));
    }
    total
}
