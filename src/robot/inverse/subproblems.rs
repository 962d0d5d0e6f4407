//! Subproblems of inverse kinematics: one or two angles about known axes, in closed form.
//!
//! The decomposition of an arm into such subproblems is that of A. J. Elias, J. T. Wen, "IK-Geo: Unified robot inverse kinematics
//! using subproblem decomposition", Mechanism and Machine Theory 209, 2025 (arXiv:2211.05737), after B. Paden and W. Kahan.
//! Axes are unit vectors, angles in rad.

use std::f64::consts::PI;

use arrayvec::ArrayVec;
use nalgebra::{Rotation3, Unit, Vector3};

/// The solutions of one subproblem: at most two.
pub(super) type Angles<T> = ArrayVec<T, 2>;

/// Share of the amplitude by which a cosine may exceed 1: axes that meet only to five decimals, next to a stretched arm. Newton's
/// method refuses what is no solution.
const BEYOND: f64 = 1e-4;

/// Amplitudes below this do not depend on the angle (m, or 1 for directions).
const CONSTANT: f64 = 1e-10;

/// The rotation by an angle about an axis through the origin.
pub(super) fn turned(axis: &Vector3<f64>, angle_rad: f64, v: &Vector3<f64>) -> Vector3<f64> {
    Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), angle_rad) * v
}

/// The part of a vector that is normal to an axis.
fn across(axis: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    v - axis * axis.dot(v)
}

/// The angle about an axis that turns `from` as near to `to` as it can; 0 if one of them is along the axis.
pub(super) fn turn_between(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    axis.dot(&from.cross(to)).atan2(across(axis, from).dot(to))
}

/// Angles about `axis` that give the turned `v` the component `component` along `along`:
/// `along . R(axis, angle) v = component`. Where the left side does not depend on the angle, 0 stands for all angles.
pub(super) fn component_angles(
    axis: &Vector3<f64>,
    v: &Vector3<f64>,
    along: &Vector3<f64>,
    component: f64,
) -> Angles<f64> {
    // In the plane normal to the axis: a cos + b sin = c.
    let (a, b) = (across(axis, v).dot(along), axis.cross(v).dot(along));
    let c = component - axis.dot(v) * axis.dot(along);
    let amplitude = a.hypot(b);
    let mut angles = Angles::new();
    if amplitude < CONSTANT {
        if c.abs() < CONSTANT {
            angles.push(0.0);
        }
        return angles;
    }
    let cosine = c / amplitude;
    if cosine.abs() > 1.0 + BEYOND {
        return angles;
    }
    let (middle, aside) = (b.atan2(a), cosine.clamp(-1.0, 1.0).acos());
    angles.push(wrapped(middle + aside));
    if aside > 0.0 && aside < PI {
        angles.push(wrapped(middle - aside));
    }
    angles
}

/// Angles about `axis` that put the turned `v` at a distance from a point: `|R(axis, angle) v - point| = distance`.
pub(super) fn distance_angles(
    axis: &Vector3<f64>,
    v: &Vector3<f64>,
    point: &Vector3<f64>,
    distance: f64,
) -> Angles<f64> {
    let component = 0.5 * (v.norm_squared() + point.norm_squared() - distance * distance);
    component_angles(axis, v, point, component)
}

/// Angles about two axes through the origin with `R(first) R(second) v = target`, for vectors of the same length.
pub(super) fn two_angles(
    first: &Vector3<f64>,
    second: &Vector3<f64>,
    v: &Vector3<f64>,
    target: &Vector3<f64>,
) -> Angles<[f64; 2]> {
    let angles = component_angles(second, v, first, first.dot(target));
    angles.into_iter().map(|angle| [turn_between(first, &turned(second, angle, v), target), angle]).collect()
}

/// Angles about three axes through the origin whose rotations follow each other to `target`:
/// `R(first) R(second) R(third) = target`. Where the first and the third axis coincide the first angle is 0.
pub(super) fn three_angles([first, second, third]: [&Vector3<f64>; 3], target: &Rotation3<f64>) -> Angles<[f64; 3]> {
    let wanted = target * third;
    let angles = component_angles(second, third, first, first.dot(&wanted));
    let complete = |angle: f64| {
        let one = turn_between(first, &turned(second, angle, third), &wanted);
        // Any vector across the third axis shows its turn.
        let mark = third.cross(&if third.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() });
        let seen = turned(second, -angle, &turned(first, -one, &(target * mark)));
        [one, angle, turn_between(third, &mark, &seen)]
    };
    angles.into_iter().map(complete).collect()
}

/// The angle plus full turns that is in [-pi, pi].
fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = Vector3<f64>> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64]
            .prop_map(Vector3::from)
            .prop_filter("long enough to normalise", |v| v.norm() > 0.1)
            .prop_map(|v| v.normalize())
    }

    /// True if two angles are equal up to full turns; the square root of rounding where two solutions merge.
    fn same(a: f64, b: f64) -> bool {
        wrapped(a - b).abs() < 1e-6
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn every_angle_solves_and_the_drawn_one_is_among_them(
            axes in [direction(), direction(), direction()],
            v in direction(), along in direction(), length in 0.1..2.0_f64, angle in [-PI..PI, -PI..PI, -PI..PI],
        ) {
            let v = v * length;
            let there = turned(&axes[0], angle[0], &v);
            let found = component_angles(&axes[0], &v, &along, along.dot(&there));
            prop_assert!(found.iter().any(|q| same(*q, angle[0])), "{found:?} {}", angle[0]);
            for q in found {
                prop_assert!((along.dot(&turned(&axes[0], q, &v)) - along.dot(&there)).abs() < 1e-12);
            }
            let found = distance_angles(&axes[0], &v, &along, (there - along).norm());
            prop_assert!(found.iter().any(|q| same(*q, angle[0])));
            for q in found {
                prop_assert!(((turned(&axes[0], q, &v) - along).norm() - (there - along).norm()).abs() < 1e-9);
            }
            let target = turned(&axes[0], angle[0], &turned(&axes[1], angle[1], &v));
            let found = two_angles(&axes[0], &axes[1], &v, &target);
            prop_assert!(found.iter().any(|q| same(q[0], angle[0]) && same(q[1], angle[1])));
            for [first, second] in found {
                let there = turned(&axes[0], first, &turned(&axes[1], second, &v));
                prop_assert!((there - target).norm() < 1e-7);
            }
            let rotation = |axis: usize, q: f64| Rotation3::from_axis_angle(&Unit::new_unchecked(axes[axis]), q);
            let target = rotation(0, angle[0]) * rotation(1, angle[1]) * rotation(2, angle[2]);
            let found = three_angles([&axes[0], &axes[1], &axes[2]], &target);
            prop_assert!(found.iter().any(|q| (0..3).all(|number| same(q[number], angle[number]))));
            for q in found {
                let there = rotation(0, q[0]) * rotation(1, q[1]) * rotation(2, q[2]);
                prop_assert!((there.matrix() - target.matrix()).amax() < 1e-7);
            }
        }
    }

    /// Where the outer axes coincide, one of the two angles is free: 0, and the other one makes up for it.
    #[test]
    fn coinciding_axes_share_their_turn() {
        let (z, y) = (Vector3::z(), Vector3::y());
        let target = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.7);
        let found = three_angles([&z, &y, &z], &target);
        assert_eq!(found.len(), 1);
        assert!(found[0][0].abs() < 1e-12 && found[0][1].abs() < 1e-12 && (found[0][2] - 0.7).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_reached_has_no_angle() {
        let (z, x) = (Vector3::z(), Vector3::x());
        assert!(component_angles(&z, &x, &x, 1.1).is_empty());
        assert!(distance_angles(&z, &x, &(x * 3.0), 1.9).is_empty());
        // Along the axis nothing depends on the angle.
        assert!(component_angles(&z, &z, &x, 0.5).is_empty());
        assert_eq!(component_angles(&z, &z, &x, 0.0)[..], [0.0]);
    }
}
