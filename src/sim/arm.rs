//! One arm of the scene: a servo in every joint, a gripper at the end.

use rapier3d_f64::prelude::{Multibody, MultibodyJointHandle, PhysicsWorld};

use super::{
    SimError,
    bodies::ArmBodies,
    border,
    chain::{Chain, ChainLink},
    gripper::SimGripper,
    servo::Servo,
};
use crate::{
    model::{
        GRAVITY_W,
        plan::{ArmHold, PlacedObject},
        trace::ArmSample,
    },
    robot::{Arm, Robot},
};

/// A servo, where it acts, and where its spring rests in this step.
struct DrivenJoint {
    servo: Servo,
    place: ChainLink,
    rest_rad: f64,
}

/// An arm of the scene.
pub(super) struct SimArm {
    /// Any of the arm's joints: the way to its multibody.
    multibody: MultibodyJointHandle,
    joints: Vec<DrivenJoint>,
    /// What it holds with.
    pub gripper: SimGripper,
}

impl SimArm {
    /// Builds an arm that stands still at `hold.q_rad` with its pads on the object's faces.
    ///
    /// # Errors
    /// [`SimError::Massless`] when a part that moves has no mass.
    pub fn new(
        world: &mut PhysicsWorld,
        robot: &Robot,
        arm: &Arm,
        hold: &ArmHold,
        object: &PlacedObject,
        friction: f64,
    ) -> Result<Self, SimError> {
        let merged = ArmBodies::new(robot, arm);
        let chain = Chain::insert(world, robot, &merged.bodies)?;
        let place = |joint: usize| chain.links[merged.of_joint[joint]];
        let arm_joints: Vec<_> = (0..arm.joints.len()).map(place).collect();
        let fingers = [place(arm.joints.len()), place(arm.joints.len() + 1)];
        let gripper = SimGripper::new(world, robot, arm, &merged, &chain, friction);

        let PhysicsWorld { bodies, colliders, multibody_joints, .. } = world;
        let handle = fingers[0].joint;
        let (multibody, _) = multibody_joints.get_mut(handle).ok_or(SimError::Engine)?;
        let finger_m = gripper.positions_at_gap_m(&arm.gripper, object.size_m[2]);
        gripper.close(multibody, hold.grip_force_n, finger_m, object.mass_kg);
        let mut positions = vec![0.0; chain.links.len()];
        for (joint, q_rad) in arm_joints.iter().zip(&hold.q_rad) {
            positions[joint.dof] = *q_rad;
        }
        for (finger, position_m) in fingers.iter().zip(finger_m) {
            positions[finger.dof] = position_m;
        }
        multibody.apply_displacements(&positions);
        multibody.forward_kinematics(bodies, false);
        multibody.update_rigid_bodies(bodies, true);
        bodies.propagate_modified_body_positions_to_colliders(colliders);
        let weight_nm = torque_against_gravity(multibody, &chain, &merged);
        let joints = driven_joints(arm, hold, &arm_joints, &weight_nm);
        for DrivenJoint { place, servo, .. } in &joints {
            multibody.damping_mut()[place.dof] = servo.damping_nm_s_rad;
        }
        Ok(Self { multibody: handle, joints, gripper })
    }

    /// Lets every servo react to the state before a step.
    pub fn drive(&mut self, world: &mut PhysicsWorld, timestep_s: f64) {
        let Some((multibody, _)) = world.multibody_joints.get_mut(self.multibody) else { return };
        for joint in &mut self.joints {
            let (q_rad, velocity_rad_s) = (joint.place.position(multibody), joint.place.velocity(multibody));
            joint.rest_rad = joint.servo.rest_rad(q_rad, velocity_rad_s, timestep_s);
            joint.place.set_spring(multibody, joint.servo.stiffness_nm_rad, joint.rest_rad);
        }
    }

    /// The largest joint speed, rad/s.
    pub fn fastest_joint_rad_s(&self, world: &PhysicsWorld) -> f64 {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return 0.0 };
        self.joints.iter().map(|joint| joint.place.velocity(multibody).abs()).fold(0.0, f64::max)
    }

    /// Writes the joints' part of the state after a step.
    pub fn observe_joints(&self, world: &PhysicsWorld, sample: &mut ArmSample) {
        let Some((multibody, _)) = world.multibody_joints.get(self.multibody) else { return };
        for (k, DrivenJoint { servo, place, rest_rad }) in self.joints.iter().enumerate() {
            let (q_rad, velocity_rad_s) = (place.position(multibody), place.velocity(multibody));
            sample.q_rad[k] = q_rad;
            sample.torque_demanded_nm[k] = servo.demanded_nm(q_rad, velocity_rad_s);
            sample.torque_applied_nm[k] = servo.applied_nm(*rest_rad, q_rad, velocity_rad_s);
        }
        for (travel_m, found_m) in sample.finger_m.iter_mut().zip(self.gripper.travel_m(multibody)) {
            *travel_m = found_m;
        }
    }
}

/// The servos that hold an arm at its planned angles.
fn driven_joints(arm: &Arm, hold: &ArmHold, places: &[ChainLink], weight_nm: &[f64]) -> Vec<DrivenJoint> {
    places
        .iter()
        .enumerate()
        .map(|(k, &place)| {
            let servo = Servo {
                wanted_rad: hold.q_rad[k],
                feed_forward_nm: weight_nm[place.dof],
                stiffness_nm_rad: arm.stiffness_nm_rad[k],
                damping_nm_s_rad: arm.damping_nm_s_rad[k],
                effort_nm: arm.effort_nm[k],
            };
            DrivenJoint { servo, place, rest_rad: servo.rest_rad(servo.wanted_rad, 0.0, 0.0) }
        })
        .collect()
}

/// The joint torques that hold the arm's own weight, in the multibody's order: `-sum J_v' m g`.
fn torque_against_gravity(multibody: &Multibody, chain: &Chain, merged: &ArmBodies) -> Vec<f64> {
    let mut torque_nm = vec![0.0; multibody.ndofs()];
    for (place, body) in chain.links.iter().zip(&merged.bodies) {
        let jacobian = multibody.body_jacobian(place.link);
        let weight_n = border::vector(&(GRAVITY_W * body.mass.mass_kg));
        for (dof, torque_nm) in torque_nm.iter_mut().enumerate() {
            *torque_nm -= (0..3).map(|row| jacobian[(row, dof)] * weight_n[row]).sum::<f64>();
        }
    }
    torque_nm
}
