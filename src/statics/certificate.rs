//! Certificates of the load factor: dual vectors whose bounds hold whatever the solver did
//! (docs/method.md#66-certificate).
//!
//! For any `z` in the dual cone and any feasible `x = (v, lambda)`, `z'(b - A x) >= 0`. With `r = q + A'z` and `q'x =
//! -lambda` this is `lambda <= b'z - r'x`, and every variable is bounded: `fn <= 2 F`, the others by friction and the
//! pad's size, those of a measured gripper by its limits. So any `z` gives an upper bound, and an optimal one a tight bound.

use clarabel::solver::SupportedConeT;
use nalgebra::Vector6;

use super::{
    contact_model::{ContactModel, ContactModelError},
    hand::HandModel,
    hold::{Hold, MeasuredHold, PadPair},
    solvers::{
        cone_program::{ConeProgram, MAX_LOAD_FACTOR},
        layout::{Layout, ProgramKind},
        units::{FORCE_UNIT_N, wrench_units},
    },
};
use crate::model::{wrench::Wrench, wrench_limits::LimitShape};

/// A dual vector of a load program, with or without torque limits, in the program's scaled rows.
#[derive(Clone, Debug, PartialEq)]
pub struct DualVector {
    kind: ProgramKind,
    z: Vec<f64>,
}

impl DualVector {
    pub(super) fn new(program: &ConeProgram, z: &[f64]) -> Self {
        Self { kind: program.layout.kind(), z: z.to_vec() }
    }

    /// An upper bound of the load factor of this contact model by weak duality, valid up to rounding for any vector:
    /// its inequality parts are first projected into the dual cone, and the residual of `q + A'z` is multiplied by the
    /// largest value of each variable. Infinite if the vector belongs to a model of other dimensions.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn upper_bound(&self, model: &ContactModel) -> Result<f64, ContactModelError> {
        model.check()?;
        let program = ConeProgram::load(model, self.kind);
        Ok(self.bound(model, &program, &program.q))
    }

    /// True if this vector proves that no load factor from 0 to 100 can be held, and so not the weight alone: `A'z =
    /// 0`, `z in K*`, `b'z < 0`, with the residual of `A'z` treated as in [`DualVector::upper_bound`].
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn proves_infeasible(&self, model: &ContactModel) -> Result<bool, ContactModelError> {
        model.check()?;
        let program = ConeProgram::load(model, self.kind);
        Ok(self.refutes(model, &program))
    }

    /// True if this vector proves that the program has no feasible point.
    pub(super) fn refutes(&self, model: &ContactModel, program: &ConeProgram) -> bool {
        self.bound(model, program, &vec![0.0; program.q.len()]) < 0.0
    }

    /// `b'z + sum |q + A'z|_i x_i,max` for the vector projected into the dual cone.
    fn bound(&self, model: &ContactModel, program: &ConeProgram, q: &[f64]) -> f64 {
        if self.z.len() != program.b.len() {
            return f64::INFINITY;
        }
        let z = self.in_dual_cone(&program.layout);
        let largest = largest_variables(model, program);
        let value: f64 = program.b.iter().zip(&z).map(|(b, z)| b * z).sum();
        let residual = |column: usize| {
            let entries = program.a.colptr[column]..program.a.colptr[column + 1];
            q[column] + entries.map(|entry| program.a.nzval[entry] * z[program.a.rowval[entry]]).sum::<f64>()
        };
        value + (0..q.len()).map(|column| residual(column).abs() * largest[column]).sum::<f64>()
    }

    fn in_dual_cone(&self, layout: &Layout) -> Vec<f64> {
        let mut z = self.z.clone();
        let mut rest = z.as_mut_slice();
        for cone in layout.cones() {
            match cone {
                SupportedConeT::NonnegativeConeT(rows) => {
                    split_off(&mut rest, rows).iter_mut().for_each(|value| *value = value.max(0.0));
                }
                SupportedConeT::SecondOrderConeT(rows) => {
                    let rows = split_off(&mut rest, rows);
                    rows[0] = rows[0].max(rows[1..].iter().fold(0.0, |norm: f64, value| norm.hypot(*value)));
                }
                // The multiplier of an equality is free; there are no other cones.
                SupportedConeT::ZeroConeT(rows) => _ = split_off(&mut rest, rows),
                _ => {}
            }
        }
        z
    }
}

/// Removes the first `count` entries from the slice and returns them.
fn split_off<'a>(rest: &mut &'a mut [f64], count: usize) -> &'a mut [f64] {
    let (first, others) = std::mem::take(rest).split_at_mut(count);
    *rest = others;
    first
}

/// An upper bound of the absolute value of each scaled variable at any feasible point.
fn largest_variables(model: &ContactModel, program: &ConeProgram) -> Vec<f64> {
    let mut largest = Vec::with_capacity(program.q.len());
    for hand in &model.hands {
        match &hand.hold {
            Hold::Pads(pair) => {
                let normal = 2.0 * pair.grip_force_n / FORCE_UNIT_N;
                for pad in &pair.pads {
                    let friction = pad.friction * normal;
                    largest.extend([friction, friction, normal, normal, normal, friction]);
                }
                largest.extend(largest_wrench(hand, pair).iter());
            }
            Hold::Measured(MeasuredHold { limits, .. }) => {
                // In any axes a component is at most the length of the vector of the largest components.
                let Wrench { force_n, moment_nm } = limits.largest();
                largest.extend(scaled_bounds(force_n.norm(), moment_nm.norm()).iter());
                largest.extend(vec![1.0; if limits.shape == LimitShape::Ellipsoid { 6 } else { 0 }]);
            }
        }
    }
    largest.push(MAX_LOAD_FACTOR * program.load_scale);
    largest
}

/// Bounds of the components of a hand's scaled wrench: each pad's force is at most `(1 + mu) 2 F`, its moment about the
/// grasp point at most that times the distance, plus its own.
fn largest_wrench(hand: &HandModel, pair: &PadPair) -> Vector6<f64> {
    let (mut force_n, mut moment_nm) = (0.0, 0.0);
    let normal_n = 2.0 * pair.grip_force_n;
    for pad in &pair.pads {
        let pad_force_n = normal_n * (1.0 + pad.friction);
        let [a, b] = pad.half_sides_m;
        let lever_m = (pad.x_op.translation.vector - hand.grasp_point_o).norm();
        force_n += pad_force_n;
        moment_nm += pad_force_n * lever_m + normal_n * (b + a + pad.friction * pad.torsion_radius_m());
    }
    scaled_bounds(force_n, moment_nm)
}

/// Bounds of a scaled wrench whose force and moment are at most so large.
fn scaled_bounds(force_n: f64, moment_nm: f64) -> Vector6<f64> {
    Vector6::new(force_n, force_n, force_n, moment_nm, moment_nm, moment_nm).component_div(&wrench_units())
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::statics::{
        load_factor::LoadFactorOutcome,
        patch::mean_distance_from_centre_m,
        solvers::units::LENGTH_UNIT_M,
        tests::{FRICTION, GRIP_N, HALF_SIDES_M, LEVER_M, pinch},
        workspace::StabilityWorkspace,
    };

    /// The program of a pinch under a newton along x, and its dual vector.
    fn solved() -> (ContactModel, ConeProgram, DualVector) {
        let model = pinch(Vector3::x());
        let outcome = StabilityWorkspace::new().load_factor(&model).unwrap();
        let LoadFactorOutcome::Solved(found) = outcome else { panic!("{outcome:?}") };
        (model.clone(), ConeProgram::load(&model, ProgramKind::Load), found.dual)
    }

    /// `fn <= 2 F`, the others by friction and the pad's size in its units; the hand's wrench is at most that of both pads.
    #[test]
    fn variables_are_bounded_by_grip_force_friction_and_size() {
        let (mut model, program, _) = solved();
        // Beside O, where the lever of a pad is not its place.
        let shift_m = Vector3::new(0.2, -0.1, 0.0);
        model.hands[0].grasp_point_o += shift_m;
        model.hands[0].pads_mut().iter_mut().for_each(|pad| pad.x_op.translation.vector += shift_m);
        let normal = 2.0 * GRIP_N / FORCE_UNIT_N;
        let sliding = FRICTION * normal;
        let of_pad = [sliding, sliding, normal, normal, normal, sliding];
        let force_n = 2.0 * (2.0 * GRIP_N) * (1.0 + FRICTION);
        let own_nm =
            2.0 * GRIP_N * (HALF_SIDES_M[0] + HALF_SIDES_M[1] + FRICTION * mean_distance_from_centre_m(HALF_SIDES_M));
        let moment_nm = force_n * LEVER_M + 2.0 * own_nm;
        let (force, moment) = (force_n / FORCE_UNIT_N, moment_nm / (FORCE_UNIT_N * LENGTH_UNIT_M));
        let mut expected = [of_pad, of_pad, [force, force, force, moment, moment, moment]].concat();
        expected.push(MAX_LOAD_FACTOR / FORCE_UNIT_N);
        let found = largest_variables(&model, &program);
        assert_eq!(found.len(), expected.len());
        assert!(
            found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12 * b),
            "{found:?}, expected {expected:?}"
        );
    }

    /// An optimal vector lies on the boundary of the cone, so what is outside of it comes back to where it was.
    #[test]
    fn a_vector_outside_of_the_dual_cone_is_projected() {
        let (model, program, dual) = solved();
        let bound = dual.upper_bound(&model).unwrap();
        // `2 mu F` of a newton.
        assert!((bound / (2.0 * FRICTION * GRIP_N) - 1.0).abs() < 1e-4, "{bound}");
        let mut outside = dual.clone();
        let mut row = 0;
        for cone in program.layout.cones() {
            match cone {
                SupportedConeT::ZeroConeT(rows) => row += rows,
                SupportedConeT::NonnegativeConeT(rows) => {
                    outside.z[row..row + rows].iter_mut().filter(|z| **z < 1e-6).for_each(|z| *z = -1.0);
                    row += rows;
                }
                SupportedConeT::SecondOrderConeT(rows) => {
                    outside.z[row] = -1.0;
                    row += rows;
                }
                _ => unreachable!("a load program has no other cones"),
            }
        }
        assert_eq!(row, outside.z.len());
        // The solver's tolerance, 1e-7, times the largest variables.
        assert!((outside.upper_bound(&model).unwrap() - bound).abs() < 1e-4 * bound);
    }

    #[test]
    fn the_zero_vector_proves_nothing() {
        let (model, program, dual) = solved();
        let zero = DualVector { z: vec![0.0; program.b.len()], ..dual.clone() };
        assert!(!zero.proves_infeasible(&model).unwrap());
        // Its bound is the cap.
        assert_eq!(zero.upper_bound(&model).unwrap(), MAX_LOAD_FACTOR);
        let short = DualVector { z: vec![0.0], ..dual };
        assert!(!short.proves_infeasible(&model).unwrap());
        assert_eq!(short.upper_bound(&model).unwrap(), f64::INFINITY);
    }
}
