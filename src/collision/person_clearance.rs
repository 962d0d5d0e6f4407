//! The person as they stand, against a robot and a board that move: how far apart they are, and which bodies are nearest.
//!
//! What a plan keeps at a distance is looked at. What a plan lets come as near as it likes is not: tool and working hand, and the
//! forearm behind them, against the board; the tool against the robot. They are at the board by their trade and go where
//! it goes, with the hands that hold it, by the few millimetres that a hold gives way; only a person who stood like a statue would
//! be pushed by them.

use super::{Body, CollisionModel, PersonPart, point_w, shapes::Piece};
use crate::{human::BodyPart, model::frames::Pose};

/// A person who stands still, with the tool, and the board that they work on.
#[derive(Clone)]
pub struct PersonClearance {
    parts: Vec<StandingPart>,
    board: Piece,
}

#[derive(Clone)]
struct StandingPart {
    name: BodyPart,
    /// In W.
    capsule: Piece,
    /// Whether a plan keeps it at a distance from the board.
    keeps_off_board: bool,
    /// Whether a plan keeps it at a distance from the robot.
    keeps_off_robot: bool,
}

/// The two bodies of a scene, one of them the person's, that come nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// A link or the board, then a part of the person.
    pub bodies: [Body; 2],
    /// Their distance, m; the depth of an overlap as a negative number.
    pub distance_m: f64,
}

impl PersonClearance {
    /// A person of these parts at a board of these sides. How large the distances are that the parts must keep in a plan is no
    /// matter here.
    pub fn new(parts: &[PersonPart], board_size_m: [f64; 3]) -> Self {
        let parts = parts.iter().map(|part| StandingPart {
            name: part.name,
            capsule: Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m),
            keeps_off_board: part.board_clearance_m.is_some_and(|clearance_m| clearance_m > 0.0),
            keeps_off_robot: part.robot_clearance_m > 0.0,
        });
        Self { parts: parts.collect(), board: Piece::cuboid(board_size_m) }
    }
}

impl CollisionModel {
    /// The bodies of robot or board and person that are nearest to each other; none when all are at least `within_m`
    /// apart. `link_poses` and `x_wo` must be finite.
    pub fn nearest_to_person(
        &self,
        person: &PersonClearance,
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
            if part.keeps_off_board {
                found.offer([Body::Board, name], capsule.signed_distance_within(&board, found.bound_m));
            }
            let links = self.links.iter().zip(link_poses).enumerate();
            for (index, (link, x_wl)) in links.filter(|_| part.keeps_off_robot) {
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
