//! Pairs of primitives that are near each other, with their closest points.

use nalgebra::{Point3, Vector3};
use parry3d_f64::glamx::DVec3;

use super::{
    CollisionModel, PlacedLink, Scene,
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
#[derive(Clone, Copy)]
struct PlacedBody<'a> {
    body: BodyRef,
    pieces: &'a [Placed<'a>],
    /// Bounding sphere.
    centre_w: DVec3,
    radius_m: f64,
}

impl CollisionModel {
    /// All pairs of primitives with a margin of less than `within_m`, under the rules of
    /// [`CollisionModel::first_violation`]. `scene` must be finite.
    #[must_use]
    pub fn near(&self, scene: &Scene<'_>, within_m: f64) -> Vec<NearPair> {
        let placed = self.placed_primitives(scene.link_poses);
        let of_link = |(link, PlacedLink { pieces, centre_w, radius_m })| PlacedBody {
            body: BodyRef::Link(link),
            pieces,
            centre_w,
            radius_m,
        };
        let links: Vec<_> = self.placed_links(scene.link_poses, &placed).into_iter().enumerate().map(of_link).collect();
        let board = [scene.board.piece.placed(&scene.x_wo)];
        let board = PlacedBody::of_piece(BodyRef::Board, &board);
        let mut found = Vec::new();
        for pair in &self.self_pairs {
            let [a, b] = pair.links.map(|link| &links[link]);
            pairs(a, b, pair.required_m(scene.clearance_m), within_m, &mut found);
        }
        for link in (0..links.len()).filter(|&link| !self.may_touch_board(scene, link)) {
            pairs(&links[link], &board, self.board_clearance_m(link, scene.clearance_m), within_m, &mut found);
        }
        for (index, part) in scene.person.iter().enumerate() {
            let capsule = Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m);
            let capsule = [capsule.placed(&Pose::identity())];
            let body = PlacedBody::of_piece(BodyRef::Person(index), &capsule);
            if let Some(clearance_m) = part.board_clearance_m {
                pairs(&board, &body, clearance_m, within_m, &mut found);
            }
            for link in &links {
                pairs(link, &body, part.robot_clearance_m, within_m, &mut found);
            }
        }
        found
    }
}

impl<'a> PlacedBody<'a> {
    /// A body of one primitive.
    fn of_piece(body: BodyRef, piece: &'a [Placed<'a>; 1]) -> Self {
        let (centre_w, radius_m) = piece[0].sphere();
        Self { body, pieces: piece, centre_w, radius_m }
    }
}

fn pairs(a: &PlacedBody<'_>, b: &PlacedBody<'_>, required_m: f64, within_m: f64, found: &mut Vec<NearPair>) {
    let apart_m = required_m + within_m;
    let reach_m = a.radius_m + b.radius_m + apart_m;
    if (a.centre_w - b.centre_w).length_squared() > reach_m * reach_m {
        return;
    }
    for (i, piece) in a.pieces.iter().enumerate() {
        // Pays only if it spares more than one test.
        if b.pieces.len() > 1 && !piece.may_meet_sphere(b.centre_w, b.radius_m + apart_m) {
            continue;
        }
        for (j, other) in b.pieces.iter().enumerate() {
            if let Some(closest) = piece.closest(other, apart_m) {
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
