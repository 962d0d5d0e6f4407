//! The stability figures of a plan.

use super::{
    contact_model::{ContactModel, ContactModelError},
    equilibrium::{CompliantResponse, ResponseOutcome},
    lateral::LoadCases,
    load_factor::LoadFactorOutcome,
    workspace::{AtRest, StabilityWorkspace},
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
        self.assess_case(model, limits, kind, &mut None).map(|(utilisation, _)| utilisation)
    }

    /// The case of the largest utilisation, see [`StabilityWorkspace::utilisation`]; the first without an equilibrium, if there is
    /// one.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn assess(
        &mut self,
        cases: &LoadCases,
        limits: &Limits,
        kind: StabilityKind,
    ) -> Result<CaseAssessment, ContactModelError> {
        self.assess_from(cases, limits, kind, &mut None)
    }

    /// As [`StabilityWorkspace::assess`], with what other loads of the same grasp have in common with these; it is filled in if it
    /// is `None`. The result is the same but for the solver's last digits.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn assess_from(
        &mut self,
        cases: &LoadCases,
        limits: &Limits,
        kind: StabilityKind,
        at_rest: &mut Option<AtRest>,
    ) -> Result<CaseAssessment, ContactModelError> {
        let mut worst = CaseAssessment { utilisation: f64::NEG_INFINITY, response: None, case: 0 };
        let mut case = 0;
        cases.each(|model| {
            // Nothing is worse.
            if worst.utilisation < f64::INFINITY {
                let (utilisation, response) = self.assess_case(model, limits, kind, at_rest)?;
                if utilisation > worst.utilisation {
                    worst = CaseAssessment { utilisation, response, case };
                }
            }
            case += 1;
            Ok(())
        })?;
        Ok(worst)
    }

    /// As [`StabilityWorkspace::utilisation`], with the response at `limits.load_factor` from which it follows; no response
    /// for the criterion `paper` or without an equilibrium.
    ///
    /// # Errors
    /// If the contact model is invalid.
    fn assess_case(
        &mut self,
        model: &ContactModel,
        limits: &Limits,
        kind: StabilityKind,
        at_rest: &mut Option<AtRest>,
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
        let ResponseOutcome::Found(response) = self.response_from(model, least, at_rest)? else { return Ok(UNSTABLE) };
        utilisation = response.utilisation(model, limits).max(utilisation);
        if least < 1.0 {
            let ResponseOutcome::Found(response) = self.response_from(model, 1.0, at_rest)? else {
                return Ok(UNSTABLE);
            };
            utilisation = utilisation.max(response.deflection_mm() / limits.deflection_mm);
        }
        Ok((utilisation, Some(*response)))
    }

    /// The stability figures of a plan, over all cases the worst of each; `None` without a load factor or without a compliant
    /// equilibrium at load 1.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn predict(&mut self, cases: &LoadCases, limits: &Limits) -> Result<Option<Prediction>, ContactModelError> {
        let (_, LoadFactorOutcome::Solved(best_case)) = self.least_load_factor(cases)? else { return Ok(None) };
        let Some(responses) = self.responses(cases, 1.0)? else { return Ok(None) };
        let (case, compliant) = self.least_compliant_load_factor(cases, limits)?;
        let torques = cases.hand_names().zip(&responses[case].equilibrium.joint_torque_nm);
        let stability = Stability {
            load_factor: best_case.load_factor,
            compliant_load_factor: compliant.load_factor,
            binding: best_case.binding,
            joint_torque_nm: torques.map(|(hand, nm)| (hand.to_owned(), nm.as_slice().to_vec())).collect(),
            predicted_deflection_mm: responses.iter().map(CompliantResponse::deflection_mm).fold(0.0, f64::max),
            lateral: cases.push(case),
        };
        Ok(Some(Prediction { stability, case }))
    }
}

/// The case of a grasp's loads that uses most of its limits.
#[derive(Clone, Debug)]
pub struct CaseAssessment {
    /// Its utilisation of the limits.
    pub utilisation: f64,
    /// The response from which it follows; none for the criterion `paper` or without an equilibrium.
    pub response: Option<CompliantResponse>,
    /// Its number.
    pub case: usize,
}

/// The predicted stability of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The figures.
    pub stability: Stability,
    /// The case with the smallest compliant load factor, in which the torques and the push are stated.
    pub case: usize,
}
