//! Loads with a sideways push of unknown direction (docs/method.md#614-sideways-push).
//!
//! The hands hold the board while the person pushes, so their forces differ from direction to direction: every direction is a
//! load of its own, and the worst of them counts. The loads that a grasp resists at one load factor are a convex set, so the
//! corners of a polygon about the circle of pushes stand for all pushes.

use super::{
    compliant_load::CompliantLoadFactor,
    contact_model::{ContactModel, ContactModelError},
    equilibrium::{CompliantResponse, ResponseOutcome},
    load_factor::LoadFactorOutcome,
    workspace::StabilityWorkspace,
};
use crate::{
    check::CheckedPlan,
    model::{
        lateral::{LateralPush, circumscribed},
        load::Load,
        operation::Operation,
        scenario::Limits,
        uncertainty::Uncertainty,
        wrench::Wrench,
    },
};

/// A contact model with all the loads that it shall resist, each on its own: that of the operation, or with a sideways push
/// those of its directions. Cases are numbered from 0.
#[derive(Clone, Debug)]
pub struct LoadCases {
    model: ContactModel,
    operation: Operation,
    lateral_share: f64,
    /// The loads about O's origin in O axes, with the push's direction; at least one.
    loads: Vec<(Option<f64>, Wrench)>,
}

impl LoadCases {
    /// The cases of a contact model that was made for this operation.
    #[must_use]
    pub fn new(model: ContactModel, operation: &Operation, load: &Load) -> Self {
        let lateral_share = load.lateral_share;
        let pushed = |push: LateralPush| {
            let wrench_o = operation.wrench_o + push.wrench_o();
            (Some(push.direction_deg), wrench_o.about(&operation.x_ot.translation.vector))
        };
        let mut loads: Vec<_> = circumscribed(operation, lateral_share).into_iter().map(pushed).collect();
        if loads.is_empty() {
            loads.push((None, model.load));
        }
        Self { model, operation: *operation, lateral_share, loads }
    }

    /// The cases of a plan, see [`ContactModel::of_plan`].
    ///
    /// # Errors
    /// If a pad is off the board.
    pub fn of_plan(checked: &CheckedPlan<'_>, friction: f64, load: &Load) -> Result<Self, ContactModelError> {
        Self::under(checked, friction, load, &Uncertainty::default())
    }

    /// The cases of a plan whose world deviates from it, see [`ContactModel::under`].
    ///
    /// # Errors
    /// If a pad is off the board.
    pub fn under(
        checked: &CheckedPlan<'_>,
        friction: f64,
        load: &Load,
        of: &Uncertainty,
    ) -> Result<Self, ContactModelError> {
        let operation = of.operation(&checked.plan().operation);
        let operation = Operation { wrench_o: operation.wrench_o.scaled(of.force_scale), ..operation };
        Ok(Self::new(ContactModel::under(checked, friction, of)?, &operation, load))
    }

    /// The same with every load multiplied by a factor.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.loads.iter_mut().for_each(|(_, load)| *load = load.scaled(factor));
        self
    }

    /// The contact model under the load of a case; under the first load if there are fewer cases.
    #[must_use]
    pub fn into_case(self, case: usize) -> ContactModel {
        let (_, load) = self.loads.get(case).unwrap_or(&self.loads[0]);
        ContactModel { load: *load, ..self.model }
    }

    /// The case with the direction of a push; the first without such a case or without a push.
    #[must_use]
    pub fn case_of(&self, push: Option<&LateralPush>) -> usize {
        let direction_deg = push.map(|push| push.direction_deg);
        self.loads.iter().position(|&(of_case_deg, _)| of_case_deg == direction_deg).unwrap_or(0)
    }

    /// The push of a case with its share of the force: the load of the case has a corner of the polygon, which is a little longer.
    #[must_use]
    pub fn push(&self, case: usize) -> Option<LateralPush> {
        let &(direction_deg, _) = self.loads.get(case)?;
        LateralPush::new(&self.operation, self.lateral_share, direction_deg?)
    }

    /// The names of the hands.
    pub(super) fn hand_names(&self) -> impl Iterator<Item = &str> {
        self.model.hands.iter().map(|hand| hand.name.as_str())
    }

    /// Evaluates a function of the contact model under each load, in order, until there is an error.
    pub(super) fn each<T>(
        &self,
        mut of: impl FnMut(&ContactModel) -> Result<T, ContactModelError>,
    ) -> Result<Vec<T>, ContactModelError> {
        let mut model = self.model.clone();
        let of_load = |(_, load): &(Option<f64>, Wrench)| {
            model.load = *load;
            of(&model)
        };
        self.loads.iter().map(of_load).collect()
    }
}

impl StabilityWorkspace {
    /// The smallest load factor lambda* of all cases, with its case. An outcome that is not a load factor comes before any other.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn least_load_factor(&mut self, cases: &LoadCases) -> Result<(usize, LoadFactorOutcome), ContactModelError> {
        let outcomes = cases.each(|model| self.load_factor(model))?;
        let factor = |outcome: &LoadFactorOutcome| outcome.load_factor().unwrap_or(f64::NEG_INFINITY);
        Ok(least(outcomes, factor))
    }

    /// The smallest compliant load factor of all cases, with its case.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn least_compliant_load_factor(
        &mut self,
        cases: &LoadCases,
        limits: &Limits,
    ) -> Result<(usize, CompliantLoadFactor), ContactModelError> {
        let found = cases.each(|model| self.compliant_load_factor(model, limits))?;
        Ok(least(found, |found| found.load_factor))
    }

    /// The responses to the loads of all cases at a load factor; `None` if one of them has no equilibrium.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub(super) fn responses(
        &mut self,
        cases: &LoadCases,
        load_factor: f64,
    ) -> Result<Option<Vec<CompliantResponse>>, ContactModelError> {
        let mut at_rest = None;
        let found = cases.each(|model| match self.response_from(model, load_factor, &mut at_rest)? {
            ResponseOutcome::Found(response) => Ok(Some(*response)),
            _ => Ok(None),
        })?;
        Ok(found.into_iter().collect())
    }
}

/// The case with the smallest value, the first of equals.
fn least<T>(of_cases: Vec<T>, value: impl Fn(&T) -> f64) -> (usize, T) {
    let numbered = of_cases.into_iter().enumerate();
    let smaller = |least: (usize, T), other: (usize, T)| if value(&other.1) < value(&least.1) { other } else { least };
    numbered.reduce(smaller).expect("there is at least one load")
}
