//! The scenario file: TOML, in which most keys are optional.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    error::{InputError, InputErrorKind},
    load_section::LoadSection,
    locate,
};
use crate::model::{
    load::Uncertainty,
    operation::OperationKind,
    scenario::{ComfortSettings, Expectation, Grip, Hand, PlannerSettings, Sex, SimulationSettings, Tool},
};

/// A scenario file.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    /// The file format, 1.
    pub format: u32,
    /// The name in tables and file names: letters, digits, `-`, `_` and `.`.
    pub name: String,
    /// The robot; `baxter` by default.
    #[serde(default)]
    pub robot: RobotSection,
    /// The person.
    #[serde(default)]
    pub human: HumanSection,
    /// The tool; by default a drill or a knife, by the kind of the operation.
    #[serde(default)]
    pub tool: Option<Tool>,
    /// The board; by default that of the reproduction of the paper.
    #[serde(default)]
    pub object: ObjectSection,
    /// The forceful operation.
    pub operation: OperationSection,
    /// How comfort is defined.
    #[serde(default)]
    pub comfort: ComfortSettings,
    /// The planner.
    #[serde(default)]
    pub planner: PlannerSettings,
    /// Grip force and friction.
    #[serde(default)]
    pub grip: Grip,
    /// Phases and time step of the simulation.
    #[serde(default)]
    pub simulation: SimulationSettings,
    /// The tool's load over time.
    #[serde(default)]
    pub load: LoadSection,
    /// Deviations of the simulation from the values that the plan assumes.
    #[serde(default)]
    pub uncertainty: Uncertainty,
    /// The limits that the hold must not exceed.
    #[serde(default)]
    pub limits: LimitsSection,
    /// The expected verdict; `holds` by default.
    #[serde(default)]
    pub expect: Expectation,
}

/// `[robot]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSection {
    /// The name of a built-in robot, or the path of a description file relative to the scenario file's folder.
    pub description: String,
}

impl Default for RobotSection {
    fn default() -> Self {
        Self { description: crate::robot::BUILTIN[0].into() }
    }
}

/// `[human]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HumanSection {
    /// Standing height, m; by default 1.75 for a man, 1.62 for a woman.
    pub height_m: Option<f64>,
    /// Body mass, kg; by default 75 for a man, 62 for a woman.
    pub mass_kg: Option<f64>,
    /// Selects the strength curves and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile, 0.1 to 99.9.
    pub percentile: f64,
    /// Forward lean of the trunk about the hips, degrees, 0 to 15; 0, upright, by default.
    pub lean_deg: f64,
}

impl Default for HumanSection {
    fn default() -> Self {
        Self { height_m: None, mass_kg: None, sex: Sex::Male, hand: Hand::Right, percentile: 50.0, lean_deg: 0.0 }
    }
}

/// `[object]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ObjectSection {
    /// Width, height and thickness, m.
    pub size_m: [f64; 3],
    /// Density, kg/m^3; by default the material's.
    pub density_kg_m3: Option<f64>,
    /// A material of `assets/materials.toml`.
    pub material: String,
}

impl Default for ObjectSection {
    /// The board of the reproduction (`docs/method.md#24-board`).
    fn default() -> Self {
        Self { size_m: [0.50, 0.40, 0.030], density_kg_m3: None, material: "foam".into() }
    }
}

/// `[operation]`: `kind` determines which other keys are required.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationSection {
    /// `drill`, `cut` or `wrench`.
    pub kind: OperationKind,
    /// For `drill` and `cut`: the point on the worked face, m along x_O and y_O from its centre.
    pub point_m: Option<[f64; 2]>,
    /// For `drill` and `cut`: the force, N.
    pub force_n: Option<f64>,
    /// For `cut`: the cutting direction in O, parallel to the face, of any length.
    pub direction_o: Option<[f64; 3]>,
    /// For `wrench`: the wrench on the board about the tool tip, O axes, N and N m.
    pub wrench_o: Option<[f64; 6]>,
    /// For `wrench`: the tool's pose in O.
    pub x_ot: Option<crate::model::frames::PoseRecord>,
}

/// `[limits]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSection {
    /// Translation of a hand relative to the board, mm.
    pub slip_mm: f64,
    /// Rotation of a hand relative to the board, degrees.
    pub slip_deg: f64,
    /// Displacement of the board's tool point, mm; by default 15 for `cut` and 5 otherwise.
    pub deflection_mm: Option<f64>,
    /// Rate of slip in the second half of the hold phase, mm/s.
    pub creep_mm_s: f64,
    /// Demanded joint torque divided by its limit.
    pub torque_ratio: f64,
    /// Smallest predicted load factor of a plan; the planner requires 1.1 times this value of the compliant load factor.
    pub load_factor: f64,
}

impl Default for LimitsSection {
    /// The default limits (`docs/method.md#810-default-limits`).
    fn default() -> Self {
        Self { slip_mm: 1.0, slip_deg: 2.0, deflection_mm: None, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 }
    }
}

/// Parses the text of a scenario file.
///
/// # Errors
/// If it is not TOML, a key is unknown or missing, or a value has the wrong type.
pub fn parse(path: &Path, text: &str) -> Result<ScenarioFile, InputError> {
    toml::from_str(text).map_err(|error| {
        let span = error.span();
        InputError {
            file: path.to_owned(),
            line: span.as_ref().map(|span| locate::line_at(text, span.start)),
            key: span.as_ref().and_then(|span| locate::toml_key_at(text, span)),
            kind: InputErrorKind::Syntax(error.message().replace('\n', "; ")),
        }
    })
}
