//! The tool's load over time in a simulation.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::omitted::is_default;

/// The tool's load in a simulation (`docs/method.md#73-applied-load`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Load {
    /// The frame in which the wrench's direction is constant.
    pub frame: ForceFrame,
    /// The wrench as a function of time.
    pub profile: ForceProfile,
    /// Sideways part of the person's push, in the plane perpendicular to the operation's force and in its worst direction, as a
    /// share of that force; 0 by default.
    #[serde(skip_serializing_if = "is_default")]
    pub lateral_share: f64,
}

/// The frame in which the direction of the tool's wrench is constant. It acts at the same point of the board in both
/// cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ForceFrame {
    /// The board: the wrench turns with the board, like that of a tool stuck in it.
    #[default]
    Board,
    /// The world: the wrench keeps the direction that it has at the planned pose of the board, like that of a person who
    /// keeps pushing in one direction.
    World,
}

/// Time in which a drill's thrust falls to zero when it breaks through, s.
pub const BREAKTHROUGH_S: f64 = 0.02;

/// The tool's wrench over time. It grows in the ramp phase and acts fully in the hold phase; it is zero before and after.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum ForceProfile {
    /// The operation's wrench: grows linearly in the ramp, constant in the hold.
    #[default]
    Ramp,
    /// A drill: `s(t) (w + z_T (vibration_n sin(2 pi vibration_hz t)); z_T spindle_torque_nm)` with `w` the operation's
    /// wrench, `t` the time since the ramp began, and `s` the load factor: it grows linearly in the ramp, is 1 in the
    /// hold, and from `breakthrough_s` on falls linearly to 0 within 20 ms.
    Drill {
        /// Torque of the spindle on the board about z_T, N m: positive for a drill that turns clockwise as seen by the
        /// person who holds it.
        spindle_torque_nm: f64,
        /// Amplitude of the thrust's vibration, N.
        vibration_n: f64,
        /// Frequency of the vibration, Hz.
        vibration_hz: f64,
        /// When the drill breaks through, s after the start of the hold; by default it does not.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        breakthrough_s: Option<f64>,
    },
    /// A knife that moves along a circle about `z_O` during the hold, in the direction of its force. The wrench and its
    /// point of application rotate with it.
    Path {
        /// Speed along the circle, m/s.
        speed_m_s: f64,
        /// The circle's centre on the worked face, m along x_O and y_O.
        centre_m: [f64; 2],
        /// Force along z_T, into the face, as a fraction of the operation's force.
        normal_share: f64,
    },
    /// A measured wrench that replaces the operation's. It is interpolated linearly between the rows and constant before the
    /// first and after the last. No ramp is applied to it.
    Measured {
        /// Rows of `[t, fx, fy, fz, mx, my, mz]` with increasing `t`: s since the ramp began, N, and N m about the tool
        /// tip, O axes.
        samples: Vec<[f64; 7]>,
    },
}

impl ForceProfile {
    /// The angle about z_O that a point has moved around the circle's centre after `travelled_s`, rad:
    /// `±(speed / radius) travelled_s`, positive if the force drives it counter-clockwise.
    ///
    /// `p_ot_m` is the start and `force_o_n` the force there, both in O.
    #[must_use]
    pub fn travel_angle_rad(
        speed_m_s: f64,
        centre_m: [f64; 2],
        p_ot_m: &Vector3<f64>,
        force_o_n: &Vector3<f64>,
        travelled_s: f64,
    ) -> f64 {
        let radius = p_ot_m - Vector3::new(centre_m[0], centre_m[1], p_ot_m.z);
        let sense = if radius.cross(force_o_n).z < 0.0 { -1.0 } else { 1.0 };
        sense * speed_m_s * travelled_s / radius.norm()
    }
}
