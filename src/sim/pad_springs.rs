//! Elastic pads, or the elastic grip of a measured gripper: six springs between the arm and its hand
//! (docs/method.md#612-pad-compliance, docs/method.md#613-measured-grippers).
//!
//! The pads of the engine are rigid but for its contacts. The compliance of real pads is put between the last body of the
//! arm and the hand, which is statically the same, since the two pads of a hand act in parallel. The springs are those of
//! the statics: along and about the axes of the frame D in the middle between the pads, in which their stiffness is
//! diagonal. Their rest positions carry the hand's own weight, which real pads do not carry.

use nalgebra::{Translation3, Vector3, Vector6};
use rapier3d_f64::prelude::Multibody;

use super::{
    balance::{JointState, drive_work_j},
    bodies::{ArmBodies, CompositeInertia},
    body_chain::ChainLink,
    conditions::Conditions,
};
use crate::{
    check::CheckedArm,
    model::{GRAVITY_W, frames::Pose, plan::PlacedObject},
    robot::{Arm, Robot},
    statics::HandModel,
};

/// The stiffness of a hand's pads.
pub(super) struct PadLayer {
    /// Frame D in G: in the middle between the parts of the pads that are on the board.
    pub x_gd: Pose,
    /// The planned pose of D in W.
    x_wd: Pose,
    /// The board as a part of the hand, at its pose in D: with the damping of the hand alone a board on soft pads swings.
    board: (CompositeInertia, Pose),
    /// Along and about the axes of D, N/m and N m/rad.
    stiffness: Vector6<f64>,
}

/// A spring with a damper along or about one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct PadSpring {
    /// N/m or N m/rad.
    pub stiffness: f64,
    /// Critical damping of the hand with the board, N s/m or N m s/rad.
    pub damping: f64,
    /// Rest position, m or rad.
    pub rest: f64,
}

impl PadLayer {
    /// The pads of an arm of the plan; `None` if they are rigid or not on the board.
    pub fn of(robot: &Robot, checked: &CheckedArm<'_>, object: &PlacedObject, conditions: &Conditions) -> Option<Self> {
        let CheckedArm { index, chain, hold, .. } = checked;
        let hand = HandModel::new(&robot.arms[*index], chain, hold, object, conditions.friction).ok()?;
        let (x_od, stiffness) = hand.springs()?;
        Some(Self {
            x_gd: hold.x_og.inverse() * x_od,
            x_wd: object.x_wo * x_od,
            board: (CompositeInertia::of_board(object), x_od.inverse()),
            stiffness: stiffness * conditions.uncertainty.contact_stiffness_scale,
        })
    }

    /// The springs along x, y, z, then about these, of D, with the fingers at these joint positions; `None` for bodies
    /// without a hand.
    pub fn springs(&self, robot: &Robot, arm: &Arm, bodies: &ArmBodies, finger_m: [f64; 2]) -> Option<[PadSpring; 6]> {
        let hand = &bodies.bodies[bodies.hand?].mass;
        let finger = |k: usize| &bodies.bodies[bodies.body_of_joint[arm.joints.len() + k]];
        let x_df = |k: usize| {
            let axis_j = robot.joints[arm.gripper.fingers[k].joint].axis_j.into_inner();
            finger(k).x_pj * Translation3::from(axis_j * finger_m[k])
        };
        // The fingers of a measured gripper are part of its hand.
        let moving = bodies.body_of_joint.len() - arm.joints.len();
        let carried = (0..moving).fold(*hand, |sum, k| sum.with(&finger(k).mass, &x_df(k)));
        let weight_n = self.x_wd.rotation.inverse() * (GRAVITY_W * carried.mass_kg);
        let moment_nm = carried.com_b.cross(&weight_n);
        let (board, x_do) = &self.board;
        let with_board = carried.with(board, x_do);
        let resisting = [Vector3::repeat(with_board.mass_kg), with_board.inertia_about_origin().diagonal()];
        Some(std::array::from_fn(|axis| {
            let stiffness = self.stiffness[axis];
            let load = [weight_n, moment_nm][axis / 3][axis % 3];
            PadSpring {
                stiffness,
                damping: 2.0 * (stiffness * resisting[axis / 3][axis % 3]).sqrt(),
                rest: -load / stiffness,
            }
        }))
    }
}

/// The springs of a hand in the engine.
pub(super) struct PadSprings {
    place: ChainLink,
    springs: [PadSpring; 6],
    /// State of the springs before this step.
    before: [JointState; 6],
}

impl PadSprings {
    /// Gives the joint of a hand its springs.
    pub fn insert(multibody: &mut Multibody, place: ChainLink, springs: [PadSpring; 6]) -> Self {
        for (axis, PadSpring { stiffness, damping, rest }) in springs.into_iter().enumerate() {
            multibody.damping_mut()[place.dof + axis] = damping;
            if let Some(link) = multibody.link_mut(place.link) {
                link.joint.set_spring(axis, stiffness, rest);
            }
        }
        Self { place, springs, before: [JointState::default(); 6] }
    }

    /// Displacements of the hand from the arm. Angles are those of the integrated angular velocity, equal to the rotation
    /// vector for the milliradians by which pads yield.
    fn states(&self, multibody: &Multibody) -> [JointState; 6] {
        let displacement = multibody.link(self.place.link).map(|link| link.joint().coords());
        std::array::from_fn(|axis| JointState {
            position: displacement.map_or(f64::NAN, |displacement| displacement[axis]),
            velocity: multibody.generalized_velocity()[self.place.dof + axis],
        })
    }

    /// Stores the state before a step.
    pub fn store_state(&mut self, multibody: &Multibody) {
        self.before = self.states(multibody);
    }

    /// Work of the springs and their dampers in the last step, J.
    pub fn work_j(&self, multibody: &Multibody) -> f64 {
        let states = self.before.into_iter().zip(self.states(multibody));
        let work_j = |(spring, (before, after)): (&PadSpring, (JointState, JointState))| {
            drive_work_j(spring.stiffness, spring.damping, spring.rest, [before, after])
        };
        self.springs.iter().zip(states).map(work_j).sum()
    }
}
