//! The conditions of a simulation: everything that is not part of the plan.

use super::error::SimError;
use crate::model::{
    load::{Load, Uncertainty},
    scenario::{Scenario, SimulationSettings},
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
    /// Deviations of the simulation from what the plan assumes.
    pub uncertainty: Uncertainty,
}

impl Conditions {
    /// A ramp of the operation's wrench, without deviations from the plan.
    pub fn new(friction: f64, settings: SimulationSettings) -> Self {
        Self { friction, settings, load: Load::default(), load_scale: 1.0, uncertainty: Uncertainty::default() }
    }

    /// The conditions of a scenario.
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            friction: scenario.grip.friction,
            settings: scenario.simulation,
            load: scenario.load.clone(),
            load_scale: 1.0,
            uncertainty: scenario.uncertainty,
        }
    }

    /// The same with the load scaled by a factor.
    #[must_use]
    pub fn scaled(&self, load_scale: f64) -> Self {
        Self { load_scale, ..self.clone() }
    }

    /// Friction coefficient in the simulation.
    pub(super) fn real_friction(&self) -> f64 {
        self.friction * self.uncertainty.friction_scale
    }

    /// # Errors
    /// [`SimError::Settings`] if the friction is negative, or a factor of the load or of an uncertainty is invalid.
    pub(super) fn check(&self) -> Result<(), SimError> {
        let Uncertainty { friction_scale, grip_force_scale, contact_stiffness_scale, joint_stiffness_scale } =
            self.uncertainty;
        let not_negative =
            [("friction", self.friction), ("load_scale", self.load_scale), ("friction_scale", friction_scale)];
        let positive = [
            ("grip_force_scale", grip_force_scale),
            ("contact_stiffness_scale", contact_stiffness_scale),
            ("joint_stiffness_scale", joint_stiffness_scale),
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
