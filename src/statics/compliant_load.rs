//! The compliant load factor: how far the load can be raised before the compliant equilibrium crosses a limit.

use super::{
    contact_model::{ContactModel, ContactModelError},
    equilibrium::{CompliantResponse, Equilibrium, EquilibriumOutcome},
    limit_crossing::LimitCrossing,
    load_factor::LoadFactorOutcome,
    solvers::{
        cone_program::{CAP_MARGIN, MAX_LOAD_FACTOR},
        energy::HandEnergy,
    },
    welded::WeldedStiffness,
    workspace::StabilityWorkspace,
};
use crate::model::scenario::Limits;

/// Accuracy of the load factor; relative above 1.
const TOLERANCE: f64 = 1e-3;

/// Limit of solves: bisection alone takes 17 from 100 to 1e-3.
const MAX_SOLVES: usize = 60;

/// The compliant load factor and the limit that ends it.
#[derive(Clone, Debug, PartialEq)]
pub struct CompliantLoadFactor {
    /// The load factor, 0 to 100; every limit is kept there.
    pub load_factor: f64,
    /// The limit that is crossed within a thousandth above it; `None` at the cap of 100.
    pub first_limit: Option<LimitCrossing>,
    /// The number of equilibria solved.
    pub equilibria: usize,
}

/// An end of the bracket: a load factor and the largest ratio there, infinite without an equilibrium.
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

    /// The ratio minus 1, on a bounded scale from -1 to 1, so that neither end dominates.
    fn residual(&self) -> f64 {
        if self.ratio.is_finite() { (self.ratio - 1.0) / (self.ratio + 1.0) } else { 1.0 }
    }
}

/// The state of the search.
struct Search<'a> {
    workspace: &'a mut StabilityWorkspace,
    model: &'a ContactModel,
    limits: &'a Limits,
    energies: Vec<HandEnergy>,
    solves: usize,
}

impl StabilityWorkspace {
    /// The compliant load factor (docs/method.md#69-compliant-load-factor): the smallest load factor at which no
    /// compliant equilibrium exists or a limit of torque ratio, deflection or slip is crossed, at most 100; accurate to
    /// a thousandth, from below.
    ///
    /// A bracket is closed: every limit is kept at its lower end; its upper end is at first the load factor without
    /// torque limits, beyond which there is no equilibrium. The welded stiffness predicts the first crossing. While no
    /// pad slips the prediction is exact, and two solves end the search; otherwise the Illinois method closes the
    /// bracket. The work of the load increases with the load factor, as the complementary energy is convex; that each
    /// ratio to a limit increases too is assumed.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn compliant_load_factor(
        &mut self,
        model: &ContactModel,
        limits: &Limits,
    ) -> Result<CompliantLoadFactor, ContactModelError> {
        model.check()?;
        let energies = HandEnergy::of_hands(model);
        let mut search = Search { workspace: self, model, limits, energies, solves: 0 };
        let (load_factor, first_limit) = match search.run() {
            Ok((load_factor, first_limit)) => (load_factor, first_limit),
            Err(crossing) => (0.0, Some(crossing)),
        };
        Ok(CompliantLoadFactor { load_factor, first_limit, equilibria: search.solves })
    }
}

impl Search<'_> {
    /// The load factor and what ends it; `Err` if a limit is crossed under the weight alone.
    fn run(&mut self) -> Result<(f64, Option<LimitCrossing>), LimitCrossing> {
        let unloaded = self.unloaded()?;
        let (last, binding) = self.last_equilibrium()?;
        let at_rest = CompliantResponse::between(self.model, &unloaded, unloaded.clone());
        let (ratio, crossing) = at_rest.worst_limit(self.model, self.limits);
        let mut low = Probe { load_factor: 0.0, ratio, crossing };
        if !low.is_kept() {
            return Err(low.crossing);
        }
        // Slightly inside: at the end the feasible set has no interior and the solver is unreliable.
        let is_capped = last >= MAX_LOAD_FACTOR - CAP_MARGIN;
        let end = if is_capped { MAX_LOAD_FACTOR } else { last - TOLERANCE / 2.0 * last.max(1.0) };
        let mut high = None;
        let guess = welded_crossing(self.model, self.limits, &unloaded);
        for load_factor in [guess - self.tolerance(guess) / 3.0, guess + self.tolerance(guess) / 3.0, end] {
            // A NaN guess is skipped.
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
            None if is_capped => Ok((MAX_LOAD_FACTOR, None)),
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

    /// The load factor up to which equilibria exist, and the pads' limits that bind there.
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
                let (ratio, crossing) = response.worst_limit(self.model, self.limits);
                Probe { load_factor, ratio, crossing }
            }
            EquilibriumOutcome::NoEquilibrium => failed(LimitCrossing::NoEquilibrium { binding: Vec::new() }),
            EquilibriumOutcome::Unknown { status } => failed(LimitCrossing::Unknown { status }),
        }
    }

    /// Closes the bracket to the tolerance: regula falsi with the weight of an end that stays twice halved (Illinois),
    /// and steps at least a third of the tolerance away from both ends.
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

/// The load factor at which the welded board crosses its first limit of torque or deflection; NaN if an arm is rigid.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_residual_is_bounded_and_zero_at_the_limit() {
        let residual = |ratio: f64| Probe { load_factor: 1.0, ratio, crossing: LimitCrossing::Deflection }.residual();
        let expected = [(0.0, -1.0), (1.0, 0.0), (3.0, 0.5), (f64::INFINITY, 1.0)];
        expected.into_iter().for_each(|(ratio, value)| assert_eq!(residual(ratio), value, "{ratio}"));
    }
}
