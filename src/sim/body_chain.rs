//! An arm's moving bodies in the engine: a chain on a fixed root with one joint a body.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{
    GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MassProperties, Multibody, MultibodyJointHandle,
    PhysicsWorld, RigidBodyBuilder, RigidBodyHandle,
};

use super::{bodies::MovingBody, convert, error::SimError};
use crate::{
    model::frames::Pose,
    robot::{JointKind, Robot},
};

/// A moving body in the engine and the joint that moves it.
#[derive(Clone, Copy)]
pub(super) struct ChainLink {
    /// The body.
    pub body: RigidBodyHandle,
    /// Its joint, which is also a handle of the multibody.
    pub joint: MultibodyJointHandle,
    /// The body's link in the multibody.
    pub link: usize,
    /// Index of the joint in the multibody's velocities, damping and displacements.
    pub dof: usize,
    /// The joint's axis, one of the engine's six; the first of a hand on its pads, which has all of them.
    pub axis: JointAxis,
}

impl ChainLink {
    /// The joint's position, rad or m.
    pub fn position(&self, multibody: &Multibody) -> f64 {
        multibody.link(self.link).map_or(f64::NAN, |link| link.joint().coords()[self.axis as usize])
    }

    /// The joint's velocity, rad/s or m/s.
    pub fn velocity(&self, multibody: &Multibody) -> f64 {
        multibody.generalized_velocity()[self.dof]
    }

    /// Sets the joint's spring `stiffness (rest - position)`, which the engine integrates implicitly.
    pub fn set_spring(&self, multibody: &mut Multibody, stiffness: f64, rest: f64) {
        if let Some(link) = multibody.link_mut(self.link) {
            link.joint.set_spring(self.axis as usize, stiffness, rest);
        }
    }

    /// Sets limits of the joint's position.
    pub fn set_limits(&self, multibody: &mut Multibody, limits: [f64; 2]) {
        if let Some(link) = multibody.link_mut(self.link) {
            link.joint.data.set_limits(self.axis, limits);
        }
    }
}

/// The bodies of an arm in the engine.
pub(super) struct BodyChain {
    /// The fixed root.
    root: RigidBodyHandle,
    /// One a moving body, in their order.
    pub links: Vec<ChainLink>,
    /// The number of the multibody's velocities.
    pub dofs: usize,
}

impl BodyChain {
    /// Inserts a fixed root and the bodies, each joint at zero and without damping.
    ///
    /// # Errors
    /// [`SimError::Massless`] if a body has no mass: the engine cannot move it.
    pub fn insert(world: &mut PhysicsWorld, robot: &Robot, moving: &[MovingBody]) -> Result<Self, SimError> {
        let root = world.bodies.insert(RigidBodyBuilder::fixed());
        let mut chain = Self { root, links: Vec::with_capacity(moving.len()), dofs: 0 };
        for body in moving {
            let parent = chain.body(body.parent);
            chain.links.push(insert_body(world, robot, body, parent)?);
        }
        let PhysicsWorld { bodies, multibody_joints, .. } = world;
        if let Some((multibody, _)) = chain.links.first().and_then(|first| multibody_joints.get_mut(first.joint)) {
            // Only now does the engine know that the root is fixed, which determines the indices of the joints'
            // coordinates.
            multibody.forward_kinematics(bodies, true);
            // The engine's default damping of a revolute joint is 0.1.
            multibody.damping_mut().fill(0.0);
            multibody.set_self_contacts_enabled(false);
            chain.dofs = multibody.ndofs();
            for place in &mut chain.links {
                place.dof = multibody.link(place.link).map_or(0, |link| link.assembly_id());
            }
        }
        Ok(chain)
    }

    /// The engine's body of a moving body, or the root for `None`.
    pub fn body(&self, moving: Option<usize>) -> RigidBodyHandle {
        moving.map_or(self.root, |body| self.links[body].body)
    }
}

/// Inserts one body with its mass and its joint.
fn insert_body(
    world: &mut PhysicsWorld,
    robot: &Robot,
    moving: &MovingBody,
    parent: RigidBodyHandle,
) -> Result<ChainLink, SimError> {
    let mass = &moving.mass;
    if mass.mass_kg <= 0.0 {
        return Err(SimError::Massless { link: robot.links[moving.link].name.clone() });
    }
    let properties = MassProperties::with_inertia_matrix(
        convert::to_engine_vector(&mass.com_b),
        mass.mass_kg,
        convert::to_engine_matrix(&mass.inertia_b),
    );
    let builder = RigidBodyBuilder::dynamic().additional_mass_properties(properties).can_sleep(false);
    let body = world.bodies.insert(builder);
    // Before this call the engine reports zero mass.
    world.bodies[body].recompute_mass_properties_from_colliders(&world.colliders);

    let (data, axis) = match moving.joint {
        Some(joint) => engine_joint(robot.joints[joint].kind, &robot.joints[joint].axis_j, moving),
        None => (free_joint(&moving.x_pj), JointAxis::LinX),
    };
    let handle = world.multibody_joints.insert(parent, body, data, true).ok_or(SimError::Engine)?;
    let (_, link) = world.multibody_joints.get(handle).ok_or(SimError::Engine)?;
    Ok(ChainLink { body, joint: handle, link, dof: 0, axis })
}

/// The engine's joints move along or about their own x, so both frames are rotated to align x with the axis.
fn engine_joint(kind: JointKind, axis_j: &Vector3<f64>, moving: &MovingBody) -> (GenericJoint, JointAxis) {
    let turn = UnitQuaternion::rotation_between(&Vector3::x(), axis_j)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI));
    let x_ja = Isometry3::from_parts(Vector3::zeros().into(), turn);
    let (locked, axis) = match kind {
        JointKind::Prismatic => (JointAxesMask::LOCKED_PRISMATIC_AXES, JointAxis::LinX),
        // A fixed joint has no moving body.
        JointKind::Revolute | JointKind::Fixed => (JointAxesMask::LOCKED_REVOLUTE_AXES, JointAxis::AngX),
    };
    let data = GenericJointBuilder::new(locked)
        .local_frame1(convert::to_engine_pose(&(moving.x_pj * x_ja)))
        .local_frame2(convert::to_engine_pose(&x_ja))
        .contacts_enabled(false)
        .build();
    (data, axis)
}

/// A joint that moves along and about all three axes of its frame.
fn free_joint(x_pj: &Pose) -> GenericJoint {
    let frame = convert::to_engine_pose(x_pj);
    GenericJointBuilder::new(JointAxesMask::empty()).local_frame1(frame).contacts_enabled(false).build()
}
