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

use arrayvec::ArrayVec;
use nalgebra::{Point3, Vector3};

use super::{
    Human,
    ranges::{ArmAngles, elevation_rad},
};
use crate::model::{
    frames::Pose,
    plan::{PostureConstraint, PostureFigure, PostureFigures},
    scenario::PostureLimits,
};

/// Number of margins of the work: two of each range, one of each other limit.
const WORK_MARGINS: usize = 10;

/// How far the work is inside the limits of a natural posture, in the order of [`CONSTRAINTS`]; none if it is unrestricted.
pub type WorkMargins<T> = ArrayVec<T, WORK_MARGINS>;

/// The constraint of each margin.
const CONSTRAINTS: [PostureConstraint; WORK_MARGINS] = {
    use PostureConstraint::{EyeDistance, FaceElevation, Facing, GazePitch, GazeYaw, View};
    [Facing, Facing, View, GazeYaw, GazeYaw, GazePitch, GazePitch, EyeDistance, EyeDistance, FaceElevation]
};

/// Half the distance of the pupils, m; assumed: the mean of adults.
const HALF_EYE_SPACING_M: f64 = 0.032;

/// Radius of the drawn sector in front of the person, m: about the reach of an arm with a tool.
const SECTOR_RADIUS_M: f64 = 0.9;

/// Edges of the polygon that represents the arc of the sector.
const SECTOR_STEPS: u32 = 24;

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

    /// Azimuth of the tool tip, rad, positive towards the working side.
    fn facing_rad(&self) -> f64 {
        libm::atan2(-self.tip_b.y, self.tip_b.x)
    }

    /// Margins: rad, of view and elevation of the face differences of cosine and sine, of the distance m.
    fn margins(&self, limits: &PostureLimits) -> [f64; WORK_MARGINS] {
        let Gaze { yaw_rad, pitch_rad, distance_m } = self.gaze();
        let (facing, yaw) = (limits.facing_deg.to_radians(), limits.gaze_yaw_deg.to_radians());
        let [lowest, highest] = limits.gaze_pitch_deg.map(f64::to_radians);
        let [nearest_m, farthest_m] = limits.eye_distance_m;
        [
            self.facing_rad() + facing,
            facing - self.facing_rad(),
            self.view_cosine() - libm::cos(limits.view_deg.to_radians()),
            yaw_rad + yaw,
            yaw - yaw_rad,
            pitch_rad - lowest,
            highest - pitch_rad,
            distance_m - nearest_m,
            farthest_m - distance_m,
            self.normal_b.z - libm::sin(limits.face_elevation_deg.to_radians()),
        ]
    }

    /// Derivatives of the margins if the tip moves by `dp` and the normal by `dn`.
    fn margin_slopes(&self, dp: &Vector3<f64>, dn: &Vector3<f64>) -> [f64; WORK_MARGINS] {
        let (p, d) = (&self.tip_b, self.tip_b - self.eye_b);
        let distance_m = d.norm();
        let azimuth = |v: &Vector3<f64>| (v.y * dp.x - v.x * dp.y) / (v.x * v.x + v.y * v.y);
        let (facing, yaw) = (azimuth(p), azimuth(&d));
        let distance = d.dot(dp) / distance_m;
        let view = (d.dot(dn) + self.normal_b.dot(dp) - self.normal_b.dot(&d) * distance / distance_m) / -distance_m;
        let pitch = (dp.z - d.z * distance / distance_m) / libm::hypot(d.x, d.y);
        [facing, -facing, view, yaw, -yaw, pitch, -pitch, distance, -distance, dn.z]
    }
}

impl Human {
    /// The point between the eyes in B, m.
    #[must_use]
    pub fn eye_b(&self) -> Point3<f64> {
        self.x_bv * Point3::from(self.body.eye_b_m)
    }

    /// Where the eyes are on the head in W, m: on its surface, at the height of [`Human::eye_b`].
    #[must_use]
    pub fn eyes_w(&self, x_wb: &Pose) -> [Point3<f64>; 2] {
        let radius_m = self.body.thickness.head_radius_m;
        let ahead_m = (radius_m * radius_m - HALF_EYE_SPACING_M * HALF_EYE_SPACING_M).max(0.0).sqrt();
        let eye_w = |y_m| x_wb * self.x_bv * Point3::new(ahead_m, y_m, self.body.eye_b_m.z);
        [-HALF_EYE_SPACING_M, HALF_EYE_SPACING_M].map(eye_w)
    }

    /// The point between the eyes and the tool tip in W, m.
    #[must_use]
    pub fn line_of_sight_w(&self, x_wb: &Pose, q_rad: &ArmAngles) -> [Point3<f64>; 2] {
        let tip_b = Point3::from(self.tool_pose_b(q_rad).translation.vector);
        [self.eye_b(), tip_b].map(|point_b| x_wb * point_b)
    }

    /// Outline on the floor of the sector in front of the person that the tool tip must be over, W, m: from the person along
    /// the arc and back. Empty if the posture has no limits.
    #[must_use]
    pub fn sector_w(&self, x_wb: &Pose) -> Vec<Point3<f64>> {
        if !self.posture.is_natural() {
            return Vec::new();
        }
        let arc_w = (0..=SECTOR_STEPS).map(|step| {
            let share = f64::from(step) / f64::from(SECTOR_STEPS);
            let (sin, cos) = libm::sincos((2.0 * share - 1.0) * self.posture.facing_deg.to_radians());
            x_wb * Point3::new(SECTOR_RADIUS_M * cos, SECTOR_RADIUS_M * sin, 0.0)
        });
        let person_w = Point3::from(x_wb.translation.vector);
        std::iter::once(person_w).chain(arc_w).chain(std::iter::once(person_w)).collect()
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

    /// True if the line of sight must be free.
    #[must_use]
    pub fn needs_sight(&self) -> bool {
        self.posture.is_natural() && self.posture.line_of_sight
    }

    /// The first limit of a natural posture that a tool pose violates, of those that do not depend on the arm's angles; `None` also
    /// if the posture is unrestricted. `normal_t` is the worked face's normal in T.
    #[must_use]
    pub fn work_violation(&self, x_bt: &Pose, normal_t: &Vector3<f64>) -> Option<PostureConstraint> {
        if !self.posture.is_natural() {
            return None;
        }
        let margins = self.work(x_bt, normal_t).margins(&self.posture);
        CONSTRAINTS.into_iter().zip(margins).find(|(_, margin)| *margin < 0.0).map(|(constraint, _)| constraint)
    }

    /// The margins of the limits that do not depend on the arm's angles but through the tool's pose.
    #[must_use]
    pub fn work_margins(&self, x_bt: &Pose, normal_t: &Vector3<f64>) -> WorkMargins<f64> {
        if !self.posture.is_natural() {
            return WorkMargins::new();
        }
        self.work(x_bt, normal_t).margins(&self.posture).into()
    }

    /// The gradients of [`Human::work_margins`] by the arm's angles.
    #[must_use]
    pub fn work_margin_gradients(&self, q_rad: &ArmAngles, normal_t: &Vector3<f64>) -> WorkMargins<[f64; 7]> {
        if !self.posture.is_natural() {
            return WorkMargins::new();
        }
        let work = self.work(&self.tool_pose_b(q_rad), normal_t);
        let frames = self.arm.frames(q_rad);
        let mut gradients = [[0.0; 7]; WORK_MARGINS];
        for joint in 0..7 {
            let axis_b = self.x_bv * frames.axes_b[joint];
            let origin_b = (self.x_bv * Point3::from(*frames.joint_origin_m(joint))).coords;
            let slopes = work.margin_slopes(&axis_b.cross(&(work.tip_b - origin_b)), &axis_b.cross(&work.normal_b));
            gradients.iter_mut().zip(slopes).for_each(|(gradient, slope)| gradient[joint] = slope);
        }
        gradients.into()
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
            facing_deg: either_way(work.facing_rad().to_degrees(), limits.facing_deg),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{default_tool, standing_pose_w},
        model::{
            operation::OperationKind,
            scenario::{Person, PostureLimits},
        },
    };

    fn human(posture: PostureLimits) -> Human {
        Human::new(&Person { posture, ..Person::PAPER }, &default_tool(OperationKind::Drill)).unwrap()
    }

    #[test]
    fn the_sector_is_on_the_floor_within_the_limit_about_the_heading() {
        let x_wb = standing_pose_w(1.0, 0.2, 2.0, -0.9);
        let outline_b: Vec<_> =
            human(PostureLimits::NATURAL).sector_w(&x_wb).iter().map(|point_w| x_wb.inverse() * point_w).collect();
        let [person_b, arc_b @ .., back_b] = &outline_b[..] else { panic!("the sector is empty") };
        assert!(person_b.coords.norm() < 1e-15 && back_b.coords.norm() < 1e-15);
        let azimuth_deg = |point_b: &Point3<f64>| libm::atan2(point_b.y, point_b.x).to_degrees();
        let limit_deg = PostureLimits::NATURAL.facing_deg;
        // Rounding of the pose and of the angles.
        for point_b in arc_b {
            assert!((point_b.coords.norm() - SECTOR_RADIUS_M).abs() < 1e-14 && point_b.z.abs() < 1e-15);
            assert!(azimuth_deg(point_b).abs() < limit_deg + 1e-12);
        }
        let ends_deg = [&arc_b[0], &arc_b[arc_b.len() - 1]].map(azimuth_deg);
        assert!((ends_deg[0] + limit_deg).abs() < 1e-12 && (ends_deg[1] - limit_deg).abs() < 1e-12);
        assert!(human(PostureLimits::UNRESTRICTED).sector_w(&x_wb).is_empty());
    }

    #[test]
    fn the_eyes_are_on_the_head_and_look_from_between_them_at_the_tip() {
        let (human, x_wb) = (human(PostureLimits::NATURAL), standing_pose_w(1.0, 0.2, 2.0, -0.9));
        let q_rad = [0.6, 0.3, 0.2, 1.2, 0.4, 0.2, 0.1];
        let eyes_w = human.eyes_w(&x_wb);
        assert!(((eyes_w[1] - eyes_w[0]).norm() - 2.0 * HALF_EYE_SPACING_M).abs() < 1e-14);
        let head = human.capsules_w(&x_wb, &q_rad)[0];
        for eye_w in eyes_w {
            let from_axis = (eye_w - head.p0_w).cross(&(head.p1_w - head.p0_w).normalize());
            assert!((from_axis.norm() - head.radius_m).abs() < 1e-14);
        }
        let [eye_w, tip_w] = human.line_of_sight_w(&x_wb, &q_rad);
        assert!((eye_w.z - eyes_w[0].z).abs() < 1e-15);
        assert!((tip_w.coords - (x_wb * human.tool_pose_b(&q_rad)).translation.vector).norm() < 1e-14);
    }
}
