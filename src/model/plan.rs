//! The plan: where the board is held, by which arms, in which configuration, and how the person stands. Its JSON form is
//! the contract with planners that are not ours.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseRecord, pose},
    operation::Operation,
    scenario::{Hand, Person, PlannerKind, Scenario, Sex, is_default},
};

/// A hold of a board. `comfort`, `stability`, `human`, `planner` and `scenario` may be absent in a file that is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The file format, 1.
    pub format: u32,
    /// A name for tables and file names.
    pub name: String,
    /// The name of a built-in robot, or the path of a description file.
    pub robot: String,
    /// The forceful operation, with the roll of the tool that was chosen.
    pub operation: Operation,
    /// The board and its pose.
    pub object: PlacedObject,
    /// The arms that hold, in the order of the robot's description.
    pub arms: Vec<ArmHold>,
    /// The person's posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub human: Option<HumanPosture>,
    /// The comfort of that posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comfort: Option<Comfort>,
    /// The stability predicted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// Who made the plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planner: Option<PlannerRecord>,
    /// The scenario that the plan answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// The version of Benchdog that wrote the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub benchdog: Option<String>,
}

/// The board in the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacedObject {
    /// Width, height and thickness along x_O, y_O, z_O, m.
    pub size_m: [f64; 3],
    /// Mass, kg.
    pub mass_kg: f64,
    /// Pose in the world.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_wo: Pose,
}

/// One arm's part of the hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmHold {
    /// The arm's name in the robot's description.
    pub name: String,
    /// The arm's joints, from the base outward.
    pub joints: Vec<String>,
    /// Their angles, rad.
    pub q_rad: Vec<f64>,
    /// The gripper's pose on the board.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_og: Pose,
    /// Force with which each finger is pushed, N.
    pub grip_force_n: f64,
}

/// The person's stance and working arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HumanPosture {
    /// Standing height, m.
    pub height_m: f64,
    /// Body mass, kg.
    pub mass_kg: f64,
    /// Selects strengths and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile.
    pub percentile: f64,
    /// How far the trunk leans forward about the hips, degrees; upright unless given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub lean_deg: f64,
    /// Pose of the body, on the floor between the feet.
    #[serde(with = "pose")]
    #[schemars(with = "PoseRecord")]
    pub x_wb: Pose,
    /// Angles of the working arm, rad; those of the mirrored right arm for a left-handed person.
    pub q_rad: [f64; 7],
}

impl HumanPosture {
    /// A person in a posture.
    pub fn new(person: &Person, x_wb: Pose, q_rad: [f64; 7]) -> Self {
        let Person { height_m, mass_kg, sex, hand, percentile, lean_deg } = *person;
        Self { height_m, mass_kg, sex, hand, percentile, lean_deg, x_wb, q_rad }
    }

    /// The person without the posture.
    pub fn person(&self) -> Person {
        let Self { height_m, mass_kg, sex, hand, percentile, lean_deg, .. } = *self;
        Person { height_m, mass_kg, sex, hand, percentile, lean_deg }
    }
}

/// The comfort of a posture (METHOD sections 4 and 5).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Comfort {
    /// `1 / ||alpha||^2`, as printed in the paper.
    pub muscular: f64,
    /// `1 / (||alpha||^2 + 0.01)`, which the planners maximise.
    pub muscular_regularised: f64,
    /// The peripersonal metric, m.
    pub peripersonal_m: f64,
    /// The peripersonal metric times the number of body points: the sum in place of the mean, on the scale of the
    /// paper's captions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peripersonal_scaled: Option<f64>,
    /// `weight_muscular muscular_regularised + weight_peripersonal peripersonal_m`, or the normalised objective where
    /// `comfort.peripersonal_share` asks for it; of this posture or, with `comfort.person = "average"`, of `average`.
    pub objective: f64,
    /// Torque over strength of each joint of the working arm.
    pub activations: [f64; 7],
    /// The mean over all of the person's answers to the hold; only with `comfort.person = "average"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub average: Option<MeanComfort>,
    /// The posture's RULA score; reported, not optimised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rula: Option<RulaScore>,
}

/// The mean comfort over the person's feasible answers on a uniform grid (METHOD section 3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeanComfort {
    /// How many answers the grid has.
    #[serde(rename = "answers")]
    pub responses: u64,
    /// Mean of `1 / (||alpha||^2 + 0.01)`.
    pub muscular_regularised: f64,
    /// Mean of the peripersonal metric, m.
    pub peripersonal_m: f64,
}

/// The score of a posture by the Rapid Upper Limb Assessment (McAtamney & Corlett 1993).
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

/// The predicted stability (METHOD section 6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stability {
    /// The largest multiple of the operation that any distribution of forces holds; at most 100.
    pub load_factor: f64,
    /// The largest multiple that compliant, position-controlled arms hold; at most 100.
    pub compliant_load_factor: f64,
    /// What limits the load factor, such as `left upper pad: friction` or `left_w1: torque`.
    pub binding: Vec<String>,
    /// Joint torques of each arm in the compliant equilibrium at load 1, N m.
    pub joint_torque_nm: BTreeMap<String, Vec<f64>>,
    /// Length of the displacement of the tool point in the compliant equilibrium at load 1, mm.
    pub predicted_deflection_mm: f64,
}

/// Who made the plan, and at what cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlannerRecord {
    /// What was maximised.
    pub kind: PlannerKind,
    /// Seed of the search.
    pub seed: u64,
    /// Time that the search took, ms; this and `map_ms` are the figures that two equal runs do not share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_ms: Option<f64>,
    /// Time that the map of the robot and this size of board took, ms: that is made once for all plans of one run; zero
    /// where it was at hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_ms: Option<f64>,
    /// How many candidates the search scored.
    pub evaluations: u64,
}
