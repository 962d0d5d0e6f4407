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

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Point3};

    use crate::{
        human::{
            ArmAngles, BodyPart, Human, Side,
            testing::{HANDS, generator, leaning, random_angles, worker},
        },
        model::{frames::Pose, muscle_work::MuscleBelly, operation::OperationKind, scenario::Hand, wrench::Wrench},
    };

    fn bellies_w(human: &Human, x_wb: &Pose, q_rad: &ArmAngles) -> Vec<MuscleBelly> {
        let effort = human.muscle_program(q_rad, x_wb, &Wrench::default()).solve().unwrap();
        human.muscle_bellies_w(x_wb, q_rad, &effort)
    }

    fn ends_w(human: &Human, x_wb: &Pose, q_rad: &ArmAngles) -> Vec<Point3<f64>> {
        bellies_w(human, x_wb, q_rad).iter().flat_map(|belly| belly.ends_w).collect()
    }

    /// The middle of the spindle of a region of an upright person, in B, m.
    fn middle_b(q_rad: &ArmAngles, name: &str) -> Point3<f64> {
        let human = worker(Hand::Right, OperationKind::Drill);
        let bellies = bellies_w(&human, &Pose::identity(), q_rad);
        let [from, to] = &bellies.iter().find(|belly| belly.region == name).unwrap().ends_w;
        nalgebra::center(from, to)
    }

    #[test]
    fn each_region_is_on_the_side_of_the_arm_that_its_name_tells() {
        // A hanging right arm: forward is x, outward is -y.
        let at = |name: &str| middle_b(&[0.0; 7], name);
        let [front, side, back] = ["front", "side", "back"].map(|part| at(&format!("{part} of the shoulder")));
        assert!(front.x > side.x + 0.01 && side.x > back.x + 0.01 && side.y < front.y.min(back.y));
        assert!(at("front of the upper arm").x > at("back of the upper arm").x + 0.05);
        assert!(at("chest").x > 0.05 && at("back").x < -0.04 && at("rotator cuff").x < -0.02);
        // Forearm and hand neither turned nor bent: the palm faces the body, the thumb is in front.
        let [palm, back, thumb] = ["palm side", "back", "thumb side"].map(|part| at(&format!("{part} of the forearm")));
        assert!(palm.y > back.y + 0.04 && thumb.x > palm.x.max(back.x) + 0.01);
        // The forearm held forward, its palm turned down and up: the wrist's end of the flexors follows.
        let height = |turn_rad| middle_b(&[0.0, 0.0, 0.0, 1.5, turn_rad, 0.0, 0.0], "palm side of the forearm").z;
        let heights = [1.3, 0.0, -1.3].map(height);
        let turns_the_same_way = (heights[0] - heights[1]) * (heights[1] - heights[2]) > 0.0;
        assert!(turns_the_same_way && (heights[0] - heights[2]).abs() > 0.02, "{heights:?}");
    }

    #[test]
    fn spindles_of_the_arm_touch_it_and_all_move_with_the_body() {
        let mut rng = generator(19);
        let human = leaning(Hand::Right, 10.0);
        let x_wb = Isometry3::new([0.4, -0.3, 0.2].into(), [0.1, 0.2, 2.0].into());
        for _ in 0..50 {
            let q_rad = random_angles(human.arm(), &mut rng);
            let bellies = bellies_w(&human, &Pose::identity(), &q_rad);
            let moved = bellies_w(&human, &x_wb, &q_rad);
            let capsules = human.capsules_w(&Pose::identity(), &q_rad);
            let arm = [BodyPart::UpperArm(Side::Working), BodyPart::Forearm(Side::Working)];
            let arm: Vec<_> = capsules.iter().filter(|capsule| arm.contains(&capsule.name)).collect();
            for (belly, moved) in bellies.iter().zip(&moved) {
                for (end, moved_end) in belly.ends_w.iter().zip(&moved.ends_w) {
                    assert!((x_wb * end - moved_end).norm() < 1e-12, "{}", belly.region);
                }
                if !belly.region.ends_with("arm") {
                    continue;
                }
                for end in &belly.ends_w {
                    let outside_m = |capsule: &&crate::human::Capsule| {
                        let axis = capsule.p1_w - capsule.p0_w;
                        let along = ((end - capsule.p0_w).dot(&axis) / axis.norm_squared()).clamp(0.0, 1.0);
                        (end - (capsule.p0_w + axis * along)).norm() - capsule.radius_m
                    };
                    let least_m = arm.iter().map(outside_m).fold(f64::INFINITY, f64::min);
                    assert!(least_m < 1e-9, "{}: an end is {least_m} m outside of the arm", belly.region);
                }
            }
        }
    }

    #[test]
    fn a_left_arm_has_the_mirror_image_of_a_right_one() {
        let mut rng = generator(20);
        let [right, left] = HANDS.map(|hand| worker(hand, OperationKind::Drill));
        for _ in 0..20 {
            let q_rad = random_angles(right.arm(), &mut rng);
            let [of_right, of_left] = [&right, &left].map(|human| ends_w(human, &Pose::identity(), &q_rad));
            for (right, left) in of_right.iter().zip(&of_left) {
                assert!((Point3::new(right.x, -right.y, right.z) - left).norm() < 1e-12);
            }
        }
    }
}
