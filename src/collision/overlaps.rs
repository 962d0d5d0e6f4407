//! All pairs of links that overlap in a posture.

use super::{CollisionModel, shapes::Measure};
use crate::model::frames::Pose;

impl CollisionModel {
    /// The pairs of links (indices, the lower one first) that must not touch and that overlap.
    #[must_use]
    pub fn overlapping_links(&self, link_poses: &[Pose]) -> Vec<[usize; 2]> {
        let overlap = |&[a, b]: &[usize; 2]| {
            // Shapes that only touch do not overlap.
            let least_m = f64::MIN_POSITIVE;
            let (one, other) = (&self.links[a], &self.links[b]);
            one.distance_within(&link_poses[a], other, &link_poses[b], least_m, Measure::Distance) <= 0.0
        };
        self.self_pairs.iter().map(|pair| pair.links).filter(overlap).collect()
    }

    /// The pairs of links that must not touch.
    #[must_use]
    pub fn link_pairs(&self) -> Vec<[usize; 2]> {
        self.self_pairs.iter().map(|pair| pair.links).collect()
    }
}
