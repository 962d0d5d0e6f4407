//! The quadratic program of one step: the dual active-set method of Goldfarb and Idnani (Mathematical Programming 27,
//! 1983), for a few dozen variables.
//!
//! Starting at the unconstrained optimum, the most violated constraint becomes active and constraints whose multipliers would
//! turn negative become inactive, until none is violated. The Hessian is positive definite, so every step is unique. With so
//! few variables the projections are computed from scratch at every change of the active set.
//!
//! It is our own because it is called a hundred times per plan: `benches/qp.rs` measures it beside clarabel.

use nalgebra::{DMatrix, DVector};

/// A linear constraint on the step d: `margin + gradient . d >= 0`.
#[derive(Clone, Debug)]
pub struct LinearConstraint {
    /// Its gradient.
    pub gradient: DVector<f64>,
    /// Its margin at d = 0; negative if violated there.
    pub margin: f64,
}

/// A constraint that is violated by less than this share of its gradient's length is satisfied.
const TOLERANCE: f64 = 1e-9;
/// Changes of the active set after which a program is given up; a few more than the number of variables are usual.
const MAX_CHANGES: usize = 200;

/// The step that maximises `gradient . d - 1/2 d' hessian d` within `|d_i| <= radius` and all constraints; `None` if they have
/// no common point or the Hessian is not positive definite.
pub fn solve(
    gradient: &DVector<f64>,
    hessian: &DMatrix<f64>,
    constraints: &[LinearConstraint],
    radius: f64,
) -> Option<DVector<f64>> {
    let inverse = hessian.clone().cholesky()?.inverse();
    let program = Program { constraints: relevant(constraints, radius), radius, count: gradient.len() };
    let mut d = &inverse * gradient;
    let mut active: Vec<Active> = Vec::new();
    let mut changes = 0;
    while let Some(violated) = program.most_violated(&d) {
        let normal = program.normal(violated);
        let along = &inverse * &normal;
        let mut multiplier = 0.0;
        loop {
            changes += 1;
            if changes > MAX_CHANGES {
                return None;
            }
            let Direction { primal, dual } = direction(&active, &normal, &along)?;
            let curvature = primal.dot(&normal);
            let full = if curvature > TOLERANCE * inverse.amax() {
                -program.margin(violated, &d) / curvature
            } else {
                f64::INFINITY
            };
            let (first, partial) = first_to_leave(&active, &dual);
            let step = full.min(partial);
            if step.is_infinite() {
                return None;
            }
            if full.is_finite() {
                d += &primal * step;
            }
            for (constraint, rate) in active.iter_mut().zip(dual.iter()) {
                constraint.multiplier -= step * rate;
            }
            multiplier += step;
            if full <= partial {
                break;
            }
            active.remove(first);
        }
        active.push(Active { normal, along, multiplier });
    }
    Some(d)
}

/// A constraint that holds with equality.
struct Active {
    normal: DVector<f64>,
    /// The inverse Hessian times the normal.
    along: DVector<f64>,
    multiplier: f64,
}

/// All constraints, with normals of length 1.
struct Program {
    constraints: Vec<LinearConstraint>,
    radius: f64,
    count: usize,
}

/// Constraints with gradients of length 1, without those that no step within the trust region can violate.
fn relevant(constraints: &[LinearConstraint], radius: f64) -> Vec<LinearConstraint> {
    constraints
        .iter()
        .filter(|constraint| constraint.margin < radius * constraint.gradient.lp_norm(1))
        .map(|constraint| (constraint, constraint.gradient.norm()))
        .filter(|(_, length)| *length > 0.0)
        .map(|(LinearConstraint { gradient, margin }, length)| LinearConstraint {
            gradient: gradient / length,
            margin: margin / length,
        })
        .collect()
}

impl Program {
    /// The most violated constraint, as an index: the linear constraints come first, then `radius - d_i` and `radius + d_i`
    /// alternately.
    fn most_violated(&self, d: &DVector<f64>) -> Option<usize> {
        let margins = (0..self.constraints.len() + 2 * self.count).map(|number| (number, self.margin(number, d)));
        margins.filter(|(_, margin)| *margin < -TOLERANCE).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number)
    }

    fn margin(&self, number: usize, d: &DVector<f64>) -> f64 {
        match self.constraints.get(number) {
            Some(constraint) => constraint.margin + constraint.gradient.dot(d),
            None => {
                let (variable, sign) = self.bound(number);
                self.radius + sign * d[variable]
            }
        }
    }

    fn normal(&self, number: usize) -> DVector<f64> {
        match self.constraints.get(number) {
            Some(constraint) => constraint.gradient.clone(),
            None => {
                let (variable, sign) = self.bound(number);
                let mut normal = DVector::zeros(self.count);
                normal[variable] = sign;
                normal
            }
        }
    }

    fn bound(&self, number: usize) -> (usize, f64) {
        let number = number - self.constraints.len();
        (number / 2, if number.is_multiple_of(2) { -1.0 } else { 1.0 })
    }
}

/// How the step and the active multipliers change as a further constraint's multiplier grows.
struct Direction {
    primal: DVector<f64>,
    /// The rates at which the multipliers fall.
    dual: DVector<f64>,
}

/// With H the inverse Hessian, N the active normals and `along` = H n: `dual = (N' H N)^-1 N' H n`,
/// `primal = H (n - N dual)`.
fn direction(active: &[Active], normal: &DVector<f64>, along: &DVector<f64>) -> Option<Direction> {
    if active.is_empty() {
        return Some(Direction { primal: along.clone(), dual: DVector::zeros(0) });
    }
    let gram = DMatrix::from_fn(active.len(), active.len(), |a, b| active[a].normal.dot(&active[b].along));
    let mut dual = DVector::from_fn(active.len(), |a, _| active[a].along.dot(normal));
    gram.cholesky()?.solve_mut(&mut dual);
    let mut primal = along.clone();
    for (active, rate) in active.iter().zip(dual.iter()) {
        primal.axpy(-rate, &active.along, 1.0);
    }
    Some(Direction { primal, dual })
}

/// The active constraint whose multiplier reaches zero first, and the step at which it does.
fn first_to_leave(active: &[Active], dual: &DVector<f64>) -> (usize, f64) {
    let steps = active.iter().zip(dual.iter()).enumerate().filter(|(_, (_, rate))| **rate > 0.0);
    steps
        .map(|(number, (active, rate))| (number, active.multiplier / rate))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn constraint(gradient: &[f64], margin: f64) -> LinearConstraint {
        LinearConstraint { gradient: DVector::from_column_slice(gradient), margin }
    }

    #[test]
    fn the_nearest_point_of_a_corner_is_found() {
        // min |d - (2, 1)|^2 / 2 within d_0 + d_1 <= 1 and d_0 <= 0.75: by hand d = (0.75, 0.25).
        let constraints = [constraint(&[-1.0, -1.0], 1.0), constraint(&[-1.0, 0.0], 0.75)];
        let d = solve(&DVector::from_column_slice(&[2.0, 1.0]), &DMatrix::identity(2, 2), &constraints, 10.0).unwrap();
        assert!((d - DVector::from_column_slice(&[0.75, 0.25])).norm() < 1e-12);
    }

    #[test]
    fn contradictory_constraints_have_no_solution() {
        let constraints = [constraint(&[1.0, 0.0], -1.0), constraint(&[-1.0, 0.0], -1.0)];
        assert!(
            solve(&DVector::from_column_slice(&[1.0, 0.0]), &DMatrix::identity(2, 2), &constraints, 10.0).is_none()
        );
    }

    proptest! {
        /// The solution is feasible, and no drawn feasible point has a higher objective.
        #[test]
        fn no_feasible_step_is_better(
            numbers in prop::collection::vec(-1.0..1.0_f64, 6 * 6 + 6 + 12 * 7),
            others in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 6), 40),
        ) {
            let root = DMatrix::from_column_slice(6, 6, &numbers[..36]);
            let hessian = &root * root.transpose() + DMatrix::identity(6, 6) * 0.05;
            let gradient = DVector::from_column_slice(&numbers[36..42]);
            // Margins of at least 0: the zero step is feasible.
            let constraints: Vec<_> = numbers[42..].chunks(7).map(|numbers| constraint(&numbers[..6], numbers[6].abs())).collect();
            let objective = |d: &DVector<f64>| gradient.dot(d) - 0.5 * d.dot(&(&hessian * d));
            let d = solve(&gradient, &hessian, &constraints, 0.8).unwrap();
            let feasible = |d: &DVector<f64>| {
                d.amax() <= 0.8 + 1e-8 && constraints.iter().all(|constraint| constraint.margin + constraint.gradient.dot(d) >= -1e-8)
            };
            prop_assert!(feasible(&d));
            for other in others {
                let mut other = DVector::from_column_slice(&other);
                while !feasible(&other) {
                    other *= 0.7;
                }
                prop_assert!(objective(&other) <= objective(&d) + 1e-8);
            }
        }
    }
}
