//! How the person stands and sees the work (docs/method.md#413-natural-postures).
//!
//! All figures but the line of sight follow from the arm's angles alone: the person stands upright, so where they stand and
//! which way they face changes neither the tool nor the face in the body's frame. They are computed for a right-handed body.
//!
//! With the tool tip `p`, the eye `e` and the worked face's normal `n` in B:
//!
//! ```text
//! facing     atan2(-p_y, p_x)                     view      angle(n, e - p)
//! gaze yaw   atan2(-d_y, d_x),  d = p - e         pitch     asin(d_z / |d|)
//! elevation of the face  asin(n_z)                upper arm angle(u, -z_V),  u from shoulder to elbow
//! ```

use nalgebra::{Point3, Vector3};

use super::{Human, arm::ArmAngles, ranges::elevation_rad};
use crate::model::{
    frames::Pose,
    plan::{PostureFigure, PostureFigures},
};

/// Where the person looks: from the point between the eyes to the tool tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// Turn from straight ahead, rad, positive towards the working side.
    pub yaw_rad: f64,
    /// Elevation over the horizontal, rad.
    pub pitch_rad: f64,
    /// Distance of the tool tip, m.
    pub distance_m: f64,
}

impl Gaze {
    /// The line of sight from the eye to the tool tip, both in the same frame of a right-handed person, m.
    fn between(eye: &Vector3<f64>, tip: &Vector3<f64>) -> Self {
        let d = tip - eye;
        let distance_m = d.norm();
        Self { yaw_rad: libm::atan2(-d.y, d.x), pitch_rad: libm::asin((d.z / distance_m).clamp(-1.0, 1.0)), distance_m }
    }
}

/// The tool tip and the worked face in the body frame of a right-handed person.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    /// The tool tip, m.
    pub tip_b: Vector3<f64>,
    /// The worked face's normal, out of the board.
    pub normal_b: Vector3<f64>,
    /// The point between the eyes, m.
    pub eye_b: Vector3<f64>,
}

impl Work {
    fn gaze(&self) -> Gaze {
        Gaze::between(&self.eye_b, &self.tip_b)
    }

    /// Cosine of the angle between the face's normal and the direction to the eye.
    fn view_cosine(&self) -> f64 {
        let to_eye = self.eye_b - self.tip_b;
        self.normal_b.dot(&to_eye) / to_eye.norm()
    }
}

impl Human {
    /// The point between the eyes in B, m.
    #[must_use]
    pub fn eye_b(&self) -> Point3<f64> {
        self.x_bv * Point3::from(self.body.eye_b_m)
    }

    /// The line of sight to a tool tip at `x_bt`.
    #[must_use]
    pub fn gaze(&self, x_bt: &Pose) -> Gaze {
        self.work(x_bt, &Vector3::z()).gaze()
    }

    /// The line of sight to the tool tip as seen from the trunk: its yaw and pitch are in V, which leans with the trunk.
    #[must_use]
    pub fn gaze_v(&self, q_rad: &ArmAngles) -> Gaze {
        Gaze::between(&self.body.eye_b_m, &self.arm.tool_pose_b(q_rad).translation.vector)
    }

    /// Tool and face as a right-handed person has them; `normal_t` is the face's normal in T.
    fn work(&self, x_bt: &Pose, normal_t: &Vector3<f64>) -> Work {
        Work {
            tip_b: self.on_working_side(x_bt.translation.vector),
            normal_b: self.on_working_side(x_bt.rotation * normal_t),
            eye_b: self.eye_b().coords,
        }
    }

    /// The figures of a posture; `normal_t` is the worked face's normal in T, and `free_share` the part of the line from the
    /// eye to the tool tip that is free.
    #[must_use]
    pub fn posture_figures(&self, q_rad: &ArmAngles, normal_t: &Vector3<f64>, free_share: f64) -> PostureFigures {
        let work = self.work(&self.tool_pose_b(q_rad), normal_t);
        let limits = &self.posture;
        let Gaze { yaw_rad, pitch_rad, distance_m } = work.gaze();
        let within = |value: f64, min: Option<f64>, max: Option<f64>| {
            if limits.is_natural() {
                PostureFigure { value, min, max }
            } else {
                PostureFigure { value, min: None, max: None }
            }
        };
        let at_most = |value: f64, max: f64| within(value, None, Some(max));
        let either_way = |value: f64, max: f64| within(value, Some(-max), Some(max));
        let between = |value: f64, [min, max]: [f64; 2]| within(value, Some(min), Some(max));
        let frames = self.arm.frames(q_rad);
        let [other, deviation] = self.anatomy.margins_rad(q_rad, &frames.r_bu);
        PostureFigures {
            facing_deg: either_way(libm::atan2(-work.tip_b.y, work.tip_b.x).to_degrees(), limits.facing_deg),
            view_deg: at_most(libm::acos(work.view_cosine().clamp(-1.0, 1.0)).to_degrees(), limits.view_deg),
            gaze_yaw_deg: either_way(yaw_rad.to_degrees(), limits.gaze_yaw_deg),
            gaze_pitch_deg: between(pitch_rad.to_degrees(), limits.gaze_pitch_deg),
            eye_distance_m: between(distance_m, limits.eye_distance_m),
            line_of_sight: within(free_share, limits.line_of_sight.then_some(1.0), None),
            face_elevation_deg: within(
                libm::asin(work.normal_b.z.clamp(-1.0, 1.0)).to_degrees(),
                Some(limits.face_elevation_deg),
                None,
            ),
            upper_arm_deg: at_most(elevation_rad(&frames.r_bu).to_degrees(), limits.upper_arm_deg),
            reach: at_most((frames.p_bw_m - frames.p_bs_m).norm() / self.arm.reach_m(), limits.reach),
            elbow_deg: between(q_rad[3].to_degrees(), limits.elbow_deg),
            limit_margin_deg: within(other.to_degrees(), Some(limits.limit_margin_deg), None),
            deviation_margin_deg: within(deviation.to_degrees(), Some(limits.deviation_margin_deg), None),
        }
    }
}
