//! The equilibrium of compliant, position-controlled arms (docs/method.md#68-compliant-equilibrium).
//!
//! A measured gripper has no limits here: like those of torque they are checked afterwards, since a gripper whose limits are
//! exceeded lets go, where a pad slides. The joints are springs about their commanded angles, the pads are rigid-plastic, or elastic-plastic if they have a
//! stiffness (`pad_layer.rs`), which adds `1/2 w_i' C_pads w_i` to the energy. Of all pad wrenches that balance
//! the object within the pads' limits, the equilibrium minimises the complementary energy `sum_i 1/2 u_i' K_i^-1 u_i`,
//! `u_i = J_i' w_i`, with `w_i` the hand's wrench on the object and `K_i = K_q + dg/dq`. The arms' gravity torque `g`
//! is compensated by their controllers at the commanded angles and is not part of `u`; away from these it changes by
//! `dg/dq`, a few per cent of the control's stiffness. The controllers also feed forward what holds the board's weight
//! (docs/method.md#71-arms), so the arms are at the commanded angles under the weight alone, and what a load changes is
//! the difference of two equilibria: with `w_0` the wrenches under the weight, the energy `1/2 (u - u_0)' K^-1 (u - u_0)`
//! has the same minimum as long as no pad is at its limit under the weight, since `C_i w_0i` is then the same motion of the
//! board for all hands. The joints move by `-K_i^-1 u`, and the motors' torque is `g +
//! K_q K_i^-1 u`.
//!
//! # Signs
//! The object exerts `-w_i` on the hand, so the faces of its pads move by `-C_i w_i`, `C_i = J_i K_i^-1 J_i' + C_pads`.
//! For a hand within its pads' limits the first-order condition is `C_i w_i + Ad_i y = 0`, with `y` the multiplier of the balance `sum
//! w_i + weight + lambda load = 0`. Hence `y` is the board's displacement `d`, in the direction of the load. A hand at
//! its limits slips: the board moves relative to it by `Ad_i d + C_i w_i`.

use clarabel::solver::SolverStatus;
use nalgebra::{DVector, Vector3};

use super::{
    contact_model::ContactModel,
    hold::HandWrench,
    solvers::{
        clarabel::RawSolution,
        cone_program::{ConeProgram, wrench_of},
        units::{DISPLACEMENT_UNIT_M, FORCE_UNIT_N, balance_twist},
    },
    twist::Twist,
};

/// Forces and displacements at one load factor. Displacements are relative to where the commanded angles, with gravity
/// of the arms compensated, put board and hands; only their changes are observable.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The multiple of the load.
    pub load_factor: f64,
    /// The wrench of each hand on the object. How it is shared between pads is not determined by the arms.
    pub hand_wrenches: Vec<HandWrench>,
    /// Motor torques of each arm, N m.
    pub joint_torque_nm: Vec<DVector<f64>>,
    /// Displacement of each arm's joints, `-(K_q + dg/dq)^-1 J' w`, rad.
    pub joint_displacement_rad: Vec<DVector<f64>>,
    /// Displacement of the board at O's origin.
    pub board: Twist,
    /// Displacement of the faces of each hand's pads at its grasp point, `-C w`. That of the palm is smaller by what the
    /// pads, or a measured gripper, yield, `-C_pads w`.
    pub hands: Vec<Twist>,
}

impl Equilibrium {
    /// The equilibrium with these wrenches of the hands and this displacement of the board.
    pub(super) fn of_hands(
        model: &ContactModel,
        load_factor: f64,
        hand_wrenches: Vec<HandWrench>,
        board: Twist,
    ) -> Self {
        let mut joint_torque_nm = Vec::with_capacity(model.hands.len());
        let mut hands = Vec::with_capacity(model.hands.len());
        let mut joint_displacement_rad = Vec::with_capacity(model.hands.len());
        for (hand, wrench) in model.hands.iter().zip(&hand_wrenches) {
            let torque = hand.joint_torque_nm(wrench);
            let deflection_rad = hand.joint_deflection_rad(&(&torque - &hand.gravity_torque_nm));
            let mut moved = (&hand.jacobian_o * &deflection_rad).fixed_rows::<6>(0).into_owned();
            if let Some(compliance) = hand.hold_compliance() {
                moved += compliance * hand.wrench_about_grasp_point(wrench).to_vector();
            }
            hands.push(Twist::from_vector(&-moved));
            joint_torque_nm.push(torque - &hand.gravity_stiffness_nm_rad * &deflection_rad);
            joint_displacement_rad.push(-deflection_rad);
        }
        Self { load_factor, hand_wrenches, joint_torque_nm, joint_displacement_rad, board, hands }
    }

    /// Displacement of the board relative to the faces of a hand's pads at the grasp point, `Ad d + C w`.
    fn slip(&self, model: &ContactModel, hand: usize) -> Twist {
        self.board.at(&model.hands[hand].grasp_point_o) - self.hands[hand]
    }

    /// The largest ratio of a joint torque to its limit: hand, joint, ratio.
    pub(super) fn largest_torque_ratio(&self, model: &ContactModel) -> (usize, usize, f64) {
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

/// The outcome of the equilibrium program.
#[derive(Clone, Debug, PartialEq)]
pub enum EquilibriumOutcome {
    /// The equilibrium.
    Found(Equilibrium),
    /// No forces within the pads' limits balance the object.
    NoEquilibrium,
    /// The solver stopped early.
    Unknown {
        /// The solver's status.
        status: String,
    },
}

/// The effect of the load: the equilibrium under weight and load relative to that under the weight alone.
#[derive(Clone, Debug, PartialEq)]
pub struct CompliantResponse {
    /// The equilibrium under weight and load; its motor torques are those of servos that feed the weight forward.
    pub equilibrium: Equilibrium,
    /// Displacement of the tool tip on the board, O axes, m.
    pub deflection_m: Vector3<f64>,
    /// Displacement of the board relative to each hand at the grasp point, O axes.
    pub slip: Vec<Twist>,
    /// Displacement of the board at O's origin, O axes.
    pub board: Twist,
    /// Displacement of each arm's joints, rad.
    pub joints_rad: Vec<DVector<f64>>,
}

impl CompliantResponse {
    pub(super) fn between(model: &ContactModel, unloaded: &Equilibrium, mut loaded: Equilibrium) -> Self {
        // The weight is fed forward, so it does not displace the joints, and the arms' gravity torque does not change.
        let arms = loaded.joint_torque_nm.iter_mut().zip(&model.hands).zip(&unloaded.joint_displacement_rad);
        for ((torque_nm, hand), displaced_rad) in arms {
            *torque_nm -= &hand.gravity_stiffness_nm_rad * displaced_rad;
        }
        let board = loaded.board - unloaded.board;
        let deflection_m = board.at(&model.p_ot).linear;
        let joints = loaded.joint_displacement_rad.iter().zip(&unloaded.joint_displacement_rad);
        let joints_rad = joints.map(|(loaded_rad, unloaded_rad)| loaded_rad - unloaded_rad).collect();
        let slip = (0..model.hands.len()).map(|hand| loaded.slip(model, hand) - unloaded.slip(model, hand)).collect();
        Self { equilibrium: loaded, deflection_m, slip, board, joints_rad }
    }

    /// Length of the displacement of the tool tip, mm.
    #[must_use]
    pub fn deflection_mm(&self) -> f64 {
        self.deflection_m.norm() * 1e3
    }
}

/// The outcome of the search for a response.
#[derive(Clone, Debug, PartialEq)]
pub enum ResponseOutcome {
    /// The response.
    Found(Box<CompliantResponse>),
    /// No equilibrium exists at this load factor; 0 means under the weight alone.
    NoEquilibrium {
        /// The load factor.
        load_factor: f64,
    },
    /// The solver stopped early.
    Unknown {
        /// The solver's status.
        status: String,
    },
}

/// Interprets clarabel's solution of an equilibrium program.
pub(super) fn interpret(
    model: &ContactModel,
    program: &ConeProgram,
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
    let places = program.layout.hands();
    let wrenches = model.hands.iter().zip(places).map(|(hand, place)| wrench_of(hand, place, raw.x)).collect();
    let board = balance_twist(raw.z, FORCE_UNIT_N * DISPLACEMENT_UNIT_M);
    EquilibriumOutcome::Found(Equilibrium::of_hands(model, load_factor, wrenches, board))
}
