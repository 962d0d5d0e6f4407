//! The hand of an arm in the engine: fingers with pads, or a measured gripper that is joined to the board.

use nalgebra::Vector3;
use rapier3d_f64::prelude::{Multibody, PhysicsWorld};

use super::{
    gripper::SimGripper,
    joined_hand::JoinedHand,
    pad::{BoardHandles, SimPad},
};
use crate::model::{frames::Pose, trace::ArmSample};

/// The hand of an arm.
pub(super) enum SimHand {
    /// Two coupled fingers with pads.
    Fingers(Box<SimGripper>),
    /// A measured gripper.
    Joined(Box<JoinedHand>),
}

impl SimHand {
    fn fingers(&self) -> Option<&SimGripper> {
        match self {
            Self::Fingers(fingers) => Some(fingers),
            Self::Joined(_) => None,
        }
    }

    /// Pushes the fingers with a share of the grip force, and stores their state before a step.
    pub fn begin_step(&mut self, multibody: &mut Multibody, share: f64) {
        if let Self::Fingers(fingers) = self {
            fingers.push(multibody, share);
            fingers.store_state(multibody);
        }
    }

    /// Reads the wrench of a joined hand after a step; it lets go if the wrench has left the limits.
    pub fn end_step(&mut self, world: &mut PhysicsWorld) {
        if let Self::Joined(joined) = self {
            joined.end_step(world);
        }
    }

    /// Work of the finger drives in the last step, J.
    pub fn work_j(&self, multibody: &Multibody) -> f64 {
        self.fingers().map_or(0.0, |fingers| fingers.work_j(multibody))
    }

    /// Kinetic energy of the drives' inertia, J.
    pub fn drive_energy_j(&self, multibody: &Multibody) -> f64 {
        self.fingers().map_or(0.0, |fingers| fingers.drive_energy_j(multibody))
    }

    /// Travel of each finger from its closed limit, m.
    pub fn travel_m(&self, multibody: &Multibody) -> [f64; 2] {
        match self {
            Self::Fingers(fingers) => fingers.travel_m(multibody),
            Self::Joined(joined) => joined.travel_m(),
        }
    }

    /// X_WC, C with the axes of G at the grasp point.
    pub fn x_wc(&self, world: &PhysicsWorld) -> Pose {
        match self {
            Self::Fingers(fingers) => fingers.x_wc(world),
            Self::Joined(joined) => joined.x_wc(world),
        }
    }

    /// The pads; none of a measured gripper.
    pub fn pads(&self) -> &[SimPad] {
        self.fingers().map_or(&[], |fingers| &fingers.pads)
    }

    /// Writes the wrenches on the board in the last step into a sample.
    pub fn observe(&self, world: &PhysicsWorld, board: BoardHandles, sample: &mut ArmSample) {
        match self {
            Self::Fingers(fingers) => {
                for (pad, sample_pad) in fingers.pads.iter().zip(&mut sample.pads) {
                    *sample_pad = pad.observe(world, board);
                }
            }
            Self::Joined(joined) => sample.grip_wrench_g = joined.wrench_g(),
        }
    }

    /// Force of a joined hand on the board in the last step, world axes, N; zero of fingers, whose pads have it.
    pub fn joint_force_w_n(&self, world: &PhysicsWorld) -> Vector3<f64> {
        match self {
            Self::Fingers(_) => Vector3::zeros(),
            Self::Joined(joined) => joined.force_w_n(world),
        }
    }
}
