//! The nearest pair of bodies of a scene.

use super::{Body, CollisionModel, Scene, shapes::Measure};

/// The nearest pair of two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The bodies: a link, and another link, the board or a part of the person.
    pub bodies: [Body; 2],
    /// Distance, m; the penetration depth as a negative number.
    pub distance_m: f64,
}

/// The nearest pair so far, and the upper bound for nearer ones.
pub(super) struct Search {
    nearest: Option<Nearest>,
    bound_m: f64,
}

impl Search {
    /// A search for pairs that are less than `bound_m` apart.
    pub fn within(bound_m: f64) -> Self {
        Self { nearest: None, bound_m }
    }

    /// The distance that a nearer pair must be below, m.
    pub fn bound_m(&self) -> f64 {
        self.bound_m
    }

    /// Keeps a pair if it is nearer.
    pub fn offer(&mut self, bodies: [Body; 2], distance_m: f64) {
        if distance_m < self.bound_m {
            self.bound_m = distance_m;
            self.nearest = Some(Nearest { bodies, distance_m });
        }
    }

    /// The nearest pair.
    pub fn nearest(self) -> Option<Nearest> {
        self.nearest
    }
}

impl CollisionModel {
    /// The nearest pair of two links, or of a link and the board, by the pairs of [`CollisionModel::first_violation`]; `None` if
    /// all are at least `within_m` apart. The person is left out. `scene` must be finite.
    #[must_use]
    pub fn nearest_of_robot(&self, scene: &Scene<'_>, within_m: f64) -> Option<Nearest> {
        let poses = scene.link_poses;
        let mut found = Search::within(within_m);
        for pair in &self.self_pairs {
            let [a, b] = pair.links;
            let bound_m = found.bound_m();
            let measure = Measure::SignedDistance;
            let distance_m = self.links[a].distance_within(&poses[a], &self.links[b], &poses[b], bound_m, measure);
            found.offer([Body::Link(a), Body::Link(b)], distance_m);
        }
        let board = scene.board.piece.placed(&scene.x_wo);
        for link in (0..self.links.len()).filter(|&link| !self.may_touch_board(scene, link)) {
            let shapes = &self.links[link];
            let centre_w = super::point_w(&poses[link], &shapes.centre_l);
            // A link inside the board may be deeper in it than its own radius.
            let reach_m = shapes.radius_m + found.bound_m().max(0.0);
            if !shapes.pieces.is_empty() && board.may_meet_sphere(centre_w, reach_m) {
                let (bound_m, measure) = (found.bound_m(), Measure::SignedDistance);
                let distance_m = shapes.distance_to_within(&poses[link], &board, bound_m, measure);
                found.offer([Body::Link(link), Body::Board], distance_m);
            }
        }
        found.nearest()
    }
}
