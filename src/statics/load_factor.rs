//! The load factor lambda* of a contact model and the limits that bind (docs/method.md#65-load-factor).

use clarabel::solver::SolverStatus;
use nalgebra::DVector;

use super::{
    certificate::DualVector,
    contact_model::ContactModel,
    hold::HandWrench,
    pad_model::PadModel,
    sensitivity::{self, Sensitivity, limit_terms},
    solvers::{
        clarabel::RawSolution,
        cone_program::{ConeProgram, MAX_LOAD_FACTOR, wrench_of},
        layout::{HoldLayout, PadLayout},
        units::FORCE_UNIT_N,
    },
};

/// Subtracted from a load factor that was found with reduced accuracy.
const ALMOST_SOLVED_MARGIN: f64 = 1e-3;

/// A pad whose normal force is below this share of the grip force counts as open (docs/method.md#86-contact).
const OPEN_PAD_RATIO: f64 = 0.05;

/// Terms below this share of the largest are not named. A limit that does not bind has a multiplier at the solver's
/// tolerance, 1e-7, far below. Strengthening an unnamed limit gains less than a twentieth of what the first one gains.
pub(super) const NAMED_SHARE: f64 = 0.05;

/// The solution of the load program.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadFactor {
    /// lambda*, 0 to 100: the largest multiple of the load that some distribution of forces balances within all limits.
    pub load_factor: f64,
    /// The binding limits, strongest first, such as `left upper pad: friction`, `left_w1: torque`, `left gripper: moment x`
    /// (a measured box) or `left gripper: wrench` (an ellipsoid); empty if only the cap of 100 binds.
    ///
    /// They are ordered by `d lambda* / d ln(limit)`: for the friction, torsion and tilt limits of a pad their part of
    /// `z's`, for a joint `tau_max (z+ + z-)`. A pad with less than 5 % of its grip force is limited by the grip. Terms
    /// below a twentieth of the largest are left out.
    pub binding: Vec<String>,
    /// Derivatives by grip force, friction and torque limits.
    pub sensitivity: Sensitivity,
    /// The wrench of each hand on the object.
    pub hand_wrenches: Vec<HandWrench>,
    /// Torques of each arm's joints, `g + J' w`, N m.
    pub joint_torque_nm: Vec<DVector<f64>>,
    /// The dual vector: a certificate of the load factor, see [`DualVector::upper_bound`].
    pub dual: DualVector,
}

/// The outcome of the load program.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadFactorOutcome {
    /// Solved, or almost solved with 1e-3 subtracted.
    Solved(LoadFactor),
    /// No load factor from 0 to 100 can be held, and so not the weight alone.
    GravityInfeasible {
        /// The proof, see [`DualVector::proves_infeasible`].
        certificate: DualVector,
    },
    /// The solver stopped early; must not be taken for stable.
    Unknown {
        /// The solver's status.
        status: String,
    },
}

impl LoadFactorOutcome {
    /// The load factor; `None` unless solved.
    #[must_use]
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
    /// Rotation about the normal.
    Torsion,
    /// Centre of pressure at the edge of the pad.
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

/// Interprets clarabel's solution of a load program.
pub(super) fn interpret(model: &ContactModel, program: &ConeProgram, raw: &RawSolution<'_>) -> LoadFactorOutcome {
    let margin = match raw.status {
        SolverStatus::Solved => 0.0,
        SolverStatus::AlmostSolved => ALMOST_SOLVED_MARGIN,
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            let certificate = DualVector::new(program, raw.z);
            // The solver's status is not trusted: the certificate is checked.
            return if certificate.refutes(model, program) {
                LoadFactorOutcome::GravityInfeasible { certificate }
            } else {
                LoadFactorOutcome::Unknown { status: format!("{:?}", raw.status) }
            };
        }
        status => return LoadFactorOutcome::Unknown { status: format!("{status:?}") },
    };
    let lambda = raw.x[raw.x.len() - 1] / program.load_scale;
    let hand_wrenches: Vec<_> =
        model.hands.iter().zip(program.layout.hands()).map(|(hand, place)| wrench_of(hand, place, raw.x)).collect();
    let joint_torque_nm =
        model.hands.iter().zip(&hand_wrenches).map(|(hand, wrench)| hand.joint_torque_nm(wrench)).collect();
    LoadFactorOutcome::Solved(LoadFactor {
        load_factor: (lambda - margin).clamp(0.0, MAX_LOAD_FACTOR),
        binding: binding(model, program, raw),
        sensitivity: sensitivity::of(model, program, raw),
        hand_wrenches,
        joint_torque_nm,
        dual: DualVector::new(program, raw.z),
    })
}

/// The names of the limits that bind, strongest first.
fn binding(model: &ContactModel, program: &ConeProgram, raw: &RawSolution<'_>) -> Vec<String> {
    let layout = &program.layout;
    let cap = raw.z[layout.load_rows() + 1];
    let mut terms: Vec<(f64, String)> = Vec::new();
    for (hand, place) in model.hands.iter().zip(layout.hands()) {
        if let HoldLayout::Measured(limits) = &place.hold {
            terms.extend(
                limit_terms(limits, raw).map(|(term, limit)| (term, format!("{} gripper: {limit}", hand.name))),
            );
        }
        let pads =
            hand.pad_pair().into_iter().flat_map(|pair| pair.pads.iter().map(move |pad| (pair.grip_force_n, pad)));
        for ((grip_force_n, pad), pad_place) in pads.zip(place.pads()) {
            let of_pad = pad_terms(grip_force_n, pad, pad_place, raw);
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
    // The cap's term, in the same measure.
    if cap > largest {
        return Vec::new();
    }
    terms.retain(|(term, _)| *term > 0.0 && *term >= NAMED_SHARE * largest);
    // A stable sort: equal terms stay in the order of hands, pads and joints.
    terms.sort_by(|left, right| right.0.total_cmp(&left.0));
    terms.into_iter().map(|(_, name)| name).collect()
}

/// `d lambda* / d ln(limit)` of a pad's four limits.
fn pad_terms(grip_force_n: f64, pad: &PadModel, place: &PadLayout, raw: &RawSolution<'_>) -> [(f64, PadLimit); 4] {
    let normal = raw.x[place.variables + 2];
    let grip = grip_force_n / FORCE_UNIT_N;
    if normal < OPEN_PAD_RATIO * grip {
        let pull = grip * pull_multiplier(pad, place, raw);
        return [(pull, PadLimit::Grip), (0.0, PadLimit::Friction), (0.0, PadLimit::Torsion), (0.0, PadLimit::Tilt)];
    }
    let [friction, torsion, tilt] = soft_terms(place, raw);
    [(friction, PadLimit::Friction), (torsion, PadLimit::Torsion), (tilt, PadLimit::Tilt), (0.0, PadLimit::Grip)]
}

/// Derivative of the load factor by the normal force of a pad that is pulled off.
fn pull_multiplier(pad: &PadModel, place: &PadLayout, raw: &RawSolution<'_>) -> f64 {
    let friction = f64::max(0.0, raw.z[place.friction_rows]);
    let pressure = &raw.z[place.pressure_rows..place.pressure_rows + 4];
    pad.friction * friction + pressure.iter().sum::<f64>()
}

/// Friction, torsion and tilt terms of a pad. The friction cone's term, `mu fn z_0 = -z_t . s_t` at the optimum, is
/// split into its sliding and its turning part.
fn soft_terms(place: &PadLayout, raw: &RawSolution<'_>) -> [f64; 3] {
    let share = |row: usize| -raw.z[place.friction_rows + row] * raw.s[place.friction_rows + row];
    let tilt: f64 = raw.z[place.pressure_rows..place.pressure_rows + 4].iter().sum();
    [share(1) + share(2), share(3), raw.x[place.variables + 2] * tilt]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::frames::Pose;

    /// The terms of a pad with this normal force, N, of a grip force of 30 N, for multipliers and slacks made up.
    fn terms(normal_n: f64) -> Vec<(f64, PadLimit)> {
        let pad = PadModel {
            name: "upper".into(),
            x_op: Pose::identity(),
            half_sides_m: [0.02, 0.018],
            friction: 0.5,
            stiffness_n_m: None,
        };
        let place = PadLayout { variables: 0, pressure_rows: 0, friction_rows: 4 };
        let x = [0.0, 0.0, normal_n / FORCE_UNIT_N, 0.0, 0.0, 0.0];
        // Four of the pressure, then four of the friction cone: the normal force, two of sliding, one of torsion.
        let z = [0.1, 0.2, 0.3, 0.4, 2.0, -0.3, 0.4, 0.5];
        let s = [0.0, 0.0, 0.0, 0.0, 9.0, 1.0, -2.0, -3.0];
        let raw = RawSolution { status: SolverStatus::Solved, x: &x, z: &z, s: &s };
        pad_terms(30.0, &pad, &place, &raw).into_iter().filter(|(term, _)| *term != 0.0).collect()
    }

    /// `d lambda* / d ln(limit)`: `-z . s` of the parts of the cone, `fn` times the multipliers of the pressure; of a pad below 5 %
    /// of its grip force `F (mu z_0 + sum z)`.
    #[test]
    fn terms_are_derivatives_by_the_limits_of_a_pad() {
        let close = |found: &[(f64, PadLimit)], expected: &[(f64, PadLimit)]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            let same = |(a, b): (&(f64, PadLimit), &(f64, PadLimit))| a.1 == b.1 && (a.0 - b.0).abs() < 1e-12;
            assert!(found.iter().zip(expected).all(same), "{found:?}");
        };
        let held = [(0.3 + 0.8, PadLimit::Friction), (1.5, PadLimit::Torsion), (0.16 * 1.0, PadLimit::Tilt)];
        close(&terms(1.6), &held);
        close(&terms(1.4), &[(3.0 * (0.5 * 2.0 + 1.0), PadLimit::Grip)]);
    }
}
