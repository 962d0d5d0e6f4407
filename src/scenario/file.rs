//! The scenario file as an author writes it: TOML, most of it optional.

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
    /// A name for tables and file names: letters, digits, `-`, `_` and `.`.
    pub name: String,
    /// The robot; `baxter` unless given.
    #[serde(default)]
    pub robot: RobotSection,
    /// The person.
    #[serde(default)]
    pub human: HumanSection,
    /// The tool; by the kind of the operation unless given.
    #[serde(default)]
    pub tool: Option<Tool>,
    /// The board; that of the paper's reproduction unless given.
    #[serde(default)]
    pub object: ObjectSection,
    /// The forceful operation.
    pub operation: OperationSection,
    /// How comfort is measured.
    #[serde(default)]
    pub comfort: ComfortSettings,
    /// How the hold is planned.
    #[serde(default)]
    pub planner: PlannerSettings,
    /// The grippers.
    #[serde(default)]
    pub grip: Grip,
    /// The simulation.
    #[serde(default)]
    pub simulation: SimulationSettings,
    /// How the tool loads the board over time.
    #[serde(default)]
    pub load: LoadSection,
    /// How far the simulation departs from what the plan counts on.
    #[serde(default)]
    pub uncertainty: Uncertainty,
    /// What the hold must keep to.
    #[serde(default)]
    pub limits: LimitsSection,
    /// What is expected; `holds` unless given.
    #[serde(default)]
    pub expect: Expectation,
}

/// `[robot]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSection {
    /// The name of a built-in robot, or the path of a description file, relative to the scenario's.
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
    /// Standing height, m; 1.75 for a man, 1.62 for a woman unless given.
    pub height_m: Option<f64>,
    /// Body mass, kg; 75 for a man, 62 for a woman unless given.
    pub mass_kg: Option<f64>,
    /// Selects strengths and segment masses.
    pub sex: Sex,
    /// The hand that works.
    pub hand: Hand,
    /// Strength percentile, 0.1 to 99.9.
    pub percentile: f64,
    /// How far the trunk leans forward about the hips, degrees, 0 to 15; upright unless given.
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
    /// Density, kg/m^3; the material's unless given.
    pub density_kg_m3: Option<f64>,
    /// A material of `assets/materials.toml`.
    pub material: String,
}

impl Default for ObjectSection {
    /// The board of the reproduction (METHOD section 2).
    fn default() -> Self {
        Self { size_m: [0.50, 0.40, 0.030], density_kg_m3: None, material: "foam".into() }
    }
}

/// `[operation]`: which keys must stand beside `kind` depends on it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationSection {
    /// `drill`, `cut` or `wrench`.
    pub kind: OperationKind,
    /// For `drill` and `cut`: the point on the worked face, m from its centre along x_O and y_O.
    pub point_m: Option<[f64; 2]>,
    /// For `drill` and `cut`: the force, N.
    pub force_n: Option<f64>,
    /// For `cut`: the cutting direction in O, in the plane of the face; its length does not matter.
    pub direction_o: Option<[f64; 3]>,
    /// For `wrench`: the wrench on the board about the tool tip, in O axes, N and N m.
    pub wrench_o: Option<[f64; 6]>,
    /// For `wrench`: the tool tip's frame in O.
    pub x_ot: Option<crate::model::frames::PoseRecord>,
}

/// `[limits]`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSection {
    /// Translation of a hand on the board, mm.
    pub slip_mm: f64,
    /// Rotation of a hand on the board, degrees.
    pub slip_deg: f64,
    /// Displacement of the tool point of the board, mm; 15 for cutting and 5 otherwise unless given.
    pub deflection_mm: Option<f64>,
    /// Rate of slip in the second half of the hold, mm/s.
    pub creep_mm_s: f64,
    /// Demanded joint torque over its limit.
    pub torque_ratio: f64,
    /// The load factor that a plan must be predicted to stand.
    pub load_factor: f64,
}

impl Default for LimitsSection {
    /// METHOD section 8.
    fn default() -> Self {
        Self { slip_mm: 1.0, slip_deg: 2.0, deflection_mm: None, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 }
    }
}

/// Reads the text of a scenario file.
///
/// # Errors
/// When it is not TOML, a key is unknown or missing, or a value has the wrong type.
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
