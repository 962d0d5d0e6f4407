//! The form of a plan file: that of [`Plan`](crate::model::plan::Plan), of which values that follow from others may be left out.

use std::{borrow::Cow, fmt};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, MapAccess, SeqAccess, Visitor},
};

use crate::model::{
    frames::{Pose, PoseForm, optional_pose},
    muscle_work::MuscleWork,
    operation::Operation,
    plan::{Clearance, Comfort, HumanPosture, PlannerRecord, Stability},
    plate::Plate,
    scenario::Scenario,
};

/// A grasp of a board by a robot's arms. `human`, `comfort`, `stability`, `clearance`, `planner`, `scenario` and `benchdog` are
/// optional. An arm has joint angles, a grasp or both; what is left out is filled in.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Plan")]
pub struct PlanFile {
    /// The file format, 1.
    pub format: u32,
    /// The name in tables and file names.
    pub name: String,
    /// The name of a built-in robot, or the path of a description file.
    pub robot: String,
    /// The forceful operation, with the chosen roll of the tool.
    pub operation: Operation,
    /// The board and its pose.
    pub object: ObjectInput,
    /// The arms that hold the board, in the order of the robot's description.
    pub arms: Vec<ArmInput>,
    /// The person's posture.
    #[serde(default)]
    pub human: Option<HumanPosture>,
    /// The comfort of this posture.
    #[serde(default)]
    pub comfort: Option<Comfort>,
    /// What the muscles of the person's working arm do.
    #[serde(default)]
    pub muscles: Option<MuscleWork>,
    /// The predicted stability.
    #[serde(default)]
    pub stability: Option<Stability>,
    /// The least distance of the robot from itself and from the board.
    #[serde(default)]
    pub clearance: Option<Clearance>,
    /// How the plan was found.
    #[serde(default)]
    pub planner: Option<PlannerRecord>,
    /// The scenario that was planned.
    #[serde(default)]
    pub scenario: Option<Scenario>,
    /// The version of Benchdog that wrote the file.
    #[serde(default)]
    pub benchdog: Option<String>,
}

/// The board and its pose.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectInput {
    /// Width, height and thickness along x_O, y_O, z_O, m; of a plate those of its bounding box.
    pub size_m: [f64; 3],
    /// Outline and holes of a plate; without them the board is a box about O.
    #[serde(default)]
    pub plate: Option<Plate>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Centre of mass in O, m; by default the centroid.
    #[serde(default)]
    pub com_m: Option<[f64; 3]>,
    /// Pose of the board in W; by default it follows from the first arm with both `q_rad` and `x_og`.
    #[serde(default, deserialize_with = "optional_pose")]
    #[schemars(with = "Option<PoseForm>")]
    pub x_wo: Option<Pose>,
}

/// The grasp or the joint angles of one arm, or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmInput {
    /// The arm's name in the robot's description.
    pub name: String,
    /// The arm's joints in the order of `q_rad` and `seed_rad`, if one of them is a list.
    #[serde(default)]
    pub joints: Option<Vec<String>>,
    /// The joint angles, rad: a list in the order of `joints`, or an object of the joints' names. By default they follow from
    /// `x_wo` and `x_og` by inverse kinematics: of the answers without a contact the nearest to `seed_rad`.
    #[serde(default)]
    pub q_rad: Option<Angles>,
    /// The joint angles that the inverse kinematics is to be near to, rad, as a list or an object; by default the middle of the
    /// joint ranges.
    #[serde(default)]
    pub seed_rad: Option<Angles>,
    /// The gripper's pose in O; by default it follows from `x_wo` and `q_rad`.
    #[serde(default, deserialize_with = "optional_pose")]
    #[schemars(with = "Option<PoseForm>")]
    pub x_og: Option<Pose>,
    /// The force that closes each finger, N; by default the scenario's `grip.force_n` or, without a scenario, the most that the
    /// gripper gives.
    #[serde(default)]
    pub grip_force_n: Option<f64>,
}

/// Angles of an arm's joints, rad.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// In the order of the arm's `joints`.
    Listed(Vec<f64>),
    /// By the joints' names, every name once.
    Named(Vec<(String, f64)>),
}

impl<'de> Deserialize<'de> for Angles {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnglesVisitor)
    }
}

struct AnglesVisitor;

impl<'de> Visitor<'de> for AnglesVisitor {
    type Value = Angles;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of angles in rad, or an object of joints with their angles")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Angles, A::Error> {
        let mut angles_rad = Vec::new();
        while let Some(angle_rad) = list.next_element()? {
            angles_rad.push(angle_rad);
        }
        Ok(Angles::Listed(angles_rad))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Angles, A::Error> {
        let mut named: Vec<(String, f64)> = Vec::new();
        while let Some((name, angle_rad)) = map.next_entry::<String, f64>()? {
            if named.iter().any(|(other, _)| *other == name) {
                return Err(A::Error::custom(format!("found the joint {name} again, expected every joint once")));
            }
            named.push((name, angle_rad));
        }
        Ok(Angles::Named(named))
    }
}

impl JsonSchema for Angles {
    fn schema_name() -> Cow<'static, str> {
        "Angles".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Joint angles, rad: a list in the order of `joints`, or an object of the joints' names.",
            "anyOf": [
                {"type": "array", "items": {"type": "number", "format": "double"}},
                {"type": "object", "additionalProperties": {"type": "number", "format": "double"}},
            ],
        })
    }
}
