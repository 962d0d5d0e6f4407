//! The plan: the board's pose, the arms' grasps and joint angles, and the person's posture.
//!
//! Its JSON form is the interface to other planners; see `benchdog schema plan`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseRecord, pose},
    operation::Operation,
    scenario::{Hand, Person, PlannerKind, Scenario, Sex, is_default},
};

/// A grasp of a board by a robot's arms. `human`, `comfort`, `stability`, `planner`, `scenario` and `benchdog` are optional.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The file format, 1.
    pub format: u32,
    /// The name in tables and file names.
    pub name: String,
    /// The name of a built-in robot, or the path of a description file.
    pub robot: String,
    /// The forceful operation, with the chosen roll of the tool.
    pub operation: Operation,
    /// The board and its pose.
    pub object: PlacedObject,
    /// The arms that hold the board, in the order of the robot's description.
    pub arms: Vec<ArmHold>,
    /// The person's posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human: Option<HumanPosture>,
    /// The comfort of this posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comfort: Option<Comfort>,
    /// The predicted stability.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// How the plan was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planner: Option<PlannerRecord>,
    /// The scenario that was planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// The version of Benchdog that wrote the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub benchdog: Option<String>,
}

/// The board and its pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacedObject {
    /// Width, height and thickness along x_O, y_O, z_O, m.
    pub size_m: [f64; 3],
    /// Mass, kg.
    pub mass_kg: f64,
    /// Pose of the board in W.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_wo: Pose,
}

/// The grasp and the joint angles of one arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmHold {
    /// The arm's name in the robot's description.
    pub name: String,
    /// The arm's joints, from the base outward.
    pub joints: Vec<String>,
    /// The joint angles, rad.
    pub q_rad: Vec<f64>,
    /// The gripper's pose in O.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_og: Pose,
    /// The force that closes each finger, N.
    pub grip_force_n: f64,
}

/// The person's body dimensions, pose and arm configuration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HumanPosture {
    /// Standing height, m.
    pub height_m: f64,
    /// Body mass, kg.
    pub mass_kg: f64,
    /// Selects the strength curves and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile.
    pub percentile: f64,
    /// Forward lean of the trunk about the hips, degrees; 0 by default.
    #[serde(default, skip_serializing_if = "is_default")]
    pub lean_deg: f64,
    /// Pose of the body in W; its origin is on the floor between the feet.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_wb: Pose,
    /// Joint angles of the working arm, rad. For a left-handed person those of the mirrored right arm.
    pub q_rad: [f64; 7],
}

impl HumanPosture {
    /// The posture of a person with this pose and these joint angles.
    pub fn new(person: &Person, x_wb: Pose, q_rad: [f64; 7]) -> Self {
        let Person { height_m, mass_kg, sex, hand, percentile, lean_deg } = *person;
        Self { height_m, mass_kg, sex, hand, percentile, lean_deg, x_wb, q_rad }
    }

    /// The person's body dimensions.
    #[must_use]
    pub fn person(&self) -> Person {
        let Self { height_m, mass_kg, sex, hand, percentile, lean_deg, .. } = *self;
        Person { height_m, mass_kg, sex, hand, percentile, lean_deg }
    }
}

/// The comfort of a posture (`docs/method.md#4-muscular-comfort`, `docs/method.md#5-peripersonal-comfort`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Comfort {
    /// Muscular comfort as printed in the paper, `1 / ||alpha||^2` with the activations `alpha`.
    pub muscular: f64,
    /// Regularised muscular comfort `1 / (||alpha||^2 + 0.01)`, which the planners maximise.
    pub muscular_regularised: f64,
    /// Peripersonal comfort, m.
    pub peripersonal_m: f64,
    /// Peripersonal comfort times the number of body points: the sum instead of the mean, on the scale of the paper's
    /// captions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peripersonal_scaled: Option<f64>,
    /// The objective: `weight_muscular muscular_regularised + weight_peripersonal peripersonal_m`, or the normalised
    /// objective if the scenario has `comfort.peripersonal_share`. It is that of this posture, or of `average` if the
    /// scenario has `comfort.person = "average"`.
    pub objective: f64,
    /// Activation of each joint of the working arm: torque divided by strength.
    pub activations: [f64; 7],
    /// The mean comfort over all of the person's responses; only with `comfort.person = "average"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub average: Option<MeanComfort>,
    /// The posture's RULA score. It is reported, not optimised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rula: Option<RulaScore>,
}

/// The mean comfort over the person's feasible responses on a uniform grid (`docs/method.md#33-the-persons-response`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeanComfort {
    /// Number of feasible responses on the grid.
    #[serde(rename = "answers")]
    pub responses: u64,
    /// Mean regularised muscular comfort.
    pub muscular_regularised: f64,
    /// Mean peripersonal comfort, m.
    pub peripersonal_m: f64,
}

/// The score of a posture by the Rapid Upper Limb Assessment (RULA, McAtamney and Corlett 1993).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RulaScore {
    /// The grand score, from table C: 1 or 2 acceptable, 3 or 4 investigate further, 5 or 6 change soon, 7 change now.
    pub score: u8,
    /// Score C: arm and wrist with the load, from table A.
    pub arm_and_wrist: u8,
    /// Score D: neck, trunk and legs with the load, from table B.
    pub neck_trunk_legs: u8,
}

/// The predicted stability (`docs/method.md#6-stability`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stability {
    /// Load factor: the largest multiple of the operation's wrench for which some contact forces within the limits balance
    /// it; at most 100.
    pub load_factor: f64,
    /// Compliant load factor: the largest multiple that position-controlled, compliant arms resist; at most 100.
    pub compliant_load_factor: f64,
    /// The constraints that are active at the load factor, such as `left upper pad: friction` or `left_w1: torque`.
    pub binding: Vec<String>,
    /// Joint torques of each arm in the compliant equilibrium at load factor 1, N m.
    pub joint_torque_nm: BTreeMap<String, Vec<f64>>,
    /// Displacement of the tool point in the compliant equilibrium at load factor 1, mm.
    pub predicted_deflection_mm: f64,
}

/// How a plan was found, and at what cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlannerRecord {
    /// The planner.
    pub kind: PlannerKind,
    /// Seed of the search.
    pub seed: u64,
    /// Duration of the search, ms. Only this and `map_ms` differ between two equal runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_ms: Option<f64>,
    /// Duration of the precomputation that the plan uses, ms. Plans of one command may share it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_ms: Option<f64>,
    /// Number of candidates that the search evaluated.
    pub evaluations: u64,
}
