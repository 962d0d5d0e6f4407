//! The pads: their shape in the engine, and what they do to the board.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{
    ColliderBuilder, ColliderHandle, ContactManifold, NEW_CONTACT_BIT, PhysicsWorld, RigidBodyHandle,
};

use super::{
    border,
    world::{pad_groups, penetration_m, substep_s},
};
use crate::{
    model::{frames::Pose, trace::PadSample, wrench::Wrench},
    robot::Pad,
};

/// Depth of the collider behind a pad's face, m: nothing reaches its back.
const DEPTH_M: f64 = 0.004;

/// The board, as the pads see it.
#[derive(Clone, Copy)]
pub(super) struct TouchedBoard {
    /// The body.
    pub body: RigidBodyHandle,
    /// Its shape.
    pub collider: ColliderHandle,
}

/// How a pad touches the board.
#[derive(Clone, Copy)]
pub(super) struct PadContact {
    /// Coulomb coefficient.
    pub friction: f64,
    /// How far the whole face lies behind the core that carries the load, m.
    recess_m: f64,
}

impl PadContact {
    /// The contact of pads that grip a board of this mass with this force. The recess is twice what the core sinks
    /// in: an evenly pressed pad rests on the core alone, and a pad that tilts meets the edge of its whole face
    /// after a fraction of a milliradian.
    pub fn new(world: &PhysicsWorld, friction: f64, grip_force_n: f64, board_mass_kg: f64) -> Self {
        Self { friction, recess_m: 2.0 * penetration_m(world, grip_force_n, board_mass_kg) }
    }
}

/// Mean distance of a rectangle's points from its centre, m: `(1/A) integral of r dA` for half sides a and b,
/// `(d + a^2/(2b) ln((b+d)/a) + b^2/(2a) ln((a+d)/b)) / 3` with `d` the half diagonal (METHOD section 6).
fn mean_radius_m([a, b]: [f64; 2]) -> f64 {
    let d = a.hypot(b);
    (d + a * a / (2.0 * b) * ((b + d) / a).ln() + b * b / (2.0 * a) * ((a + d) / b).ln()) / 3.0
}

/// A pad as boxes: half sides along x_P and y_P, and how far the box lies behind the face, m.
///
/// The engine holds two flat boxes together in four corners. Corners of the whole face would turn too hard; those of a
/// face shrunk until they lie at its mean radius turn exactly as hard as an evenly pressed face. The whole face, a
/// little recessed, comes to bear where the pad tilts.
fn boxes(half_m: [f64; 2], recess_m: f64) -> [([f64; 2], f64); 2] {
    let [a, b] = half_m;
    let shrink = mean_radius_m(half_m) / a.hypot(b);
    [(half_m.map(|half| half * shrink), 0.0), (half_m, recess_m)]
}

/// A box of a pad.
pub(super) struct PadBox {
    /// Half sides, m.
    pub half_m: [f64; 3],
    /// Pose of its centre in P.
    pub x_pc: Pose,
}

/// The boxes of a pad, its face recessed behind its core.
pub(super) fn pad_boxes(pad: &Pad, recess_m: f64) -> [PadBox; 2] {
    boxes(pad.size_m.map(|side| side / 2.0), recess_m).map(|([x, y], recess_m)| PadBox {
        half_m: [x, y, DEPTH_M / 2.0],
        x_pc: Isometry3::translation(0.0, 0.0, -recess_m - DEPTH_M / 2.0),
    })
}

/// Pose of the pad of finger `k` (0 on the +y_G side) in G when its travel is 0: x_P along x_G, z_P into the object.
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
    /// P in the finger's body: x_P along x_G, z_P into the board, at the centre of the face.
    x_fp: Pose,
    /// The core, then the whole face.
    colliders: [ColliderHandle; 2],
}

impl SimPad {
    /// The pad of finger `k` (0 on the +y_G side), whose body is at `x_gf` when its travel is 0.
    pub fn new(
        world: &mut PhysicsWorld,
        pad: &Pad,
        k: usize,
        finger: RigidBodyHandle,
        x_gf: &Pose,
        contact: PadContact,
    ) -> Self {
        let x_fp = x_gf.inverse() * x_gp(pad, k);
        let colliders = pad_boxes(pad, contact.recess_m).map(|PadBox { half_m: [x, y, z], x_pc }| {
            let collider = ColliderBuilder::cuboid(x, y, z)
                .density(0.0)
                .friction(contact.friction)
                .position(border::engine_pose(&(x_fp * x_pc)))
                .collision_groups(pad_groups());
            world.colliders.insert_with_parent(collider, finger, &mut world.bodies)
        });
        Self { finger, x_fp, colliders }
    }

    /// How deep the pad's contacts with the board sank in before the last step, m: nothing where it does not touch.
    pub fn penetration_m(&self, world: &PhysicsWorld, board: TouchedBoard) -> f64 {
        let pairs = self.colliders.iter().filter_map(|core| world.narrow_phase.contact_pair(*core, board.collider));
        let points = pairs.flat_map(|pair| pair.solver_manifolds()).flat_map(|manifold| &manifold.points);
        points.map(|point| -point.dist).fold(0.0, f64::max)
    }

    /// What the pad does to the board in the last substep: the engine keeps the friction of no other.
    pub fn observe(&self, world: &PhysicsWorld, board: TouchedBoard) -> PadSample {
        let x_wp = border::from_engine_pose(world.bodies[self.finger].position()) * self.x_fp;
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

/// Impulse and its moment about a point that the contacts of a manifold gave the board in the last substep, world axes.
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
    // A point that the solver left out keeps an old impulse, so only the solver's own contacts are read.
    for contact in &data.solver_contacts {
        let Some(point) = manifold.points.get((contact.contact_id[0] & !NEW_CONTACT_BIT) as usize) else { continue };
        let on_first = point.data.warmstart_tangent_world - data.normal * point.data.warmstart_impulse;
        let (impulse, arm) =
            if board_is_first { (on_first, point.data.solver_dp1) } else { (-on_first, point.data.solver_dp2) };
        let p_w = border::from_vector(com_w + arm);
        total = total + Wrench::from_force(border::from_vector(impulse)).about(&(p_w - about_w));
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_radius_is_that_of_the_rectangle() {
        // 14.63 mm for the pad of 40.4 x 36.0 mm (METHOD section 6), given to four digits.
        assert!((mean_radius_m([0.0202, 0.018]) - 0.01463).abs() < 5e-6);
    }
}
