//! One arm of the scene: a servo in each joint, a gripper at the end.

use rapier3d_f64::prelude::{Multibody, MultibodyJointHandle, PhysicsWorld, RigidBodyHandle};

use super::{
    balance::{JointState, drive_work_j, mechanical_energy_j},
    board::collider_of,
    bodies::ArmBodies,
    body_chain::{BodyChain, ChainLink},
    conditions::Conditions,
    error::SimError,
    feed_forward::FeedForward,
    gripper::SimGripper,
    hand::SimHand,
    hand_over::HandOver,
    joined_hand::JoinedHand,
    pad::PadContact,
    pad_shape::{GraspingHand, PadLoading},
    pad_springs::{PadLayer, PadSprings},
    servo::Servo,
    staged::ArmCommand,
    world::{contact_softness_s2, drive_inertia_kg},
};
use crate::{
    check::CheckedArm,
    model::{
        plan::{ArmHold, PlacedObject},
        trace::ArmSample,
    },
    robot::{Arm, Holding, Robot},
};

/// A joint with its servo and the rest angle of its spring in this step.
struct DrivenJoint {
    servo: Servo,
    place: ChainLink,
    /// Torque that the board's weight adds to the feed-forward, N m.
    board_nm: f64,
    rest_rad: f64,
    /// State of the joint before this step.
    before: JointState,
}

/// An arm of the scene.
pub(super) struct SimArm {
    /// A handle of the arm's multibody: one of its joints.
    multibody: MultibodyJointHandle,
    joints: Vec<DrivenJoint>,
    /// All moving bodies.
    bodies: Vec<RigidBodyHandle>,
    /// The hand.
    pub hand: SimHand,
    /// Its elastic pads, or an elastic grip.
    pad_springs: Option<PadSprings>,
    /// Factor of the force with which the gripper closes; negative while it opens.
    grip_share: f64,
}

/// The board of a scene.
#[derive(Clone, Copy)]
pub(super) struct PlacedBoard<'a> {
    /// The board.
    pub object: &'a PlacedObject,
    /// Its body in the engine.
    pub body: RigidBodyHandle,
}

impl SimArm {
    /// Builds an arm at rest at `hold.q_rad` with its hand on the board.
    ///
    /// # Errors
    /// [`SimError::Massless`] if a moving body has no mass.
    pub fn new(
        world: &mut PhysicsWorld,
        robot: &Robot,
        (number, checked): (usize, &CheckedArm<'_>),
        feed_forward: FeedForward,
        board: PlacedBoard<'_>,
        conditions: &Conditions,
    ) -> Result<Self, SimError> {
        let (arm, hold, object) = (&robot.arms[checked.index], checked.hold, board.object);
        let layer = PadLayer::of(robot, checked, object, conditions);
        let merged = ArmBodies::new(robot, arm, layer.as_ref().map(|layer| &layer.x_gd), object.size_m[2]);
        let chain = BodyChain::insert(world, robot, &merged.bodies)?;
        let links = merged.body_of_joint.iter().map(|&body| chain.links[body]);
        let links: Vec<_> = links.collect();
        let (arm_links, finger_links) = links.split_at(arm.joints.len());
        let mut hand = hand(world, robot, (number, checked), (&merged, &chain), object, conditions);
        let finger_m = arm.gripper.finger_positions_m(object.size_m[2]);

        let mut positions = vec![0.0; chain.dofs];
        let placed = arm_links.iter().zip(&hold.q_rad).chain(finger_links.iter().zip(&finger_m));
        placed.for_each(|(link, position)| positions[link.dof] = *position);
        let multibody = links.last().ok_or(SimError::Engine)?.joint;
        let engine = set_joint_positions(world, multibody, &positions)?;
        if let SimHand::Fingers(fingers) = &mut hand {
            let grip_force_n = hold.grip_force_n * conditions.uncertainty.grip_force_scale_of(number);
            fingers.close(engine, grip_force_n, finger_m, drive_inertia_kg(object));
        }
        let joint_stiffness_scale = conditions.uncertainty.joint_stiffness_scale;
        let joints = driven_joints(arm, hold, arm_links, &feed_forward, joint_stiffness_scale);
        for DrivenJoint { place, servo, .. } in &joints {
            engine.damping_mut()[place.dof] = servo.damping_nm_s_rad;
        }
        let springs = layer.and_then(|layer| layer.springs(robot, arm, &merged, finger_m));
        let hand_place = merged.hand.map(|hand| chain.links[hand]);
        let pad_springs = hand_place.zip(springs).map(|(place, springs)| PadSprings::insert(engine, place, springs));
        if let SimHand::Joined(joined) = &mut hand {
            joined.join(world, board.body);
        }
        let bodies = chain.links.iter().map(|link| link.body).collect();
        Ok(Self { multibody, joints, bodies, hand, pad_springs, grip_share: 1.0 })
    }

    /// Sets the rest angle of every servo, and the forces of the fingers, from the state before a step.
    pub fn drive(&mut self, world: &mut PhysicsWorld, timestep_s: f64, hand_over: &HandOver) {
        let Some((multibody, _)) = world.multibody_joints.get_mut(self.multibody) else { return };
        for joint in &mut self.joints {
            let (q_rad, velocity_rad_s) = (joint.place.position(multibody), joint.place.velocity(multibody));
            joint.servo.board_nm = joint.board_nm * hand_over.carried_share();
            joint.before = JointState { position: q_rad, velocity: velocity_rad_s };
            joint.rest_rad = joint.servo.rest_rad(q_rad, velocity_rad_s, timestep_s);
            joint.place.set_spring(multibody, joint.servo.stiffness_nm_rad, joint.rest_rad);
        }
        self.hand.begin_step(multibody, hand_over.grip_share() * self.grip_share);
        if let Some(springs) = &mut self.pad_springs {
            springs.store_state(multibody);
        }
    }

    /// Gives every joint a new target, and the gripper another share of its force.
    pub fn command(&mut self, command: &ArmCommand) {
        let ArmCommand { q_rad, speed_rad_s, arm_nm, board_nm, grip_share } = command;
        for (k, joint) in self.joints.iter_mut().enumerate() {
            (joint.servo.commanded_rad, joint.servo.commanded_rad_s) = (q_rad[k], speed_rad_s[k]);
            (joint.servo.arm_nm, joint.board_nm) = (arm_nm[k], board_nm[k]);
        }
        self.grip_share = *grip_share;
    }

    /// Gives the fingers the pads of another grasp, and the grip force of that grasp, N.
    pub fn regrip(
        &mut self,
        world: &mut PhysicsWorld,
        robot: &Robot,
        (number, index, hold): (usize, usize, &ArmHold),
        object: &PlacedObject,
        conditions: &Conditions,
    ) {
        let SimHand::Fingers(fingers) = &mut self.hand else { return };
        let arm = &robot.arms[index];
        let bodies = ArmBodies::new(robot, arm, None, object.size_m[2]);
        let contact = pad_contact(world, arm, (number, hold), &bodies, object, conditions);
        let force_n = hold.grip_force_n * conditions.uncertainty.grip_force_scale_of(number);
        fingers.regrip(world, arm, contact, force_n);
    }

    /// True if the gripper has rigid pads.
    pub fn has_rigid_pads(&self) -> bool {
        matches!(self.hand, SimHand::Fingers(_)) && self.pad_springs.is_none()
    }

    /// Kinetic and gravitational energy of the arm, J.
    pub fn energy_j(&self, world: &PhysicsWorld) -> f64 {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return f64::NAN };
        let bodies: f64 = self.bodies.iter().map(|&body| mechanical_energy_j(&world.bodies[body])).sum();
        bodies + self.hand.drive_energy_j(multibody)
    }

    /// Work of the servos, the finger drives and the elastic pads in the last step, J.
    pub fn work_j(&self, world: &PhysicsWorld) -> f64 {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return f64::NAN };
        let servos = self.joints.iter().map(|joint| {
            let DrivenJoint { servo, place, rest_rad, before, .. } = joint;
            let after = JointState { position: place.position(multibody), velocity: place.velocity(multibody) };
            drive_work_j(servo.stiffness_nm_rad, servo.damping_nm_s_rad, *rest_rad, [*before, after])
        });
        let drives_j = servos.sum::<f64>() + self.hand.work_j(multibody);
        self.pad_springs.as_ref().map_or(drives_j, |springs| drives_j + springs.work_j(multibody))
    }

    /// True if no joint is faster than `limit_rad_s`; false for a NaN speed.
    pub fn is_slower_than(&self, world: &PhysicsWorld, limit_rad_s: f64) -> bool {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return false };
        self.joints.iter().all(|joint| joint.place.velocity(multibody).abs() <= limit_rad_s)
    }

    /// Writes the state of the joints after a step.
    pub fn observe_joints(&self, world: &PhysicsWorld, sample: &mut ArmSample) {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return };
        for (k, DrivenJoint { servo, place, rest_rad, .. }) in self.joints.iter().enumerate() {
            let (q_rad, velocity_rad_s) = (place.position(multibody), place.velocity(multibody));
            sample.q_rad[k] = q_rad;
            sample.torque_demanded_nm[k] = servo.demanded_nm(q_rad, velocity_rad_s);
            sample.torque_applied_nm[k] = servo.applied_nm(*rest_rad, q_rad, velocity_rad_s);
        }
        for (travel_m, found_m) in sample.finger_m.iter_mut().zip(self.hand.travel_m(multibody)) {
            *travel_m = found_m;
        }
    }
}

/// The hand of an arm: fingers with their pads, or a measured gripper, not yet joined to the board.
fn hand(
    world: &mut PhysicsWorld,
    robot: &Robot,
    (number, checked): (usize, &CheckedArm<'_>),
    (merged, chain): (&ArmBodies, &BodyChain),
    object: &PlacedObject,
    conditions: &Conditions,
) -> SimHand {
    let &CheckedArm { index, hold, .. } = checked;
    let arm = &robot.arms[index];
    let grip_scale = conditions.uncertainty.grip_force_scale_of(number);
    if let Holding::Measured(measured) = &arm.gripper.holding {
        let limits = measured.limits.scaled(grip_scale);
        return SimHand::Joined(Box::new(JoinedHand::new(arm, merged, chain, limits, object.size_m[2])));
    }
    let contact = pad_contact(world, arm, (number, hold), merged, object, conditions);
    SimHand::Fingers(Box::new(SimGripper::new(world, robot, arm, merged, chain, contact)))
}

/// How the pads of a hand touch the board.
fn pad_contact(
    world: &PhysicsWorld,
    arm: &Arm,
    (number, hold): (usize, &ArmHold),
    bodies: &ArmBodies,
    object: &PlacedObject,
    conditions: &Conditions,
) -> PadContact {
    let force_n = hold.grip_force_n * conditions.uncertainty.grip_force_scale_of(number);
    let grasping = GraspingHand { arm, bodies, x_og: hold.x_og };
    let loading = PadLoading::new(&grasping, object, force_n, contact_softness_s2(world));
    PadContact { friction: conditions.friction_of(number), loading, collider: collider_of(object, number) }
}

/// Moves a chain, with its bodies and pads, from zero to these joint positions.
fn set_joint_positions<'a>(
    world: &'a mut PhysicsWorld,
    handle: MultibodyJointHandle,
    positions: &[f64],
) -> Result<&'a mut Multibody, SimError> {
    let PhysicsWorld { bodies, colliders, multibody_joints, .. } = world;
    let (multibody, _) = multibody_joints.get_mut(handle).ok_or(SimError::Engine)?;
    multibody.apply_displacements(positions);
    multibody.forward_kinematics(bodies, false);
    multibody.update_rigid_bodies(bodies, true);
    bodies.propagate_modified_body_positions_to_colliders(colliders);
    Ok(multibody)
}

/// The servos that hold an arm at its planned angles.
fn driven_joints(
    arm: &Arm,
    hold: &ArmHold,
    places: &[ChainLink],
    feed_forward: &FeedForward,
    stiffness_scale: f64,
) -> Vec<DrivenJoint> {
    places
        .iter()
        .enumerate()
        .map(|(k, &place)| {
            let servo = Servo {
                commanded_rad: hold.q_rad[k],
                commanded_rad_s: 0.0,
                arm_nm: feed_forward.arm_nm[k],
                board_nm: 0.0,
                stiffness_nm_rad: arm.stiffness_nm_rad[k] * stiffness_scale,
                damping_nm_s_rad: arm.damping_nm_s_rad[k],
                effort_nm: arm.effort_nm[k],
            };
            let before = JointState { position: servo.commanded_rad, velocity: 0.0 };
            let rest_rad = servo.rest_rad(servo.commanded_rad, 0.0, 0.0);
            DrivenJoint { servo, place, board_nm: feed_forward.board_nm[k], rest_rad, before }
        })
        .collect()
}
