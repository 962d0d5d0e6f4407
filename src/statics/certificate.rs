//! Dual vectors of the load program: proofs that need no trust in a solver.
//!
//! For any `z` in the dual cone and any feasible `x = (v, lambda)`, `z'(b - A x) >= 0`. With `r = q + A'z` and
//! `q'x = -lambda` that is `lambda <= b'z - r'x`, and every variable is bounded by the grip: `fn <= 2 F`, the others
//! by friction and the pad's size. So any `z` gives a bound, and a good one a tight bound.

use super::{
    hold::{Hold, HoldError},
    program::{FORCE_UNIT_N, Layout, MAX_LOAD_FACTOR, Program, ProgramKind},
};

/// A dual vector of a hold's load program, in the program's scaled rows.
#[derive(Clone, Debug, PartialEq)]
pub struct DualVector(pub(super) Vec<f64>);

impl DualVector {
    /// An upper bound of the load factor of this hold, by weak duality, true up to rounding whatever the vector: its
    /// inequality parts are first moved into the dual cone, and what is left of `q + A'z` is charged at the largest
    /// size that each variable can have. Infinite when the vector is that of a hold with other dimensions.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn upper_bound(&self, hold: &Hold) -> Result<f64, HoldError> {
        hold.check()?;
        let program = Program::load(hold, ProgramKind::Load);
        Ok(self.bound(hold, &program, &program.q))
    }

    /// True when this vector proves that no load factor from 0 to 100 can be held, so in particular not the weight
    /// alone: `A'z = 0`, `z in K*`, `b'z < 0`, with what is left of `A'z` charged as in [`DualVector::upper_bound`].
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn proves_infeasible(&self, hold: &Hold) -> Result<bool, HoldError> {
        hold.check()?;
        let program = Program::load(hold, ProgramKind::Load);
        Ok(self.bound(hold, &program, &vec![0.0; program.q.len()]) < 0.0)
    }

    /// `b'z + sum |q + A'z|_i x_i,max` for the vector moved into the dual cone.
    fn bound(&self, hold: &Hold, program: &Program, q: &[f64]) -> f64 {
        if self.0.len() != program.b.len() {
            return f64::INFINITY;
        }
        let z = self.in_dual_cone(&program.layout, hold.hands.len());
        let largest = largest_variables(hold, program);
        let value: f64 = program.b.iter().zip(&z).map(|(b, z)| b * z).sum();
        let residual = |column: usize| {
            let entries = program.a.colptr[column]..program.a.colptr[column + 1];
            q[column] + entries.map(|entry| program.a.nzval[entry] * z[program.a.rowval[entry]]).sum::<f64>()
        };
        value + (0..q.len()).map(|column| residual(column).abs() * largest[column]).sum::<f64>()
    }

    fn in_dual_cone(&self, layout: &Layout, hands: usize) -> Vec<f64> {
        let mut z = self.0.clone();
        let first_cone = layout.friction_rows(0, 0);
        z[layout.load_rows()..first_cone].iter_mut().for_each(|value| *value = value.max(0.0));
        for cone in 0..2 * hands {
            let rows = &mut z[first_cone + 4 * cone..first_cone + 4 * cone + 4];
            rows[0] = rows[0].max(rows[1].hypot(rows[2]).hypot(rows[3]));
        }
        z
    }
}

/// The largest size of each scaled variable at any feasible point.
fn largest_variables(hold: &Hold, program: &Program) -> Vec<f64> {
    let mut largest = Vec::with_capacity(program.q.len());
    for hand in &hold.hands {
        let normal = 2.0 * hand.grip_force_n / FORCE_UNIT_N;
        for pad in &hand.pads {
            let friction = pad.friction * normal;
            largest.extend([friction, friction, normal, normal, normal, friction]);
        }
    }
    largest.push(MAX_LOAD_FACTOR * program.load_scale);
    largest
}
