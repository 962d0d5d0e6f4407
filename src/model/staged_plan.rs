//! The staged plan of a task: holds, motions of the board and regrasps in their order (`docs/method.md#112-staged-plans`).
//!
//! Its JSON form, format 2, is the interface to other task planners; see `benchdog schema staged-plan`. It states what cannot be
//! computed: how the board is held at the start, the joint paths over time, the new grasp of a regrasp and where the person
//! stands. Everything else follows: the arms end a motion where its path ends, and the board goes with the hands that hold it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseForm, pose},
    muscle_work::MuscleWork,
    plan::{ArmHold, Comfort, HumanPosture, PlacedObject, PlannerRecord, Stability},
    scenario::Scenario,
    task::Task,
    tool_path::Piece,
};

/// The file format of staged plans.
pub const STAGED_FORMAT: u32 = 2;

/// A plan for a whole task. `planner`, `scenario` and `benchdog` are optional.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StagedPlan {
    /// The file format, 2.
    pub format: u32,
    /// The name in tables and file names.
    pub name: String,
    /// The name of a built-in robot, or the path of a description file.
    pub robot: String,
    /// The task.
    pub task: Task,
    /// The board and its pose at the start.
    pub object: PlacedObject,
    /// The arms that hold the board at the start, in the order of the robot's description.
    pub arms: Vec<ArmHold>,
    /// The stages in their order. All pieces of the path are worked on in their order.
    pub stages: Vec<Stage>,
    /// How the plan was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planner: Option<PlannerRecord>,
    /// The scenario that was planned; its operation is that of the first piece.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// The version of Benchdog that wrote the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub benchdog: Option<String>,
}

/// A stage of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "lowercase")]
pub enum Stage {
    /// All arms hold the board still, and the person works on it.
    Hold(HoldStage),
    /// All arms move the board; the tool is lifted.
    Move(MoveStage),
    /// One arm lets go, moves and grips the board elsewhere while the others hold it still; the tool is lifted.
    Regrasp(RegraspStage),
}

impl Stage {
    /// The kind's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hold(_) => "hold",
            Self::Move(_) => "move",
            Self::Regrasp(_) => "regrasp",
        }
    }

    /// What the person does; in a hold they work where they stand.
    #[must_use]
    pub fn person(&self) -> PersonDuring {
        match self {
            Self::Hold(_) => PersonDuring::Stays,
            Self::Move(motion) => motion.person,
            Self::Regrasp(regrasp) => regrasp.person,
        }
    }
}

/// A hold in which pieces of the path are worked on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoldStage {
    /// The pieces in their order.
    pub pieces: Vec<WorkedPiece>,
}

/// A piece of the path with the person who works on it. All but `piece` is optional.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorkedPiece {
    /// The piece.
    pub piece: Piece,
    /// Roll of a drill about its axis from x_T = x_O, rad; 0 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_rad: Option<f64>,
    /// The person's posture in its middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human: Option<HumanPosture>,
    /// The comfort of this posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comfort: Option<Comfort>,
    /// What the muscles of the working arm do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscles: Option<MuscleWork>,
    /// The predicted stability in its middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
}

/// What the person does while arms move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PersonDuring {
    /// They stay in the posture of the piece before, or of the first piece if there is no piece before.
    #[default]
    Stays,
    /// They step back by [`STEP_BACK_M`].
    StepsBack,
}

/// How far the person steps back from the board, m (assumed): one step.
pub const STEP_BACK_M: f64 = 0.6;

/// A motion of the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoveStage {
    /// What the person does.
    #[serde(default)]
    pub person: PersonDuring,
    /// Times of the path, s, from 0.
    pub time_s: Vec<f64>,
    /// The path of every arm that holds, in the order of the plan's arms.
    pub arms: Vec<ArmPath>,
}

/// The joint path of an arm, at the times of its stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmPath {
    /// The arm's name.
    pub name: String,
    /// Joint angles at each time, rad; linear in between.
    pub q_rad: Vec<Vec<f64>>,
}

/// A change of one arm's grasp. Before its path the gripper opens, after it the gripper closes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegraspStage {
    /// What the person does.
    #[serde(default)]
    pub person: PersonDuring,
    /// Times of the path, s, from 0.
    pub time_s: Vec<f64>,
    /// The path of the arm that lets go, from its old grasp to the new one.
    pub arm: ArmPath,
    /// The gripper's new pose in O.
    #[serde(with = "pose")]
    #[schemars(with = "PoseForm")]
    pub x_og: Pose,
    /// The force with which each finger closes, N.
    pub grip_force_n: f64,
}

/// How the board is held between two stages: what follows from a plan by kinematics.
#[derive(Clone, Debug, PartialEq)]
pub struct Holding {
    /// The board's pose.
    pub x_wo: Pose,
    /// The arms that hold it.
    pub arms: Vec<ArmHold>,
}

impl StagedPlan {
    /// The number of regrasps.
    #[must_use]
    pub fn regrasps(&self) -> usize {
        self.stages.iter().filter(|stage| matches!(stage, Stage::Regrasp(_))).count()
    }

    /// The number of motions of the board.
    #[must_use]
    pub fn moves(&self) -> usize {
        self.stages.iter().filter(|stage| matches!(stage, Stage::Move(_))).count()
    }

    /// All worked pieces in their order, each with the number of its stage.
    pub fn worked_pieces(&self) -> impl Iterator<Item = (usize, &WorkedPiece)> {
        self.stages.iter().enumerate().flat_map(|(number, stage)| {
            let pieces = if let Stage::Hold(hold) = stage { &hold.pieces[..] } else { &[] };
            pieces.iter().map(move |piece| (number, piece))
        })
    }
}
