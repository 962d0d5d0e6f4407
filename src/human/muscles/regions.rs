//! Where the muscles are: regions of shoulder and arm, each drawn as one spindle between two points.
//!
//! The points follow the textbooks' origins and insertions (Standring (ed.), Gray's Anatomy, 41st edition, 2016, chapters 48 to
//! 50) roughly: on the surface of the capsules of [`super::super::shape`], so that a picture shows which side of the arm works.
//! No figure is computed from them.

use nalgebra::{Rotation3, Vector3};

use super::super::{arm::ArmFrames, body::Body, ranges::ArmAngles};

/// A point that is fixed to a part of the body.
#[derive(Clone, Copy, Debug)]
enum Anchor {
    /// On the trunk: from the centre of the shoulder, in units of the height, V axes.
    Trunk([f64; 3]),
    /// On the upper arm.
    UpperArm(OnSegment),
    /// On the forearm, which does not turn with the hand here.
    Elbow(OnSegment),
    /// On the forearm where it has turned with the hand.
    Wrist(OnSegment),
}

/// A point on a segment of the arm: its share of the way from the distal to the proximal joint, and its distance from the line
/// between them along x and y of the segment, in units of the segment's radius. In a hanging arm x is forward and y inward.
type OnSegment = (f64, [f64; 2]);

/// Muscles that are drawn as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    /// Its name, as in the muscles' file.
    pub name: &'static str,
    ends: [Anchor; 2],
    /// Radius in the middle, in units of the upper arm's radius.
    radius: f64,
}

use Anchor::{Elbow, Trunk, UpperArm, Wrist};

/// All regions.
pub(super) const REGIONS: [Region; 11] = [
    region("chest", 0.5, Trunk([0.055, 0.07, -0.06]), UpperArm((0.8, [0.6, 0.2]))),
    region("back", 0.5, Trunk([-0.055, 0.06, -0.14]), UpperArm((0.85, [-0.5, 0.6]))),
    region("rotator cuff", 0.4, Trunk([-0.055, 0.06, -0.03]), UpperArm((1.0, [-0.5, -0.5]))),
    region("front of the shoulder", 0.45, Trunk([0.024, 0.02, 0.02]), UpperArm((0.55, [0.6, -0.8]))),
    region("side of the shoulder", 0.45, Trunk([0.0, 0.006, 0.03]), UpperArm((0.5, [0.0, -1.0]))),
    region("back of the shoulder", 0.45, Trunk([-0.026, 0.02, 0.018]), UpperArm((0.55, [-0.6, -0.8]))),
    region("front of the upper arm", 0.55, UpperArm((0.75, [0.7, 0.1])), UpperArm((0.05, [0.7, 0.1]))),
    region("back of the upper arm", 0.55, UpperArm((0.8, [-0.8, 0.0])), UpperArm((0.05, [-0.8, 0.0]))),
    region("thumb side of the forearm", 0.34, UpperArm((0.1, [0.4, -0.8])), Wrist((0.3, [0.9, 0.0]))),
    region("palm side of the forearm", 0.38, Elbow((1.0, [0.0, 0.9])), Wrist((0.12, [0.0, 0.8]))),
    region("back of the forearm", 0.36, Elbow((0.98, [0.0, -0.9])), Wrist((0.12, [0.0, -0.8]))),
];

const fn region(name: &'static str, radius: f64, from: Anchor, to: Anchor) -> Region {
    Region { name, ends: [from, to], radius }
}

impl Region {
    /// Radius in the middle, m.
    pub fn radius_m(&self, body: &Body) -> f64 {
        self.radius * body.thickness.upper_arm_radius_m
    }

    /// The two ends in V, m, of a right arm.
    pub fn ends_v(&self, body: &Body, arm: &ArmFrames, q_rad: &ArmAngles) -> [Vector3<f64>; 2] {
        self.ends.map(|end| end.point_v(body, arm, q_rad))
    }
}

impl Anchor {
    fn point_v(self, body: &Body, arm: &ArmFrames, q_rad: &ArmAngles) -> Vector3<f64> {
        let turned = || arm.r_bf * Rotation3::from_axis_angle(&Vector3::z_axis(), q_rad[4]);
        let forearm = body.thickness.forearm_radius_m;
        let (distal, proximal, rotation, radius_m, (share, [x, y])) = match self {
            Trunk(from_shoulder) => return arm.p_bs_m + Vector3::from(from_shoulder) * body.height_m,
            UpperArm(place) => (arm.p_be_m, arm.p_bs_m, arm.r_bu, body.thickness.upper_arm_radius_m, place),
            Elbow(place) => (arm.p_bw_m, arm.p_be_m, arm.r_bf, forearm, place),
            Wrist(place) => (arm.p_bw_m, arm.p_be_m, turned(), forearm, place),
        };
        distal.lerp(&proximal, share) + rotation * Vector3::new(x, y, 0.0) * radius_m
    }
}
