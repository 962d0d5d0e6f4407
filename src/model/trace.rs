//! The trace of a simulation: the state after every step. It is all that the judge and the recording receive from the
//! simulation.

use super::{frames::Pose, wrench::Wrench, wrench_limits::WrenchLimits};

/// A phase of the simulation (`docs/method.md#74-phases`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// The board is supported from outside while the grippers close. At its end the board is handed over to the arms.
    Grip,
    /// The arms carry the board. The state at its end is the reference state of the load.
    Settle,
    /// The load grows.
    Ramp,
    /// The full load acts.
    Hold,
    /// The load is removed.
    Release,
    /// Of a task: all arms move the board.
    Move,
    /// Of a task: one arm changes its grasp, the others hold the board.
    Regrasp,
}

impl Phase {
    /// The name in tables and recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grip => "grip",
            Self::Settle => "settle",
            Self::Ramp => "ramp",
            Self::Hold => "hold",
            Self::Release => "release",
            Self::Move => "move",
            Self::Regrasp => "regrasp",
        }
    }

    /// True if a hold is judged in this phase, and up to its end: under a load, or while arms move.
    pub fn is_judged(self) -> bool {
        self.is_loaded() || matches!(self, Self::Move | Self::Regrasp)
    }

    /// True if the tool's wrench acts in this phase.
    pub fn is_loaded(self) -> bool {
        matches!(self, Self::Ramp | Self::Hold)
    }
}

/// The trace of a simulated hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The arms, in the order of every sample's `arms`.
    pub arms: Vec<ArmTrace>,
    /// Position in O of the tool point at the start, m.
    pub p_ot_m: nalgebra::Vector3<f64>,
    /// One sample per step, the first at time 0. Forces are those of the step that ends at the sample.
    pub samples: Vec<Sample>,
    /// When and why the simulation broke down; the samples end before. `None` if it completed.
    pub broke_down: Option<String>,
    /// The first overlap of the robot or the board with the person. `None` if there was none or the plan has no person.
    pub person_touch: Option<PersonTouch>,
    /// The names of the first two bodies of robot and board that overlapped; `None` if there was no overlap.
    pub robot_touch: Option<[String; 2]>,
}

/// An overlap with the person.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersonTouch {
    /// The name of the overlapping link, or `the board`.
    pub body: String,
    /// The body part of the person.
    pub part: String,
}

/// The constant data of an arm in a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTrace {
    /// The arm's name.
    pub name: String,
    /// The arm's joints, in the order of the samples.
    pub joints: Vec<String>,
    /// The torque limit of each joint, N m.
    pub effort_nm: Vec<f64>,
    /// The pads, in the order of the samples; none of a measured gripper.
    pub pads: Vec<String>,
    /// The force that closes each finger, N; 0 of a measured gripper.
    pub grip_force_n: f64,
    /// The measured limits of the gripper's wrench; `None` if it has pads.
    pub wrench_limits: Option<WrenchLimits>,
}

/// A part of an arm that events are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmPart {
    /// The hand.
    Hand,
    /// The pad with this number.
    Pad(usize),
    /// The joint with this number.
    Joint(usize),
}

impl ArmTrace {
    /// The part that an event calls so: `left hand`, `left upper pad`, or the name of a joint.
    #[must_use]
    pub fn part(&self, name: &str) -> Option<ArmPart> {
        let of_arm = name.strip_prefix(&self.name).and_then(|rest| rest.strip_prefix(' '));
        let is_pad = |pad: &String| of_arm.and_then(|rest| rest.strip_suffix(" pad")) == Some(pad);
        let hand = (of_arm == Some("hand")).then_some(ArmPart::Hand);
        let pad = || self.pads.iter().position(is_pad).map(ArmPart::Pad);
        let joint = || self.joints.iter().position(|joint| joint == name).map(ArmPart::Joint);
        hand.or_else(pad).or_else(joint)
    }
}

/// The state after one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start of the simulation, s.
    pub time_s: f64,
    /// The phase.
    pub phase: Phase,
    /// The applied multiple of the operation's wrench.
    pub load_factor: f64,
    /// The tool's wrench on the board about the tool point, W axes.
    pub tool_wrench_w: Wrench,
    /// The board's pose.
    pub x_wo: Pose,
    /// Position in O of the tool point, m. It changes if the load is a `path`.
    pub p_ot_m: nalgebra::Vector3<f64>,
    /// One entry per arm.
    pub arms: Vec<ArmSample>,
    /// How well the engine satisfied the laws of mechanics in this step.
    pub self_check: StepCheck,
    /// Least distance of robot and board from the person, who does not move, m; negative for an overlap: its depth. Tool,
    /// working hand and forearm are not compared with the board. It is measured every 10 ms, and in every step while it
    /// is below 1 cm; other samples repeat the last value. `None` if the plan has no person.
    pub person_distance_m: Option<f64>,
    /// Least distance of the robot from itself and from the board, m, without the pairs that may touch; negative for an
    /// overlap: its depth. It is measured every 10 ms, and in every step while it is below 1 mm; other samples repeat the last
    /// value. `None` if no two bodies can meet, or if an older recording does not contain it.
    pub robot_clearance_m: Option<f64>,
}

/// Deviations of one step from the laws of mechanics (`docs/method.md#75-self-checks`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCheck {
    /// Deepest penetration of a pad that touches the board, m.
    pub penetration_m: f64,
    /// Residual of the board's momentum balance: `|m dv/dt - (hands + tool + weight)|`, N. The hands' forces are those of the
    /// last substep, so the residual is meaningful only while forces change slowly.
    pub force_residual_n: f64,
    /// Difference between the travels of two coupled fingers, m.
    pub coupling_m: f64,
    /// Energy that contacts and integration added to the scene since the start, J: the kinetic energy minus the work of
    /// weight, servos, fingers and tool. Friction and damping decrease it. It can increase physically only by the
    /// small elastic energy of the contacts.
    pub contact_energy_j: f64,
}

impl Sample {
    /// True if at least one pad presses on the board, or a measured gripper holds it.
    #[must_use]
    pub fn has_contact(&self) -> bool {
        let holds =
            |arm: &ArmSample| arm.grip_wrench_g.is_some() || arm.pads.iter().any(|pad| pad.normal_force_n > 0.0);
        self.arms.iter().any(holds)
    }
}

/// The state of one arm after one step.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSample {
    /// Joint angles, rad.
    pub q_rad: Vec<f64>,
    /// Travel of each finger from its closed position, m.
    pub finger_m: Vec<f64>,
    /// Joint torques demanded by the position control, N m.
    pub torque_demanded_nm: Vec<f64>,
    /// Joint torques after the effort limit, N m.
    pub torque_applied_nm: Vec<f64>,
    /// Pose of the hand in O: G axes, origin at the centre between the pads.
    pub x_oc: Pose,
    /// One entry per pad.
    pub pads: Vec<PadSample>,
    /// Wrench of a measured gripper on the board about the grasp point in G axes. It lets go in the step in which the wrench
    /// leaves the limits; `None` after it, and for pads.
    pub grip_wrench_g: Option<Wrench>,
}

/// The state of one pad after one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadSample {
    /// Force of the pad on the board along the pad's normal, N.
    pub normal_force_n: f64,
    /// Wrench of the pad on the board about the pad's centre, W axes.
    pub wrench_w: Wrench,
    /// Position of the pad's centre in W, m.
    pub p_wp_m: nalgebra::Vector3<f64>,
}
