//! The distance of one link from the board.

use super::{
    BoardBody, CollisionModel,
    shapes::{Measure, place_all},
};
use crate::model::frames::Pose;

impl CollisionModel {
    /// True if a link (by its index) at `x_wl` overlaps a board at `x_wo` or is closer to it than `within_m`. Faster than the
    /// distance. Any frame may serve as W.
    #[must_use]
    pub fn is_near_board(&self, link: usize, x_wl: &Pose, board: &BoardBody, x_wo: &Pose, within_m: f64) -> bool {
        let board = board.piece.placed(x_wo);
        place_all(&self.links[link].pieces, x_wl).any(|piece| piece.closer_than(&board, within_m))
    }

    /// The distance of a link (by its index) at `x_wl` from a board at `x_wo`, m: zero if they overlap, infinite
    /// for a link without primitives. Any frame may serve as W.
    #[must_use]
    pub fn link_to_board_m(&self, link: usize, x_wl: &Pose, board: &BoardBody, x_wo: &Pose) -> f64 {
        self.links[link].distance_to_within(x_wl, &board.piece.placed(x_wo), f64::INFINITY, Measure::Distance)
    }
}
