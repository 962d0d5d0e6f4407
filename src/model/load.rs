//! How the tool loads the board over the time of a simulation, and how far the simulated world departs from the one that
//! was planned for.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The load of a simulation: how the operation's wrench comes and goes, and which way it keeps pointing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Load {
    /// What the wrench's direction is fixed to.
    pub frame: ForceFrame,
    /// The wrench over time.
    pub profile: ForceProfile,
}

/// What the direction of the tool's wrench is fixed to. It acts at the same point of the board either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ForceFrame {
    /// The board: the wrench turns with it, as that of a tool which is stuck in it does.
    #[default]
    Board,
    /// The world: the wrench keeps the direction that it has on the planned board, as that of a person who pushes on
    /// does.
    World,
}

/// How long the thrust of a drill takes to collapse when it breaks through, s.
pub const BREAKTHROUGH_S: f64 = 0.02;

/// The tool's wrench over time. It grows in the ramp and acts in the hold; nothing acts before or after.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum ForceProfile {
    /// The operation's wrench, growing evenly in the ramp and whole in the hold.
    #[default]
    Ramp,
    /// A drill: `s(t) (w + z_T (vibration_n sin(2 pi vibration_hz t)); z_T spindle_torque_nm)` with `w` the operation's
    /// wrench, `t` the time since the load began, and `s` the ramp, 1 in the hold, and from `breakthrough_s` on an even
    /// fall to nothing within 20 ms.
    Drill {
        /// Moment of the spindle on the board about z_T, N m: positive for a drill that turns clockwise for the one who
        /// holds it.
        spindle_torque_nm: f64,
        /// Amplitude of the thrust's vibration, N.
        vibration_n: f64,
        /// Its frequency, Hz.
        vibration_hz: f64,
        /// When the drill breaks through, s after the hold began; never unless given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        breakthrough_s: Option<f64>,
    },
    /// A knife that travels around a circle about `z_O` in the hold, in the direction of its force: wrench and point turn
    /// with it.
    Path {
        /// Speed along the circle, m/s.
        speed_m_s: f64,
        /// The circle's centre on the face, m along x_O and y_O.
        centre_m: [f64; 2],
        /// Force along z_T, into the face, as a share of the operation's force.
        normal_share: f64,
    },
    /// A measured wrench in place of the operation's, linear between its rows; before the first and after the last the
    /// wrench is that row's. The ramp is the profile's own.
    Measured {
        /// Rows of `[t, fx, fy, fz, mx, my, mz]`: s since the load began, N and N m about the tool tip in O axes, in the
        /// order of time.
        samples: Vec<[f64; 7]>,
    },
}

impl ForceProfile {
    /// Where a point is on the face after it has travelled along the circle for `travelled_s`, and by which angle about
    /// z_O it went around the centre, rad: `speed / radius` a second, counter-clockwise when the force drives it so.
    ///
    /// `p_ot_m` is the start and `force_o_n` the force there, O axes.
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

/// What the simulation has, as a multiple of what the plan counts on; 1 throughout unless given. Plans and predictions
/// do not see it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Uncertainty {
    /// Friction between pads and board.
    pub friction_scale: f64,
    /// Grip force.
    pub grip_force_scale: f64,
    /// Stiffness of the contacts between pads and board.
    pub contact_stiffness_scale: f64,
    /// Stiffness of every joint's position control.
    pub joint_stiffness_scale: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self { friction_scale: 1.0, grip_force_scale: 1.0, contact_stiffness_scale: 1.0, joint_stiffness_scale: 1.0 }
    }
}
