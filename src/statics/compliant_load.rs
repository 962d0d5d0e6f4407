//! The compliant load factor: how far the load can be raised before the arms, as they really hold, cross a limit.

use super::{
    StabilityWorkspace,
    compliance::WeldedStiffness,
    contact_model::ContactModel,
    equilibrium::{CompliantResponse, Equilibrium, EquilibriumOutcome},
    load_factor::LoadFactorOutcome,
    program::{HandEnergy, MAX_LOAD_FACTOR},
    workspace::hand_energies,
};
use crate::model::scenario::Limits;

/// Load factors are found to this; relative above 1.
const TOLERANCE: f64 = 1e-3;

/// A bracket shrinks to the tolerance in fewer solves than this: bisection alone takes 17 from 100 to 1e-3.
const MAX_SOLVES: usize = 60;

/// The first thing that goes wrong as the load grows.
#[derive(Clone, Debug, PartialEq)]
pub enum LimitCrossing {
    /// No forces within the pads' limits balance the object any more.
    NoEquilibrium {
        /// The pads' limits that bind, strongest first; empty when the weight alone cannot be held.
        binding: Vec<String>,
    },
    /// A joint is asked for more than its torque limit times the allowed ratio.
    Torque {
        /// The joint.
        joint: String,
    },
    /// The tool point of the board gives way.
    Deflection,
    /// A hand slides on the board.
    Slip {
        /// The hand.
        hand: String,
    },
    /// A hand turns on the board.
    SlipRotation {
        /// The hand.
        hand: String,
    },
    /// The solver stopped early, so nothing is known from here on.
    Unknown {
        /// The solver's own word.
        status: String,
    },
}

impl std::fmt::Display for LimitCrossing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoEquilibrium { binding } if binding.is_empty() => f.write_str("weight: no equilibrium"),
            Self::NoEquilibrium { binding } => f.write_str(&binding.join(", ")),
            Self::Torque { joint } => write!(f, "{joint}: torque"),
            Self::Deflection => f.write_str("deflection"),
            Self::Slip { hand } => write!(f, "{hand} hand: slip"),
            Self::SlipRotation { hand } => write!(f, "{hand} hand: slip rotation"),
            Self::Unknown { status } => write!(f, "unknown: {status}"),
        }
    }
}

/// The compliant load factor and what ends it.
#[derive(Clone, Debug, PartialEq)]
pub struct CompliantLoadFactor {
    /// The load factor, 0 to 100: every limit is kept there.
    pub load_factor: f64,
    /// What is crossed within a thousandth above it; none when the cap of 100 was reached.
    pub first_limit: Option<LimitCrossing>,
    /// How many equilibria were solved for.
    pub equilibria: usize,
}

impl CompliantResponse {
    /// The limit that is exceeded most, relative to its size; none when all are kept. Creep needs time and is no part
    /// of this.
    pub fn crossing(&self, model: &ContactModel, limits: &Limits) -> Option<LimitCrossing> {
        let (ratio, crossing) = self.worst(model, limits);
        (ratio > 1.0).then_some(crossing)
    }

    /// The largest ratio of a torque, deflection or slip to its limit.
    pub fn utilisation(&self, model: &ContactModel, limits: &Limits) -> f64 {
        self.worst(model, limits).0
    }

    /// The largest ratio of a value to its limit, and the crossing that it would be.
    fn worst(&self, model: &ContactModel, limits: &Limits) -> (f64, LimitCrossing) {
        let (hand, joint, torque) = self.equilibrium.largest_torque_ratio(model);
        let joint = model.hands[hand].joints.get(joint).cloned().unwrap_or_default();
        let mut worst = (torque / limits.torque_ratio, LimitCrossing::Torque { joint });
        let mut consider = |ratio: f64, crossing: &dyn Fn() -> LimitCrossing| {
            if ratio > worst.0 {
                worst = (ratio, crossing());
            }
        };
        consider(self.deflection_mm() / limits.deflection_mm, &|| LimitCrossing::Deflection);
        for (hand, slip) in model.hands.iter().zip(&self.slip) {
            let name = || hand.name.clone();
            consider(slip.linear.norm() * 1e3 / limits.slip_mm, &|| LimitCrossing::Slip { hand: name() });
            let turned = slip.angular.norm().to_degrees() / limits.slip_deg;
            consider(turned, &|| LimitCrossing::SlipRotation { hand: name() });
        }
        worst
    }
}

/// One end of the bracket: a load factor and the worst ratio there, infinite without an equilibrium.
#[derive(Clone, Debug)]
struct Probe {
    load_factor: f64,
    ratio: f64,
    crossing: LimitCrossing,
}

impl Probe {
    fn is_kept(&self) -> bool {
        self.ratio <= 1.0
    }

    /// The ratio's distance from 1 on a bounded scale, -1 to 1, so that no end outweighs the other.
    fn residual(&self) -> f64 {
        if self.ratio.is_finite() { (self.ratio - 1.0) / (self.ratio + 1.0) } else { 1.0 }
    }
}

/// The search's state.
struct Search<'a> {
    workspace: &'a mut StabilityWorkspace,
    model: &'a ContactModel,
    limits: &'a Limits,
    energies: Vec<HandEnergy>,
    solves: usize,
}

/// See [`StabilityWorkspace::compliant_load_factor`].
///
/// A bracket: everything is kept at its lower end, something is crossed at its upper end, at first the load factor
/// without torque limits, where equilibria end. The welded hold says where it expects the first crossing: while no pad
/// slips that is exact, and two solves there end the search. Otherwise the bracket is closed by the Illinois method. The
/// work done by the load grows with it, since the complementary energy is convex; that each limit's own measure grows as
/// well is taken for granted.
pub(super) fn search(workspace: &mut StabilityWorkspace, model: &ContactModel, limits: &Limits) -> CompliantLoadFactor {
    let energies = hand_energies(model);
    let mut search = Search { workspace, model, limits, energies, solves: 0 };
    match search.run() {
        Ok((load_factor, first_limit)) => CompliantLoadFactor { load_factor, first_limit, equilibria: search.solves },
        Err(crossing) => {
            CompliantLoadFactor { load_factor: 0.0, first_limit: Some(crossing), equilibria: search.solves }
        }
    }
}

impl Search<'_> {
    /// The load factor and what ends it; `Err` when something is crossed already under the weight alone.
    fn run(&mut self) -> Result<(f64, Option<LimitCrossing>), LimitCrossing> {
        let unloaded = self.unloaded()?;
        let (last, binding) = self.last_equilibrium()?;
        let at_rest = CompliantResponse::between(self.model, &unloaded, unloaded.clone());
        let (ratio, crossing) = at_rest.worst(self.model, self.limits);
        let mut low = Probe { load_factor: 0.0, ratio, crossing };
        if !low.is_kept() {
            return Err(low.crossing);
        }
        // A little inside: at the very end the feasible set has no interior and the solver no solution to trust.
        let end = if last < MAX_LOAD_FACTOR { last - TOLERANCE / 2.0 * last.max(1.0) } else { last };
        let mut high = None;
        let guess = welded_crossing(self.model, self.limits, &unloaded);
        for load_factor in [guess - self.tolerance(guess) / 3.0, guess + self.tolerance(guess) / 3.0, end] {
            // Written so that a guess that is not a number is passed over.
            if !(load_factor > low.load_factor && load_factor <= end) {
                continue;
            }
            let probe = self.probe(&unloaded, load_factor);
            if probe.is_kept() {
                low = probe;
            } else {
                high = Some(probe);
                break;
            }
        }
        match high {
            Some(high) => Ok(self.close(&unloaded, low, high)),
            None if last >= MAX_LOAD_FACTOR => Ok((MAX_LOAD_FACTOR, None)),
            None => Ok((low.load_factor, Some(LimitCrossing::NoEquilibrium { binding }))),
        }
    }

    fn tolerance(&self, load_factor: f64) -> f64 {
        TOLERANCE * load_factor.max(1.0)
    }

    fn unloaded(&mut self) -> Result<Equilibrium, LimitCrossing> {
        self.solves += 1;
        match self.workspace.solve_equilibrium(self.model, &self.energies, 0.0) {
            EquilibriumOutcome::Found(unloaded) => Ok(unloaded),
            EquilibriumOutcome::NoEquilibrium => Err(LimitCrossing::NoEquilibrium { binding: Vec::new() }),
            EquilibriumOutcome::Unknown { status } => Err(LimitCrossing::Unknown { status }),
        }
    }

    /// The load factor up to which equilibria exist, and the pads' limits that end them.
    fn last_equilibrium(&mut self) -> Result<(f64, Vec<String>), LimitCrossing> {
        match self.workspace.solve_friction(self.model) {
            LoadFactorOutcome::Solved(solved) => Ok((solved.load_factor, solved.binding)),
            LoadFactorOutcome::GravityInfeasible { .. } => Err(LimitCrossing::NoEquilibrium { binding: Vec::new() }),
            LoadFactorOutcome::Unknown { status } => Err(LimitCrossing::Unknown { status }),
        }
    }

    fn probe(&mut self, unloaded: &Equilibrium, load_factor: f64) -> Probe {
        self.solves += 1;
        let failed = |crossing| Probe { load_factor, ratio: f64::INFINITY, crossing };
        match self.workspace.solve_equilibrium(self.model, &self.energies, load_factor) {
            EquilibriumOutcome::Found(loaded) => {
                let response = CompliantResponse::between(self.model, unloaded, loaded);
                let (ratio, crossing) = response.worst(self.model, self.limits);
                Probe { load_factor, ratio, crossing }
            }
            EquilibriumOutcome::NoEquilibrium => failed(LimitCrossing::NoEquilibrium { binding: Vec::new() }),
            EquilibriumOutcome::Unknown { status } => failed(LimitCrossing::Unknown { status }),
        }
    }

    /// Closes the bracket to the tolerance: regula falsi, the weight of an end that stays twice halved (Illinois), and
    /// never closer to an end than a third of the tolerance.
    fn close(&mut self, unloaded: &Equilibrium, mut low: Probe, mut high: Probe) -> (f64, Option<LimitCrossing>) {
        let (mut low_weight, mut high_weight) = (low.residual(), high.residual());
        let mut last_was_kept = None;
        while high.load_factor - low.load_factor > self.tolerance(high.load_factor) && self.solves < MAX_SOLVES {
            let width = high.load_factor - low.load_factor;
            let share = low_weight / (low_weight - high_weight);
            let margin = self.tolerance(high.load_factor) / 3.0;
            let step = (share * width).clamp(margin, width - margin);
            let probe = self.probe(unloaded, low.load_factor + step);
            let kept = probe.is_kept();
            if kept {
                low_weight = probe.residual();
                low = probe;
            } else {
                high_weight = probe.residual();
                high = probe;
            }
            if last_was_kept == Some(kept) {
                *(if kept { &mut high_weight } else { &mut low_weight }) /= 2.0;
            }
            last_was_kept = Some(kept);
        }
        (low.load_factor, Some(high.crossing))
    }
}

/// Where the welded hold crosses its first limit of torque or deflection; not a number when it cannot be said.
fn welded_crossing(model: &ContactModel, limits: &Limits, unloaded: &Equilibrium) -> f64 {
    let Some(welded) = WeldedStiffness::new(model) else { return f64::NAN };
    let deflection_mm = welded.twist_at_tip(&model.load).linear.norm() * 1e3;
    let mut first = limits.deflection_mm / deflection_mm;
    for ((hand, wrench), torque) in
        model.hands.iter().zip(welded.hand_wrenches(&model.load)).zip(&unloaded.joint_torque_nm)
    {
        let growth = hand.jacobian_o.tr_mul(&wrench.to_vector());
        for joint in 0..hand.dof() {
            let limit = limits.torque_ratio * hand.effort_nm[joint];
            first = first.min((limit - torque[joint] * growth[joint].signum()) / growth[joint].abs());
        }
    }
    first
}
