//! All pairs of links that overlap, or are near each other, in a posture.

use super::{CollisionModel, shapes::Measure};
use crate::model::frames::Pose;

impl CollisionModel {
    /// The pairs of links (indices, the lower one first) that must not touch and that overlap.
    #[must_use]
    pub fn overlapping_links(&self, link_poses: &[Pose]) -> Vec<[usize; 2]> {
        // Shapes that only touch do not overlap.
        self.links_nearer_than(link_poses, f64::MIN_POSITIVE)
    }

    /// The pairs of links that must not touch and that are nearer to each other than `within_m`.
    #[must_use]
    pub fn links_nearer_than(&self, link_poses: &[Pose], within_m: f64) -> Vec<[usize; 2]> {
        let is_near = |&[a, b]: &[usize; 2]| {
            let (one, other) = (&self.links[a], &self.links[b]);
            one.distance_within(&link_poses[a], other, &link_poses[b], within_m, Measure::Distance) < within_m
        };
        self.self_pairs.iter().map(|pair| pair.links).filter(is_near).collect()
    }

    /// The pairs of links that must not touch.
    #[must_use]
    pub fn link_pairs(&self) -> Vec<[usize; 2]> {
        self.self_pairs.iter().map(|pair| pair.links).collect()
    }
}
