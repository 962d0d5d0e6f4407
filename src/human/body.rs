//! The person's body: proportions, masses and how it stands.
//!
//! Always right-handed; [`Human`](super::Human) mirrors it for a left-handed person.

use std::sync::LazyLock;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Deserialize;

use super::ranges::ShoulderLimits;
use crate::model::{
    frames::Pose,
    scenario::{Person, Sex},
};

/// The person's pose X_WB: upright on the floor, facing along `heading_rad` from x_W towards y_W.
pub fn standing_pose_w(x_m: f64, y_m: f64, heading_rad: f64, floor_z_m: f64) -> Pose {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    Isometry3::from_parts(Vector3::new(x_m, y_m, floor_z_m).into(), rotation)
}

/// Maximum lean, degrees; more is not a comfortable stance.
pub const MAX_LEAN_DEG: f64 = 15.0;

/// A segment of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length, m; of the hand to the fingertip.
    pub length_m: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Distance of the centre of mass from the proximal joint, m.
    pub com_m: f64,
}

/// A person's body, right-handed.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Standing height, m.
    pub height_m: f64,
    /// Centre of the right shoulder in B, m.
    pub p_bs_m: Vector3<f64>,
    /// Height of the chin over the floor, m.
    pub chin_m: f64,
    /// The point between the eyes in B, m.
    pub eye_b_m: Vector3<f64>,
    /// Height of the hip joints over the floor, m.
    pub hip_m: f64,
    /// Height of the knees over the floor, m.
    pub knee_m: f64,
    /// Forward lean of the trunk about the hips, rad. All other fields describe the upright body.
    pub lean_rad: f64,
    /// Shoulder to elbow.
    pub upper_arm: Segment,
    /// Elbow to wrist.
    pub forearm: Segment,
    /// Wrist to fingertip.
    pub hand: Segment,
    /// Centre of the palm in H, m.
    pub palm_h: Vector3<f64>,
    /// Anatomical range of each joint of the arm, rad: of the shoulder those of `shoulder = "box"`.
    pub arm_limits_rad: [[f64; 2]; 7],
    /// Anatomical limits of the shoulder with `shoulder = "swing-twist"`.
    pub shoulder: ShoulderLimits,
    /// Radii of the parts.
    pub thickness: Thickness,
}

/// Radii and spacings of the capsules that represent the body, m.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thickness {
    /// Radius of the head.
    pub head_radius_m: f64,
    /// Radius of each half of the trunk.
    pub trunk_radius_m: f64,
    /// Distance of the axis of each half of the trunk from the middle.
    pub trunk_half_spacing_m: f64,
    /// Radius of an upper arm.
    pub upper_arm_radius_m: f64,
    /// Radius of a forearm.
    pub forearm_radius_m: f64,
    /// Radius of a hand, open or closed.
    pub hand_radius_m: f64,
    /// Radius of thigh and shank.
    pub leg_radius_m: f64,
    /// Distance of the axis of each leg from the middle.
    pub leg_half_spacing_m: f64,
}

/// `assets/human/anthropometry.toml`, which states units and sources.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Anthropometry {
    lengths: Lengths,
    eye: Eye,
    segments: SegmentsBySex,
    capsules: ReferenceThickness,
    arm: ArmRanges,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Lengths {
    shoulder_height: f64,
    shoulder_half_breadth: f64,
    hip_height: f64,
    knee_height: f64,
    chin_height: f64,
    eye_height: f64,
    upper_arm: f64,
    forearm: f64,
    hand: f64,
    wrist_to_palm: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Eye {
    ahead_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentsBySex {
    male: Segments,
    female: Segments,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Segments {
    upper_arm: SegmentFractions,
    forearm: SegmentFractions,
    hand: SegmentFractions,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentFractions {
    mass: f64,
    com: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceThickness {
    reference_height_m: f64,
    thickness: Thickness,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArmRanges {
    limits_deg: [[f64; 2]; 7],
    twist_deg: [f64; 2],
    elevation_deg: f64,
}

static ANTHROPOMETRY: LazyLock<Anthropometry> = LazyLock::new(|| {
    // The file is compiled in and every test of a body parses it.
    toml::from_str(include_str!("../../assets/human/anthropometry.toml")).expect("the built-in proportions are valid")
});

impl Body {
    /// The right-handed body of a person (docs/method.md#43-body-dimensions).
    pub fn new(person: &Person) -> Self {
        let Anthropometry { lengths, eye, segments, capsules, arm } = &*ANTHROPOMETRY;
        let of_sex = match person.sex {
            Sex::Male => &segments.male,
            Sex::Female => &segments.female,
        };
        let height_m = person.height_m;
        let segment = |length: f64, fractions: &SegmentFractions| Segment {
            length_m: length * height_m,
            mass_kg: fractions.mass * person.mass_kg,
            com_m: fractions.com * length * height_m,
        };
        Self {
            height_m,
            p_bs_m: Vector3::new(0.0, -lengths.shoulder_half_breadth, lengths.shoulder_height) * height_m,
            chin_m: lengths.chin_height * height_m,
            eye_b_m: Vector3::new(eye.ahead_m, 0.0, lengths.eye_height * height_m),
            hip_m: lengths.hip_height * height_m,
            knee_m: lengths.knee_height * height_m,
            lean_rad: person.lean_deg.to_radians(),
            upper_arm: segment(lengths.upper_arm, &of_sex.upper_arm),
            forearm: segment(lengths.forearm, &of_sex.forearm),
            hand: segment(lengths.hand, &of_sex.hand),
            palm_h: Vector3::new(0.0, 0.0, -lengths.wrist_to_palm * height_m),
            arm_limits_rad: arm.limits_deg.map(|range| range.map(f64::to_radians)),
            shoulder: ShoulderLimits {
                twist_rad: arm.twist_deg.map(f64::to_radians),
                elevation_rad: arm.elevation_deg.to_radians(),
            },
            thickness: capsules.thickness.scaled(height_m / capsules.reference_height_m),
        }
    }

    /// Pose of the upper body's frame V in B: B rotated forward about the hips by the lean. Coordinates in V of all parts above
    /// the hips are those in B of the upright body.
    pub fn x_bv(&self) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.lean_rad);
        let hips = Vector3::new(0.0, 0.0, self.hip_m);
        Isometry3::from_parts((hips - turn * hips).into(), turn)
    }
}

impl Thickness {
    fn scaled(&self, factor: f64) -> Self {
        Self {
            head_radius_m: self.head_radius_m * factor,
            trunk_radius_m: self.trunk_radius_m * factor,
            trunk_half_spacing_m: self.trunk_half_spacing_m * factor,
            upper_arm_radius_m: self.upper_arm_radius_m * factor,
            forearm_radius_m: self.forearm_radius_m * factor,
            hand_radius_m: self.hand_radius_m * factor,
            leg_radius_m: self.leg_radius_m * factor,
            leg_half_spacing_m: self.leg_half_spacing_m * factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{human::testing::average_man, model::scenario::Hand};

    #[test]
    fn the_average_man_has_the_lengths_of_the_method() {
        let body = Body::new(&average_man());
        // docs/method.md#43-body-dimensions at 1.75 m and 75 kg, by hand; one rounding of a product each.
        assert_relative_eq!(body.p_bs_m, Vector3::new(0.0, -0.22575, 1.4315), epsilon = 1e-12);
        assert_relative_eq!(body.upper_arm.length_m + body.forearm.length_m, 0.581, epsilon = 1e-12);
        assert_relative_eq!(body.palm_h.z, -0.0875, epsilon = 1e-12);
        assert_relative_eq!(body.hand.com_m, 0.3624 * 0.108 * 1.75, epsilon = 1e-12);
        assert_relative_eq!(body.forearm.mass_kg, 1.215, epsilon = 1e-12);
        assert_eq!(body.thickness.forearm_radius_m, 0.035);
    }

    #[test]
    fn a_woman_has_lighter_arms_of_the_same_length() {
        let man = Body::new(&average_man());
        let woman = Body::new(&Person { sex: Sex::Female, ..average_man() });
        for (hers, his) in [(woman.upper_arm, man.upper_arm), (woman.forearm, man.forearm), (woman.hand, man.hand)] {
            assert!(hers.mass_kg < his.mass_kg && hers.com_m < his.com_m);
            assert_eq!(hers.length_m, his.length_m);
        }
    }

    #[test]
    fn the_working_hand_does_not_change_the_body() {
        assert_eq!(Body::new(&Person { hand: Hand::Left, ..average_man() }), Body::new(&average_man()));
    }

    #[test]
    fn a_standing_body_faces_its_heading() {
        let x_wb = standing_pose_w(1.0, 0.5, std::f64::consts::FRAC_PI_2, -0.9);
        assert_relative_eq!(
            x_wb * nalgebra::Point3::new(0.2, 0.0, 1.0),
            nalgebra::Point3::new(1.0, 0.7, 0.1),
            epsilon = 1e-15
        );
    }
}
