//! The person as they stand, against a robot and a board that move: how far apart they are, and which bodies are nearest.

use super::{Body, CollisionModel, PersonPart, point_w, shapes::Piece};
use crate::{human::BodyPart, model::frames::Pose};

/// A person who stands still, with the tool, and the board that they work on.
#[derive(Clone)]
pub struct StandingPerson {
    parts: Vec<StandingPart>,
    board: Piece,
}

#[derive(Clone)]
struct StandingPart {
    name: BodyPart,
    /// In W.
    capsule: Piece,
    /// Tool and working hand are at the board by their trade.
    may_touch_board: bool,
}

/// The two bodies of a scene, one of them the person's, that come nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// A link or the board, then a part of the person.
    pub bodies: [Body; 2],
    /// Their distance, m; the depth of an overlap as a negative number.
    pub distance_m: f64,
}

impl StandingPerson {
    /// A person of these parts at a board of these sides. The distances that the parts must keep in a plan are no matter
    /// here, but what may touch the board is left out against it as there.
    pub fn new(parts: &[PersonPart], board_size_m: [f64; 3]) -> Self {
        let parts = parts.iter().map(|part| StandingPart {
            name: part.name,
            capsule: Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m),
            may_touch_board: part.board_clearance_m.is_none(),
        });
        Self { parts: parts.collect(), board: Piece::cuboid(board_size_m) }
    }
}

impl CollisionModel {
    /// The bodies of robot or board and person that are nearest to each other; none when all are at least `within_m`
    /// apart. `link_poses` and `x_wo` must be finite.
    pub fn nearest_to_person(
        &self,
        person: &StandingPerson,
        link_poses: &[Pose],
        x_wo: &Pose,
        within_m: f64,
    ) -> Option<Nearest> {
        let board = person.board.placed(x_wo);
        let centres_w: Vec<_> =
            self.links.iter().zip(link_poses).map(|(link, x_wl)| point_w(x_wl, &link.centre_l)).collect();
        let mut found = Search { nearest: None, bound_m: within_m };
        for part in &person.parts {
            let capsule = part.capsule.placed(&Pose::identity());
            let name = Body::Person(part.name);
            if !part.may_touch_board {
                found.offer([Body::Board, name], capsule.signed_distance_within(&board, found.bound_m));
            }
            for (index, (link, x_wl)) in self.links.iter().zip(link_poses).enumerate() {
                if !link.pieces.is_empty() && capsule.meets_sphere(centres_w[index], link.radius_m + found.bound_m) {
                    let distance_m = link.signed_distance_within(x_wl, &capsule, found.bound_m);
                    found.offer([Body::Link(index), name], distance_m);
                }
            }
        }
        found.nearest
    }
}

/// The nearest bodies so far, and the distance that nearer ones must be within.
struct Search {
    nearest: Option<Nearest>,
    bound_m: f64,
}

impl Search {
    fn offer(&mut self, bodies: [Body; 2], distance_m: f64) {
        if distance_m < self.bound_m {
            self.bound_m = distance_m;
            self.nearest = Some(Nearest { bodies, distance_m });
        }
    }
}
