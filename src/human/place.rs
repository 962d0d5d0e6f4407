//! Where the person may stand (docs/method.md#415-the-persons-place).

use std::f64::consts::PI;

use arrayvec::ArrayVec;
use nalgebra::{Point3, Vector3};

use super::Human;
use crate::model::{frames::Pose, scenario::StandingPlace, staged_plan::STEP_BACK_M};

/// Rounding of a standing pose, m and rad: the grid of responses has points at the ends of the tolerances.
const ROUNDING: f64 = 1e-9;

/// Margins of a standing pose in a given place: along x_W and y_W, m, and of the heading, rad, two each; none if the place is
/// free.
pub type PlaceMargins<T> = ArrayVec<T, 6>;

/// How a person with this centre of the head steps back from the tool's tip, W, m: by [`STEP_BACK_M`] in the horizontal direction
/// from the tip to the head.
#[must_use]
pub fn step_back_w(head_w: &Point3<f64>, tip_w: &Point3<f64>) -> Vector3<f64> {
    let away = head_w - tip_w;
    Vector3::new(away.x, away.y, 0.0).try_normalize(1e-6).unwrap_or_default() * STEP_BACK_M
}

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
        self.place_margins(standing).iter().all(|&margin| margin >= -ROUNDING)
    }

    /// The standing pose nearest to another at which the person may stand, each coordinate by itself; the same one if the place is
    /// free.
    #[must_use]
    pub fn standing_nearest_to(&self, standing: &Standing) -> Standing {
        let StandingPlace::Given { tolerance_m, tolerance_deg, .. } = self.place else { return *standing };
        let given = self.given_standing();
        let axis = |axis: usize| {
            let middle_m = given.p_wb_m[axis];
            standing.p_wb_m[axis].clamp(middle_m - tolerance_m, middle_m + tolerance_m)
        };
        let turn_rad = (standing.heading_rad - given.heading_rad + PI).rem_euclid(2.0 * PI) - PI;
        let tolerance_rad = tolerance_deg.to_radians();
        let heading_rad = given.heading_rad + turn_rad.clamp(-tolerance_rad, tolerance_rad);
        Standing { p_wb_m: [axis(0), axis(1)], heading_rad }
    }

    /// True if the scenario says where the person stands.
    #[must_use]
    pub fn place_is_given(&self) -> bool {
        self.place != StandingPlace::Free
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        human::{default_tool, standing_pose_w},
        model::{operation::OperationKind, scenario::Person},
    };

    fn human(place: StandingPlace) -> Human {
        Human::new(&Person { place, ..Person::default() }, &default_tool(OperationKind::Drill)).unwrap()
    }

    /// 0.1 m and 5 degrees about a place, towards -x_W.
    const GIVEN: StandingPlace =
        StandingPlace::Given { p_wb_m: [1.1, -0.2], heading_deg: 178.0, tolerance_m: 0.1, tolerance_deg: 5.0 };

    fn standing(p_wb_m: [f64; 2], heading_deg: f64) -> Standing {
        Standing { p_wb_m, heading_rad: heading_deg.to_radians() }
    }

    #[test]
    fn margins_are_the_distances_from_the_tolerances() {
        let human = human(GIVEN);
        assert!(human.place_is_given());
        let margins = human.place_margins(&standing([1.13, -0.28], 176.0));
        let expected = [0.13, 0.07, 0.02, 0.18, 3_f64.to_radians(), 7_f64.to_radians()];
        // Differences of numbers up to pi.
        assert!(margins.iter().zip(expected).all(|(found, e)| (found - e).abs() < 1e-14), "{margins:?}");
    }

    #[test]
    fn a_heading_beyond_a_half_turn_is_the_same_as_on_the_other_side() {
        let human = human(GIVEN);
        let margins = |heading_deg: f64| human.place_margins(&standing([1.1, -0.2], heading_deg));
        for turns in [-2.0, -1.0, 0.0, 1.0] {
            // -179 degrees is 181: 3 degrees beyond the given heading.
            let found = margins(-179.0 + 360.0 * turns);
            let expected = [8_f64, 2.0].map(f64::to_radians);
            // Angles up to 16 rad.
            assert!(found[4..].iter().zip(expected).all(|(found, e)| (found - e).abs() < 1e-14), "{found:?}");
        }
        for (heading_deg, may) in [(172.5, false), (173.5, true), (-177.5, true), (-176.5, false), (0.0, false)] {
            assert_eq!(human.may_stand(&standing([1.1, -0.2], heading_deg)), may, "{heading_deg}");
        }
    }

    #[test]
    fn the_person_may_stand_within_the_tolerances_only() {
        let human = human(GIVEN);
        for (p_wb_m, may) in [
            ([1.1, -0.2], true),
            ([1.19, -0.29], true),
            ([1.21, -0.2], false),
            ([0.99, -0.2], false),
            ([1.1, -0.31], false),
            ([1.1, -0.09], false),
        ] {
            assert_eq!(human.may_stand(&standing(p_wb_m, 178.0)), may, "{p_wb_m:?}");
        }
        assert!(human.may_stand(&human.given_standing()));
    }

    #[test]
    fn a_free_place_has_no_margins() {
        let human = human(StandingPlace::Free);
        assert!(!human.place_is_given() && human.given_standing() == Standing::default());
        assert!(human.place_margins(&standing([7.0, -9.0], 50.0)).is_empty());
        assert!(human.may_stand(&standing([7.0, -9.0], 50.0)));
    }

    #[test]
    fn a_standing_pose_has_its_place_and_heading() {
        for heading_rad in [-3.0, -0.5, 0.0, 2.0, 3.1] {
            let found = Standing::of(&standing_pose_w(0.4, -0.7, heading_rad, -0.9));
            assert_eq!(found.p_wb_m, [0.4, -0.7]);
            assert!((found.heading_rad - heading_rad).abs() < 1e-15);
        }
    }
}
