//! Where the person may stand (docs/method.md#415-the-persons-place).

use std::f64::consts::PI;

use arrayvec::ArrayVec;
use nalgebra::Vector3;

use super::Human;
use crate::model::{frames::Pose, scenario::StandingPlace};

/// Margins of a standing pose in a given place: along x_W and y_W, m, and of the heading, rad, two each; none if the place is
/// free.
pub type PlaceMargins<T> = ArrayVec<T, 6>;

/// A standing pose: place in W, m, and heading, rad from x_W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// The body's origin along x_W and y_W, m.
    pub p_wb_m: [f64; 2],
    /// Direction of x_B, rad from x_W towards y_W.
    pub heading_rad: f64,
}

impl Standing {
    /// Of a body that stands upright.
    #[must_use]
    pub fn of(x_wb: &Pose) -> Self {
        let (ahead, place) = (x_wb.rotation * Vector3::x(), x_wb.translation.vector);
        Self { p_wb_m: [place.x, place.y], heading_rad: libm::atan2(ahead.y, ahead.x) }
    }
}

impl Human {
    /// The standing pose that the scenario gives; the origin if it is free.
    #[must_use]
    pub fn given_standing(&self) -> Standing {
        match self.place {
            StandingPlace::Free => Standing::default(),
            StandingPlace::Given { p_wb_m, heading_deg, .. } => {
                Standing { p_wb_m, heading_rad: heading_deg.to_radians() }
            }
        }
    }

    /// How far a standing pose is inside the tolerances of the given place; negative outside.
    #[must_use]
    pub fn place_margins(&self, standing: &Standing) -> PlaceMargins<f64> {
        let StandingPlace::Given { tolerance_m, tolerance_deg, .. } = self.place else { return PlaceMargins::new() };
        let given = self.given_standing();
        let [x_m, y_m] = [0, 1].map(|axis| standing.p_wb_m[axis] - given.p_wb_m[axis]);
        let turn_rad = (standing.heading_rad - given.heading_rad + PI).rem_euclid(2.0 * PI) - PI;
        let tolerance_rad = tolerance_deg.to_radians();
        [
            tolerance_m + x_m,
            tolerance_m - x_m,
            tolerance_m + y_m,
            tolerance_m - y_m,
            tolerance_rad + turn_rad,
            tolerance_rad - turn_rad,
        ]
        .into()
    }

    /// True if the person may stand there.
    #[must_use]
    pub fn may_stand(&self, standing: &Standing) -> bool {
        self.place_margins(standing).iter().all(|&margin| margin >= 0.0)
    }

    /// True if the scenario says where the person stands.
    #[must_use]
    pub fn place_is_given(&self) -> bool {
        self.place != StandingPlace::Free
    }
}
