//! The trace: what happened in a simulation, step by step. The judge and the recording see this and nothing else of the
//! physics.

use super::{frames::Pose, wrench::Wrench};

/// A part of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Under gravity alone; the state at its end is the reference.
    Settle,
    /// The load grows.
    Ramp,
    /// Under the whole load.
    Hold,
    /// The load is gone.
    Release,
}

impl Phase {
    /// The phase's name in tables and recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Settle => "settle",
            Self::Ramp => "ramp",
            Self::Hold => "hold",
            Self::Release => "release",
        }
    }

    /// True while the tool's wrench acts.
    pub fn is_loaded(self) -> bool {
        matches!(self, Self::Ramp | Self::Hold)
    }
}

/// A simulated hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The arms, in the order of every sample's `arms`.
    pub arms: Vec<ArmTrace>,
    /// Position of the tool point on the board at the start, in O, m.
    pub p_ot_m: nalgebra::Vector3<f64>,
    /// One sample a step, the first at time 0. The sample's forces are those of the step that led to it.
    pub samples: Vec<Sample>,
    /// When and why the simulation broke down, in words; the samples end before. None when it ran to its end.
    pub broke_down: Option<String>,
    /// The first bodies of robot or board and person that overlapped; none when none did, or the plan has no person.
    pub person_touch: Option<PersonTouch>,
}

/// Who touched the person, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersonTouch {
    /// A link's name, or `the board`.
    pub body: String,
    /// The part of the person, in words.
    pub part: String,
}

/// What stays the same about an arm during a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTrace {
    /// The arm's name.
    pub name: String,
    /// The arm's joints, in the order of every sample.
    pub joints: Vec<String>,
    /// The largest torque of each joint, N m.
    pub effort_nm: Vec<f64>,
    /// The pads, in the order of every sample.
    pub pads: Vec<String>,
    /// Force with which each finger is pushed, N.
    pub grip_force_n: f64,
}

/// The state after one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start, s.
    pub time_s: f64,
    /// The part of the simulation.
    pub phase: Phase,
    /// The multiple of the operation's wrench that acts.
    pub load_factor: f64,
    /// The tool's wrench on the board about the tool point, world axes.
    pub tool_wrench_w: Wrench,
    /// The board's pose.
    pub x_wo: Pose,
    /// Position of the tool point on the board, in O, m: a knife travels.
    pub p_ot_m: nalgebra::Vector3<f64>,
    /// One entry an arm.
    pub arms: Vec<ArmSample>,
    /// What the engine makes of the laws of mechanics.
    pub self_check: StepCheck,
    /// Least distance of robot and board from the person, who stands still, m; the depth of an overlap as a negative number. Tool,
    /// working hand and forearm may be at the board. Measured every 10 ms, in every step where it is below 1 cm, and held in
    /// between. None when the plan has no person.
    pub person_distance_m: Option<f64>,
}

/// How far the engine is from the laws that it should keep, in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCheck {
    /// Deepest penetration of a pad that touches the board, m.
    pub penetration_m: f64,
    /// What the board's change of momentum leaves unexplained: `|m dv/dt - (pads + tool + weight)|`, N. The pads' forces
    /// are those of the last substep, so it is nothing at rest and no figure of merit while forces change quickly.
    pub force_residual_n: f64,
    /// How far the travels of two coupled fingers differ, m.
    pub coupling_m: f64,
    /// Energy that contacts and integration brought into the scene since the start, J: the kinetic energy less the work
    /// of weight, servos, fingers and tool. Friction and damping make it fall; nothing real makes it rise, but for
    /// the little that contacts store.
    pub contact_energy_j: f64,
}

impl Sample {
    /// True when some pad presses on the board.
    pub fn has_contact(&self) -> bool {
        self.arms.iter().flat_map(|arm| &arm.pads).any(|pad| pad.normal_force_n > 0.0)
    }
}

/// The state of one arm after one step.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSample {
    /// Joint angles, rad.
    pub q_rad: Vec<f64>,
    /// Travel of each finger from its closed limit, m.
    pub finger_m: Vec<f64>,
    /// Torque that the position control asked for, N m.
    pub torque_demanded_nm: Vec<f64>,
    /// Torque after the effort limit, N m.
    pub torque_applied_nm: Vec<f64>,
    /// Pose of the hand on the board: the frame with the gripper's axes at the centre between its pads, in O.
    pub x_oc: Pose,
    /// One entry a pad.
    pub pads: Vec<PadSample>,
}

/// The state of one pad after one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadSample {
    /// Force of the pad on the board along the pad's normal, N.
    pub normal_force_n: f64,
    /// Wrench of the pad on the board about the pad's centre, world axes.
    pub wrench_w: Wrench,
    /// The pad's centre, world, m.
    pub p_wp_m: nalgebra::Vector3<f64>,
}
