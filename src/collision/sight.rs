//! The line of sight from the person's eye to the tool tip (docs/method.md#413-natural-postures).

use nalgebra::{Point3, Unit};

use super::{CollisionModel, Scene, shapes::Piece};
use crate::{
    human::{BodyPart, Side},
    model::frames::Pose,
};

/// The line ends this far from the tip, m: the tip is on the board's face, and a ray that ends there would meet it.
const BEFORE_TIP_M: f64 = 1e-3;

/// This much of the line before the tip may pass through the working forearm, m: it ends at the hand.
const NEAR_HAND_M: f64 = 0.12;

/// The length of the line's end that a part of the person may be in, m; `None` if it is nowhere in the way: tool, hand, head and
/// legs.
fn exempt_m(part: BodyPart) -> Option<f64> {
    use Side::{Idle, Working};
    match part {
        BodyPart::Trunk(_) | BodyPart::UpperArm(_) | BodyPart::Forearm(Idle) | BodyPart::Hand(Idle) => {
            Some(BEFORE_TIP_M)
        }
        BodyPart::Forearm(Working) => Some(NEAR_HAND_M),
        _ => None,
    }
}

impl CollisionModel {
    /// The free share of the line from the eye to the tool tip, from 0 to 1: 1 if neither the board nor the robot nor the
    /// person's trunk, idle arm, upper arm and forearm are in the way. The scene must be finite; without link poses the robot is
    /// not in the way.
    #[must_use]
    pub fn free_share_of_sight(&self, scene: &Scene<'_>, eye_w: &Point3<f64>, tip_w: &Point3<f64>) -> f64 {
        let line = tip_w - eye_w;
        let length_m = line.norm();
        let Some(direction_w) = Unit::try_new(line, f64::MIN_POSITIVE) else { return 1.0 };
        let before_tip_m = length_m - BEFORE_TIP_M;
        let mut free_m = before_tip_m;
        let mut meet = |piece: &Piece, x_wl: &Pose, within_m: f64| {
            let within_m = within_m.min(free_m);
            free_m = piece.placed(x_wl).ray_m(eye_w, &direction_w, within_m).unwrap_or(free_m);
        };
        meet(&scene.board.piece, &scene.x_wo, before_tip_m);
        for part in scene.person {
            if let Some(exempt_m) = exempt_m(part.name).filter(|exempt_m| *exempt_m < length_m) {
                let capsule = Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m);
                meet(&capsule, &Pose::identity(), length_m - exempt_m);
            }
        }
        for (link, x_wl) in self.links.iter().zip(scene.link_poses) {
            // The line passes the link's bounding sphere by.
            let to_centre = x_wl * link.centre_l - eye_w;
            let along_m = to_centre.dot(&direction_w).clamp(0.0, length_m);
            if (to_centre - direction_w.into_inner() * along_m).norm() <= link.radius_m {
                link.pieces.iter().for_each(|piece| meet(piece, x_wl, before_tip_m));
            }
        }
        if free_m < before_tip_m { free_m / length_m } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use std::{path::Path, sync::LazyLock};

    use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::{
        super::{BoardBody, PersonPart, shapes::point_w},
        *,
    };
    use crate::{
        human::{Human, default_tool, standing_pose_w},
        model::{board::BoardShape, operation::OperationKind, scenario::Person},
        robot::Robot,
    };

    static BOARD: LazyLock<BoardBody> = LazyLock::new(|| BoardBody::new(&BoardShape::cuboid([0.5, 0.4, 0.03])));

    fn robot() -> Robot {
        Robot::load("baxter", Path::new("")).unwrap()
    }

    /// Without a robot, a board far from the line unless `x_wo` says otherwise.
    fn scene<'a>(x_wo: Pose, person: &'a [PersonPart]) -> Scene<'a> {
        Scene { link_poses: &[], holding: &[], board: &BOARD, x_wo, person, clearance_m: 0.0 }
    }

    fn far_away() -> Pose {
        Pose::translation(0.0, 0.0, 10.0)
    }

    fn share(scene: &Scene<'_>, eye_w: [f64; 3], tip_w: [f64; 3]) -> f64 {
        CollisionModel::new(&robot()).free_share_of_sight(scene, &eye_w.into(), &tip_w.into())
    }

    #[test]
    fn a_board_is_in_the_way_from_behind_and_not_from_the_front() {
        // The tip is on the face z = 0.015.
        let (scene, tip_w) = (scene(Pose::identity(), &[]), [0.1, 0.05, 0.015]);
        for front_w in [[0.1, 0.05, 0.5], [-0.3, 0.4, 0.2], [0.6, 0.05, 0.03]] {
            assert_eq!(share(&scene, front_w, tip_w), 1.0);
        }
        // From behind the line ends at the other face, after 0.485 of 0.515 m.
        let found = share(&scene, [0.1, 0.05, -0.5], tip_w);
        assert!((found - 0.485 / 0.515).abs() < 1e-14, "{found}");
        // From inside nothing is free.
        assert_eq!(share(&scene, [0.1, 0.05, 0.0], tip_w), 0.0);
        assert_eq!(share(&scene, tip_w, tip_w), 1.0);
    }

    #[test]
    fn a_link_of_the_robot_is_in_the_way() {
        let (robot, mut crossed) = (robot(), 0);
        let (model, poses) = (CollisionModel::new(&robot), robot.link_poses(&vec![0.0; robot.joints.len()]));
        for (link, x_wl) in model.links.iter().zip(&poses).filter(|(link, _)| link.pieces.len() == 1) {
            let centre_w = x_wl * link.centre_l;
            let (eye_w, tip_w) = (centre_w + Vector3::y() * 2.0, centre_w - Vector3::y() * 2.0);
            let with_robot = Scene { link_poses: &poses, ..scene(far_away(), &[]) };
            // The line passes through the middle of the link.
            assert!(model.free_share_of_sight(&with_robot, &eye_w, &tip_w) < 0.5);
            assert_eq!(model.free_share_of_sight(&scene(far_away(), &[]), &eye_w, &tip_w), 1.0);
            crossed += 1;
        }
        assert!(crossed > 5, "{crossed}");
    }

    /// A part across a line along x_W, at this distance from the tip at the origin.
    fn across(name: BodyPart, from_tip_m: f64) -> PersonPart {
        let end_w = |y| Point3::new(from_tip_m, y, 0.0);
        let (p0_w, p1_w) = (end_w(-0.1), end_w(0.1));
        PersonPart { name, p0_w, p1_w, radius_m: 0.03, robot_clearance_m: 0.0, board_clearance_m: None }
    }

    #[test]
    fn the_own_forearm_is_in_the_way_beyond_the_last_12_cm_only() {
        use BodyPart::{Forearm, Hand, Head, Shank, Thigh, Tool, Trunk, UpperArm};
        use Side::{Idle, Working};
        let of = |name, from_tip_m| share(&scene(far_away(), &[across(name, from_tip_m)]), [0.6, 0.0, 0.0], [0.0; 3]);
        let blocked = |from_tip_m: f64| (0.6 - from_tip_m - 0.03) / 0.6;
        // The surface is 0.03 m nearer to the eye: at 0.119 and at 0.121 m.
        assert_eq!(of(Forearm(Working), 0.089), 1.0);
        assert!((of(Forearm(Working), 0.091) - blocked(0.091)).abs() < 1e-9);
        for part in [Trunk(Idle), Trunk(Working), UpperArm(Idle), UpperArm(Working), Forearm(Idle), Hand(Idle)] {
            for from_tip_m in [0.05, 0.3] {
                assert!((of(part, from_tip_m) - blocked(from_tip_m)).abs() < 1e-9, "{part:?}");
            }
        }
        for part in [Tool, Hand(Working), Head, Thigh(Idle), Shank(Working)] {
            assert_eq!(of(part, 0.3), 1.0, "{part:?}");
        }
        // A line that is shorter than 12 cm, from inside the forearm.
        let near = scene(far_away(), &[across(Forearm(Working), 0.09)]).person.to_vec();
        assert_eq!(share(&scene(far_away(), &near), [0.1, 0.0, 0.0], [0.0; 3]), 1.0);
    }

    /// Everything that may be in the way, with the distance from the eye up to which it counts.
    fn obstacles(model: &CollisionModel, scene: &Scene<'_>, length_m: f64) -> Vec<(Piece, Pose, f64)> {
        use Side::{Idle, Working};
        let before_tip_m = length_m - 1e-3;
        let mut obstacles = vec![(scene.board.piece.clone(), scene.x_wo, before_tip_m)];
        for part in scene.person {
            let until_m = match part.name {
                BodyPart::Forearm(Working) => length_m - 0.12,
                BodyPart::Trunk(_) | BodyPart::UpperArm(_) | BodyPart::Forearm(Idle) | BodyPart::Hand(Idle) => {
                    before_tip_m
                }
                _ => continue,
            };
            obstacles.push((Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m), Pose::identity(), until_m));
        }
        for (link, x_wl) in model.links.iter().zip(scene.link_poses) {
            obstacles.extend(link.pieces.iter().map(|piece| (piece.clone(), *x_wl, before_tip_m)));
        }
        obstacles
    }

    #[test]
    fn the_free_share_is_that_of_points_along_the_line() {
        const STEP_M: f64 = 1e-3;
        /// Of a ray and of a point's distance, which parry finds by iteration for cylinders.
        const TOLERANCE_M: f64 = 1e-6;
        let (robot, mut generator) = (robot(), Pcg64::seed_from_u64(71));
        let model = CollisionModel::new(&robot);
        let human = Human::new(&Person::default(), &default_tool(OperationKind::Drill)).unwrap();
        let (mut free, mut blocked) = (0, 0);
        for round in 0..600 {
            let mut within = |range: f64| generator.random_range(-range..range);
            let positions: Vec<f64> = robot.joints.iter().map(|_| within(1.5)).collect();
            let link_poses = robot.link_poses(&positions);
            let x_wb = standing_pose_w(1.1 + within(0.2), within(0.3), 3.1 + within(0.7), -0.92);
            let q_rad = human.arm().ranges.at_shares([(); 7].map(|()| 0.5 + within(0.5)));
            let [mut eye_w, tip_w] = human.line_of_sight_w(&x_wb, &q_rad);
            if round % 3 == 0 {
                // From anywhere, also through robot and trunk.
                eye_w = Point3::new(0.5 + within(1.0), within(1.0), 0.2 + within(0.8));
            }
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|_, _| within(1.8)));
            let aside = turn * Vector3::new(within(0.2), within(0.2), -0.015 + within(0.02));
            let x_wo = Isometry3::from_parts(Translation3::from(tip_w.coords + aside), turn);
            let person = human.capsules_w(&x_wb, &q_rad).map(PersonPart::from);
            let scene = Scene { link_poses: &link_poses, ..scene(x_wo, &person) };

            let share = model.free_share_of_sight(&scene, &eye_w, &tip_w);
            let line = tip_w - eye_w;
            let length_m = line.norm();
            let obstacles = obstacles(&model, &scene, length_m);
            let touches = |at_m: f64, radius_m: f64| {
                let point_w = point_w(&Pose::identity(), &(eye_w + line * (at_m / length_m)));
                obstacles.iter().any(|(piece, x_wl, until_m)| {
                    at_m <= *until_m && piece.placed(x_wl).meets_sphere(point_w, radius_m)
                })
            };
            let found_m = share * length_m;
            let is_free = |at_m: f64| !touches(at_m, 0.0);
            let steps = ((found_m - TOLERANCE_M) / STEP_M).max(0.0) as usize;
            assert!((0..steps).all(|step| is_free(step as f64 * STEP_M)), "{round}: {share}");
            if share < 1.0 {
                assert!(touches(found_m, TOLERANCE_M), "{round}: {share}");
                blocked += 1;
            } else {
                free += 1;
            }
        }
        assert!(free > 50 && blocked > 50, "{free} {blocked}");
    }
}
