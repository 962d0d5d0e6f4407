//! The deviations of each run of a sweep (`docs/method.md#102-draws`).

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    distribution::{Quantiles, VariableFlaw, standard_normal, standard_probability},
    points::Points,
};
use crate::model::{
    plan::Plan,
    sweep::{Quantity, Sampling, Sweep, Variable},
    uncertainty::Uncertainty,
};

/// An arm of a plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArmJoints {
    /// Its name.
    pub name: String,
    /// The number of its joints.
    pub joints: usize,
}

impl ArmJoints {
    /// The arms of a plan, in its order.
    #[must_use]
    pub fn of(plan: &Plan) -> Vec<Self> {
        plan.arms.iter().map(|arm| Self { name: arm.name.clone(), joints: arm.q_rad.len() }).collect()
    }
}

/// One drawn number of each run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dimension {
    /// The key of the variable, with what the number belongs to: an arm, an axis, a joint from 1; such as
    /// `joint_offset_deg.left.3`.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The unit of the values.
    pub unit: String,
}

/// What is drawn for one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// The values, one a dimension, as the scenario's distributions have them.
    pub values: Vec<f64>,
    /// The same as deviations of a simulation from its plan, beside those of the scenario:
    /// [`Uncertainty::and`] joins the two.
    pub uncertainty: Uncertainty,
}

/// Why a sweep cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// A variable is not valid.
    #[error("{name}.{flaw}")]
    Variable {
        /// The key of the variable.
        name: &'static str,
        /// What is wrong.
        flaw: VariableFlaw,
    },
    /// There are too many numbers to draw for Sobol points.
    #[error(
        "found {found} numbers to draw for each run, expected at most {} with sampling = \"sobol\"",
        Points::MOST_DIMENSIONS
    )]
    Dimensions {
        /// Their number.
        found: usize,
    },
}

/// A variable, and its numbers in a point.
#[derive(Clone, Debug)]
struct Drawer {
    variable: Variable,
    quantiles: Quantiles,
    /// Each row makes a correlated normal number of independent ones; `None` for independent numbers.
    correlation: Option<DMatrix<f64>>,
    count: usize,
}

/// The draws of a sweep for a plan. Run `index` is the same in every sweep with this seed, however many runs it has.
#[derive(Clone, Debug)]
pub struct Draws {
    points: Points,
    drawers: Vec<Drawer>,
    dimensions: Vec<Dimension>,
    /// The number of joints of each arm.
    joints: Vec<usize>,
}

impl Draws {
    /// The draws of a sweep for a plan with these arms.
    ///
    /// # Errors
    /// If a variable is not valid, or there are more dimensions than Sobol points have.
    pub fn new(sweep: &Sweep, arms: &[ArmJoints]) -> Result<Self, DrawError> {
        let mut dimensions = Vec::new();
        let mut drawers = Vec::new();
        for variable in &sweep.variables {
            let refused = |flaw| DrawError::Variable { name: variable.name(), flaw };
            let quantiles = Quantiles::of(variable).map_err(refused)?;
            let parts = parts(variable, arms);
            let of_arms = correlation(variable);
            let correlation = (parts.len() > 1 && of_arms > 0.0).then(|| equal_correlation(of_arms, parts.len()));
            drawers.push(Drawer { variable: variable.clone(), quantiles, correlation, count: parts.len() });
            dimensions.extend(parts.into_iter().map(|part| Dimension {
                name: format!("{}{part}", variable.name()),
                quantity: variable.quantity,
                unit: variable.unit().into(),
            }));
        }
        if sweep.sampling == Sampling::Sobol && dimensions.len() > Points::MOST_DIMENSIONS {
            return Err(DrawError::Dimensions { found: dimensions.len() });
        }
        let points = Points::new(sweep.sampling, sweep.seed, dimensions.len());
        Ok(Self { points, drawers, dimensions, joints: arms.iter().map(|arm| arm.joints).collect() })
    }

    /// The numbers that are drawn for each run, in the order of [`Drawn::values`].
    #[must_use]
    pub fn dimensions(&self) -> &[Dimension] {
        &self.dimensions
    }

    /// The draw of a run.
    #[must_use]
    pub fn draw(&self, index: u64) -> Drawn {
        let point = self.points.point(index);
        let mut rest = point.as_slice();
        let mut values = Vec::with_capacity(point.len());
        let mut uncertainty = Uncertainty::default();
        for drawer in &self.drawers {
            let (own, further) = rest.split_at(drawer.count);
            rest = further;
            let drawn = drawer.values(own);
            let deviations: Vec<f64> = drawn.iter().map(|&value| drawer.variable.deviation(value)).collect();
            self.put(&drawer.variable, &deviations, &mut uncertainty);
            values.extend(drawn);
        }
        Drawn { values, uncertainty }
    }

    /// Puts the deviations of a quantity where the simulation reads them.
    fn put(&self, variable: &Variable, deviations: &[f64], to: &mut Uncertainty) {
        let common = deviations.first().copied().unwrap_or(1.0);
        let pair = || [0, 1].map(|axis| deviations.get(axis).copied().unwrap_or(0.0));
        match variable.quantity {
            Quantity::Friction if is_common(variable) => to.friction_scale = common,
            Quantity::Friction => to.friction_scales = deviations.to_vec(),
            Quantity::GripForce if is_common(variable) => to.grip_force_scale = common,
            Quantity::GripForce => to.grip_force_scales = deviations.to_vec(),
            Quantity::ContactStiffness => to.contact_stiffness_scale = common,
            Quantity::JointStiffness => to.joint_stiffness_scale = common,
            Quantity::BoardMass => to.board_mass_scale = common,
            Quantity::BoardThickness => to.board_thickness_mm = common,
            Quantity::Force => to.force_scale = common,
            Quantity::ToolTilt => to.tool_tilt_deg = pair(),
            Quantity::ToolOffset => to.tool_offset_mm = pair(),
            Quantity::PersonOffset => to.person_offset_mm = pair(),
            Quantity::JointOffset => {
                let mut rest = deviations;
                to.joint_offset_deg = Vec::with_capacity(self.joints.len());
                for &joints in &self.joints {
                    let (own, further) = rest.split_at(joints);
                    to.joint_offset_deg.push(own.to_vec());
                    rest = further;
                }
            }
            Quantity::RampTime => to.ramp_scale = common,
        }
    }
}

impl Drawer {
    /// The values of a variable from its coordinates of a point.
    fn values(&self, coordinates: &[f64]) -> Vec<f64> {
        let Some(correlation) = &self.correlation else {
            return coordinates.iter().map(|&coordinate| self.quantiles.at(coordinate)).collect();
        };
        let normal: Vec<f64> = coordinates.iter().map(|&coordinate| standard_normal(coordinate)).collect();
        let correlated = correlation.row_iter().map(|row| row.iter().zip(&normal).map(|(a, z)| a * z).sum::<f64>());
        correlated.map(|z| self.quantiles.at(standard_probability(z))).collect()
    }
}

/// The correlation of the arms' values; 0 for a quantity that arms do not have.
fn correlation(variable: &Variable) -> f64 {
    variable.correlation.or(variable.quantity.usual_correlation()).unwrap_or(0.0)
}

/// True if one value is drawn for all arms.
fn is_common(variable: &Variable) -> bool {
    variable.quantity.usual_correlation().is_some() && correlation(variable) == 1.0
}

/// What each number of a variable belongs to, as the end of its name.
fn parts(variable: &Variable, arms: &[ArmJoints]) -> Vec<String> {
    match variable.quantity {
        Quantity::Friction | Quantity::GripForce if !is_common(variable) => {
            arms.iter().map(|arm| format!(".{}", arm.name)).collect()
        }
        Quantity::ToolTilt | Quantity::ToolOffset | Quantity::PersonOffset => vec![".x".into(), ".y".into()],
        Quantity::JointOffset => {
            arms.iter().flat_map(|arm| (1..=arm.joints).map(move |joint| format!(".{}.{joint}", arm.name))).collect()
        }
        _ => vec![String::new()],
    }
}

/// The lower triangle `L` with `L L^T` the matrix of ones in the diagonal and `correlation`, below 1, elsewhere.
fn equal_correlation(correlation: f64, count: usize) -> DMatrix<f64> {
    let matrix = DMatrix::from_fn(count, count, |row, column| if row == column { 1.0 } else { correlation });
    // It is positive definite: its eigenvalues are 1 - correlation and 1 + (count - 1) correlation.
    matrix.clone().cholesky().map_or(matrix, |factor| factor.l())
}
