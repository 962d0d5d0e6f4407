//! Geometry of the body: capsules for collisions and pictures, and points for the peripersonal metric.
//!
//! Right-handed and upright. The caller's functions place the body in the world and mirror it for a left-handed person: one
//! function for the parts above the hips, which may lean, one for the legs.

use std::sync::LazyLock;

use nalgebra::{Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::{arm::ArmFrames, body::Body};

/// Number of body points in the peripersonal metric (docs/method.md#51-point-sets).
pub const BODY_POINTS: usize = 64;

/// Number of body points that do not move with the working arm; they come first.
pub const STILL_POINTS: usize = 55;

/// Number of capsules of the person and the tool.
pub const CAPSULES: usize = 14;

/// Radius of the tool's capsule, m. Assumed: a drill's chuck; the scenario's tool has no radius.
const TOOL_RADIUS_M: f64 = 0.02;

/// The side of a part of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Side {
    /// The side whose hand holds the tool.
    Working,
    /// The side whose arm hangs.
    Idle,
}

/// A part of the body, or the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum BodyPart {
    /// The head.
    Head,
    /// One half of the trunk.
    Trunk(Side),
    /// An upper arm.
    UpperArm(Side),
    /// A forearm.
    Forearm(Side),
    /// A hand; the working hand is closed around the tool.
    Hand(Side),
    /// A thigh.
    Thigh(Side),
    /// A shank.
    Shank(Side),
    /// The tool, from the palm to its tip.
    Tool,
}

impl BodyPart {
    /// True for the working arm and the tool.
    pub fn moves_with_arm(self) -> bool {
        use Side::Working;
        matches!(self, Self::UpperArm(Working) | Self::Forearm(Working) | Self::Hand(Working) | Self::Tool)
    }

    /// Number of the working arm's joints that move its capsule: the first ones. Those after them turn it about its own axis or
    /// not at all.
    #[must_use]
    pub fn joints(self) -> usize {
        match self {
            Self::UpperArm(Side::Working) => 3,
            Self::Forearm(Side::Working) => 4,
            Self::Hand(Side::Working) | Self::Tool => 7,
            _ => 0,
        }
    }
}

/// A capsule in W.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The part that it represents.
    pub name: BodyPart,
    /// Centre of one end, m; of a limb the proximal end.
    pub p0_w: Point3<f64>,
    /// Centre of the other end, m.
    pub p1_w: Point3<f64>,
    /// Radius, m.
    pub radius_m: f64,
}

/// The segment that a body point is fixed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PointSegment {
    Body,
    UpperArm(Side),
    Forearm(Side),
    Hand(Side),
}

/// A body point, in units of height from its segment's origin: the floor, shoulder, elbow or wrist.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BodyPoint {
    segment: PointSegment,
    position: Vector3<f64>,
}

static POINTS: LazyLock<Vec<BodyPoint>> = LazyLock::new(|| {
    let rows = include_str!("../../assets/human/points64.csv").lines().filter(|row| !row.starts_with('#')).skip(1);
    // A malformed row is left out; a test counts the rows.
    rows.filter_map(parse_point).collect()
});

/// Parses a row `carrier,x,y,z`.
fn parse_point(row: &str) -> Option<BodyPoint> {
    let mut cells = row.split(',');
    let segment = match cells.next()? {
        "body" => PointSegment::Body,
        "working_upper_arm" => PointSegment::UpperArm(Side::Working),
        "working_forearm" => PointSegment::Forearm(Side::Working),
        "working_hand" => PointSegment::Hand(Side::Working),
        "idle_upper_arm" => PointSegment::UpperArm(Side::Idle),
        "idle_forearm" => PointSegment::Forearm(Side::Idle),
        "idle_hand" => PointSegment::Hand(Side::Idle),
        _ => return None,
    };
    let mut number = || cells.next()?.parse().ok();
    Some(BodyPoint { segment, position: Vector3::new(number()?, number()?, number()?) })
}

/// Number of the working arm's joints that move a point of [`super::Human::body_points_w`]: the first ones.
#[must_use]
pub fn body_point_joints(point: usize) -> usize {
    match POINTS[point].segment {
        PointSegment::UpperArm(Side::Working) => 3,
        PointSegment::Forearm(Side::Working) => 4,
        PointSegment::Hand(Side::Working) => 7,
        _ => 0,
    }
}

impl Body {
    /// Shoulder, elbow and wrist of the idle arm in B, m. It hangs, so its axes are those of B.
    fn idle_arm_b(&self) -> [Vector3<f64>; 3] {
        let shoulder = Vector3::new(self.p_bs_m.x, -self.p_bs_m.y, self.p_bs_m.z);
        let elbow = shoulder - Vector3::z() * self.upper_arm.length_m;
        [shoulder, elbow, elbow - Vector3::z() * self.forearm.length_m]
    }

    /// The capsules of the standing body with the working arm at `arm`, and of the tool with its tip at `p_ht_m` in the hand.
    /// Order: head, then each part working side first, the tool last.
    pub(super) fn capsules(
        &self,
        arm: &ArmFrames,
        p_ht_m: &Vector3<f64>,
        upper_to_w: impl Fn(&Vector3<f64>) -> Point3<f64>,
        legs_to_w: impl Fn(&Vector3<f64>) -> Point3<f64>,
    ) -> [Capsule; CAPSULES] {
        use BodyPart::{Forearm, Hand, Head, Shank, Thigh, Tool, Trunk, UpperArm};
        use Side::{Idle, Working};
        let limb = |name, radius_m, p0: Vector3<f64>, p1: Vector3<f64>| Capsule {
            name,
            p0_w: upper_to_w(&p0),
            p1_w: upper_to_w(&p1),
            radius_m,
        };
        let leg_part = |name, y_m: f64, top_m, bottom_m| Capsule {
            name,
            p0_w: legs_to_w(&Vector3::new(0.0, y_m, top_m)),
            p1_w: legs_to_w(&Vector3::new(0.0, y_m, bottom_m)),
            radius_m: self.thickness.leg_radius_m,
        };
        let upright = |name, radius_m, y_m, top_m, bottom_m| {
            limb(name, radius_m, Vector3::new(0.0, y_m, top_m), Vector3::new(0.0, y_m, bottom_m))
        };
        let thick = &self.thickness;
        let (head, trunk, leg) = (thick.head_radius_m, thick.trunk_radius_m, thick.leg_radius_m);
        let (upper, fore, hand) = (thick.upper_arm_radius_m, thick.forearm_radius_m, thick.hand_radius_m);
        let (trunk_y, leg_y) = (thick.trunk_half_spacing_m, thick.leg_half_spacing_m);
        let shoulders_m = self.p_bs_m.z - trunk;
        let palm = arm.hand_point_b(&self.palm_h);
        let [shoulder, elbow, wrist] = self.idle_arm_b();
        let fingers = wrist - Vector3::z() * (self.hand.length_m - hand);
        [
            upright(Head, head, 0.0, self.height_m - head, self.chin_m + head),
            upright(Trunk(Working), trunk, -trunk_y, shoulders_m, self.hip_m),
            upright(Trunk(Idle), trunk, trunk_y, shoulders_m, self.hip_m),
            limb(UpperArm(Working), upper, arm.p_bs_m, arm.p_be_m),
            limb(UpperArm(Idle), upper, shoulder, elbow),
            limb(Forearm(Working), fore, arm.p_be_m, arm.p_bw_m),
            limb(Forearm(Idle), fore, elbow, wrist),
            limb(Hand(Working), hand, arm.p_bw_m, palm),
            limb(Hand(Idle), hand, wrist, fingers),
            leg_part(Thigh(Working), -leg_y, self.hip_m, self.knee_m),
            leg_part(Thigh(Idle), leg_y, self.hip_m, self.knee_m),
            // The round end of the shank stands on the floor.
            leg_part(Shank(Working), -leg_y, self.knee_m, leg),
            leg_part(Shank(Idle), leg_y, self.knee_m, leg),
            limb(Tool, TOOL_RADIUS_M, palm, arm.hand_point_b(p_ht_m)),
        ]
    }

    /// The points on the body's surface, in the order of `assets/human/points64.csv`.
    pub(super) fn points(
        &self,
        arm: &ArmFrames,
        upper_to_w: impl Fn(&Vector3<f64>) -> Point3<f64>,
        legs_to_w: impl Fn(&Vector3<f64>) -> Point3<f64>,
    ) -> [Point3<f64>; BODY_POINTS] {
        use Side::{Idle, Working};
        let upright = Matrix3::identity();
        let [shoulder, elbow, wrist] = self.idle_arm_b();
        let mut points_w = [Point3::origin(); BODY_POINTS];
        for (point_w, BodyPoint { segment, position }) in points_w.iter_mut().zip(POINTS.iter()) {
            let (rotation, origin) = match segment {
                PointSegment::Body => (&upright, Vector3::zeros()),
                PointSegment::UpperArm(Working) => (&arm.r_bu, arm.p_bs_m),
                PointSegment::Forearm(Working) => (&arm.r_bf, arm.p_be_m),
                PointSegment::Hand(Working) => (&arm.r_bh, arm.p_bw_m),
                PointSegment::UpperArm(Idle) => (&upright, shoulder),
                PointSegment::Forearm(Idle) => (&upright, elbow),
                PointSegment::Hand(Idle) => (&upright, wrist),
            };
            let p_b_m = origin + rotation * position * self.height_m;
            let of_legs = *segment == PointSegment::Body && p_b_m.z < self.hip_m;
            *point_w = if of_legs { legs_to_w(&p_b_m) } else { upper_to_w(&p_b_m) };
        }
        points_w
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{
            Human, standing_pose_w,
            testing::{average_man, worker},
        },
        model::{
            frames::Pose,
            operation::OperationKind,
            scenario::{Hand, Person},
        },
    };

    /// Half a step of the sixth digit in each of three coordinates, in units of height, and the same of the radius.
    const ROUNDING: f64 = 1e-6;

    fn drill() -> Human {
        worker(Hand::Right, OperationKind::Drill)
    }

    /// Distance of a point from the surface of a capsule, m; negative inside.
    fn distance_m(point: &Point3<f64>, capsule: &Capsule) -> f64 {
        let axis = capsule.p1_w - capsule.p0_w;
        let along = ((point - capsule.p0_w).dot(&axis) / axis.norm_squared()).clamp(0.0, 1.0);
        (point - (capsule.p0_w + axis * along)).norm() - capsule.radius_m
    }

    #[test]
    fn every_point_lies_on_the_surface_of_the_hanging_body() {
        assert_eq!(POINTS.len(), BODY_POINTS);
        for height_m in [1.5, 1.75, 2.0] {
            let person = Person { height_m, ..average_man() };
            let human = Human::new(&person, &crate::human::default_tool(OperationKind::Drill)).unwrap();
            let (x_wb, hanging) = (Pose::identity(), [0.0; 7]);
            let capsules = human.capsules_w(&x_wb, &hanging);
            for point in human.body_points_w(&x_wb, &hanging) {
                let body = capsules.iter().filter(|capsule| capsule.name != BodyPart::Tool);
                let nearest_m = body.map(|capsule| distance_m(&point, capsule)).fold(f64::INFINITY, f64::min);
                assert!(nearest_m.abs() < 2.0 * ROUNDING * height_m, "{point}: {nearest_m}");
            }
        }
    }

    #[test]
    fn points_of_the_working_arm_move_with_it() {
        let (human, x_wb) = (drill(), standing_pose_w(1.0, 0.2, 2.0, -0.9));
        let raised = [1.0, 0.5, 0.3, 1.2, 0.4, 0.2, 0.1];
        let capsules = human.capsules_w(&x_wb, &raised);
        let points = human.body_points_w(&x_wb, &raised);
        for (BodyPoint { segment, .. }, point) in POINTS.iter().zip(points) {
            let part = match *segment {
                PointSegment::Body => continue,
                PointSegment::UpperArm(side) => BodyPart::UpperArm(side),
                PointSegment::Forearm(side) => BodyPart::Forearm(side),
                PointSegment::Hand(side) => BodyPart::Hand(side),
            };
            let capsule = capsules.iter().find(|capsule| capsule.name == part).unwrap();
            assert!(distance_m(&point, capsule).abs() < 2.0 * ROUNDING * 1.75, "{part:?}");
        }
    }

    #[test]
    fn the_first_points_and_their_parts_stay_when_the_arm_moves() {
        let (human, x_wb, raised) = (drill(), Pose::identity(), [1.0, 0.5, 0.3, 1.2, 0.4, 0.2, 0.1]);
        let pairs = human.body_points_w(&x_wb, &[0.0; 7]).into_iter().zip(human.body_points_w(&x_wb, &raised));
        for (index, (hanging, raised)) in pairs.enumerate() {
            assert_eq!(hanging == raised, index < STILL_POINTS, "{index}");
        }
        for (hanging, raised) in human.capsules_w(&x_wb, &[0.0; 7]).iter().zip(human.capsules_w(&x_wb, &raised)) {
            assert_eq!(*hanging != raised, raised.name.moves_with_arm(), "{:?}", raised.name);
        }
    }

    #[test]
    fn the_points_are_their_own_mirror_image() {
        let points = drill().body_points_w(&Pose::identity(), &[0.0; 7]);
        for point in &points {
            let image = Point3::new(point.x, -point.y, point.z);
            // Sums of the same numbers with another sign.
            assert!(points.iter().any(|other| (other - image).norm() < 1e-15), "{point}");
        }
    }

    #[test]
    fn the_points_are_spread_out() {
        let points = drill().body_points_w(&Pose::identity(), &[0.0; 7]);
        for (i, point) in points.iter().enumerate() {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            let nearest_m = others.map(|(_, other)| (other - point).norm()).fold(f64::INFINITY, f64::min);
            // About 1.8 m^2 for 64 points: squares of 0.17 m. Thighs stand 0.025 m apart.
            assert!((0.03..0.25).contains(&nearest_m), "{point}: {nearest_m}");
        }
    }

    #[test]
    fn the_capsules_stand_on_the_floor_and_end_at_the_top_of_the_head() {
        let floor_z_m = -0.9242;
        let capsules = drill().capsules_w(&standing_pose_w(1.0, 0.0, 0.3, floor_z_m), &[0.0; 7]);
        let ends = || capsules.iter().flat_map(|c| [(c.p0_w.z, c.radius_m), (c.p1_w.z, c.radius_m)]);
        let top_m = ends().map(|(z, radius_m)| z + radius_m).fold(f64::NEG_INFINITY, f64::max);
        let bottom_m = ends().map(|(z, radius_m)| z - radius_m).fold(f64::INFINITY, f64::min);
        assert!((top_m - floor_z_m - 1.75).abs() < 1e-14 && (bottom_m - floor_z_m).abs() < 1e-14);
    }

    #[test]
    fn hanging_arms_clear_trunk_and_legs() {
        let capsules = drill().capsules_w(&Pose::identity(), &[0.0; 7]);
        let hangs = |part| matches!(part, BodyPart::UpperArm(_) | BodyPart::Forearm(_) | BodyPart::Hand(_));
        let stands = |part| matches!(part, BodyPart::Trunk(_) | BodyPart::Thigh(_) | BodyPart::Shank(_));
        for arm in capsules.iter().filter(|capsule| hangs(capsule.name)) {
            for other in capsules.iter().filter(|capsule| stands(capsule.name)) {
                // All of them are upright: their axes' horizontal distance is what counts.
                let apart_m = (arm.p0_w - other.p0_w).xy().norm() - arm.radius_m - other.radius_m;
                assert!(apart_m > 0.0, "{:?} {:?}: {apart_m}", arm.name, other.name);
            }
        }
    }

    #[test]
    fn the_tool_reaches_from_the_palm_to_the_tip() {
        let (human, x_wb) = (drill(), standing_pose_w(1.0, 0.2, 2.0, -0.9));
        let q_rad = [1.0, 0.5, 0.3, 1.2, 0.4, 0.2, 0.1];
        let capsules = human.capsules_w(&x_wb, &q_rad);
        let tool = capsules.iter().find(|capsule| capsule.name == BodyPart::Tool).unwrap();
        let hand = capsules.iter().find(|capsule| capsule.name == BodyPart::Hand(Side::Working)).unwrap();
        let tip_w = (x_wb * human.tool_pose_b(&q_rad)).translation.vector;
        assert!((tool.p1_w.coords - tip_w).norm() < 1e-14);
        assert_eq!(tool.p0_w, hand.p1_w);
    }
}
