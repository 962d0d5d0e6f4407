//! The objective of the equilibrium program: complementary energy in units of 10 N x 1 mm.

use nalgebra::{Matrix6, Vector6};

use super::units::{DISPLACEMENT_UNIT_M, FORCE_UNIT_N, wrench_units};
use crate::statics::{contact_model::ContactModel, hand::HandModel};

/// Compliance of a pad against a force through its centre, m/N; against a moment, this over the square of the lever at
/// which the pad resists it (a half side, or the torsion radius).
///
/// The arms' energy determines neither the internal force nor how a hand's wrench is shared between its pads. This
/// compliance, a thousandth or less of a real pad's, makes the solution and the multipliers unique and changes the
/// board's displacement by less than 1e-4 of itself.
const PAD_COMPLIANCE_M_N: f64 = 1e-10;

/// One hand's energy in the scaled variables: `1/2 w' arm w + shift' w` and the pads' part.
#[derive(Clone, Debug)]
pub struct HandEnergy {
    /// The second derivative by the hand's wrench.
    pub arm: Matrix6<f64>,
    /// The second derivative by each of its pads' variables.
    pub pads: f64,
    /// The first derivative by the hand's wrench at zero: the negative of the hand's offset.
    pub shift: Vector6<f64>,
}

impl HandEnergy {
    /// The energy of a hand without offsets, with this compliance, see
    /// [`HandModel::compliance`](crate::statics::HandModel::compliance).
    pub fn new(compliance: &Matrix6<f64>) -> Self {
        let energy_unit_j = FORCE_UNIT_N * DISPLACEMENT_UNIT_M;
        let units = wrench_units();
        let arm = compliance.component_mul(&(units * units.transpose())) / energy_unit_j;
        // The pads' variables are scaled by the levers that divide their compliance, so one value serves all.
        Self { arm, pads: PAD_COMPLIANCE_M_N * FORCE_UNIT_N * FORCE_UNIT_N / energy_unit_j, shift: Vector6::zeros() }
    }

    /// The energy of a hand.
    fn of(hand: &HandModel) -> Self {
        let shift = -hand.offset.to_vector().component_mul(&wrench_units()) / (FORCE_UNIT_N * DISPLACEMENT_UNIT_M);
        Self { shift, ..Self::new(&hand.compliance()) }
    }

    /// The energy of each hand.
    pub fn of_hands(model: &ContactModel) -> Vec<Self> {
        model.hands.iter().map(Self::of).collect()
    }
}
