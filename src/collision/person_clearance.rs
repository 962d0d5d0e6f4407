//! Distance between a person who stands still and a robot and board that move, and the nearest bodies.
//!
//! Only pairs with a required distance above zero in a plan are measured. Tool, working hand and forearm touch the board by
//! design and follow it with the few millimetres that the grasp deflects, so they are ignored; so is the tool near the robot.

use super::{BoardBody, Body, CollisionModel, Nearest, PersonPart, nearest::Search, point_w, shapes::Piece};
use crate::{human::BodyPart, model::frames::Pose};

/// A person who stands still, with the tool, and the board.
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
    /// True if a plan requires a distance to the board.
    keeps_off_board: bool,
    /// True if a plan requires a distance to the robot.
    keeps_off_robot: bool,
}

impl PersonClearance {
    /// A person and a board. Of the clearances of `parts` only whether they are above zero matters.
    #[must_use]
    pub fn new(parts: &[PersonPart], board: &BoardBody) -> Self {
        let parts = parts.iter().map(|part| StandingPart {
            name: part.name,
            capsule: Piece::capsule_w(&part.p0_w, &part.p1_w, part.radius_m),
            keeps_off_board: part.board_clearance_m.is_some_and(|clearance_m| clearance_m > 0.0),
            keeps_off_robot: part.robot_clearance_m > 0.0,
        });
        Self { parts: parts.collect(), board: board.piece.clone() }
    }
}

impl CollisionModel {
    /// The nearest pair of a body of robot or board and a part of the person; `None` if all are at least `within_m` apart.
    /// `link_poses` and `x_wo` must be finite.
    #[must_use]
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
        let mut found = Search::within(within_m);
        for part in &person.parts {
            let capsule = part.capsule.placed(&Pose::identity());
            let name = Body::Person(part.name);
            if part.keeps_off_board {
                found.offer([Body::Board, name], capsule.signed_distance_within(&board, found.bound_m()));
            }
            let links = self.links.iter().zip(link_poses).enumerate();
            for (index, (link, x_wl)) in links.filter(|_| part.keeps_off_robot) {
                if !link.pieces.is_empty() && capsule.may_meet_sphere(centres_w[index], link.radius_m + found.bound_m())
                {
                    let distance_m = link.signed_distance_within(x_wl, &capsule, found.bound_m());
                    found.offer([Body::Link(index), name], distance_m);
                }
            }
        }
        found.nearest()
    }
}
