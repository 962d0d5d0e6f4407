//! A parallel gripper in the engine: two coupled fingers under a constant force, and their pads.

use nalgebra::{Isometry3, Translation3};
use rapier3d_f64::prelude::{Multibody, MultibodyDofCoupling, PhysicsWorld, RigidBodyHandle};

use super::{
    balance::{JointState, drive_work_j},
    bodies::ArmBodies,
    body_chain::{BodyChain, ChainLink},
    convert,
    pad::{PadContact, SimPad},
};
use crate::{
    model::frames::Pose,
    robot::{Arm, Finger, Robot},
};

/// Damping of each finger, N s/m (assumed): a finger settles within milliseconds, much faster than an arm.
pub(super) const FINGER_DAMPING_N_S_M: f64 = 50.0;

/// Stiffness, N/m, of the spring that models the constant force on a finger: over a travel of 20 mm the force changes
/// by less than a thousandth of 30 N. It acts in the joint, so the palm feels the reaction.
const PUSH_STIFFNESS_N_M: f64 = 1.0;

/// A finger of the gripper.
struct SimFinger {
    place: ChainLink,
    finger: Finger,
    /// Limits of the joint position, m.
    limits_m: [f64; 2],
    /// The planned position, m.
    planned_m: f64,
    /// Rest position of the spring that pushes it, m.
    rest_m: f64,
    /// State of the joint before this step.
    before: JointState,
}

impl SimFinger {
    fn state(&self, multibody: &Multibody) -> JointState {
        JointState { position: self.place.position(multibody), velocity: self.place.velocity(multibody) }
    }
}

/// A gripper of the scene.
pub(super) struct SimGripper {
    fingers: [SimFinger; 2],
    /// The force that closes each finger, N.
    force_n: f64,
    /// The pad on the +y_G side first.
    pub pads: [SimPad; 2],
    /// The body that contains G.
    hand: RigidBodyHandle,
    /// Frame C, with the axes of G at the centre between the pads, in that body.
    x_bc: Pose,
}

impl SimGripper {
    /// Adds pads to the fingers of an arm.
    pub fn new(
        world: &mut PhysicsWorld,
        robot: &Robot,
        arm: &Arm,
        merged: &ArmBodies,
        chain: &BodyChain,
        contact: PadContact,
    ) -> Self {
        let placement = merged.placements[arm.gripper.frame_link];
        let parts = [0, 1].map(|k| {
            let body = merged.body_of_joint[arm.joints.len() + k];
            let x_gj = placement.x_bl.inverse() * merged.bodies[body].x_pj;
            let joint = &robot.joints[arm.gripper.fingers[k].joint];
            let finger = arm.gripper.fingers[k].clone();
            let place = chain.links[body];
            let x_gf = x_gj * Translation3::from(joint.axis_j.into_inner() * finger.closed_m);
            let pad = SimPad::new(world, &finger.pad, k, place.body, &x_gf, contact);
            (
                SimFinger {
                    place,
                    finger,
                    limits_m: [joint.lower, joint.upper],
                    planned_m: 0.0,
                    rest_m: 0.0,
                    before: JointState::default(),
                },
                pad,
            )
        });
        let [(first, first_pad), (second, second_pad)] = parts;
        Self {
            fingers: [first, second],
            force_n: 0.0,
            pads: [first_pad, second_pad],
            hand: chain.body(placement.body),
            x_bc: placement.x_bl * Isometry3::from(arm.gripper.grasp_point_g()),
        }
    }

    /// Couples the fingers at `positions_m`, so that both open by the same travel, and prepares the drives that push each
    /// towards the other with `force_n`, see [`SimGripper::push`].
    ///
    /// A geared drive adds its own inertia to each finger; its value is not known, and no state of rest depends on it.
    /// The engine's iterative contact solver converges if the masses on both sides of a contact are similar: measured,
    /// a bare finger of 30 g shakes a board of more than 0.3 kg out of its grip, and with drives heavier than the board a
    /// light hand shakes. With 0.3 times the board's inertia every board is held still by every hand that was tried.
    pub fn close(&mut self, multibody: &mut Multibody, force_n: f64, positions_m: [f64; 2], drive_inertia_kg: f64) {
        let [first, second] = &self.fingers;
        let coeff = first.finger.opening_sign * second.finger.opening_sign;
        multibody.add_dof_coupling(MultibodyDofCoupling {
            link1: first.place.link,
            dof1: 0,
            axis1: first.place.axis as usize,
            link2: second.place.link,
            dof2: 0,
            axis2: second.place.axis as usize,
            coeff,
            offset: second.finger.closed_m - coeff * first.finger.closed_m,
        });
        // The coupling applies the first finger's limits to the second.
        first.place.set_limits(multibody, first.limits_m);
        self.force_n = force_n;
        for (SimFinger { place, planned_m, .. }, position_m) in self.fingers.iter_mut().zip(positions_m) {
            *planned_m = position_m;
            multibody.damping_mut()[place.dof] = FINGER_DAMPING_N_S_M;
            multibody.armature_mut()[place.dof] = drive_inertia_kg;
        }
    }

    /// Pushes each finger towards the other with a share of the grip force, which is exact at the planned position.
    pub fn push(&mut self, multibody: &mut Multibody, share: f64) {
        for SimFinger { place, finger, planned_m, rest_m, .. } in &mut self.fingers {
            *rest_m = *planned_m - finger.opening_sign * share * self.force_n / PUSH_STIFFNESS_N_M;
            place.set_spring(multibody, PUSH_STIFFNESS_N_M, *rest_m);
        }
    }

    /// Gives the fingers pads with other contacts, and another force, N.
    pub fn regrip(&mut self, world: &mut PhysicsWorld, arm: &Arm, contact: PadContact, force_n: f64) {
        for (pad, finger) in self.pads.iter_mut().zip(&arm.gripper.fingers) {
            pad.replace(world, &finger.pad, contact);
        }
        self.force_n = force_n;
    }

    /// Stores the fingers' state before a step.
    pub fn store_state(&mut self, multibody: &Multibody) {
        for finger in &mut self.fingers {
            finger.before = finger.state(multibody);
        }
    }

    /// Work of the finger drives in the last step, J.
    pub fn work_j(&self, multibody: &Multibody) -> f64 {
        let work_j = |finger: &SimFinger| {
            let states = [finger.before, finger.state(multibody)];
            drive_work_j(PUSH_STIFFNESS_N_M, FINGER_DAMPING_N_S_M, finger.rest_m, states)
        };
        self.fingers.iter().map(work_j).sum()
    }

    /// Kinetic energy of the drives' inertia, J.
    pub fn drive_energy_j(&self, multibody: &Multibody) -> f64 {
        let energy_j = |finger: &SimFinger| {
            let velocity_m_s = finger.place.velocity(multibody);
            multibody.armature()[finger.place.dof] * velocity_m_s * velocity_m_s / 2.0
        };
        self.fingers.iter().map(energy_j).sum()
    }

    /// Travel of each finger from its closed limit, m.
    pub fn travel_m(&self, multibody: &Multibody) -> [f64; 2] {
        self.fingers.each_ref().map(|f| f.finger.opening_sign * (f.place.position(multibody) - f.finger.closed_m))
    }

    /// X_WC, C with the axes of G at the centre between the pads.
    pub fn x_wc(&self, world: &PhysicsWorld) -> Pose {
        convert::from_engine_pose(world.bodies[self.hand].position()) * self.x_bc
    }
}
