//! The quadratic program of one step: the dual active-set method of Goldfarb and Idnani (Mathematical Programming 27,
//! 1983), for a few dozen variables.
//!
//! Starting at the unconstrained optimum, the most violated constraint becomes active and constraints whose multipliers would
//! turn negative become inactive, until none is violated. The Hessian is positive definite, so every step is unique. The
//! factorisation of the active constraints is updated at every change, as in the paper (`factors`).
//!
//! It is our own because it is called a hundred times per plan: `benches/qp.rs` measures it beside clarabel.

mod factors;

use nalgebra::{DMatrix, DVector};

use factors::{Factors, axpy, dot};

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
/// A step of a variable that is more than rounding, in the units of the variables.
const DRIFT: f64 = 1e-9;

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
    let mut factors = Factors::new(hessian)?;
    let program = Program::new(constraints, radius, gradient.len());
    let mut d = factors.unconstrained(gradient);
    let mut multipliers: Vec<f64> = Vec::with_capacity(gradient.len());
    let mut workspace = Workspace::new(&program);
    let least_curvature = TOLERANCE * factors.largest_of_inverse();
    let mut changes = 0;
    while let Some(violated) = program.most_violated(&d, &mut workspace.margins) {
        let Workspace { normal, primal, dual, .. } = &mut workspace;
        program.normal(violated, normal);
        let mut multiplier = 0.0;
        loop {
            changes += 1;
            if changes > MAX_CHANGES {
                return None;
            }
            let curvature = factors.direction(normal, primal, dual);
            let full = if curvature > least_curvature {
                -program.margin(violated, normal, &d) / curvature
            } else {
                f64::INFINITY
            };
            let (first, partial) = first_to_leave(&multipliers, dual);
            let step = full.min(partial);
            if step.is_infinite() {
                return None;
            }
            if full.is_finite() {
                axpy(&mut d, step, primal);
            }
            multipliers.iter_mut().zip(dual.iter()).for_each(|(multiplier, rate)| *multiplier -= step * rate);
            multiplier += step;
            if full <= partial {
                break;
            }
            factors.remove(first);
            multipliers.remove(first);
        }
        factors.add();
        multipliers.push(multiplier);
    }
    let d = DVector::from_vec(d);
    // Where normals are nearly dependent, rounding may have moved d along the active constraints: a Newton step within them takes it
    // back.
    let Workspace { primal, dual, .. } = &mut workspace;
    factors.direction((gradient - hessian * &d).as_slice(), primal, dual);
    let step = DVector::from_column_slice(primal);
    Some(if step.amax() > DRIFT { d + step } else { d })
}

/// Memory of one program.
struct Workspace {
    margins: Vec<f64>,
    normal: Vec<f64>,
    /// How the step changes as a further constraint's multiplier grows.
    primal: Vec<f64>,
    /// The rates at which the active multipliers then fall.
    dual: Vec<f64>,
}

impl Workspace {
    fn new(program: &Program) -> Self {
        let zeros = vec![0.0; program.count];
        Self { margins: vec![0.0; program.margins.len()], normal: zeros.clone(), primal: zeros.clone(), dual: zeros }
    }
}

/// All constraints, with normals of length 1.
struct Program {
    /// The normals of the linear constraints by columns: the entries of all constraints for one variable are adjacent.
    normals: Vec<f64>,
    /// Their margins at d = 0.
    margins: Vec<f64>,
    radius: f64,
    count: usize,
}

impl Program {
    /// The constraints without those that no step within the trust region can violate.
    fn new(constraints: &[LinearConstraint], radius: f64, count: usize) -> Self {
        let relevant: Vec<_> = constraints
            .iter()
            .filter(|constraint| {
                constraint.margin < radius * constraint.gradient.iter().map(|entry| entry.abs()).sum::<f64>()
            })
            .map(|constraint| (constraint, constraint.gradient.norm()))
            .filter(|(_, length)| *length > 0.0)
            .collect();
        let rows = relevant.len();
        let mut normals = vec![0.0; rows * count];
        for (row, (constraint, length)) in relevant.iter().enumerate() {
            for (variable, entry) in constraint.gradient.iter().enumerate() {
                normals[variable * rows + row] = entry / length;
            }
        }
        let margins = relevant.iter().map(|(constraint, length)| constraint.margin / length).collect();
        Self { normals, margins, radius, count }
    }

    /// The most violated constraint, as an index: the linear constraints come first, then `radius - d_i` and `radius + d_i`
    /// alternately.
    fn most_violated(&self, d: &[f64], margins: &mut [f64]) -> Option<usize> {
        let rows = self.margins.len();
        margins.copy_from_slice(&self.margins);
        for (variable, step) in d.iter().enumerate() {
            axpy(margins, *step, &self.normals[variable * rows..(variable + 1) * rows]);
        }
        let bounds = d.iter().flat_map(|step| [self.radius - step, self.radius + step]);
        let mut most = (None, -TOLERANCE);
        for (number, margin) in margins.iter().copied().chain(bounds).enumerate() {
            if margin < most.1 {
                most = (Some(number), margin);
            }
        }
        most.0
    }

    /// The margin of a constraint with this normal.
    fn margin(&self, number: usize, normal: &[f64], d: &[f64]) -> f64 {
        self.margins.get(number).unwrap_or(&self.radius) + dot(normal, d)
    }

    /// Writes the normal of a constraint.
    fn normal(&self, number: usize, normal: &mut [f64]) {
        let rows = self.margins.len();
        if number < rows {
            normal.iter_mut().enumerate().for_each(|(variable, entry)| *entry = self.normals[variable * rows + number]);
        } else {
            let bound = number - rows;
            normal.fill(0.0);
            normal[bound / 2] = if bound.is_multiple_of(2) { -1.0 } else { 1.0 };
        }
    }
}

/// The active constraint whose multiplier reaches zero first, and the step at which it does.
fn first_to_leave(multipliers: &[f64], dual: &[f64]) -> (usize, f64) {
    let mut first = (0, f64::INFINITY);
    for (number, (multiplier, rate)) in multipliers.iter().zip(dual).enumerate() {
        if *rate > 0.0 && multiplier / rate < first.1 {
            first = (number, multiplier / rate);
        }
    }
    first
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

    /// A constraint with a smaller margin counts as active: of the constraints that are not, one in some thousands is as near.
    const ACTIVE: f64 = 1e-6;

    proptest! {
        /// The conditions of Karush, Kuhn and Tucker, with multipliers by least squares: the gradient at the solution is a
        /// combination of the active constraints' normals with coefficients of one sign. As in a refinement there are more
        /// constraints than variables, many of them active, and some twice.
        #[test]
        fn the_gradient_is_held_by_the_active_constraints(
            numbers in prop::collection::vec(-1.0..1.0_f64, 19 * 19 + 19 + 40 * 20),
            radius in 0.05..2.0_f64,
        ) {
            let count = 19;
            let (root, rest) = numbers.split_at(count * count);
            let root = DMatrix::from_column_slice(count, count, root);
            let hessian = &root * root.transpose() + DMatrix::identity(count, count) * 0.1;
            let gradient = DVector::from_column_slice(&rest[..count]) * 5.0;
            let mut constraints: Vec<_> =
                rest[count..].chunks(20).map(|numbers| constraint(&numbers[..19], 0.2 * numbers[19].abs())).collect();
            constraints.extend_from_within(..5);
            let d = solve(&gradient, &hessian, &constraints, radius).unwrap();
            let mut normals: Vec<DVector<f64>> = Vec::new();
            for constraint in &constraints {
                let margin = constraint.margin + constraint.gradient.dot(&d);
                prop_assert!(margin > -1e-8);
                // Where normals are nearly dependent, rounding moves the step off the constraints that hold it by more than 1e-8.
                if margin < ACTIVE && !normals.contains(&constraint.gradient) {
                    normals.push(constraint.gradient.clone());
                }
            }
            for variable in 0..count {
                prop_assert!(d[variable].abs() < radius + 1e-8);
                if d[variable].abs() > radius - ACTIVE {
                    let mut normal = DVector::zeros(count);
                    normal[variable] = -d[variable].signum();
                    normals.push(normal);
                }
            }
            let residual = &gradient - &hessian * &d;
            // A drift of the variables that is not taken back; the Hessian's norm is about 40.
            let rounding = DRIFT * hessian.norm();
            if normals.is_empty() {
                prop_assert!(residual.amax() < 1e-8);
            } else {
                // gradient - hessian d + sum multiplier normal = 0.
                let normals = DMatrix::from_columns(&normals);
                let multipliers = -normals.clone().svd(true, true).solve(&residual, 1e-12).unwrap();
                prop_assert!((residual + &normals * &multipliers).amax() < rounding);
                prop_assert!(multipliers.min() > -rounding);
            }
        }

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
