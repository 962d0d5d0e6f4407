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

/// How far the work is inside the limits of a natural posture, in the order of `CONSTRAINTS`; none if it is unrestricted.
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
    use std::f64::consts::PI;

    use nalgebra::{Isometry3, UnitQuaternion};
    use rand::RngExt;

    use super::*;
    use crate::{
        human::{
            Arm, default_tool, standing_pose_w,
            testing::{generator, random_shares},
        },
        model::{
            operation::OperationKind,
            scenario::{Hand, Person, PostureLimits},
        },
    };

    impl Human {
        /// The arm within its anatomical ranges.
        fn anatomy_arm(&self) -> Arm {
            Arm { ranges: self.anatomy, ..self.arm.clone() }
        }
    }

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

    /// The average man with a drill, with either hand, leaning, within these limits.
    fn leaning(posture: PostureLimits, hand: Hand) -> Human {
        let person = Person { hand, lean_deg: 8.0, posture, ..Person::default() };
        Human::new(&person, &default_tool(OperationKind::Drill)).unwrap()
    }

    /// A tool at a point in B with z_T along a direction.
    fn tool_at(p_bt_m: [f64; 3], z_t: Vector3<f64>) -> Pose {
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &z_t).unwrap();
        Isometry3::from_parts(Vector3::from(p_bt_m).into(), turn)
    }

    /// The worked face's normal in T for a tool at a right angle to the face.
    const NORMAL_T: Vector3<f64> = Vector3::new(0.0, 0.0, -1.0);

    #[test]
    fn the_gaze_at_known_points() {
        // The eye is at 0.936 x 1.75 m = 1.638 m, 0.09 m ahead of the middle.
        let human = human(PostureLimits::NATURAL);
        assert!((human.eye_b() - Point3::new(0.09, 0.0, 1.638)).norm() < 1e-14);
        // A triangle with the sides 3, 4 and 5 to the front and down; to the right at 45 degrees; up.
        let points = [
            ([0.49, 0.0, 1.338], 0.0, -0.6_f64.asin(), 0.5),
            ([0.39, -0.3, 1.638], 45_f64.to_radians(), 0.0, 0.3 * 2_f64.sqrt()),
            ([0.39, 0.3, 1.638], -45_f64.to_radians(), 0.0, 0.3 * 2_f64.sqrt()),
            ([0.39, 0.0, 2.038], 0.0, 0.8_f64.asin(), 0.5),
        ];
        for (p_bt_m, yaw_rad, pitch_rad, distance_m) in points {
            let found = human.gaze(&tool_at(p_bt_m, Vector3::x()));
            let errors = [found.yaw_rad - yaw_rad, found.pitch_rad - pitch_rad, found.distance_m - distance_m];
            assert!(errors.iter().all(|error| error.abs() < 1e-14), "{found:?}");
        }
    }

    #[test]
    fn the_margins_of_the_work_by_hand() {
        let human = human(PostureLimits::NATURAL);
        let degrees = |degrees: f64| degrees.to_radians();
        let near = |found: &WorkMargins<f64>, expected: [f64; WORK_MARGINS]| {
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14), "{found:?} {expected:?}");
        };
        // Straight ahead; the face is upright and looks back to the person: seen at the cosine 0.8.
        let margins = human.work_margins(&tool_at([0.49, 0.0, 1.338], Vector3::x()), &NORMAL_T);
        let (pitch, seen, up) = (0.6_f64.asin(), 0.8 - degrees(70.0).cos(), degrees(10.0).sin());
        let (ahead, gaze) = (degrees(30.0), degrees(55.0));
        let [above, below] = [degrees(65.0) - pitch, degrees(35.0) + pitch];
        near(&margins, [ahead, ahead, seen, gaze, gaze, above, below, 0.25, 0.35, up]);
        // To the right by 60 degrees as seen from the middle; the face looks down by 30 degrees, to the person's front.
        let (sin, cos) = libm::sincos(degrees(60.0));
        let p_bt_m = [0.4 * cos, -0.4 * sin, 1.638];
        let normal = Vector3::new(degrees(30.0).cos(), 0.0, -0.5);
        let margins = human.work_margins(&tool_at(p_bt_m, -normal), &NORMAL_T);
        let (x, y) = (0.4 * cos - 0.09, 0.4 * sin);
        let (yaw, distance) = (y.atan2(x), x.hypot(y));
        let seen = -normal.x * x / distance - degrees(70.0).cos();
        near(
            &margins,
            [
                degrees(90.0),
                degrees(-30.0),
                seen,
                gaze + yaw,
                gaze - yaw,
                degrees(65.0),
                degrees(35.0),
                distance - 0.25,
                0.85 - distance,
                up - 0.5,
            ],
        );
        let violation = human.work_violation(&tool_at(p_bt_m, -normal), &NORMAL_T);
        assert_eq!(violation, Some(PostureConstraint::Facing));
        assert!(self::human(PostureLimits::UNRESTRICTED).work_margins(&Pose::identity(), &NORMAL_T).is_empty());
    }

    #[test]
    fn the_figures_of_a_bent_arm_by_hand() {
        let human = human(PostureLimits::NATURAL);
        // The upper arm hangs and the forearm is level: the drill points ahead from the right shoulder's plane, its tip
        // 0.2555 + 0.26 m ahead, 0.05 m to the left and 0.05 m up of the wrist.
        let q_rad = [0.0, 0.0, 0.0, 90_f64.to_radians(), 0.0, 0.0, 0.0];
        let figures = human.posture_figures(&q_rad, &NORMAL_T, 0.75);
        let (ahead, right, up) = (0.5155_f64, 0.22575 - 0.05, 1.4315 - 0.3255 + 0.05);
        let (dx, dz) = (ahead - 0.09, up - 1.638);
        let distance = (dx * dx + right * right + dz * dz).sqrt();
        let expected = [
            (figures.facing_deg, right.atan2(ahead).to_degrees(), Some(-30.0), Some(30.0)),
            (figures.view_deg, (dx / distance).acos().to_degrees(), None, Some(70.0)),
            (figures.gaze_yaw_deg, right.atan2(dx).to_degrees(), Some(-55.0), Some(55.0)),
            (figures.gaze_pitch_deg, (dz / distance).asin().to_degrees(), Some(-65.0), Some(35.0)),
            (figures.eye_distance_m, distance, Some(0.25), Some(0.85)),
            (figures.line_of_sight, 0.75, Some(1.0), None),
            (figures.face_elevation_deg, 0.0, Some(-10.0), None),
            (figures.upper_arm_deg, 0.0, None, Some(60.0)),
            (figures.reach, 0.3255_f64.hypot(0.2555) / 0.581, None, Some(0.9)),
            (figures.elbow_deg, 90.0, Some(30.0), Some(130.0)),
            // To -30 degrees of abduction, and to -20 degrees of radial deviation.
            (figures.limit_margin_deg, 30.0, Some(10.0), None),
            (figures.deviation_margin_deg, 20.0, Some(5.0), None),
        ];
        for (figure, value, min, max) in expected {
            assert!((figure.value - value).abs() < 1e-12, "{figure:?} {value}");
            assert_eq!((figure.min, figure.max), (min, max));
        }
        assert_eq!(figures.iter().filter(|(_, figure)| figure.margin() < 0.0).count(), 1);
        // The same figures without limits.
        let free = self::human(PostureLimits::UNRESTRICTED).posture_figures(&q_rad, &NORMAL_T, 0.75);
        for ((_, free), (_, limited)) in free.iter().zip(figures.iter()) {
            assert_eq!((free.value, free.min, free.max, free.margin()), (limited.value, None, None, f64::INFINITY));
        }
    }

    #[test]
    fn a_left_handed_person_has_the_figures_of_the_mirror_image() {
        let [right, left] = [Hand::Right, Hand::Left].map(|hand| leaning(PostureLimits::NATURAL, hand));
        let mut generator = generator(61);
        for _ in 0..1_000 {
            let q_rad = random_shares(&right.anatomy_arm(), &mut generator);
            let normal_t = Vector3::from_fn(|_, _| generator.random_range(-1.0..1.0)).normalize();
            // For a left-handed person x_T and z_T are mirrored and y_T is not.
            let of_left = Vector3::new(normal_t.x, -normal_t.y, normal_t.z);
            let figures =
                [(&right, normal_t), (&left, of_left)].map(|(human, n)| human.posture_figures(&q_rad, &n, 1.0));
            for ((constraint, r), (_, l)) in figures[0].iter().zip(figures[1].iter()) {
                // Degrees; the arc sine of the pitch and the arc cosine of the view lose digits near their ends.
                assert!((r.value - l.value).abs() < 1e-6, "{constraint:?}: {r:?} {l:?}");
            }
        }
    }

    #[test]
    fn the_gradients_of_the_works_margins_are_derivatives() {
        const STEP: f64 = 1e-6;
        for hand in [Hand::Right, Hand::Left] {
            let (human, mut generator) = (leaning(PostureLimits::NATURAL, hand), generator(62));
            for _ in 0..1_000 {
                let q_rad = random_shares(&human.anatomy_arm(), &mut generator);
                let normal_t = Vector3::from_fn(|_, _| generator.random_range(-1.0..1.0)).normalize();
                let margins = |q_rad: &ArmAngles| human.work_margins(&human.tool_pose_b(q_rad), &normal_t);
                let work = human.work(&human.tool_pose_b(&q_rad), &normal_t);
                let to_tip = work.tip_b - work.eye_b;
                if work.tip_b.xy().norm() < 0.05 || to_tip.xy().norm() < 0.05 {
                    continue; // the azimuths run fast over and under the eye and the body's axis
                }
                let gradients = human.work_margin_gradients(&q_rad, &normal_t);
                for joint in 0..7 {
                    let [back, forth] = [-STEP, STEP].map(|by| {
                        let mut q_rad = q_rad;
                        q_rad[joint] += by;
                        margins(&q_rad)
                    });
                    for ((gradient, back), forth) in gradients.iter().zip(back).zip(forth) {
                        let turn = (forth - back).abs() > PI; // straight behind
                        let slope = (forth - back) / (2.0 * STEP);
                        // Rounding 1e-15 / step, third derivative (1 / 0.05)^3 step^2.
                        assert!(turn || (gradient[joint] - slope).abs() < 3e-8, "{joint}: {gradient:?} {slope}");
                    }
                }
            }
        }
        let unrestricted = leaning(PostureLimits::UNRESTRICTED, Hand::Right);
        assert!(unrestricted.work_margin_gradients(&[0.0; 7], &NORMAL_T).is_empty());
    }

    #[test]
    fn the_first_violated_limit_is_the_first_figure_beyond_its_limit() {
        use PostureConstraint::{EyeDistance, FaceElevation, Facing, GazePitch, GazeYaw, View};
        for hand in [Hand::Right, Hand::Left] {
            let (human, mut generator) = (leaning(PostureLimits::NATURAL, hand), generator(63));
            let mut found = std::collections::BTreeMap::new();
            for _ in 0..10_000 {
                let q_rad = random_shares(&human.anatomy_arm(), &mut generator);
                let tilt = Vector3::from_fn(|_, _| generator.random_range(-0.5..0.5));
                let normal_t = (NORMAL_T + tilt).normalize();
                let figures = human.posture_figures(&q_rad, &normal_t, 1.0);
                let is_of_work = |constraint: &PostureConstraint| {
                    matches!(constraint, Facing | View | GazeYaw | GazePitch | EyeDistance | FaceElevation)
                };
                let expected = figures.iter().find(|(constraint, f)| is_of_work(constraint) && f.margin() < 0.0);
                let violation = human.work_violation(&human.tool_pose_b(&q_rad), &normal_t);
                assert_eq!(violation, expected.map(|(constraint, _)| constraint), "{q_rad:?} {figures:?}");
                *found.entry(violation).or_insert(0) += 1;
            }
            // No violation, and each of the limits that can be the first.
            assert!(found.len() >= 6 && found[&None] > 100, "{found:?}");
        }
    }
}
