//! The stability that a plan carries, from the solvers of this module.

use super::{Hold, HoldError, LoadFactorOutcome, ResponseOutcome, StabilityWorkspace};
use crate::model::{
    plan::Stability,
    scenario::{Limits, StabilityKind},
};

impl StabilityWorkspace {
    /// True when a hold keeps `limits` in the sense of `kind` (METHOD section 3): the load factor of the cone program at
    /// least `limits.load_factor`; for compliant stability also an equilibrium within the limits of torque, deflection
    /// and slip at that load, and within those of deflection at load 1. The cheapest test comes first.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn stands(&mut self, hold: &Hold, limits: &Limits, kind: StabilityKind) -> Result<bool, HoldError> {
        let least = limits.load_factor;
        if hold.cannot_hold(least).is_some() {
            return Ok(false);
        }
        if self.load_factor(hold)?.load_factor().is_none_or(|load_factor| load_factor < least) {
            return Ok(false);
        }
        if kind == StabilityKind::Paper {
            return Ok(true);
        }
        let keeps_all = match self.response(hold, least)? {
            ResponseOutcome::Found(response) => response.crossing(hold, limits).is_none(),
            ResponseOutcome::NoEquilibrium { .. } | ResponseOutcome::Unknown { .. } => false,
        };
        if !keeps_all || least >= 1.0 {
            return Ok(keeps_all);
        }
        Ok(match self.response(hold, 1.0)? {
            ResponseOutcome::Found(response) => response.deflection_mm() <= limits.deflection_mm,
            ResponseOutcome::NoEquilibrium { .. } | ResponseOutcome::Unknown { .. } => false,
        })
    }

    /// The figures of a plan; none when the hold has no load factor or no compliant equilibrium at load 1.
    ///
    /// # Errors
    /// When the hold is broken.
    pub fn predict(&mut self, hold: &Hold, limits: &Limits) -> Result<Option<Stability>, HoldError> {
        let LoadFactorOutcome::Solved(best_case) = self.load_factor(hold)? else { return Ok(None) };
        let ResponseOutcome::Found(response) = self.response(hold, 1.0)? else { return Ok(None) };
        let torques = hold.hands.iter().zip(&response.equilibrium.joint_torque_nm);
        Ok(Some(Stability {
            load_factor: best_case.load_factor,
            compliant_load_factor: self.compliant_load_factor(hold, limits)?.load_factor,
            binding: best_case.binding,
            joint_torque_nm: torques.map(|(hand, nm)| (hand.name.clone(), nm.as_slice().to_vec())).collect(),
            predicted_deflection_mm: response.deflection_mm(),
        }))
    }
}
