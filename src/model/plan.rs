//! The plan: the board's pose, the arms' grasps and joint angles, and the person's posture.
//!
//! Its JSON form is the interface to other planners; see `benchdog schema plan`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    frames::{Pose, PoseForm, pose},
    lateral::LateralPush,
    muscle_work::MuscleWork,
    omitted::is_default,
    operation::Operation,
    scenario::{Hand, Limits, Person, PlannerKind, Scenario, Sex},
};

pub use super::board::PlacedObject;

/// A grasp of a board by a robot's arms. `human`, `comfort`, `muscles`, `stability`, `clearance`,
/// `planner`, `scenario` and `benchdog` are optional.
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
    /// What the muscles of the person's working arm do, whatever metric the planners maximise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscles: Option<MuscleWork>,
    /// The predicted stability.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// The least distance of the robot from itself and from the board.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clearance: Option<Clearance>,
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
    #[schemars(with = "PoseForm")]
    pub x_og: Pose,
    /// The force that closes each finger, N; 0, which files leave out, for a gripper with measured wrench limits.
    #[serde(default, skip_serializing_if = "is_default")]
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
    #[schemars(with = "PoseForm")]
    pub x_wb: Pose,
    /// Joint angles of the working arm, rad. For a left-handed person those of the mirrored right arm.
    pub q_rad: [f64; 7],
    /// How the person stands and sees the work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posture: Option<PostureFigures>,
}

impl HumanPosture {
    /// The posture of a person with this pose and these joint angles.
    pub fn new(person: &Person, x_wb: Pose, q_rad: [f64; 7]) -> Self {
        let Person { height_m, mass_kg, sex, hand, percentile, lean_deg, .. } = *person;
        Self { height_m, mass_kg, sex, hand, percentile, lean_deg, x_wb, q_rad, posture: None }
    }

    /// The person with these body dimensions, and the shoulder, posture limits and place of `rules`.
    #[must_use]
    pub fn person(&self, rules: &Person) -> Person {
        let Self { height_m, mass_kg, sex, hand, percentile, lean_deg, .. } = *self;
        Person { height_m, mass_kg, sex, hand, percentile, lean_deg, ..*rules }
    }
}

/// A figure of a posture with its limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PostureFigure {
    /// The value.
    pub value: f64,
    /// The smallest value that is permitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The largest value that is permitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
}

impl PostureFigure {
    /// The limits in words, such as `at most 60`; `None` without limits.
    #[must_use]
    pub fn limits_in_words(&self) -> Option<String> {
        match (self.min, self.max) {
            (Some(min), Some(max)) => Some(format!("{min} to {max}")),
            (Some(min), None) => Some(format!("at least {min}")),
            (None, Some(max)) => Some(format!("at most {max}")),
            (None, None) => None,
        }
    }

    /// The distance from the nearer limit, negative beyond it; infinite without limits.
    #[must_use]
    pub fn margin(&self) -> f64 {
        let above = self.min.map_or(f64::INFINITY, |min| self.value - min);
        let below = self.max.map_or(f64::INFINITY, |max| max - self.value);
        above.min(below)
    }
}

/// How the person stands and sees the work (`docs/method.md#413-natural-postures`), with the limits of
/// [`super::scenario::PostureLimits`]; without limits if the posture is unrestricted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PostureFigures {
    /// Azimuth of the tool tip from straight ahead, degrees, positive towards the working side.
    pub facing_deg: PostureFigure,
    /// Angle between the worked face's normal and the direction from the tool tip to the eye, degrees.
    pub view_deg: PostureFigure,
    /// Turn of the gaze from straight ahead, degrees, positive towards the working side.
    pub gaze_yaw_deg: PostureFigure,
    /// Elevation of the gaze over the horizontal, degrees.
    pub gaze_pitch_deg: PostureFigure,
    /// Distance from the eye to the tool tip, m.
    pub eye_distance_m: PostureFigure,
    /// The free share of the line from the eye to the tool tip: 1 if nothing is in the way.
    pub line_of_sight: PostureFigure,
    /// Elevation of the worked face's normal over the horizontal, degrees.
    pub face_elevation_deg: PostureFigure,
    /// Elevation of the upper arm from hanging, degrees.
    pub upper_arm_deg: PostureFigure,
    /// Distance from shoulder to wrist as a share of the straight arm.
    pub reach: PostureFigure,
    /// Flexion of the elbow, degrees.
    pub elbow_deg: PostureFigure,
    /// Smallest distance of a joint of the arm but the last from its limits, degrees.
    pub limit_margin_deg: PostureFigure,
    /// Distance of the wrist's ulnar deviation from its limits, degrees.
    pub deviation_margin_deg: PostureFigure,
}

/// A limit of a natural posture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PostureConstraint {
    /// The tool tip is too far to the side.
    Facing,
    /// The worked face is seen too flat, or from behind.
    View,
    /// The gaze turns too far to the side.
    GazeYaw,
    /// The gaze is too steep.
    GazePitch,
    /// The tool tip is too near to the eye or too far from it.
    EyeDistance,
    /// A body is in the line of sight.
    LineOfSight,
    /// The worked face looks down.
    FaceElevation,
    /// The upper arm is raised too far.
    UpperArm,
    /// The arm is too straight.
    Reach,
    /// The elbow is too straight or too bent.
    Elbow,
    /// A joint of the arm is too near to a limit.
    LimitMargin,
    /// The wrist's ulnar deviation is too near to a limit.
    DeviationMargin,
}

impl PostureConstraint {
    /// All of them, in the order of [`PostureFigures`].
    pub const ALL: [Self; 12] = [
        Self::Facing,
        Self::View,
        Self::GazeYaw,
        Self::GazePitch,
        Self::EyeDistance,
        Self::LineOfSight,
        Self::FaceElevation,
        Self::UpperArm,
        Self::Reach,
        Self::Elbow,
        Self::LimitMargin,
        Self::DeviationMargin,
    ];

    /// The key under `[human]` and in `human.posture`.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Facing => "facing_deg",
            Self::View => "view_deg",
            Self::GazeYaw => "gaze_yaw_deg",
            Self::GazePitch => "gaze_pitch_deg",
            Self::EyeDistance => "eye_distance_m",
            Self::LineOfSight => "line_of_sight",
            Self::FaceElevation => "face_elevation_deg",
            Self::UpperArm => "upper_arm_deg",
            Self::Reach => "reach",
            Self::Elbow => "elbow_deg",
            Self::LimitMargin => "limit_margin_deg",
            Self::DeviationMargin => "deviation_margin_deg",
        }
    }

    /// What is wrong if the limit is broken.
    #[must_use]
    pub fn broken(self) -> &'static str {
        match self {
            Self::Facing => "the tool tip is too far to the person's side",
            Self::View => "the person sees the worked face too flat or from behind",
            Self::GazeYaw => "the gaze turns too far to the side",
            Self::GazePitch => "the gaze is too steep",
            Self::EyeDistance => "the tool tip is too near to the eye or too far from it",
            Self::LineOfSight => "something is in the line of sight",
            Self::FaceElevation => "the worked face looks down",
            Self::UpperArm => "the upper arm is raised too far",
            Self::Reach => "the arm is too straight",
            Self::Elbow => "the elbow is too straight or too bent",
            Self::LimitMargin => "a joint of the arm is too near to a limit",
            Self::DeviationMargin => "the wrist's deviation is too near to a limit",
        }
    }

    /// The unit of its figure, empty for a ratio.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::EyeDistance => "m",
            Self::LineOfSight | Self::Reach => "",
            _ => "deg",
        }
    }

    /// True if it decides whether the person sees the work.
    #[must_use]
    pub fn is_of_sight(self) -> bool {
        use PostureConstraint::{EyeDistance, FaceElevation, GazePitch, GazeYaw, LineOfSight, View};
        matches!(self, View | GazeYaw | GazePitch | EyeDistance | LineOfSight | FaceElevation)
    }
}

impl PostureFigures {
    /// Each constraint with its figure.
    pub fn iter(&self) -> impl Iterator<Item = (PostureConstraint, PostureFigure)> {
        let figures = [
            self.facing_deg,
            self.view_deg,
            self.gaze_yaw_deg,
            self.gaze_pitch_deg,
            self.eye_distance_m,
            self.line_of_sight,
            self.face_elevation_deg,
            self.upper_arm_deg,
            self.reach,
            self.elbow_deg,
            self.limit_margin_deg,
            self.deviation_margin_deg,
        ];
        PostureConstraint::ALL.into_iter().zip(figures)
    }
}

/// The comfort of a posture (`docs/method.md#4-muscular-comfort`, `docs/method.md#5-peripersonal-comfort`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Comfort {
    /// Muscular comfort as printed in the paper, `1 / ||alpha||^2` with the activations `alpha` of `muscular = "paper"`.
    pub muscular: f64,
    /// The muscular comfort that the planners maximise: with `muscular = "intrinsic"` it is `muscular_intrinsic`, with
    /// `muscular = "paper"` the printed one with regularisation, `1 / (||alpha||^2 + 0.01)`.
    pub muscular_regularised: f64,
    /// Intrinsic muscular comfort `1 / (||alpha||^2 + 0.0175)` with the activations of `muscular = "intrinsic"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub muscular_intrinsic: Option<f64>,
    /// The moment about the shoulder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shoulder: Option<ShoulderMoment>,
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
    /// Activations of the metric that the planners maximise: torque divided by strength. With `muscular = "intrinsic"` the first
    /// three are those of raising the upper arm, moving it horizontally and turning it about itself; otherwise one per joint.
    pub activations: [f64; 7],
    /// The mean comfort over all of the person's responses; only with `comfort.person = "average"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub average: Option<MeanComfort>,
    /// The posture's RULA score. It is reported, not optimised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rula: Option<RulaScore>,
    /// The posture's REBA score. It is reported, not optimised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reba: Option<RebaScore>,
}

impl Comfort {
    /// The posture's scores in words, such as `RULA 3 (arm and wrist 4), REBA 5`; `None` without both.
    #[must_use]
    pub fn scores(&self) -> Option<String> {
        let (rula, reba) = (self.rula?, self.reba?);
        Some(format!("RULA {} (arm and wrist {}), REBA {}", rula.score, rula.arm_and_wrist, reba.score))
    }
}

/// A score of a posture that has a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PostureScore {
    /// The RULA score.
    Rula,
    /// The RULA score of arm and wrist.
    RulaArm,
    /// The REBA score.
    Reba,
}

impl PostureScore {
    /// The score's key in a plan.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Rula => "comfort.rula.score",
            Self::RulaArm => "comfort.rula.arm_and_wrist",
            Self::Reba => "comfort.reba.score",
        }
    }
}

/// A score that exceeds its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExceededScore {
    /// Which score.
    pub score: PostureScore,
    /// Its value.
    pub found: u8,
    /// Its limit.
    pub limit: u8,
}

/// The scores that exceed their limits; one that is not known exceeds none.
pub fn exceeded_scores(
    rula: Option<RulaScore>,
    reba: Option<RebaScore>,
    limits: &Limits,
) -> impl Iterator<Item = ExceededScore> + use<> {
    let scores = [
        (PostureScore::Rula, rula.map(|rula| rula.score), limits.rula),
        (PostureScore::RulaArm, rula.map(|rula| rula.arm_and_wrist), limits.rula_arm),
        (PostureScore::Reba, reba.map(|reba| reba.score), limits.reba),
    ];
    scores.into_iter().filter_map(|(score, found, limit)| {
        let (found, limit) = (found?, limit?);
        (found > limit).then_some(ExceededScore { score, found, limit })
    })
}

/// The moment that the working arm exerts about the shoulder (`docs/method.md#414-intrinsic-metric`). For a left-handed person
/// that of the mirrored right arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShoulderMoment {
    /// The moment in the axes of the upper body, N m.
    pub moment_v_nm: [f64; 3],
    /// Its part that raises the upper arm, N m; zero where the upper arm is vertical.
    pub raising_nm: f64,
    /// Its part that moves the raised upper arm horizontally, N m, positive towards the body's middle.
    pub horizontal_nm: f64,
    /// Its part that turns the upper arm about itself, N m, positive for internal rotation.
    pub axial_nm: f64,
}

/// The score of a posture by Rapid Entire Body Assessment (REBA, Hignett and McAtamney 2000).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RebaScore {
    /// The score: 1 negligible risk, 2 or 3 low, 4 to 7 medium, 8 to 10 high, 11 or more very high.
    pub score: u8,
    /// Score A: neck, trunk and legs with the load.
    pub neck_trunk_legs: u8,
    /// Score B: upper arm, lower arm and wrist with the grip.
    pub arm_and_wrist: u8,
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
    /// The sideways push of the direction with the least compliant load factor; the torques are those under it. Only with
    /// `load.lateral_share`; all figures are then the worst of all directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral: Option<LateralPush>,
}

/// The least distance of the robot from itself and from the board (`docs/method.md#35-clearances`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clearance {
    /// In the planned pose.
    pub planned: LeastDistance,
    /// In the pose that the compliant equilibrium predicts at load factor 1; only if the planner's stability is compliant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loaded: Option<LeastDistance>,
}

/// The nearest two bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeastDistance {
    /// Their distance, mm; the penetration depth as a negative number.
    pub distance_mm: f64,
    /// Two links, or a link and `the board`.
    pub between: [String; 2],
}

impl std::fmt::Display for LeastDistance {
    /// `5.00 mm between left_wrist and the board`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [one, other] = &self.between;
        write!(f, "{:.2} mm between {one} and {other}", self.distance_mm)
    }
}

impl std::fmt::Display for Clearance {
    /// `5.00 mm between left_wrist and the board, under the load 4.80 mm between ...`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.planned)?;
        self.loaded.as_ref().map_or(Ok(()), |loaded| write!(f, ", under the load {loaded}"))
    }
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
    /// Duration of making or reading the maps that the plan uses, ms. Plans of one command may share it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_ms: Option<f64>,
    /// Number of candidates that the search evaluated.
    pub evaluations: u64,
    /// How likely the plan holds, if the planner was asked for a probability.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<Robustness>,
}

/// How likely a plan holds, by a small sweep (docs/method.md#107-robust-plans).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robustness {
    /// The estimated probability of holding.
    pub probability: f64,
    /// The lower end of its interval.
    pub low: f64,
    /// The upper end of its interval.
    pub high: f64,
    /// The number of runs.
    pub runs: u64,
    /// The load factor that the search required, before the safety factor.
    pub load_factor: f64,
}
