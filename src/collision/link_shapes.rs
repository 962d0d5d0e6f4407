//! The primitives of a link, and their distances.

use nalgebra::Point3;

use super::shapes::{Measure, Piece, Placed, place_all};
use crate::model::frames::Pose;

/// Primitives of a link and their bounding sphere, in the link's frame.
#[derive(Clone)]
pub(super) struct LinkShapes {
    pub pieces: Vec<Piece>,
    /// Centre of the bounding sphere.
    pub centre_l: Point3<f64>,
    pub radius_m: f64,
}

impl LinkShapes {
    /// Minimum of `bound_m` and the measure to another link, m.
    pub fn distance_within(&self, x_wl: &Pose, other: &Self, x_wm: &Pose, bound_m: f64, measure: Measure) -> f64 {
        let centres_m = (x_wl * self.centre_l - x_wm * other.centre_l).norm();
        if centres_m >= self.radius_m + other.radius_m + bound_m {
            return bound_m;
        }
        let others = place_all(&other.pieces, x_wm);
        others.fold(bound_m, |bound_m, other| self.distance_to_within(x_wl, &other, bound_m, measure))
    }

    /// Minimum of `bound_m` and the signed distance to another body, m.
    pub fn signed_distance_within(&self, x_wl: &Pose, other: &Placed<'_>, bound_m: f64) -> f64 {
        place_all(&self.pieces, x_wl).fold(bound_m, |bound_m, piece| piece.signed_distance_within(other, bound_m))
    }

    /// Minimum of `bound_m` and the measure to another body, m.
    pub fn distance_to_within(&self, x_wl: &Pose, other: &Placed<'_>, bound_m: f64, measure: Measure) -> f64 {
        place_all(&self.pieces, x_wl).fold(bound_m, |bound_m, piece| piece.distance_within(other, bound_m, measure))
    }
}
