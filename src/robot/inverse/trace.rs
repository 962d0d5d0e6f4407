//! Continuation of the self-motion of a seven-joint arm.
//!
//! The solutions for a gripper pose are closed curves on the torus of joint angles, `q' = t` with `J t = 0`,
//! `|t| = 1`. A curve is followed by prediction along its tangent and correction by Newton's method in the plane normal
//! to it: `[J; t'] dq = [e; 0]` (E. L. Allgower, K. Georg, "Introduction to Numerical Continuation Methods", 1990). Joint
//! limits are ignored here.

use std::f64::consts::TAU;

use nalgebra::{Const, LU, Matrix6, SMatrix, SVector, Vector6};

use super::solution::{RESIDUAL_TOLERANCE, is_finite};
use crate::{model::frames::Pose, robot::chain::Chain};

/// Joint angles of a seven-joint arm, or their derivatives.
pub(super) type Angles = SVector<f64, 7>;

type System = SMatrix<f64, 7, 7>;

/// Maximum, initial and minimum step, rad.
const MAX_STEP_RAD: f64 = 0.25;
const FIRST_STEP_RAD: f64 = 0.05;
const MIN_STEP_RAD: f64 = 1e-6;

/// Desired rotation of the tangent per step, and the maximum above which the step is halved, rad. Chords then deviate from the
/// curve by 3 % of their length.
const STEP_TURN_RAD: f64 = 0.2;
const MAX_TURN_RAD: f64 = 0.45;

/// Maximum correction of a prediction relative to the step; other curves are farther away.
const MAX_CORRECTION: f64 = 0.15;

/// Corrections shorter than this leave an error of about their square, rad.
const LAST_CORRECTION_RAD: f64 = 1e-4;

/// Maximum number of corrections per step: convergence is quadratic, with one to spare.
const MAX_CORRECTIONS: usize = 4;

/// Maximum number of steps of a projection, which is slow near a stretched arm. After `FREE_STEPS` it stops if the residual is
/// above `HOPELESS`.
const PROJECTION_STEPS: usize = 150;
const FREE_STEPS: usize = 24;
const HOPELESS: f64 = 1e-2;

/// Residual at which a projection has converged (m, rad).
const PROJECTED: f64 = 1e-6;

/// Maximum number of points of a curve; a thousand random poses had at most 500.
const MAX_POINTS: usize = 5000;

/// A point on a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub q: Angles,
    /// The unit tangent, in the direction of the trace.
    pub tangent: Angles,
}

/// A traced curve with continuous angles.
pub(super) struct Curve {
    pub points: Vec<Point>,
    /// True if the last point is the first, modulo full turns of joints.
    pub closed: bool,
}

/// The self-motions at one target.
pub(super) struct Tracer<'a> {
    chain: &'a Chain,
    target: Pose,
}

impl<'a> Tracer<'a> {
    /// `None` unless the chain has seven joints and the target is finite.
    pub fn new(chain: &'a Chain, target: &Pose) -> Option<Self> {
        (chain.dof() == 7 && is_finite(target)).then_some(Self { chain, target: *target })
    }

    /// The pose error (m, rad) and the Jacobian with an empty seventh row.
    fn linearised(&self, q: &Angles) -> (Vector6<f64>, System) {
        let mut columns = [Vector6::zeros(); 7];
        let x_wg = self.chain.pose_and_columns(q.as_slice(), &mut columns);
        let mut error = Vector6::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&(self.target.translation.vector - x_wg.translation.vector));
        error.fixed_rows_mut::<3>(3).copy_from(&(self.target.rotation * x_wg.rotation.inverse()).scaled_axis());
        let system = System::from_fn(|row, column| if row < 6 { columns[column][row] } else { 0.0 });
        (error, system)
    }

    /// The point on the curve at which `row . q` is `row . anchor`, by Newton's method from `q`; `None` if it does not
    /// converge to [`RESIDUAL_TOLERANCE`]. The tangent's sign is that of `row`.
    pub fn settled(&self, mut q: Angles, row: &Angles, anchor: &Angles) -> Option<Point> {
        for _ in 0..8 {
            let (error, mut system) = self.linearised(&q);
            let aside = row.dot(&(anchor - q));
            let lu = bordered(&mut system, row);
            if error.norm() <= 0.1 * RESIDUAL_TOLERANCE && aside.abs() <= 0.1 * RESIDUAL_TOLERANCE {
                return Some(Point { q, tangent: tangent(&lu)? });
            }
            q += lu.solve(&error.push(aside))?;
        }
        None
    }

    /// The angles on a self-motion to which a damped search without limits converges from `q`, or `None`. Near a stretched arm it
    /// needs many steps, and finds short curves that slices miss.
    pub fn projected(&self, mut q: Angles) -> Option<Angles> {
        let (mut error, mut system) = self.linearised(&q);
        let mut damping = 1e-2;
        for step in 0..PROJECTION_STEPS {
            if step >= FREE_STEPS && error.norm() > HOPELESS {
                return None;
            }
            let jacobian = system.fixed_rows::<6>(0).into_owned();
            let normal = jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(damping);
            let there = q + jacobian.tr_mul(&normal.cholesky()?.solve(&error));
            let (error_there, system_there) = self.linearised(&there);
            if error_there.norm() >= error.norm() {
                damping *= 8.0;
                continue;
            }
            (q, error, system, damping) = (there, error_there, system_there, damping * 0.1);
            if error.norm() < PROJECTED {
                return Some(q);
            }
        }
        None
    }

    /// The nearest point on the curve for angles nearly on it; `None` if the iteration does not converge.
    pub fn seeded(&self, mut q: Angles) -> Option<Point> {
        for _ in 0..12 {
            let (error, system) = self.linearised(&q);
            let normal = system.tr_mul(&system).symmetric_eigen();
            let (least, _) = normal.eigenvalues.argmin();
            let along = normal.eigenvectors.column(least).into_owned();
            if error.norm() <= 0.1 * RESIDUAL_TOLERANCE {
                return Some(Point { q, tangent: along });
            }
            let mut system = system;
            let step = bordered(&mut system, &along).solve(&error.push(0.0))?;
            q += step * (MAX_TURN_RAD / step.norm()).min(1.0);
        }
        None
    }

    /// The curve through a point: the closed curve, or as far as it can be traced in both directions.
    pub fn curve(&self, start: Point) -> Curve {
        let forward = self.followed(start);
        if forward.closed {
            return forward;
        }
        let mut backward = self.followed(Point { tangent: -start.tangent, ..start }).points;
        backward.iter_mut().for_each(|point| point.tangent = -point.tangent);
        backward.reverse();
        backward.extend(forward.points.into_iter().skip(1));
        Curve { points: backward, closed: false }
    }

    fn followed(&self, start: Point) -> Curve {
        let mut points = vec![start];
        let (mut here, mut step_rad) = (start, FIRST_STEP_RAD);
        // Derivative of the tangent by arc length, for a second-order prediction.
        let mut bend = Angles::zeros();
        // The sign of `det [J; t']` is constant along a curve. It changes if a step jumps to a neighbouring curve.
        let (_, mut system) = self.linearised(&start.q);
        let side = bordered(&mut system, &start.tangent).determinant().signum();
        while points.len() < MAX_POINTS && step_rad > MIN_STEP_RAD {
            let Some((there, turn_rad)) = self.step(&here, &bend, step_rad, side) else {
                step_rad *= 0.5;
                continue;
            };
            if points.len() > 2
                && let Some(end) = meeting(&here, &there, &start)
            {
                points.push(end);
                return Curve { points, closed: true };
            }
            bend = (there.tangent - here.tangent) / (there.q - here.q).norm();
            points.push(there);
            here = there;
            step_rad = (step_rad * (STEP_TURN_RAD / turn_rad.max(1e-3)).clamp(0.5, 2.0)).min(MAX_STEP_RAD);
        }
        Curve { points, closed: false }
    }

    /// The next point and the rotation of the tangent, rad; `None` if the step is too long.
    fn step(&self, here: &Point, bend: &Angles, step_rad: f64, side: f64) -> Option<(Point, f64)> {
        let mut q = here.q + here.tangent * step_rad + bend * (0.5 * step_rad * step_rad);
        for _ in 0..MAX_CORRECTIONS {
            let (error, mut system) = self.linearised(&q);
            let lu = bordered(&mut system, &here.tangent);
            let correction = lu.solve(&error.push(0.0))?;
            let length_rad = correction.norm();
            if length_rad > MAX_CORRECTION * step_rad {
                return None;
            }
            q += correction;
            if length_rad < LAST_CORRECTION_RAD.min(0.01 * step_rad) {
                let tangent = tangent(&lu)?;
                let turn_rad = tangent.dot(&here.tangent).clamp(-1.0, 1.0).acos();
                let follows = turn_rad <= MAX_TURN_RAD && lu.determinant() * side > 0.0;
                return follows.then_some((Point { q, tangent }, turn_rad));
            }
        }
        None
    }
}

/// The LU factors of the Jacobian with this seventh row.
fn bordered(system: &mut System, row: &Angles) -> LU<f64, Const<7>, Const<7>> {
    system.set_row(6, &row.transpose());
    system.lu()
}

/// The unit tangent: in the null space of the Jacobian, with a positive product with the last row.
fn tangent(lu: &LU<f64, Const<7>, Const<7>>) -> Option<Angles> {
    let along = lu.solve(&Vector6::zeros().push(1.0))?;
    let norm = along.norm();
    (norm.is_finite() && norm > 0.0).then(|| along / norm)
}

/// The start of a curve, modulo full turns near the trace, if the step from `here` to `there` passes it.
fn meeting(here: &Point, there: &Point, start: &Point) -> Option<Point> {
    let turned = start.q.zip_map(&here.q, |q, near| q + ((near - q) / TAU).round() * TAU);
    let (chord, to_start) = (there.q - here.q, turned - here.q);
    let share = to_start.dot(&chord) / chord.norm_squared();
    let aside = (to_start - chord * share).norm();
    let passed = share > 0.0 && share <= 1.0 && aside <= MAX_CORRECTION * chord.norm();
    (passed && start.tangent.dot(&chord) > 0.0).then_some(Point { q: turned, tangent: start.tangent })
}
