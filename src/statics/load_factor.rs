//! The load factor of a hold and what limits it.

use clarabel::solver::SolverStatus;
use nalgebra::{DVector, Vector3};

use super::{
    certificate::DualVector,
    compliance::Twist,
    contact_model::{ContactModel, HandModel, PadModel},
    layout::PadLayout,
    program::{FORCE_UNIT_N, LENGTH_UNIT_M, Program, RawSolution, pad_wrenches},
    sensitivity::{self, Sensitivity},
};
use crate::model::wrench::Wrench;

/// What is taken off a load factor that was found with reduced accuracy.
const ALMOST_SOLVED_MARGIN: f64 = 1e-3;

/// A pad whose normal force is below this share of the grip force counts as open (METHOD section 8).
const OPEN_PAD_RATIO: f64 = 0.05;

/// Terms below this share of the largest are not named. A limit that does not bind has a multiplier at the solver's
/// tolerance, 1e-8: the threshold is far above that, and is there for the reader, who wants to know what to
/// strengthen: a limit below it would bring less than a twentieth of what the first one brings.
pub(super) const NAMED_SHARE: f64 = 0.05;

/// The solution of the load program.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadFactor {
    /// lambda*, 0 to 100: the largest multiple of the load that some distribution of forces holds.
    pub load_factor: f64,
    /// What limits it, strongest first, such as `left upper pad: friction` or `left_w1: torque`; empty when nothing
    /// but the cap of 100 does.
    ///
    /// Each limit's term is `d lambda* / d ln(limit)`, what a relative increase of the limit brings: for the sliding,
    /// torsion and tilt parts of a pad's limits their share of `z's`, for a joint `tau_max (z+ + z-)`. A pad that is
    /// left with less than 5 % of its grip force is limited by the grip. Named are the terms of at least a twentieth
    /// of the largest.
    pub binding: Vec<String>,
    /// What a stronger grip, rougher pads or stronger joints would bring.
    pub sensitivity: Sensitivity,
    /// Wrenches of each hand's pads on the object, about the pad's centre in pad axes.
    pub pad_wrenches_p: Vec<[Wrench; 2]>,
    /// Torques of each arm's joints, `g + J' w`, N m.
    pub joint_torque_nm: Vec<DVector<f64>>,
    /// The virtual twist that the failing load drives: `twist . load = 1` unless the cap of 100 limits; its linear part
    /// in 1/N, its angular part in 1/(N m).
    pub dual_twist: Twist,
    /// The whole dual vector: a proof of the load factor, see [`DualVector::upper_bound`].
    pub dual: DualVector,
}

/// What became of the load program.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadFactorOutcome {
    /// Solved, or almost solved with 1e-3 taken off.
    Solved(LoadFactor),
    /// No load factor from 0 to 100 can be held, so not the weight alone either.
    GravityInfeasible {
        /// The proof, see [`DualVector::proves_infeasible`].
        certificate: DualVector,
    },
    /// The solver stopped early: never to be taken for stable.
    Unknown {
        /// The solver's own word.
        status: String,
    },
}

impl LoadFactorOutcome {
    /// The load factor; none unless solved.
    pub fn load_factor(&self) -> Option<f64> {
        match self {
            Self::Solved(solved) => Some(solved.load_factor),
            _ => None,
        }
    }
}

/// A limit of a pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PadLimit {
    /// Sliding along the face.
    Friction,
    /// Turning about the normal.
    Torsion,
    /// The centre of pressure at the pad's rim.
    Tilt,
    /// The pad is pulled off the face.
    Grip,
}

impl PadLimit {
    /// The name in plans and tables.
    fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Torsion => "torsion",
            Self::Tilt => "tilt",
            Self::Grip => "grip",
        }
    }
}

/// Reads clarabel's answer to a load program.
pub(super) fn interpret(model: &ContactModel, program: &Program, raw: &RawSolution<'_>) -> LoadFactorOutcome {
    let margin = match raw.status {
        SolverStatus::Solved => 0.0,
        SolverStatus::AlmostSolved => ALMOST_SOLVED_MARGIN,
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            let certificate = DualVector::new(program, raw.z);
            // The solver's word is not enough: the proof must be one.
            return if certificate.refutes(model, program) {
                LoadFactorOutcome::GravityInfeasible { certificate }
            } else {
                LoadFactorOutcome::Unknown { status: format!("{:?}", raw.status) }
            };
        }
        status => return LoadFactorOutcome::Unknown { status: format!("{status:?}") },
    };
    let lambda = raw.x[raw.x.len() - 1] / program.load_scale;
    let pad_wrenches_p: Vec<_> =
        model.hands.iter().zip(program.layout.hands()).map(|(hand, place)| pad_wrenches(hand, place, raw.x)).collect();
    let joint_torque_nm =
        model.hands.iter().zip(&pad_wrenches_p).map(|(hand, pads)| joint_torque(hand, pads)).collect();
    LoadFactorOutcome::Solved(LoadFactor {
        load_factor: (lambda - margin).clamp(0.0, super::MAX_LOAD_FACTOR),
        binding: binding(model, program, raw),
        sensitivity: sensitivity::of(model, program, raw),
        pad_wrenches_p,
        joint_torque_nm,
        dual_twist: balance_twist(raw.z, 1.0),
        dual: DualVector::new(program, raw.z),
    })
}

/// `g + J' w`, N m.
pub(super) fn joint_torque(hand: &HandModel, pads_p: &[Wrench; 2]) -> DVector<f64> {
    let wrench = hand.wrench_about_grasp_point(pads_p).to_vector();
    hand.jacobian_o.tr_mul(&wrench) + &hand.gravity_torque_nm
}

/// The dual of the balance rows as a twist, for an objective in units of `objective_unit`.
pub(super) fn balance_twist(z: &[f64], objective_unit: f64) -> Twist {
    let part = |first: usize| Vector3::new(z[first], z[first + 1], z[first + 2]) * (objective_unit / FORCE_UNIT_N);
    Twist { linear: part(0), angular: part(3) / LENGTH_UNIT_M }
}

/// The names of the limits that bind, strongest first.
fn binding(model: &ContactModel, program: &Program, raw: &RawSolution<'_>) -> Vec<String> {
    let layout = &program.layout;
    let cap = raw.z[layout.load_rows() + 1];
    let mut terms: Vec<(f64, String)> = Vec::new();
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        for (pad, pad_place) in hand.pads.iter().zip(&place.pads) {
            let of_pad = pad_terms(hand, pad, pad_place, raw);
            terms.extend(
                of_pad.map(|(term, limit)| (term, format!("{} {} pad: {}", hand.name, pad.name, limit.name()))),
            );
        }
        if layout.has_torque_rows() {
            let row = place.torque_rows;
            // The rows are divided by the limit, so the multipliers are the terms.
            let of_joint = |joint: usize| raw.z[row + joint] + raw.z[row + hand.dof() + joint];
            terms.extend(
                hand.joints.iter().enumerate().map(|(joint, name)| (of_joint(joint), format!("{name}: torque"))),
            );
        }
    }
    let largest = terms.iter().map(|(term, _)| *term).fold(0.0, f64::max);
    // The cap's own term, in the same measure.
    if cap > largest {
        return Vec::new();
    }
    terms.retain(|(term, _)| *term > 0.0 && *term >= NAMED_SHARE * largest);
    // Stable: equal terms stay in the order of hands, pads and joints.
    terms.sort_by(|left, right| right.0.total_cmp(&left.0));
    terms.into_iter().map(|(_, name)| name).collect()
}

/// `d lambda* / d ln(limit)` of a pad's four limits.
fn pad_terms(hand: &HandModel, pad: &PadModel, place: &PadLayout, raw: &RawSolution<'_>) -> [(f64, PadLimit); 4] {
    let normal = raw.x[place.variables + 2];
    let grip = hand.grip_force_n / FORCE_UNIT_N;
    if normal < OPEN_PAD_RATIO * grip {
        let pull = grip * pull_multiplier(pad, place, raw);
        return [(pull, PadLimit::Grip), (0.0, PadLimit::Friction), (0.0, PadLimit::Torsion), (0.0, PadLimit::Tilt)];
    }
    let [friction, torsion, tilt] = soft_terms(place, raw);
    [(friction, PadLimit::Friction), (torsion, PadLimit::Torsion), (tilt, PadLimit::Tilt), (0.0, PadLimit::Grip)]
}

/// What a pad that is pulled off would gain from each unit of normal force.
fn pull_multiplier(pad: &PadModel, place: &PadLayout, raw: &RawSolution<'_>) -> f64 {
    let friction = f64::max(0.0, raw.z[place.friction_rows]);
    let pressure = &raw.z[place.pressure_rows..place.pressure_rows + 4];
    pad.friction * friction + pressure.iter().sum::<f64>()
}

/// Sliding, torsion and tilt of a soft finger. `mu fn z_0 = -z_t . s_t` at the optimum is the friction cone's term,
/// split into its sliding and its turning part.
fn soft_terms(place: &PadLayout, raw: &RawSolution<'_>) -> [f64; 3] {
    let share = |row: usize| -raw.z[place.friction_rows + row] * raw.s[place.friction_rows + row];
    let tilt: f64 = raw.z[place.pressure_rows..place.pressure_rows + 4].iter().sum();
    [share(1) + share(2), share(3), raw.x[place.variables + 2] * tilt]
}
