//! The tolerances of the check, with their reasons.

use std::{f64::consts::PI, fmt};

/// The largest deviation of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseTolerance {
    /// Of its position, m.
    pub position_m: f64,
    /// Of its rotation, rad.
    pub rotation_rad: f64,
}

impl PoseTolerance {
    /// True if a deviation is within the tolerance; false if it is not a number.
    #[must_use]
    pub fn allows(&self, [position_m, rotation_rad]: [f64; 2]) -> bool {
        position_m <= self.position_m && rotation_rad <= self.rotation_rad
    }

    /// True if the tolerance is written in m and rad: too small for decimals of mm and degrees.
    fn is_fine(&self) -> bool {
        self.position_m < 1e-4
    }

    /// A deviation in the units in which the tolerance is written.
    pub(super) fn deviation(&self, [position_m, rotation_rad]: [f64; 2]) -> String {
        if self.is_fine() {
            format!("{position_m:.1e} m and {rotation_rad:.1e} rad")
        } else {
            format!("{:.2} mm and {:.2} degrees", position_m * 1e3, rotation_rad.to_degrees())
        }
    }
}

impl fmt::Display for PoseTolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_fine() {
            write!(f, "{:e} m and {:e} rad", self.position_m, self.rotation_rad)
        } else {
            write!(f, "{:.0} mm and {:.1} degrees", self.position_m * 1e3, self.rotation_rad.to_degrees())
        }
    }
}

/// For plans that are given: 1 mm and 0.1 degrees, the rounding of a plan that is written with three decimals (m, rad). It is
/// small beside a pad of 40 mm. Contact model and simulation have the pads flat on the board: at 0.1 degrees the edge of such
/// a pad is at most 0.07 mm off the face, so they have no limit of their own.
pub const GIVEN: PoseTolerance = PoseTolerance { position_m: 1e-3, rotation_rad: 0.1 * PI / 180.0 };

/// For the planner's own plans: 1e-6 m and rad, to which its inverse kinematics converges (docs/method.md#34-constraints).
pub const EXACT: PoseTolerance = PoseTolerance { position_m: 1e-6, rotation_rad: 1e-6 };

/// Largest excess of a joint angle over its limit, rad: rounding of written numbers.
pub(super) const LIMIT_RAD: f64 = 1e-6;

/// Largest excess of a posture's angle over its limit, degrees: a plan that is written with three decimals of rad and m
/// misses its angles by less. It is that of [`GIVEN`].
pub const POSTURE_DEG: f64 = 0.1;

/// The same of a distance, m, and of a share. It is that of [`GIVEN`].
pub const POSTURE_M: f64 = 1e-3;

/// Largest distance of the tool point outside the board, m: rounding of written numbers.
pub const ON_BOARD_M: f64 = 1e-9;

/// Range of a board's sides, m: no material is thinner, no pair of arms holds more.
pub const BOARD_SIDE_M: [f64; 2] = [0.001, 5.0];

/// Largest relative difference of a stated figure from the recomputed one: rounding of another order of operations.
pub const FIGURE_TOLERANCE: f64 = 1e-6;
