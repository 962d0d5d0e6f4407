//! A sweep: many simulations of one plan whose parameters are drawn at random (`docs/method.md#10-sweeps`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sweep with all defaults filled in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// The number of runs.
    pub runs: u64,
    /// How the runs' parameters are drawn.
    pub sampling: Sampling,
    /// Seed of the draws.
    pub seed: u64,
    /// The uncertain quantities.
    pub variables: Vec<Variable>,
}

impl Sweep {
    /// The number of runs of a sweep that does not state it.
    pub const RUNS: u64 = 1000;
    /// The seed of a sweep that does not state it.
    pub const SEED: u64 = 1;
    /// The most runs.
    pub const MOST_RUNS: u64 = 1 << 31;
}

/// How points of the unit cube are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// The points of a scrambled Sobol sequence: more even than independent ones.
    Sobol,
    /// Independent points.
    #[default]
    Independent,
}

/// An uncertain quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Variable {
    /// The quantity.
    pub quantity: Quantity,
    /// The distribution of its values.
    pub distribution: Distribution,
    /// Values below this are not drawn: the distribution is that of the values within both bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Values above this are not drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The planned value, of a distribution of absolute values: they are divided by it, a thickness is less by it. Absent if
    /// the values are factors or offsets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal: Option<f64>,
    /// Correlation of the arms' values, from 0 to 1, of a quantity that each arm has (Gaussian copula).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// Where its figures are from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

impl Variable {
    /// The key of the variable in a scenario file.
    #[must_use]
    pub fn name(&self) -> &'static str {
        let is = |&&(_, quantity, absolute, _): &&(_, Quantity, bool, _)| {
            quantity == self.quantity && absolute == self.nominal.is_some()
        };
        // A quantity without absolute values has none with a nominal one.
        NAMES
            .iter()
            .find(is)
            .or_else(|| NAMES.iter().find(|entry| entry.1 == self.quantity))
            .map_or("", |entry| entry.0)
    }

    /// The unit of its values.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        NAMES.iter().find(|entry| entry.0 == self.name()).map_or("", |entry| entry.3)
    }

    /// What a value is for the simulation: a factor, or an offset in the unit of the quantity.
    #[must_use]
    pub fn deviation(&self, value: f64) -> f64 {
        match self.nominal {
            Some(nominal) if self.quantity == Quantity::BoardThickness => value - nominal,
            Some(nominal) => value / nominal,
            None => value,
        }
    }
}

/// The keys of variables in a scenario file: key, quantity, whether the values are absolute, unit.
pub const NAMES: [(&str, Quantity, bool, &str); 17] = [
    ("friction", Quantity::Friction, true, "a Coulomb coefficient"),
    ("friction_factor", Quantity::Friction, false, "a factor"),
    ("grip_force_n", Quantity::GripForce, true, "N"),
    ("grip_force_factor", Quantity::GripForce, false, "a factor"),
    ("contact_stiffness_factor", Quantity::ContactStiffness, false, "a factor"),
    ("joint_stiffness_factor", Quantity::JointStiffness, false, "a factor"),
    ("board_mass_kg", Quantity::BoardMass, true, "kg"),
    ("board_mass_factor", Quantity::BoardMass, false, "a factor"),
    ("board_thickness_mm", Quantity::BoardThickness, true, "mm"),
    ("board_thickness_offset_mm", Quantity::BoardThickness, false, "mm"),
    ("force_n", Quantity::Force, true, "N"),
    ("force_factor", Quantity::Force, false, "a factor"),
    ("tool_tilt_deg", Quantity::ToolTilt, false, "degrees"),
    ("tool_offset_mm", Quantity::ToolOffset, false, "mm"),
    ("person_offset_mm", Quantity::PersonOffset, false, "mm"),
    ("joint_offset_deg", Quantity::JointOffset, false, "degrees"),
    ("ramp_factor", Quantity::RampTime, false, "a factor"),
];

impl Quantity {
    /// The correlation of the arms' values where a scenario has none; `None` for a quantity that arms do not have one by one.
    #[must_use]
    pub fn usual_correlation(self) -> Option<f64> {
        match self {
            Self::Friction => Some(1.0),
            Self::GripForce => Some(0.0),
            _ => None,
        }
    }
}

/// What is uncertain: the deviations of [`Uncertainty`](super::uncertainty::Uncertainty).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Friction between pads and board, a factor or a coefficient; one value an arm unless they are fully correlated.
    Friction,
    /// Grip force, a factor or N; one value an arm unless they are fully correlated.
    GripForce,
    /// Factor of the stiffness of contacts and elastic pads.
    ContactStiffness,
    /// Factor of the stiffness of all joints.
    JointStiffness,
    /// Mass of the board, a factor or kg.
    BoardMass,
    /// What the board is thicker than planned, or its thickness, mm.
    BoardThickness,
    /// The tool's wrench, a factor or N.
    Force,
    /// Tilt of the tool's wrench, degrees; one value about each of two axes.
    ToolTilt,
    /// Displacement of the tool point, mm; one value along each of two axes.
    ToolOffset,
    /// Displacement of the person, mm; one value along each of two axes.
    PersonOffset,
    /// Offsets of the joints' angles, degrees; one value a joint.
    JointOffset,
    /// Factor of the duration of the ramp.
    RampTime,
}

/// A distribution of a value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Distribution {
    /// The normal distribution.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, above 0.
        sd: f64,
    },
    /// The uniform distribution.
    Uniform {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// The distribution of a value whose logarithm is normal.
    LogNormal {
        /// Median, above 0.
        median: f64,
        /// Standard deviation of the natural logarithm, above 0.
        sd_log: f64,
    },
    /// The triangular distribution.
    Triangular {
        /// The smallest value.
        low: f64,
        /// The most likely value.
        mode: f64,
        /// The largest value.
        high: f64,
    },
    /// Some values.
    Discrete {
        /// The values.
        values: Vec<f64>,
        /// Their weights, at least 0; equal by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        weights: Option<Vec<f64>>,
    },
    /// Measured values, interpolated linearly between their quantiles.
    Measured {
        /// The values in increasing order; read from a CSV file.
        values: Vec<f64>,
    },
}
