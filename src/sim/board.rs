//! The board in the engine, and what of it each hand touches (docs/method.md#72-grippers-and-pads).
//!
//! A box is one collider. Of a plate every hand has a collider of its own that collides with its pads alone: the smallest box
//! along the grasped edge that contains the plate. It has the plate's two faces and the grasped edge; beyond the other edges and
//! in the holes it has material that the plate does not have. Pads of a checked plan lie on the material, so the two differ only
//! after a hand has slipped off it. The engine's contacts of two boxes are those that the pads are made for (`pad_shape.rs`):
//! pieces of a polygon would have seams under a pad, with contact points of their own.

use rapier3d_f64::prelude::{ColliderBuilder, MassProperties, PhysicsWorld, RigidBodyBuilder};

use super::{
    bodies::CompositeInertia,
    convert,
    pad::BoardHandles,
    world::{board_groups, inertial_mass_kg},
};
use crate::model::{
    board::{BoardRectangle, BoardShape, Edge},
    frames::Pose,
    grasp::grasped_edge,
    plan::{ArmHold, PlacedObject},
};

/// A box that pads touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TouchedBox {
    /// Its centre and axes in O.
    pub x_ob: Pose,
    /// Half of its sides, m.
    pub half_m: [f64; 3],
}

impl TouchedBox {
    /// What a hand at `x_og` touches.
    pub fn of(board: &BoardShape, x_og: &Pose) -> Self {
        if board.plate.is_none() {
            return Self { x_ob: Pose::identity(), half_m: board.size_m.map(|side| side / 2.0) };
        }
        // A hand that points along the edges, or out of the board, grasps none of them.
        let edge = grasped_edge(x_og, board).unwrap_or(Edge(0));
        let BoardRectangle { x_or, half_m: [x, y] } = board.rectangle_at(edge);
        Self { x_ob: x_or, half_m: [x, y, board.thickness_m() / 2.0] }
    }
}

/// The number of the collider that an arm of the plan touches: one for all of a box, one for each of a plate.
pub(super) fn collider_of(object: &PlacedObject, arm: usize) -> usize {
    if object.plate.is_some() { arm } else { 0 }
}

/// The board's factor of the friction: that of a contact is the product of both sides, and the pads have the coefficient.
const BOARD_FRICTION: f64 = 1.0;

/// Inserts the board as a free body with the inertia of [`inertial_mass_kg`]; one entry per arm of the plan.
pub(super) fn insert_board(world: &mut PhysicsWorld, object: &PlacedObject, arms: &[ArmHold]) -> Vec<BoardHandles> {
    // A sleeping board would not react to the load.
    let body = RigidBodyBuilder::dynamic().pose(convert::to_engine_pose(&object.x_wo)).can_sleep(false);
    let body = if object.is_uniform_box() { body } else { body.additional_mass_properties(mass_properties(object)) };
    let body = world.bodies.insert(body);
    let shape = object.shape();
    let mut handles: Vec<BoardHandles> = Vec::with_capacity(arms.len());
    for (arm, hold) in arms.iter().enumerate() {
        let number = collider_of(object, arm);
        if let Some(&shared) = handles.get(number) {
            handles.push(shared);
            continue;
        }
        let TouchedBox { x_ob, half_m: [hx, hy, hz] } = TouchedBox::of(&shape, &hold.x_og);
        let collider =
            ColliderBuilder::cuboid(hx, hy, hz).friction(BOARD_FRICTION).collision_groups(board_groups(number));
        let collider = if object.is_uniform_box() {
            collider.mass(inertial_mass_kg(object))
        } else {
            collider.density(0.0).position(convert::to_engine_pose(&x_ob))
        };
        let collider = world.colliders.insert_with_parent(collider, body, &mut world.bodies);
        handles.push(BoardHandles { body, collider });
    }
    world.bodies[body].recompute_mass_properties_from_colliders(&world.colliders);
    world.bodies[body].set_gravity_scale(object.mass_kg / inertial_mass_kg(object), false);
    handles
}

/// Mass, centre of mass and inertia as the engine has them.
fn mass_properties(object: &PlacedObject) -> MassProperties {
    let CompositeInertia { mass_kg, com_b, inertia_b } = CompositeInertia::of_board(object);
    let (com, inertia) = (convert::to_engine_vector(&com_b), convert::to_engine_matrix(&inertia_b));
    MassProperties::with_inertia_matrix(com, mass_kg, inertia)
}
