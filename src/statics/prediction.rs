//! The stability figures of a plan.

use super::{
    contact_model::{ContactModel, ContactModelError},
    equilibrium::{CompliantResponse, ResponseOutcome},
    load_factor::LoadFactorOutcome,
    workspace::StabilityWorkspace,
};
use crate::model::{
    plan::Stability,
    scenario::{Limits, StabilityKind},
};

impl StabilityWorkspace {
    /// Utilisation of `limits` under the stability criterion `kind` (docs/method.md#34-constraints): at most 1 if the
    /// grasp is stable, infinite if no equilibrium exists.
    ///
    /// - paper: `limits.load_factor` over the load factor lambda*;
    /// - compliant: the largest ratio of torque, deflection and slip to their limits in the equilibrium at that load
    ///   factor, and of the deflection at load 1. An equilibrium within the torque limits is feasible for the load
    ///   program, so lambda* is at least as large; lambda* is computed only if `limits.torque_ratio` allows more than
    ///   the torque limits.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn utilisation(
        &mut self,
        model: &ContactModel,
        limits: &Limits,
        kind: StabilityKind,
    ) -> Result<f64, ContactModelError> {
        self.assess(model, limits, kind).map(|(utilisation, _)| utilisation)
    }

    /// As [`StabilityWorkspace::utilisation`], with the response at `limits.load_factor` from which it follows; no response
    /// for the criterion `paper` or without an equilibrium.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn assess(
        &mut self,
        model: &ContactModel,
        limits: &Limits,
        kind: StabilityKind,
    ) -> Result<(f64, Option<CompliantResponse>), ContactModelError> {
        const UNSTABLE: (f64, Option<CompliantResponse>) = (f64::INFINITY, None);
        let least = limits.load_factor;
        if model.infeasibility(least).is_some() {
            return Ok(UNSTABLE);
        }
        let mut utilisation = 0.0;
        if kind == StabilityKind::Paper || limits.torque_ratio > 1.0 {
            let Some(load_factor) = self.load_factor(model)?.load_factor() else { return Ok(UNSTABLE) };
            utilisation = if least == 0.0 { 0.0 } else { least / load_factor };
        }
        if kind == StabilityKind::Paper {
            return Ok((utilisation, None));
        }
        let ResponseOutcome::Found(response) = self.response(model, least)? else { return Ok(UNSTABLE) };
        utilisation = response.utilisation(model, limits).max(utilisation);
        if least < 1.0 {
            let ResponseOutcome::Found(response) = self.response(model, 1.0)? else { return Ok(UNSTABLE) };
            utilisation = utilisation.max(response.deflection_mm() / limits.deflection_mm);
        }
        Ok((utilisation, Some(*response)))
    }

    /// The stability figures of a plan; `None` without a load factor or without a compliant equilibrium at load 1.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn predict(&mut self, model: &ContactModel, limits: &Limits) -> Result<Option<Stability>, ContactModelError> {
        let LoadFactorOutcome::Solved(best_case) = self.load_factor(model)? else { return Ok(None) };
        let ResponseOutcome::Found(response) = self.response(model, 1.0)? else { return Ok(None) };
        let torques = model.hands.iter().zip(&response.equilibrium.joint_torque_nm);
        Ok(Some(Stability {
            load_factor: best_case.load_factor,
            compliant_load_factor: self.compliant_load_factor(model, limits)?.load_factor,
            binding: best_case.binding,
            joint_torque_nm: torques.map(|(hand, nm)| (hand.name.clone(), nm.as_slice().to_vec())).collect(),
            predicted_deflection_mm: response.deflection_mm(),
        }))
    }
}
