//! The distance of one link from the board.

use super::{BoardBody, CollisionModel, shapes::Measure};
use crate::model::frames::Pose;

impl CollisionModel {
    /// The distance of a link (by its index) at `x_wl` from a board at `x_wo`, m: zero if they overlap, infinite
    /// for a link without primitives. Any frame may serve as W.
    #[must_use]
    pub fn link_to_board_m(&self, link: usize, x_wl: &Pose, board: &BoardBody, x_wo: &Pose) -> f64 {
        self.links[link].distance_to_within(x_wl, &board.piece.placed(x_wo), f64::INFINITY, Measure::Distance)
    }
}
