//! The sideways part of a person's push (`docs/method.md#614-sideways-push`).
//!
//! Nobody pushes exactly along a tool. Besides the operation's force `f` the hand exerts a share of it in the plane
//! perpendicular to `f`, through the tool tip, in a direction that nobody knows beforehand.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{operation::Operation, wrench::Wrench};

/// Directions of the push that are predicted, evenly around the operation's force. The corners of a polygon about the circle of
/// pushes are longer than its radius by `1 / cos(pi / 16) - 1`, 2 %.
pub const DIRECTIONS: usize = 16;

/// `|z_O x f| / |f|` below which a force counts as perpendicular to the faces: written directions are rounded.
const ALONG_NORMAL: f64 = 1e-6;

/// A sideways push.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LateralPush {
    /// Its direction about the operation's force, right-handed, degrees. 0 is along `z_O x f`, in the plane of the face, or along
    /// x_O if the force is perpendicular to the face. So a drill's 90 is along -y_O; a cut's 0 is left of the
    /// cut as seen from +z_O, and its 90 is out of the face, along +z_O.
    pub direction_deg: f64,
    /// The force at load factor 1, N, O axes.
    pub force_o_n: [f64; 3],
}

impl LateralPush {
    /// The push with a share of an operation's force; `None` if the share is zero or the operation has no force.
    #[must_use]
    pub fn new(operation: &Operation, share: f64, direction_deg: f64) -> Option<Self> {
        let force_n = operation.wrench_o.force_n;
        let along = force_n.try_normalize(0.0).filter(|_| share > 0.0)?;
        let across = Vector3::z().cross(&along);
        let first = if across.norm() < ALONG_NORMAL { Vector3::x() } else { across.normalize() };
        let (sin, cos) = libm::sincos(direction_deg.to_radians());
        let direction = first * cos + along.cross(&first) * sin;
        Some(Self { direction_deg, force_o_n: (direction * (share * force_n.norm())).into() })
    }

    /// Its force as a wrench about the tool tip, O axes.
    #[must_use]
    pub fn wrench_o(&self) -> Wrench {
        Wrench::from_force(self.force_o_n.into())
    }
}

impl std::fmt::Display for LateralPush {
    /// `1.95 N at 45.0 degrees, (1.38, -1.38, 0.00) N in O`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { direction_deg, force_o_n } = self;
        // Adding 0 turns -0 into 0.
        let [x_n, y_n, z_n] = force_o_n.map(|n| (n * 100.0).round() / 100.0 + 0.0);
        let size_n = Vector3::from(*force_o_n).norm();
        write!(f, "{size_n:.2} N at {direction_deg:.1} degrees, ({x_n:.2}, {y_n:.2}, {z_n:.2}) N in O")
    }
}

/// The pushes at the corners of the regular polygon about the circle of all pushes with a share of an operation's force: every
/// push is a mixture of them. None if the share is zero or the operation has no force.
pub fn circumscribed(operation: &Operation, share: f64) -> Vec<LateralPush> {
    let outward = 1.0 / libm::cos(std::f64::consts::PI / DIRECTIONS as f64);
    let direction_deg = |number: usize| 360.0 * number as f64 / DIRECTIONS as f64;
    (0..DIRECTIONS).filter_map(|number| LateralPush::new(operation, share * outward, direction_deg(number))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An operation with this force at a point of the upper face.
    fn with_force(force_n: Vector3<f64>) -> Operation {
        let drill = Operation::drill([0.1, -0.1], 15.0, 0.03);
        Operation { wrench_o: Wrench::from_force(force_n), ..drill }
    }

    fn force_n(operation: &Operation, share: f64, direction_deg: f64) -> Vector3<f64> {
        LateralPush::new(operation, share, direction_deg).unwrap().force_o_n.into()
    }

    #[test]
    fn directions_are_those_of_drill_and_cut_in_words() {
        let drill = Operation::drill([0.1, -0.1], 10.0, 0.03);
        assert!((force_n(&drill, 0.2, 0.0) - Vector3::x() * 2.0).norm() < 1e-15);
        assert!((force_n(&drill, 0.2, 90.0) + Vector3::y() * 2.0).norm() < 1e-15);
        let cut = Operation::cut([0.12, 0.0], Vector3::y(), 10.0, 0.03);
        assert!((force_n(&cut, 0.2, 0.0) + Vector3::x() * 2.0).norm() < 1e-15);
        assert!((force_n(&cut, 0.2, 90.0) - Vector3::z() * 2.0).norm() < 1e-15);
    }

    #[test]
    fn a_push_is_perpendicular_to_the_force_and_has_its_share() {
        let oblique = Vector3::new(3.0, -4.0, 1.0);
        for force in [oblique, -oblique, Vector3::z() * 7.0, Vector3::x() * 30.0, Vector3::new(1e-9, 0.0, -15.0)] {
            let operation = with_force(force);
            for direction_deg in [0.0, 33.0, 90.0, 200.0, 359.0] {
                let push_n = force_n(&operation, 0.13, direction_deg);
                // Rounding of a handful of products of numbers below 30; the small tilt of the last force is its 1e-9.
                assert!(push_n.dot(&force).abs() < 1e-8, "{force} {direction_deg}");
                assert!((push_n.norm() - 0.13 * force.norm()).abs() < 1e-8, "{force} {direction_deg}");
            }
            let quarter = force_n(&operation, 0.13, 0.0).cross(&force_n(&operation, 0.13, 90.0));
            assert!(quarter.dot(&force) > 0.0, "directions turn right-handed about {force}");
        }
    }

    /// The roll of a drill is the person's choice; the directions of the push must not turn with it.
    #[test]
    fn directions_do_not_depend_on_the_roll() {
        let drill = Operation::drill([0.1, -0.1], 10.0, 0.03);
        assert_eq!(LateralPush::new(&drill, 0.2, 40.0), LateralPush::new(&drill.rolled(1.0), 0.2, 40.0));
    }

    #[test]
    fn without_share_or_force_there_is_no_push() {
        assert_eq!(LateralPush::new(&with_force(Vector3::x()), 0.0, 0.0), None);
        assert_eq!(LateralPush::new(&with_force(Vector3::zeros()), 0.5, 0.0), None);
        assert!(circumscribed(&with_force(Vector3::zeros()), 0.5).is_empty());
    }

    /// A point is in a regular polygon if along the normal of every edge it is no farther than the edge, whose distance is the
    /// circle's radius.
    #[test]
    fn the_polygon_is_about_the_circle() {
        let operation = with_force(Vector3::new(3.0, -4.0, 1.0));
        let radius_n = 0.13 * operation.wrench_o.force_n.norm();
        let corners = circumscribed(&operation, 0.13);
        assert_eq!(corners.len(), DIRECTIONS);
        for (number, corner) in corners.iter().enumerate() {
            let next = Vector3::from(corners[(number + 1) % DIRECTIONS].force_o_n);
            let middle_n = (Vector3::from(corner.force_o_n) + next) / 2.0;
            assert!((middle_n.norm() - radius_n).abs() < 1e-14 * radius_n.max(1.0) * 10.0, "{number}");
        }
    }
}
