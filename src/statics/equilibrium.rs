//! The forces that compliant, position-controlled arms settle at.
//!
//! The arms' joints are springs about their commanded angles, the pads are rigid-plastic: of all pad wrenches that
//! balance the object within the pads' limits, those are found that minimise the complementary energy
//! `sum_i 1/2 u_i' K_i^-1 u_i`, `u_i = J_i' w_i`, `w_i` the hand's wrench on the object, `K_i = K_q + dg/dq`. The arms'
//! own gravity `g` is compensated by their controllers at the commanded angles and is no part of `u`; away from them it
//! changes by `dg/dq`, a few per cent of the control's stiffness (METHOD section 6 leaves it out). The joints move by
//! `-K_i^-1 u`, and the motors' torque is `g + K_q K_i^-1 u`.
//!
//! # Signs
//! The object pushes the hand with `-w_i`, so the hand gives way by `-C_i w_i`, `C_i = J_i K_i^-1 J_i'`. For a hand
//! within its pads' limits the first-order condition is `C_i w_i + Ad_i y = 0`, `y` the multiplier of the balance
//! `sum w_i + weight + lambda load = 0`: so `y` is the board's displacement `d`, in the direction of the load. A hand at
//! its limits slips: the board moves on it by `Ad_i d + C_i w_i`. (METHOD section 6 writes the same with the wrench on
//! the hand.)
//!
//! # Solvers
//! [`super::elastic`] where every pad is below its limits, [`super::interior_point`] where not, and clarabel where that one
//! does not end well: this module reads the latter's answer.
//!
//! # Uniqueness
//! The energy does not see the squeeze, nor how a hand's wrench is shared between its pads. Each pad is therefore given
//! a compliance of its own, a thousandth or less of any real pad's, which singles out one distribution and one set of
//! multipliers and changes the board's displacement by less than a ten-thousandth.

use clarabel::solver::SolverStatus;
use nalgebra::{DVector, Vector3};

use super::{
    compliance::Twist,
    contact_model::{ContactModel, HandModel},
    layout::Layout,
    load_factor::{balance_twist, joint_torque},
    program::{DISPLACEMENT_UNIT_M, FORCE_UNIT_N, HandEnergy, RawSolution, pad_wrenches, wrench_units},
};
use crate::model::wrench::Wrench;

/// Compliance of a pad against a force through its centre, m/N; against a moment, this over the square of the lever at
/// which the pad takes it up (a half side, or the torsion radius). See the module's text.
const PAD_COMPLIANCE_M_N: f64 = 1e-10;

/// The forces and displacements at one load factor. Displacements are measured from where the commanded angles, with
/// gravity of the arms compensated, would put board and hands; only changes of them are observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The multiple of the load.
    pub load_factor: f64,
    /// Wrenches of each hand's pads on the object, about the pad's centre in pad axes. How a hand's wrench is shared
    /// between its pads is not determined by the arms.
    pub pad_wrenches_p: Vec<[Wrench; 2]>,
    /// Torques of each arm's motors, N m.
    pub joint_torque_nm: Vec<DVector<f64>>,
    /// Displacement of the board, stated for O's origin.
    pub board: Twist,
    /// Displacement of each hand, stated for its grasp point: `-C w`.
    pub hands: Vec<Twist>,
}

impl Equilibrium {
    /// The equilibrium with these pads' wrenches and displacement of the board; the rest follows.
    pub(super) fn of_pads(
        model: &ContactModel,
        load_factor: f64,
        pad_wrenches_p: Vec<[Wrench; 2]>,
        board: Twist,
    ) -> Self {
        let mut joint_torque_nm = Vec::with_capacity(model.hands.len());
        let mut hands = Vec::with_capacity(model.hands.len());
        for (hand, pads) in model.hands.iter().zip(&pad_wrenches_p) {
            let torque = joint_torque(hand, pads);
            let deflection_rad = hand.joint_deflection_rad(&(&torque - &hand.gravity_torque_nm));
            let moved = &hand.jacobian_o * &deflection_rad;
            hands.push(Twist::from_vector(&-moved.fixed_rows::<6>(0).into_owned()));
            joint_torque_nm.push(torque - &hand.gravity_stiffness_nm_rad * deflection_rad);
        }
        Self { load_factor, pad_wrenches_p, joint_torque_nm, board, hands }
    }

    /// Displacement of the board relative to a hand, stated for the grasp point: `Ad d + C w`.
    fn slip(&self, model: &ContactModel, hand: usize) -> Twist {
        self.board.at(&model.hands[hand].grasp_point_o) - self.hands[hand]
    }

    /// The largest joint torque over its limit: hand, joint, ratio.
    pub fn largest_torque_ratio(&self, model: &ContactModel) -> (usize, usize, f64) {
        let mut largest = (0, 0, 0.0);
        for (number, (hand, torque)) in model.hands.iter().zip(&self.joint_torque_nm).enumerate() {
            for joint in 0..hand.dof() {
                let ratio = torque[joint].abs() / hand.effort_nm[joint];
                if ratio > largest.2 {
                    largest = (number, joint, ratio);
                }
            }
        }
        largest
    }
}

/// What became of the search for an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub enum EquilibriumOutcome {
    /// The equilibrium.
    Found(Equilibrium),
    /// No forces within the pads' limits balance the object.
    NoEquilibrium,
    /// The solver stopped early.
    Unknown {
        /// The solver's own word.
        status: String,
    },
}

/// What the load does: the equilibrium under load against that under the weight alone.
#[derive(Clone, Debug, PartialEq)]
pub struct CompliantResponse {
    /// The equilibrium under weight and load.
    pub equilibrium: Equilibrium,
    /// Displacement of the tool point of the board, O axes, m.
    pub deflection_m: Vector3<f64>,
    /// Displacement of the board relative to each hand, stated for the grasp point, O axes.
    pub slip: Vec<Twist>,
}

impl CompliantResponse {
    pub(super) fn between(model: &ContactModel, unloaded: &Equilibrium, loaded: Equilibrium) -> Self {
        let deflection_m = (loaded.board - unloaded.board).at(&model.p_ot).linear;
        let slip = (0..model.hands.len()).map(|hand| loaded.slip(model, hand) - unloaded.slip(model, hand)).collect();
        Self { equilibrium: loaded, deflection_m, slip }
    }

    /// Length of the displacement of the tool point, mm.
    pub fn deflection_mm(&self) -> f64 {
        self.deflection_m.norm() * 1e3
    }
}

/// What became of the search for a response.
#[derive(Clone, Debug, PartialEq)]
pub enum ResponseOutcome {
    /// The response.
    Found(CompliantResponse),
    /// No equilibrium exists at this load factor, 0 meaning under the weight alone.
    NoEquilibrium {
        /// The load factor.
        load_factor: f64,
    },
    /// The solver stopped early.
    Unknown {
        /// The solver's own word.
        status: String,
    },
}

/// One hand's energy in the scaled variables, in units of 10 N x 1 mm.
pub(super) fn hand_energy(hand: &HandModel) -> HandEnergy {
    let energy_unit_j = FORCE_UNIT_N * DISPLACEMENT_UNIT_M;
    let units = wrench_units();
    let arm = hand.compliance().component_mul(&(units * units.transpose())) / energy_unit_j;
    // The pads' variables are scaled by the levers that divide their compliance, so it is the same for all.
    HandEnergy { arm, pads: PAD_COMPLIANCE_M_N * FORCE_UNIT_N * FORCE_UNIT_N / energy_unit_j }
}

/// Reads clarabel's answer to an equilibrium program.
pub(super) fn interpret(
    model: &ContactModel,
    layout: &Layout,
    load_factor: f64,
    raw: &RawSolution<'_>,
) -> EquilibriumOutcome {
    match raw.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => {}
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            return EquilibriumOutcome::NoEquilibrium;
        }
        status => return EquilibriumOutcome::Unknown { status: format!("{status:?}") },
    }
    let places = layout.hands();
    let pad_wrenches_p: Vec<_> =
        model.hands.iter().zip(places).map(|(hand, place)| pad_wrenches(hand, place, raw.x)).collect();
    let board = balance_twist(raw.z, FORCE_UNIT_N * DISPLACEMENT_UNIT_M);
    EquilibriumOutcome::Found(Equilibrium::of_pads(model, load_factor, pad_wrenches_p, board))
}
