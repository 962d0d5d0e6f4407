//! A sweep: many simulations of one plan whose parameters are drawn at random (`docs/method.md#10-sweeps`).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::omitted::is_one;

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
}

/// How points of the unit cube are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// The points of a scrambled Sobol sequence: more even than independent ones.
    #[default]
    Sobol,
    /// Independent points.
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
    /// The planned value that the values are divided by; 1 if they are factors or offsets.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub nominal: f64,
    /// Correlation of the arms' values, from 0 to 1, of a quantity that each arm has (Gaussian copula).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// Where its figures are from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

fn one() -> f64 {
    1.0
}

/// What is uncertain: the deviations of [`Uncertainty`](super::load::Uncertainty).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Friction between pads and board, a factor or a coefficient; one value an arm.
    Friction,
    /// Grip force, a factor or N; one value an arm.
    GripForce,
    /// Factor of the stiffness of contacts and elastic pads.
    ContactStiffness,
    /// Factor of the stiffness of all joints.
    JointStiffness,
    /// Mass of the board, a factor or kg.
    BoardMass,
    /// What the board is thicker than planned, mm.
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
