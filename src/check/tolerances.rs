//! The tolerances of the check, with their reasons.

use std::f64::consts::PI;

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
}

/// For plans that are given: 1 mm and 0.1 degrees, the rounding of a plan that is written with three decimals (m, rad). It is
/// small beside a pad of 40 mm, and an angle at which a pad is still flat on the board.
pub const GIVEN: PoseTolerance = PoseTolerance { position_m: 1e-3, rotation_rad: 0.1 * PI / 180.0 };

/// For the planner's own plans: 1e-6 m and rad, to which its inverse kinematics converges (docs/method.md#34-constraints).
pub const EXACT: PoseTolerance = PoseTolerance { position_m: 1e-6, rotation_rad: 1e-6 };

/// Largest excess of a joint angle over its limit, rad: rounding of written numbers.
pub(super) const LIMIT_RAD: f64 = 1e-6;

/// Largest distance of the tool point outside the board, m: rounding of written numbers.
pub(super) const ON_BOARD_M: f64 = 1e-9;

/// Range of a board's sides, m: no material is thinner, no pair of arms holds more.
pub(super) const BOARD_SIDE_M: [f64; 2] = [0.001, 5.0];

/// Largest relative difference of a stated figure from the recomputed one: rounding of another order of operations.
pub const FIGURE_TOLERANCE: f64 = 1e-6;
