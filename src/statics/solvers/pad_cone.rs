//! The limits of a soft finger as a symmetric cone, with the operations that an interior-point method needs.
//!
//! In a pad's scaled variables `x = (ft1, ft2, fn, mt1, mt2, mn)`, each moment divided by the lever at which the pad
//! resists it, the limits are `s = K x` in a cone of dimension 8: four nonnegative components `fn -+ mt1`, `fn -+ mt2`
//! (centre of pressure inside the patch) and `(mu fn, ft1, ft2, mn)` in a second-order cone (friction).
//!
//! The scaling is Nesterov and Todd's: the symmetric `W` with `W z = W^-1 s = l`; see Vandenberghe, *The CVXOPT linear
//! and quadratic cone program solvers* (2010), section 4.

use nalgebra::{Matrix6, SVector, Vector4, Vector6};

/// Slacks or multipliers of a pad's limits: four of the pressure, then four of the friction cone.
pub type Slack = SVector<f64, 8>;

/// Degree of a pad's cone: 1 for each pressure row, 1 for the friction cone.
pub const DEGREE: f64 = 5.0;

/// `K x`.
pub fn slack(x: &Vector6<f64>, friction: f64) -> Slack {
    let [ft1, ft2, normal, mt1, mt2, mn] = (*x).into();
    Slack::from([normal - mt1, normal + mt1, normal - mt2, normal + mt2, friction * normal, ft1, ft2, mn])
}

/// `K' z`.
pub fn gradient(z: &Slack, friction: f64) -> Vector6<f64> {
    let normal = z[0] + z[1] + z[2] + z[3] + friction * z[4];
    Vector6::new(z[5], z[6], normal, z[1] - z[0], z[3] - z[2], z[7])
}

/// The identity element of the cone's product.
pub fn unit() -> Slack {
    Slack::from([1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
}

/// The cone's product: componentwise for pressure, `(a'b, a0 b1 + b0 a1)` for friction.
pub fn product(a: &Slack, b: &Slack) -> Slack {
    let mut product = a.component_mul(b);
    let (a, b) = (friction_part(a), friction_part(b));
    let vector = b.fixed_rows::<3>(1) * a[0] + a.fixed_rows::<3>(1) * b[0];
    product[4] = a.dot(&b);
    product.fixed_rows_mut::<3>(5).copy_from(&vector);
    product
}

/// The `u` with `l o u = r`.
pub fn quotient(r: &Slack, l: &Slack) -> Slack {
    let mut quotient = r.component_div(l);
    let (r, l) = (friction_part(r), friction_part(l));
    let (r1, l1) = (r.fixed_rows::<3>(1), l.fixed_rows::<3>(1));
    let first = (l[0] * r[0] - l1.dot(&r1)) / minkowski(&l, &l);
    quotient[4] = first;
    quotient.fixed_rows_mut::<3>(5).copy_from(&((r1 - l1 * first) / l[0]));
    quotient
}

/// The largest multiple of a step that stays in the cone from a point inside it; infinite if there is no limit.
pub fn longest_step(from: &Slack, step: &Slack) -> f64 {
    let pressure =
        (0..4).filter(|&row| step[row] < 0.0).map(|row| -from[row] / step[row]).fold(f64::INFINITY, f64::min);
    let (from, step) = (friction_part(from), friction_part(step));
    // The first root of the Minkowski square `c + 2 b t + a t^2`, c > 0.
    let (a, b, c) = (minkowski(&step, &step), minkowski(&from, &step), minkowski(&from, &from));
    let root = (b * b - a * c).sqrt() - b;
    // NaN without a root, and then the comparison is false.
    let friction = if root > 0.0 { c / root } else { f64::INFINITY };
    pressure.min(friction)
}

/// The Nesterov-Todd scaling of a pad's limits at a slack and a multiplier inside the cone.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// `sqrt(s / z)` of the pressure rows.
    pressure: Vector4<f64>,
    /// `W = beta (2 v v' - J)` of the friction cone is written with `w = (w0, w1)`, `w'J w = 1`: `W = beta [w0, w1';
    /// w1, 1 + w1 w1' / (1 + w0)]`.
    beta: f64,
    w: Vector4<f64>,
    /// `l = W z = W^-1 s`.
    pub scaled: Slack,
}

impl Scaling {
    pub fn new(s: &Slack, z: &Slack) -> Self {
        let mut scaled = s.component_mul(z).map(f64::sqrt);
        let pressure = Vector4::from_fn(|row, _| (s[row] / z[row]).sqrt());
        let (s, z) = (friction_part(s), friction_part(z));
        let (size_s, size_z) = (minkowski(&s, &s).sqrt(), minkowski(&z, &z).sqrt());
        let (s, z) = (s / size_s, z / size_z);
        let gamma = ((1.0 + s.dot(&z)) / 2.0).sqrt();
        let w = (s + reflected(&z)) / (2.0 * gamma);
        let scaling = Self { pressure, beta: (size_s / size_z).sqrt(), w, scaled };
        scaled.fixed_rows_mut::<4>(4).copy_from(&(scaling.apply_friction(&z) * size_z));
        Self { scaled, ..scaling }
    }

    /// `W u`.
    pub fn apply(&self, u: &Slack) -> Slack {
        let friction = self.apply_friction(&friction_part(u));
        let pressure = self.pressure.component_mul(&u.fixed_rows::<4>(0));
        joined(&pressure, &friction)
    }

    /// `W^-1 u`: `W^-1 = J W J / beta^2`.
    pub fn apply_inverse(&self, u: &Slack) -> Slack {
        let back = reflected(&self.apply_friction(&reflected(&friction_part(u))));
        let pressure = u.fixed_rows::<4>(0).component_div(&self.pressure);
        joined(&pressure, &(back / (self.beta * self.beta)))
    }

    fn apply_friction(&self, u: &Vector4<f64>) -> Vector4<f64> {
        let (w0, w1) = (self.w[0], self.w.fixed_rows::<3>(1));
        let (u0, u1) = (u[0], u.fixed_rows::<3>(1));
        let along = w1.dot(&u1);
        let rest = u1 + w1 * (u0 + along / (1.0 + w0));
        Vector4::new(w0 * u0 + along, rest[0], rest[1], rest[2]) * self.beta
    }

    /// `K' W^-2 K`, the curvature that the barrier adds: `W^-2 = (2 (J w)(J w)' - J) / beta^2` for friction.
    pub fn curvature(&self, friction: f64) -> Matrix6<f64> {
        let [d0, d1, d2, d3] = self.pressure.map(|w| 1.0 / (w * w)).into();
        let mut curvature = Matrix6::zeros();
        curvature[(2, 2)] = d0 + d1 + d2 + d3;
        curvature[(3, 3)] = d0 + d1;
        curvature[(4, 4)] = d2 + d3;
        curvature[(2, 3)] = d1 - d0;
        curvature[(2, 4)] = d3 - d2;
        // The variables of the friction cone's components, and their factors.
        let places = [2, 0, 1, 5];
        let factors = Vector4::new(friction, 1.0, 1.0, 1.0);
        let back = reflected(&self.w);
        let scale = 1.0 / (self.beta * self.beta);
        for (i, &row) in places.iter().enumerate() {
            for (j, &column) in places.iter().enumerate() {
                let own = if i == j { reflected(&Vector4::repeat(1.0))[i] } else { 0.0 };
                let entry = (2.0 * back[i] * back[j] - own) * factors[i] * factors[j] * scale;
                if row <= column {
                    curvature[(row, column)] += entry;
                }
            }
        }
        curvature.fill_lower_triangle_with_upper_triangle();
        curvature
    }
}

fn friction_part(slack: &Slack) -> Vector4<f64> {
    slack.fixed_rows::<4>(4).into_owned()
}

fn joined(pressure: &Vector4<f64>, friction: &Vector4<f64>) -> Slack {
    let mut slack = Slack::zeros();
    slack.fixed_rows_mut::<4>(0).copy_from(pressure);
    slack.fixed_rows_mut::<4>(4).copy_from(friction);
    slack
}

/// `a'J b = a0 b0 - a1'b1`.
fn minkowski(a: &Vector4<f64>, b: &Vector4<f64>) -> f64 {
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
}

/// `J a`.
fn reflected(a: &Vector4<f64>) -> Vector4<f64> {
    Vector4::new(a[0], -a[1], -a[2], -a[3])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FRICTION: f64 = 0.6;

    /// A point inside the cone.
    fn inside(numbers: &[f64]) -> Slack {
        let mut slack = Slack::from_column_slice(numbers);
        slack.fixed_rows_mut::<4>(0).apply(|value| *value = value.abs() + 0.1);
        slack[4] = slack.fixed_rows::<3>(5).norm() + slack[4].abs() + 0.1;
        slack
    }

    fn numbers(count: usize) -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..1.0_f64, count)
    }

    #[test]
    fn a_step_along_the_boundary_has_no_limit() {
        assert_eq!(longest_step(&unit(), &Slack::zeros()), f64::INFINITY);
        // Along one row of the pressure, inward and outward.
        let mut step = Slack::zeros();
        step[2] = 1.0;
        assert_eq!(longest_step(&unit(), &step), f64::INFINITY);
        assert_eq!(longest_step(&unit(), &(step * -4.0)), 0.25);
    }

    proptest! {
        #[test]
        fn the_scaling_takes_slack_and_multiplier_to_one_point(s in numbers(8), z in numbers(8), u in numbers(8)) {
            let (s, z, u) = (inside(&s), inside(&z), Slack::from_column_slice(&u));
            let scaling = Scaling::new(&s, &z);
            // A few roundings of numbers of order one, magnified by the narrowest angle of the cone, about 0.1.
            prop_assert!((scaling.apply(&z) - scaling.scaled).amax() < 1e-12);
            prop_assert!((scaling.apply_inverse(&s) - scaling.scaled).amax() < 1e-12);
            prop_assert!((scaling.apply_inverse(&scaling.apply(&u)) - u).amax() < 1e-11);
        }

        #[test]
        fn the_curvature_is_that_of_the_scaled_slack(s in numbers(8), z in numbers(8), x in numbers(6), y in numbers(6)) {
            let scaling = Scaling::new(&inside(&s), &inside(&z));
            let (x, y) = (Vector6::from_column_slice(&x), Vector6::from_column_slice(&y));
            let scaled = |x: &Vector6<f64>| scaling.apply_inverse(&slack(x, FRICTION));
            let found = y.dot(&(scaling.curvature(FRICTION) * x));
            prop_assert!((found - scaled(&y).dot(&scaled(&x))).abs() < 1e-10 * (1.0 + found.abs()));
        }

        #[test]
        fn a_longest_step_ends_on_the_boundary(s in numbers(8), step in numbers(8)) {
            let (s, step) = (inside(&s), Slack::from_column_slice(&step));
            let longest = longest_step(&s, &step);
            let depth = |t: f64| {
                let at = s + step * t;
                at.fixed_rows::<4>(0).min().min(at[4] - at.fixed_rows::<3>(5).norm())
            };
            if longest.is_finite() {
                prop_assert!(depth(longest).abs() < 1e-9 * (1.0 + longest));
                prop_assert!(depth(0.999 * longest) > 0.0);
            } else {
                prop_assert!(depth(1e6) > 0.0);
            }
        }

        #[test]
        fn a_quotient_undoes_a_product(l in numbers(8), u in numbers(8)) {
            let (l, u) = (inside(&l), Slack::from_column_slice(&u));
            prop_assert!((quotient(&product(&l, &u), &l) - u).amax() < 1e-11);
            prop_assert!((product(&l, &unit()) - l).amax() < 1e-15);
        }

        #[test]
        fn the_gradient_is_the_slacks_transpose(x in numbers(6), z in numbers(8)) {
            let (x, z) = (Vector6::from_column_slice(&x), Slack::from_column_slice(&z));
            prop_assert!((slack(&x, FRICTION).dot(&z) - x.dot(&gradient(&z, FRICTION))).abs() < 1e-14);
        }
    }
}
