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
        meet(&Piece::cuboid(scene.board_size_m), &scene.x_wo, before_tip_m);
        for part in scene.person {
            if let Some(exempt_m) = exempt_m(part.name) {
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
