//! The conditions of a simulation: everything that is not part of the plan.

use super::error::SimError;
use crate::{
    check::CheckedPlan,
    model::{
        lateral::LateralPush,
        load::Load,
        scenario::{Limits, Scenario, SimulationSettings},
        uncertainty::Uncertainty,
    },
    statics::{LoadCases, StabilityWorkspace},
};

/// The conditions of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Coulomb coefficient between pads and board that the plan assumes.
    pub friction: f64,
    /// Phases and time step.
    pub settings: SimulationSettings,
    /// The tool's wrench over time.
    pub load: Load,
    /// Factor of that wrench.
    pub load_scale: f64,
    /// Direction of the push of `load.lateral_share`.
    pub lateral_direction: LateralDirection,
    /// Deviations of the simulation from what the plan assumes.
    pub uncertainty: Uncertainty,
}

/// The direction of a sideways push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LateralDirection {
    /// That with the least predicted compliant load factor within these limits.
    Worst(Limits),
    /// This one, degrees, see [`LateralPush::direction_deg`].
    Given(f64),
}

impl Conditions {
    /// A ramp of the operation's wrench, without deviations from the plan.
    #[must_use]
    pub fn new(friction: f64, settings: SimulationSettings) -> Self {
        Self {
            friction,
            settings,
            load: Load::default(),
            load_scale: 1.0,
            lateral_direction: LateralDirection::Given(0.0),
            uncertainty: Uncertainty::default(),
        }
    }

    /// The conditions of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            friction: scenario.grip.friction,
            settings: scenario.simulation,
            load: scenario.load.clone(),
            load_scale: 1.0,
            lateral_direction: LateralDirection::Worst(scenario.limits),
            uncertainty: scenario.uncertainty.clone(),
        }
    }

    /// The same with the load scaled by a factor.
    #[must_use]
    pub fn scaled(&self, load_scale: f64) -> Self {
        Self { load_scale, ..self.clone() }
    }

    /// The sideways push on a plan's board at load factor 1; `None` without one. Where the statics find no direction worse than
    /// others, for example because the hands cannot carry the board's weight, it is that of 0 degrees.
    #[must_use]
    pub fn lateral_push(&self, checked: &CheckedPlan<'_>) -> Option<LateralPush> {
        let (operation, share) = (&checked.plan().operation, self.load.lateral_share);
        if let LateralDirection::Given(direction_deg) = self.lateral_direction {
            return LateralPush::new(operation, share, direction_deg);
        }
        // Without a push there is no direction to look for.
        let any = LateralPush::new(operation, share, 0.0)?;
        self.worst_push(checked).or(Some(any))
    }

    /// The push with the least predicted compliant load factor.
    fn worst_push(&self, checked: &CheckedPlan<'_>) -> Option<LateralPush> {
        let LateralDirection::Worst(limits) = &self.lateral_direction else { return None };
        let cases = LoadCases::of_plan(checked, self.friction, &self.load).ok()?;
        let (case, _) = StabilityWorkspace::new().least_compliant_load_factor(&cases, limits).ok()?;
        cases.push(case)
    }

    /// Friction coefficient of an arm's pads in the simulation, by the arm's place in the plan.
    pub(super) fn friction_of(&self, arm: usize) -> f64 {
        self.friction * self.uncertainty.friction_scale_of(arm)
    }

    /// # Errors
    /// [`SimError::Settings`] if the friction is negative, or a factor of the load or of an uncertainty is invalid.
    pub(super) fn check(&self) -> Result<(), SimError> {
        let of = &self.uncertainty;
        let not_negative = [
            ("friction", self.friction),
            ("load_scale", self.load_scale),
            ("friction_scale", of.friction_scale),
            ("force_scale", of.force_scale),
        ];
        let positive = [
            ("grip_force_scale", of.grip_force_scale),
            ("contact_stiffness_scale", of.contact_stiffness_scale),
            ("joint_stiffness_scale", of.joint_stiffness_scale),
            ("board_mass_scale", of.board_mass_scale),
            ("ramp_scale", of.ramp_scale),
        ];
        let odd = |&(_, found): &(&str, f64)| !(found.is_finite() && found >= 0.0);
        if let Some(&(key, found)) = not_negative.iter().find(|entry| odd(entry)) {
            return Err(SimError::Settings { key, found, expected: "a coefficient of at least zero" });
        }
        if let Some(&(key, found)) = positive.iter().find(|entry| odd(entry) || entry.1 == 0.0) {
            return Err(SimError::Settings { key, found, expected: "a positive factor" });
        }
        Ok(())
    }
}
