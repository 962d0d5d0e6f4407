//! The scenario file: TOML, in which most keys are optional.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    load_section::LoadSection, object_section::ObjectSection, sweep_section::SweepSection, task_section::TaskSection,
};
use crate::model::{
    operation::OperationKind,
    scenario::{
        ComfortSettings, Expectation, Hand, Limits, Person, PlannerSettings, PostureKind, PostureLimits, Sex,
        ShoulderKind, SimulationSettings,
    },
    uncertainty::Uncertainty,
};

/// A scenario file.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// The file format, 1.
    pub format: u32,
    /// The name in tables and file names: letters, digits, `-`, `_` and `.`.
    pub name: String,
    /// The robot; `baxter` by default.
    #[serde(default)]
    pub robot: RobotSection,
    /// The person.
    #[serde(default)]
    pub human: HumanSection,
    /// The tool; by default a drill or a knife, by the kind of the operation.
    #[serde(default)]
    pub tool: Option<ToolSection>,
    /// The board; by default that of the reproduction of the paper.
    #[serde(default)]
    pub object: ObjectSection,
    /// The forceful operation. A task file has `task` in its place.
    pub operation: Option<OperationSection>,
    /// A path that is cut or drilled, in place of `operation`.
    pub task: Option<TaskSection>,
    /// How comfort is defined.
    #[serde(default)]
    pub comfort: ComfortSettings,
    /// The planner.
    #[serde(default)]
    pub planner: PlannerSettings,
    /// Grip force and friction.
    #[serde(default)]
    pub grip: GripSection,
    /// Phases and time step of the simulation.
    #[serde(default)]
    pub simulation: SimulationSettings,
    /// The tool's load over time.
    #[serde(default)]
    pub load: LoadSection,
    /// Deviations of the simulation from the values that the plan assumes.
    #[serde(default)]
    pub uncertainty: Uncertainty,
    /// What a sweep draws at random for each of its runs; without it there is no sweep.
    #[serde(default)]
    pub sweep: Option<SweepSection>,
    /// The limits that the hold must not exceed.
    #[serde(default)]
    pub limits: LimitsSection,
    /// The expected verdict; `holds` by default.
    #[serde(default)]
    pub expect: Expectation,
}

/// `[grip]`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GripSection {
    /// The force that closes each finger, N; by default the smallest `grip_force_n` of the robot's grippers, or 30.
    pub force_n: Option<f64>,
    /// Coulomb friction coefficient of pads and board; by default the smallest `friction` of the robot's grippers, or 0.6.
    pub friction: Option<f64>,
}

/// `[robot]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSection {
    /// The name of a built-in robot, or the path of a description file relative to the scenario file's folder.
    pub description: String,
    /// Folders that contain the packages of the urdf's meshes, relative to the scenario file's folder; looked at before those
    /// of the description.
    pub packages: Vec<String>,
    /// Positions of joints that are not part of an arm or a gripper, such as a lifting torso, rad or m; in place of those of
    /// the description.
    pub posture: BTreeMap<String, f64>,
}

impl Default for RobotSection {
    fn default() -> Self {
        Self { description: crate::robot::BUILTIN[0].into(), packages: Vec::new(), posture: BTreeMap::new() }
    }
}

/// `[human]`. The keys from `facing_deg` on are limits of a natural posture; angles in degrees.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HumanSection {
    /// Standing height, m; by default 1.75 for a man, 1.62 for a woman.
    pub height_m: Option<f64>,
    /// Body mass, kg; by default 75 for a man, 62 for a woman.
    pub mass_kg: Option<f64>,
    /// Selects the strength curves and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile, 0.1 to 99.9.
    pub percentile: f64,
    /// Forward lean of the trunk about the hips, degrees, 0 to 15; 0, upright, by default.
    pub lean_deg: f64,
    /// Which arm configurations the shoulder permits: `swing-twist` limits elevation and twist of the upper arm, `box` each of
    /// the three shoulder angles.
    pub shoulder: ShoulderKind,
    /// `natural`: the person stands as people stand and sees the work; `unrestricted`: only strength, joint limits and
    /// clearances apply.
    pub posture: PostureKind,
    /// Largest azimuth of the tool tip from straight ahead, seen from the body's axis.
    pub facing_deg: f64,
    /// Largest angle between the worked face's normal and the direction from the tool tip to the eye.
    pub view_deg: f64,
    /// Largest turn of the gaze from straight ahead.
    pub gaze_yaw_deg: f64,
    /// Range of the gaze's elevation over the horizontal.
    pub gaze_pitch_deg: [f64; 2],
    /// Range of the distance from the eye to the tool tip, m.
    pub eye_distance_m: [f64; 2],
    /// True if board, robot, trunk, idle arm and working arm must not be in the line of sight.
    pub line_of_sight: bool,
    /// Smallest elevation of the worked face's normal over the horizontal.
    pub face_elevation_deg: f64,
    /// Largest elevation of the upper arm, from hanging.
    pub upper_arm_deg: f64,
    /// Largest distance from shoulder to wrist as a share of the straight arm.
    pub reach: f64,
    /// Range of the elbow's flexion.
    pub elbow_deg: [f64; 2],
    /// Smallest distance of every joint of the arm but the last from its limits.
    pub limit_margin_deg: f64,
    /// Smallest distance of the wrist's ulnar deviation from its limits.
    pub deviation_margin_deg: f64,
    /// `free`: the plan says where the person stands; `given`: they stand at `x_m`, `y_m` and face along `heading_deg`.
    pub place: PlaceKind,
    /// With `place = "given"`: position along x_W, m.
    pub x_m: Option<f64>,
    /// With `place = "given"`: position along y_W, m.
    pub y_m: Option<f64>,
    /// With `place = "given"`: direction in which the person faces, degrees from x_W towards y_W.
    pub heading_deg: Option<f64>,
    /// With `place = "given"`: largest deviation along each of x_W and y_W, m; 0.05 by default.
    pub place_tolerance_m: Option<f64>,
    /// With `place = "given"`: largest deviation of the heading, degrees; 5 by default.
    pub heading_tolerance_deg: Option<f64>,
}

/// Whether a scenario says where the person stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PlaceKind {
    /// The plan does.
    #[default]
    Free,
    /// The scenario does.
    Given,
}

impl Default for HumanSection {
    fn default() -> Self {
        let Person { sex, hand, percentile, lean_deg, shoulder, .. } = Person::default();
        let PostureLimits {
            kind: posture,
            facing_deg,
            view_deg,
            gaze_yaw_deg,
            gaze_pitch_deg,
            eye_distance_m,
            line_of_sight,
            face_elevation_deg,
            upper_arm_deg,
            reach,
            elbow_deg,
            limit_margin_deg,
            deviation_margin_deg,
        } = PostureLimits::NATURAL;
        Self {
            height_m: None,
            mass_kg: None,
            sex,
            hand,
            percentile,
            lean_deg,
            shoulder,
            posture,
            facing_deg,
            view_deg,
            gaze_yaw_deg,
            gaze_pitch_deg,
            eye_distance_m,
            line_of_sight,
            face_elevation_deg,
            upper_arm_deg,
            reach,
            elbow_deg,
            limit_margin_deg,
            deviation_margin_deg,
            place: PlaceKind::Free,
            x_m: None,
            y_m: None,
            heading_deg: None,
            place_tolerance_m: None,
            heading_tolerance_deg: None,
        }
    }
}

impl HumanSection {
    /// The limits of the posture.
    pub fn posture_limits(&self) -> PostureLimits {
        PostureLimits {
            kind: self.posture,
            facing_deg: self.facing_deg,
            view_deg: self.view_deg,
            gaze_yaw_deg: self.gaze_yaw_deg,
            gaze_pitch_deg: self.gaze_pitch_deg,
            eye_distance_m: self.eye_distance_m,
            line_of_sight: self.line_of_sight,
            face_elevation_deg: self.face_elevation_deg,
            upper_arm_deg: self.upper_arm_deg,
            reach: self.reach,
            elbow_deg: self.elbow_deg,
            limit_margin_deg: self.limit_margin_deg,
            deviation_margin_deg: self.deviation_margin_deg,
        }
    }
}

/// `[tool]`: the name of a shipped tool, or all of its figures.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToolSection {
    /// `drill`, `knife` or `knife-thumb-side`.
    pub name: Option<String>,
    /// Mass, kg. Its centre is at the palm.
    pub mass_kg: Option<f64>,
    /// Position of the tip in the hand's frame H, m.
    pub tip_h_m: Option<[f64; 3]>,
    /// Rotation `R_HT`, unit quaternion, scalar last.
    pub rotation_xyzw: Option<[f64; 4]>,
}

/// `[operation]`: `kind` determines which other keys are required.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationSection {
    /// `drill`, `cut` or `wrench`.
    pub kind: OperationKind,
    /// For `drill` and `cut`: the point on the worked face, m along x_O and y_O from its centre.
    pub point_m: Option<[f64; 2]>,
    /// For `drill` and `cut`: the force, N.
    pub force_n: Option<f64>,
    /// For `cut`: the cutting direction in O, parallel to the face, of any length.
    pub direction_o: Option<[f64; 3]>,
    /// For `wrench`: the wrench on the board about the tool tip, O axes, N and N m.
    pub wrench_o: Option<[f64; 6]>,
    /// For `wrench`: the tool's pose in O.
    pub x_ot: Option<crate::model::frames::PoseForm>,
}

/// `[limits]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSection {
    /// Translation of a hand relative to the board, mm.
    pub slip_mm: f64,
    /// Rotation of a hand relative to the board, degrees.
    pub slip_deg: f64,
    /// Displacement of the board's tool point under the load, mm; by default 15 for `cut` and 5 otherwise.
    pub deflection_mm: Option<f64>,
    /// Displacement of the board's tool point under the board's weight, mm: from the hand-over to the load.
    pub sag_mm: f64,
    /// Rate of slip in the second half of the hold phase, mm/s.
    pub creep_mm_s: f64,
    /// Demanded joint torque divided by its limit.
    pub torque_ratio: f64,
    /// Smallest predicted load factor of a plan; the planner requires 1.1 times this value of the compliant load factor.
    pub load_factor: f64,
    /// Least distance of the robot from itself and from the board that the planner keeps, mm, at least 0.
    pub clearance_mm: f64,
    /// Largest RULA score of the person's posture, 1 to 7; no limit by default.
    pub rula: Option<u8>,
    /// Largest RULA score of arm and wrist, 1 to 12; no limit by default.
    pub rula_arm: Option<u8>,
    /// Largest REBA score of the person's posture, 1 to 12; no limit by default.
    pub reba: Option<u8>,
}

impl Default for LimitsSection {
    /// The default limits (`docs/method.md#810-default-limits`).
    fn default() -> Self {
        const USUAL: Limits = Limits::USUAL;
        Self {
            slip_mm: USUAL.slip_mm,
            slip_deg: USUAL.slip_deg,
            deflection_mm: None,
            sag_mm: USUAL.sag_mm,
            creep_mm_s: USUAL.creep_mm_s,
            torque_ratio: USUAL.torque_ratio,
            load_factor: USUAL.load_factor,
            clearance_mm: USUAL.clearance_mm,
            rula: USUAL.rula,
            rula_arm: USUAL.rula_arm,
            reba: USUAL.reba,
        }
    }
}
