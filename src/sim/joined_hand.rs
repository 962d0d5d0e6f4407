//! A measured gripper in the engine: its hand is joined to the board until the wrench leaves the limits
//! (docs/method.md#613-measured-grippers).
//!
//! The joint locks all six directions. Its impulses are those of the last substep, like the pads' forces. With an elastic grip
//! the hand is on six springs, as with elastic pads (`pad_springs.rs`). A gripper that has let go touches nothing: jaws do not
//! collide with the board.

use nalgebra::{Isometry3, Vector3};
use rapier3d_f64::prelude::{GenericJointBuilder, ImpulseJointHandle, JointAxesMask, PhysicsWorld, RigidBodyHandle};

use super::{bodies::ArmBodies, body_chain::BodyChain, convert, world::substep_s};
use crate::{
    model::{frames::Pose, wrench::Wrench, wrench_limits::WrenchLimits},
    robot::Arm,
};

/// The engine measures the rotation of a joint by the vector part of its quaternion, half of the rotation vector, so the
/// moment is half of the impulse over time.
const MOMENT_PER_IMPULSE: f64 = 0.5;

/// A measured gripper of the scene.
pub(super) struct JoinedHand {
    /// The body that contains G.
    hand: RigidBodyHandle,
    /// Frame C, with the axes of G at the grasp point, in that body.
    x_bc: Pose,
    /// Travel of each finger from its closed limit, m: they do not move.
    travel_m: [f64; 2],
    limits: WrenchLimits,
    /// `None` before it is joined and after it has let go.
    joint: Option<ImpulseJointHandle>,
    /// Wrench on the board in the last step about C in its axes; `None` if it let go before.
    wrench_c: Option<Wrench>,
}

impl JoinedHand {
    /// The hand of an arm, not yet joined.
    pub fn new(arm: &Arm, merged: &ArmBodies, chain: &BodyChain, limits: WrenchLimits, gap_m: f64) -> Self {
        let placement = merged.placements[arm.gripper.frame_link];
        Self {
            hand: chain.body(placement.body),
            x_bc: placement.x_bl * Isometry3::from(arm.gripper.grasp_point_g()),
            travel_m: [0, 1].map(|k| arm.gripper.travel_for_gap_m(k, gap_m)),
            limits,
            joint: None,
            wrench_c: None,
        }
    }

    /// Joins the hand to the board as they are.
    pub fn join(&mut self, world: &mut PhysicsWorld, board: RigidBodyHandle) {
        let x_wo = convert::from_engine_pose(world.bodies[board].position());
        let x_oc = x_wo.inverse() * self.x_wc(world);
        let joint = GenericJointBuilder::new(JointAxesMask::LOCKED_FIXED_AXES)
            .local_frame1(convert::to_engine_pose(&self.x_bc))
            .local_frame2(convert::to_engine_pose(&x_oc))
            .contacts_enabled(false)
            .build();
        self.joint = Some(world.impulse_joints.insert(self.hand, board, joint, true));
        self.wrench_c = Some(Wrench::default());
    }

    /// Reads the wrench after a step, and lets go if it has left the limits.
    pub fn end_step(&mut self, world: &mut PhysicsWorld) {
        self.wrench_c = self.joint.and_then(|joint| wrench_on_board(world, joint));
        let is_kept = self.wrench_c.is_none_or(|wrench_c| self.limits.ratio(&wrench_c) <= 1.0);
        if let Some(joint) = self.joint.filter(|_| !is_kept) {
            world.impulse_joints.remove(joint, true);
            self.joint = None;
        }
    }

    /// Wrench on the board in the last step about the grasp point in G axes; `None` if it let go before.
    pub fn wrench_g(&self) -> Option<Wrench> {
        self.wrench_c
    }

    /// Force on the board in the last step, world axes, N.
    pub fn force_w_n(&self, world: &PhysicsWorld) -> Vector3<f64> {
        self.wrench_c.map_or_else(Vector3::zeros, |wrench_c| self.x_wc(world).rotation * wrench_c.force_n)
    }

    /// Travel of each finger from its closed limit, m.
    pub fn travel_m(&self) -> [f64; 2] {
        self.travel_m
    }

    /// X_WC.
    pub fn x_wc(&self, world: &PhysicsWorld) -> Pose {
        convert::from_engine_pose(world.bodies[self.hand].position()) * self.x_bc
    }
}

/// The wrench of a joint on its second body in the last substep, about the joint and in its axes.
fn wrench_on_board(world: &PhysicsWorld, joint: ImpulseJointHandle) -> Option<Wrench> {
    // The impulses are those on the first body.
    let [fx, fy, fz, mx, my, mz] = world.impulse_joints.get(joint)?.impulses;
    let per_s = -1.0 / substep_s(world);
    let force_n = Vector3::new(fx, fy, fz) * per_s;
    Some(Wrench::new(force_n, Vector3::new(mx, my, mz) * (per_s * MOMENT_PER_IMPULSE)))
}
