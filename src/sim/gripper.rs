//! A parallel gripper in the engine: two coupled fingers, pushed with a constant force, and their pads.

use nalgebra::{Isometry3, Translation3, Vector3};
use rapier3d_f64::prelude::{Multibody, MultibodyDofCoupling, PhysicsWorld, RigidBodyHandle};

use super::{
    bodies::ArmBodies,
    border,
    chain::{Chain, ChainLink},
    pad::SimPad,
};
use crate::{
    model::frames::Pose,
    robot::{Arm, Gripper, Joint, Robot},
};

/// Damping of each finger, N s/m (METHOD gives none): a finger of 30 g with its share of the board comes to rest within
/// a few milliseconds, far faster than an arm.
const FINGER_DAMPING_N_S_M: f64 = 50.0;

/// Stiffness, N/m, of the spring that stands for the constant force on a finger: so soft that over a whole travel of
/// 20 mm the force changes by less than a thousandth of 30 N. It acts in the joint, so it pulls the palm exactly as
/// hard as it pushes the finger.
const PUSH_STIFFNESS_N_M: f64 = 1.0;

/// A finger of the gripper.
struct SimFinger {
    place: ChainLink,
    /// 1 when the finger opens with growing joint position, -1 otherwise.
    opening_sign: f64,
    /// The joint position at the closed end of the travel, m.
    closed_m: f64,
    /// Limits of the joint position, m.
    limits_m: [f64; 2],
}

impl SimFinger {
    /// The finger's joint position after opening by `travel_m`.
    fn position_m(&self, travel_m: f64) -> f64 {
        self.closed_m + self.opening_sign * travel_m
    }
}

/// A gripper of the scene.
pub(super) struct SimGripper {
    fingers: [SimFinger; 2],
    /// The finger on the +y_G side first.
    pub pads: [SimPad; 2],
    /// The body that carries G.
    hand: RigidBodyHandle,
    /// The frame with the axes of G at the centre between the pads, in that body.
    x_bc: Pose,
    /// G in that body.
    x_bg: Pose,
}

impl SimGripper {
    /// Puts pads on the fingers of an arm.
    pub fn new(
        world: &mut PhysicsWorld,
        robot: &Robot,
        arm: &Arm,
        merged: &ArmBodies,
        chain: &Chain,
        friction: f64,
    ) -> Self {
        let seat = merged.seats[arm.gripper.frame_link];
        let parts = [0, 1].map(|k| {
            let body = merged.of_joint[arm.joints.len() + k];
            let x_gj = seat.x_bl.inverse() * merged.bodies[body].x_pj;
            let joint = &robot.joints[arm.gripper.fingers[k].joint];
            let finger = new_finger(chain.links[body], joint, &x_gj, k);
            let x_gf = x_gj * Translation3::from(joint.axis_j.into_inner() * finger.closed_m);
            let pad = SimPad::new(world, &arm.gripper.fingers[k].pad, k, finger.place.body, &x_gf, friction);
            (finger, pad)
        });
        let [(first, upper), (second, lower)] = parts;
        Self {
            fingers: [first, second],
            pads: [upper, lower],
            hand: chain.body(seat.body),
            x_bc: seat.x_bl * Isometry3::from(arm.gripper.grasp_point_g()),
            x_bg: seat.x_bl,
        }
    }

    /// Joint positions of the fingers with the pads `gap_m` apart.
    pub fn positions_at_gap_m(&self, gripper: &Gripper, gap_m: f64) -> [f64; 2] {
        [0, 1].map(|k| self.fingers[k].position_m(gripper.travel_for_gap_m(k, gap_m)))
    }

    /// Couples the fingers, so that both open by the same travel, and pushes each with `force_n` towards the other, which is
    /// exact at `positions_m`.
    ///
    /// A geared drive adds its own inertia to each finger; no figure is known, and no state of rest depends on it.
    /// The solver, which goes from contact to contact, converges when the masses on both sides of them are alike:
    /// measured, a bare finger of 30 g shakes a board of more than 0.3 kg out of its grip, and a drive of 0.3 to 20
    /// times the board's mass holds every board still. So the caller gives the board's mass.
    pub fn close(&self, multibody: &mut Multibody, force_n: f64, positions_m: [f64; 2], drive_inertia_kg: f64) {
        let [first, second] = &self.fingers;
        let coeff = first.opening_sign * second.opening_sign;
        multibody.add_dof_coupling(MultibodyDofCoupling {
            link1: first.place.link,
            dof1: 0,
            axis1: first.place.axis as usize,
            link2: second.place.link,
            dof2: 0,
            axis2: second.place.axis as usize,
            coeff,
            offset: second.closed_m - coeff * first.closed_m,
        });
        // The coupling hands the first finger's limits on to the second.
        first.place.set_limits(multibody, first.limits_m);
        for (finger, position_m) in self.fingers.iter().zip(positions_m) {
            let rest_m = position_m - finger.opening_sign * force_n / PUSH_STIFFNESS_N_M;
            finger.place.set_spring(multibody, PUSH_STIFFNESS_N_M, rest_m);
            multibody.damping_mut()[finger.place.dof] = FINGER_DAMPING_N_S_M;
            multibody.armature_mut()[finger.place.dof] = drive_inertia_kg;
        }
    }

    /// Travel of each finger from its closed limit, m.
    pub fn travel_m(&self, multibody: &Multibody) -> [f64; 2] {
        self.fingers.each_ref().map(|f| f.opening_sign * (f.place.position(multibody) - f.closed_m))
    }

    /// Pose of G in the world.
    pub fn x_wg(&self, world: &PhysicsWorld) -> Pose {
        border::from_engine_pose(world.bodies[self.hand].position()) * self.x_bg
    }

    /// Pose of the frame with the axes of G at the centre between the pads, in the world.
    pub fn x_wc(&self, world: &PhysicsWorld) -> Pose {
        border::from_engine_pose(world.bodies[self.hand].position()) * self.x_bc
    }
}

/// The finger `k` (0 on the +y_G side, 1 on the other) whose joint's frame is at `x_gj`.
fn new_finger(place: ChainLink, joint: &Joint, x_gj: &Pose, k: usize) -> SimFinger {
    let outward_g = if k == 0 { Vector3::y() } else { -Vector3::y() };
    let opens_up = (x_gj.rotation * joint.axis_j.into_inner()).dot(&outward_g) > 0.0;
    SimFinger {
        place,
        opening_sign: if opens_up { 1.0 } else { -1.0 },
        closed_m: if opens_up { joint.lower } else { joint.upper },
        limits_m: [joint.lower, joint.upper],
    }
}
