//! The person who works: body, limits of shoulder and posture, place.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::omitted::is_default;

/// Selects the strength curves and segment masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sex {
    /// Male.
    Male,
    /// Female.
    Female,
}

/// The hand that holds the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// The right hand.
    Right,
    /// The left hand: the mirror image of the right hand, tool included.
    Left,
}

/// Which arm configurations the shoulder permits (`docs/method.md#41-arm-kinematics`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShoulderKind {
    /// Limits on the upper arm's elevation and on its twist about itself.
    #[default]
    SwingTwist,
    /// Limits on each of the three shoulder angles.
    Box,
}

/// Whether the person must stand as people stand (`docs/method.md#413-natural-postures`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PostureKind {
    /// The person keeps every limit of [`PostureLimits`].
    #[default]
    Natural,
    /// Only strength, joint limits and clearances apply.
    Unrestricted,
}

/// The limits of a natural posture (`docs/method.md#413-natural-postures`). Angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PostureLimits {
    /// `natural`: the limits below apply; `unrestricted`: they do not.
    pub kind: PostureKind,
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
}

impl PostureLimits {
    /// No limits: the figures are reported only.
    pub const UNRESTRICTED: Self = Self { kind: PostureKind::Unrestricted, ..Self::NATURAL };

    /// The default limits (`docs/method.md#413-natural-postures`).
    pub const NATURAL: Self = Self {
        kind: PostureKind::Natural,
        facing_deg: 30.0,
        view_deg: 70.0,
        gaze_yaw_deg: 55.0,
        gaze_pitch_deg: [-65.0, 35.0],
        eye_distance_m: [0.25, 0.85],
        line_of_sight: true,
        face_elevation_deg: -10.0,
        upper_arm_deg: 60.0,
        reach: 0.9,
        elbow_deg: [30.0, 130.0],
        limit_margin_deg: 10.0,
        deviation_margin_deg: 5.0,
    };

    /// True if the limits apply.
    #[must_use]
    pub fn is_natural(&self) -> bool {
        self.kind == PostureKind::Natural
    }
}

impl Default for PostureLimits {
    fn default() -> Self {
        Self::NATURAL
    }
}

/// Where the person stands (`docs/method.md#31-decision-variables`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", tag = "kind", deny_unknown_fields)]
pub enum StandingPlace {
    /// Where the plan puts them.
    #[default]
    Free,
    /// At a given place with a given heading, within tolerances.
    Given {
        /// Position of the body's origin in W, m.
        p_wb_m: [f64; 2],
        /// Direction of x_B in W, degrees from x_W towards y_W.
        heading_deg: f64,
        /// Largest deviation along each of x_W and y_W, m.
        tolerance_m: f64,
        /// Largest deviation of the heading, degrees.
        tolerance_deg: f64,
    },
}

/// The person who works.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Standing height, m.
    pub height_m: f64,
    /// Body mass, kg.
    pub mass_kg: f64,
    /// Selects the strength curves and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile, 0.1 to 99.9.
    pub percentile: f64,
    /// Forward lean of the trunk about the hips, degrees; 0, upright, by default.
    #[serde(default, skip_serializing_if = "is_default")]
    pub lean_deg: f64,
    /// The limits of the shoulder.
    #[serde(default)]
    pub shoulder: ShoulderKind,
    /// The limits of the posture.
    #[serde(default)]
    pub posture: PostureLimits,
    /// Where the person stands.
    #[serde(default, skip_serializing_if = "is_default")]
    pub place: StandingPlace,
}

impl Person {
    /// The person of the reproduction of the paper: the default body, a shoulder limited by its three angles and no limits of
    /// the posture.
    pub const PAPER: Self = Self {
        height_m: 1.75,
        mass_kg: 75.0,
        sex: Sex::Male,
        hand: Hand::Right,
        percentile: 50.0,
        lean_deg: 0.0,
        shoulder: ShoulderKind::Box,
        posture: PostureLimits::UNRESTRICTED,
        place: StandingPlace::Free,
    };
}

impl Default for Person {
    /// The person of `docs/method.md#43-body-dimensions`.
    fn default() -> Self {
        Self { shoulder: ShoulderKind::SwingTwist, posture: PostureLimits::NATURAL, ..Self::PAPER }
    }
}
