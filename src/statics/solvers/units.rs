//! Scaling of the programs: forces in units of 10 N, moments in the balance and in hands' wrenches in units of 10 N x
//! 0.2 m, displacements in mm. A pad's own moments are scaled by its half sides and its torsion radius, so that the
//! rows of all pads look alike.

use nalgebra::{Matrix6, Vector3, Vector6};

use crate::{
    model::wrench::Wrench,
    statics::{pad_model::PadModel, twist::Twist},
};

/// Unit of force, N.
pub const FORCE_UNIT_N: f64 = 10.0;

/// Unit of displacement, m: displacements of interest are a few of it.
pub const DISPLACEMENT_UNIT_M: f64 = 1e-3;

/// Unit of length of the moments in the balance rows, m.
pub const LENGTH_UNIT_M: f64 = 0.2;

/// Units of a pad's variables `(ft1, ft2, fn, mt1, mt2, mn)`: N for the forces, N m for the moments.
pub fn pad_units(pad: &PadModel) -> Vector6<f64> {
    let [a, b] = pad.half_sides_m;
    Vector6::new(1.0, 1.0, 1.0, b, a, pad.torsion_radius_m()) * FORCE_UNIT_N
}

/// Units of a hand's wrench variables, N and N m.
pub fn wrench_units() -> Vector6<f64> {
    let (force, moment) = (FORCE_UNIT_N, FORCE_UNIT_N * LENGTH_UNIT_M);
    Vector6::new(force, force, force, moment, moment, moment)
}

/// A wrench in the units of the balance rows.
pub fn scaled(wrench: &Wrench) -> Vector6<f64> {
    Wrench::new(wrench.force_n, wrench.moment_nm / LENGTH_UNIT_M).to_vector() / FORCE_UNIT_N
}

/// `[R 0; [p]x R, R]` times the units of a pad's variables: maps them to the wrench about a point, N and N m. `lever_o`
/// is p, from that point to the pad.
pub fn pad_map(pad: &PadModel, lever_o: &Vector3<f64>) -> Matrix6<f64> {
    let rotation = pad.rotation();
    let mut map = Matrix6::zeros();
    map.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    map.fixed_view_mut::<3, 3>(3, 0).copy_from(&(lever_o.cross_matrix() * rotation));
    map.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    for (mut column, unit) in map.column_iter_mut().zip(pad_units(pad).iter()) {
        column *= *unit;
    }
    map
}

/// The wrench of a pad on the object, about its centre in pad axes, from its variables.
pub fn pad_wrench(pad: &PadModel, variables: &Vector6<f64>) -> Wrench {
    let [fx, fy, fz, mx, my, mz] = variables.component_mul(&pad_units(pad)).into();
    Wrench::from([fx, fy, fz, mx, my, mz])
}

/// The twist that the multipliers of the balance rows stand for, with the objective in units of `objective_unit`.
pub fn balance_twist(multipliers: &[f64], objective_unit: f64) -> Twist {
    let part = |first: usize| {
        Vector3::new(multipliers[first], multipliers[first + 1], multipliers[first + 2])
            * (objective_unit / FORCE_UNIT_N)
    };
    Twist { linear: part(0), angular: part(3) / LENGTH_UNIT_M }
}
