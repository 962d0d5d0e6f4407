//! Pairs of primitives that are near each other, with their closest points.

use nalgebra::{Point3, Vector3};

use super::{
    CollisionModel, Scene,
    shapes::{Piece, Placed},
};
use crate::model::frames::Pose;

/// A body of a scene, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyRef {
    /// A link of the robot, by its index.
    Link(usize),
    /// The board.
    Board,
    /// A part of the person, by its index in the scene.
    Person(usize),
}

/// Two primitives that are near each other.
#[derive(Clone, Copy, Debug)]
pub struct NearPair {
    /// The two bodies, and the number of the primitive in each.
    pub bodies: [(BodyRef, usize); 2],
    /// Closest point of each, W, m.
    pub p_w: [Point3<f64>; 2],
    /// From the first to the second, a unit vector in W.
    pub normal_w: Vector3<f64>,
    /// Distance minus required distance, m; negative if violated.
    pub margin_m: f64,
}

/// A body with its primitives in W.
struct PlacedBody<'a> {
    body: BodyRef,
    pieces: Vec<Placed<'a>>,
}

impl CollisionModel {
    /// All pairs of primitives with a margin of less than `within_m`, under the rules of
    /// [`CollisionModel::first_violation`]. `scene` must be finite.
    #[must_use]
    pub fn near(&self, scene: &Scene<'_>, within_m: f64) -> Vec<NearPair> {
        let links = self.links.iter().zip(scene.link_poses).enumerate();
        let links: Vec<_> = links
            .map(|(link, (shapes, x_wl))| PlacedBody {
                body: BodyRef::Link(link),
                pieces: shapes.pieces.iter().map(|piece| piece.placed(x_wl)).collect(),
            })
            .collect();
        let board = PlacedBody { body: BodyRef::Board, pieces: vec![scene.board.piece.placed(&scene.x_wo)] };
        let capsules: Vec<_> =
            scene.person.iter().map(|part| Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m)).collect();
        let mut found = Vec::new();
        for pair in &self.self_pairs {
            let ([a, b], required_m) = (pair.links, pair.required_m(scene.clearance_m));
            let centres_m = (self.centre_w(scene, a) - self.centre_w(scene, b)).norm();
            if centres_m <= self.links[a].radius_m + self.links[b].radius_m + required_m + within_m {
                pairs(&links[a], &links[b], required_m, within_m, &mut found);
            }
        }
        for link in (0..links.len()).filter(|&link| !self.may_touch_board(scene, link)) {
            pairs(&links[link], &board, self.board_clearance_m(link, scene.clearance_m), within_m, &mut found);
        }
        for (index, (part, capsule)) in scene.person.iter().zip(&capsules).enumerate() {
            let body = PlacedBody { body: BodyRef::Person(index), pieces: vec![capsule.placed(&Pose::identity())] };
            if let Some(clearance_m) = part.board_clearance_m {
                pairs(&board, &body, clearance_m, within_m, &mut found);
            }
            for link in &links {
                pairs(link, &body, part.robot_clearance_m, within_m, &mut found);
            }
        }
        found
    }

    fn centre_w(&self, scene: &Scene<'_>, link: usize) -> Point3<f64> {
        scene.link_poses[link] * self.links[link].centre_l
    }
}

fn pairs(a: &PlacedBody<'_>, b: &PlacedBody<'_>, required_m: f64, within_m: f64, found: &mut Vec<NearPair>) {
    for (i, piece) in a.pieces.iter().enumerate() {
        for (j, other) in b.pieces.iter().enumerate() {
            if let Some(closest) = piece.closest(other, required_m + within_m) {
                found.push(NearPair {
                    bodies: [(a.body, i), (b.body, j)],
                    p_w: closest.p_w,
                    normal_w: closest.normal_w,
                    margin_m: closest.distance_m - required_m,
                });
            }
        }
    }
}
