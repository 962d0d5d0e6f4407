//! The resolved scenario: every input of a plan, a simulation and a verdict, with all defaults filled in.
//!
//! Most keys of a scenario file are optional; `crate::scenario` reads, checks and completes the file. A plan contains the
//! resolved scenario, so that its values can be recomputed from the plan's file alone.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    board::{BoardShape, PlacedObject},
    frames::Pose,
    load::Load,
    omitted::is_default,
    operation::{Operation, OperationKind},
    plate::Plate,
    sweep::Sweep,
    uncertainty::Uncertainty,
    wrench_limits::WrenchLimits,
};

pub use super::expectation::Expectation;
pub use super::person::{Hand, Person, PostureKind, PostureLimits, Sex, ShoulderKind, StandingPlace};

/// A scenario with all defaults filled in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// The file format, 1.
    pub format: u32,
    /// The name in tables and file names.
    pub name: String,
    /// The robot, with the parameters of its description that the result depends on.
    pub robot: RobotParameters,
    /// The person.
    pub human: Person,
    /// The tool in the person's hand.
    pub tool: Tool,
    /// The board.
    pub object: Board,
    /// The forceful operation.
    pub operation: Operation,
    /// How comfort is defined.
    pub comfort: ComfortSettings,
    /// The planner.
    pub planner: PlannerSettings,
    /// Grip force and friction.
    pub grip: Grip,
    /// Phases and time step of the simulation.
    pub simulation: SimulationSettings,
    /// The tool's load over time; by default a ramp of a wrench that rotates with the board.
    #[serde(default, skip_serializing_if = "is_default")]
    pub load: Load,
    /// Deviations of the simulation from the values that the plan assumes; none by default.
    #[serde(default, skip_serializing_if = "is_default")]
    pub uncertainty: Uncertainty,
    /// What a sweep varies; absent if the scenario states none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Sweep>,
    /// The limits that the hold must not exceed.
    pub limits: Limits,
    /// The expected verdict.
    pub expect: Expectation,
}

/// The robot's name and the parameters that stability and simulation depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotParameters {
    /// The name of a built-in robot, or the path of a description file.
    pub description: String,
    /// Folders in which packages are looked for before those of the description.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub packages: Vec<String>,
    /// Positions of joints that are not part of an arm or a gripper, in place of those of the description, rad or m.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub posture: BTreeMap<String, f64>,
    /// One entry per arm, in the description's order.
    pub arms: Vec<ArmParameters>,
}

/// Parameters of one arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmParameters {
    /// The arm's name.
    pub name: String,
    /// The arm's joints, from the base outward.
    pub joints: Vec<String>,
    /// Stiffness of each joint under position control, N m/rad.
    pub stiffness_nm_rad: Vec<f64>,
    /// Damping of each joint under position control, N m s/rad.
    pub damping_nm_s_rad: Vec<f64>,
    /// Torque limit of each joint, N m.
    pub effort_nm: Vec<f64>,
    /// The pads of the arm's gripper, or the faces of its jaws if it was measured.
    pub pads: Vec<PadParameters>,
    /// Measured limits of what the gripper holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrench_limits: Option<WrenchLimits>,
}

/// Parameters of one pad of a gripper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PadParameters {
    /// The pad's name, such as `upper`.
    pub name: String,
    /// Side lengths along x_G and z_G, m.
    pub size_m: [f64; 2],
    /// Position of its centre along x_G and z_G, m.
    pub centre_m: [f64; 2],
}

/// The tool in the hand: its mass and its frame T in the right hand's frame H.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Mass, kg. Its centre is at the palm.
    pub mass_kg: f64,
    /// Position of the tip in H, m.
    pub tip_h_m: [f64; 3],
    /// Rotation `R_HT`, unit quaternion, scalar last.
    pub rotation_xyzw: [f64; 4],
}

/// Elasticity and strength of a board's material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingProperties {
    /// Young's modulus in bending, Pa.
    pub youngs_modulus_pa: f64,
    /// Bending strength (modulus of rupture), Pa.
    pub strength_pa: f64,
}

/// The board: a box, or a plate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Board {
    /// Width, height and thickness along x_O, y_O, z_O, m; of a plate those of its bounding box.
    pub size_m: [f64; 3],
    /// Outline and holes of a plate; without them the board is a box about O.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plate: Option<Plate>,
    /// Density, kg/m^3; the mean one if the mass is given.
    pub density_kg_m3: f64,
    /// Mass, kg; by default that of the density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// Centre of mass in O, m; by default the centroid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub com_m: Option<[f64; 3]>,
    /// The material's name.
    pub material: String,
}

impl Board {
    /// Mass of the board, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg.unwrap_or_else(|| self.shape().volume_m3() * self.density_kg_m3)
    }

    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> BoardShape {
        BoardShape { size_m: self.size_m, plate: self.plate.clone() }
    }

    /// The board at a pose.
    #[must_use]
    pub fn placed(&self, x_wo: Pose) -> PlacedObject {
        let Self { size_m, com_m, .. } = *self;
        PlacedObject { size_m, plate: self.plate.clone(), mass_kg: self.mass_kg(), com_m, x_wo }
    }
}

/// Which of the person's feasible responses to a grasp determines its comfort (`docs/method.md#33-the-persons-response`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ResponseKind {
    /// The best feasible response.
    #[serde(rename = "most")]
    Best,
    /// The mean over all feasible responses on a uniform grid. The search uses the best response and ranks its best few
    /// grasps by the mean.
    #[serde(rename = "average")]
    Mean,
}

/// The form of peripersonal comfort (`docs/method.md#5-peripersonal-comfort`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PeripersonalForm {
    /// The minimum distance.
    Min,
    /// The mean distance.
    Mean,
    /// The mean distance, weighted towards close points.
    Weighted,
}

/// Which sign selects one of the two strengths of a joint (`docs/method.md#47-direction-of-motion`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StrengthDirection {
    /// The sign of the joint motion that the wrench drives, as in the paper.
    Paper,
    /// The sign of the joint torque.
    Torque,
}

/// The metric of muscular comfort (`docs/method.md#4-muscular-comfort`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MuscularMetric {
    /// A function of the posture: the moment about the shoulder along directions that belong to the upper arm.
    #[default]
    Intrinsic,
    /// As printed in the paper: torques about the axes of three shoulder angles.
    Paper,
    /// The effort of the arm's muscles: the sum of the squares of their activations.
    Muscles,
}

/// How comfort is defined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ComfortSettings {
    /// The person's best response (`most`) or the mean of all responses (`average`).
    pub person: ResponseKind,
    /// The metric of muscular comfort.
    pub muscular: MuscularMetric,
    /// Form of peripersonal comfort.
    pub peripersonal: PeripersonalForm,
    /// Distance beyond which peripersonal comfort does not increase, m: every distance `d` is replaced by
    /// `min(d, saturation_m)`. By default distances are not saturated, as in the paper.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturation_m: Option<f64>,
    /// Which sign selects the strength of a joint; only with `muscular = "paper"`.
    pub direction: StrengthDirection,
    /// Weight of regularised muscular comfort.
    pub weight_muscular: f64,
    /// Weight of peripersonal comfort, 1/m.
    pub weight_peripersonal: f64,
    /// Instead of the two weights: the share `s` of peripersonal comfort, from 0 to 1, in the normalised objective
    /// `100 ((1 - s) muscular_regularised / optima.muscular_regularised + s peripersonal_m / optima.peripersonal_m)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peripersonal_share: Option<f64>,
    /// The values that the normalised objective divides the comforts by. By default the planner `comfort` determines them: the
    /// values that the planners `muscular` and `peripersonal` reach. The other planners do not determine them; where they
    /// need the objective, they use 100 and 1 m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optima: Option<Optima>,
}

/// The largest value of each comfort if the other one has no weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Optima {
    /// Muscular comfort, `comfort.muscular_regularised` of a plan.
    pub muscular_regularised: f64,
    /// Peripersonal comfort, m.
    pub peripersonal_m: f64,
}

impl Optima {
    /// Used if the optima are not known: the upper bound of the regularised muscular comfort as printed (that of the intrinsic one
    /// is 57), and 1 m.
    const FALLBACK: Self = Self { muscular_regularised: 100.0, peripersonal_m: 1.0 };
}

impl ComfortSettings {
    /// The weights of regularised muscular comfort and of peripersonal comfort (1/m) in the objective, which is their weighted
    /// sum also if it is normalised.
    #[must_use]
    pub fn weights(&self) -> [f64; 2] {
        let Some(share) = self.peripersonal_share else { return [self.weight_muscular, self.weight_peripersonal] };
        let Optima { muscular_regularised, peripersonal_m } = self.optima.unwrap_or(Optima::FALLBACK);
        // No division by an optimum of zero.
        let over = |share: f64, best: f64| if best > 0.0 { 100.0 * share / best } else { 0.0 };
        [over(1.0 - share, muscular_regularised), over(share, peripersonal_m)]
    }
}

impl Default for ComfortSettings {
    /// The weights of the paper's combined metric; 64 is the number of body points
    /// (`docs/method.md#56-weight-in-the-objective`).
    fn default() -> Self {
        Self {
            person: ResponseKind::Best,
            muscular: MuscularMetric::Intrinsic,
            peripersonal: PeripersonalForm::Weighted,
            saturation_m: None,
            direction: StrengthDirection::Paper,
            weight_muscular: 1.0,
            weight_peripersonal: 64.0,
            peripersonal_share: None,
            optima: None,
        }
    }
}

/// What a planner maximises (`docs/method.md#32-objective`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PlannerKind {
    /// The weighted sum of both comforts.
    Comfort,
    /// Muscular comfort.
    Muscular,
    /// Peripersonal comfort.
    Peripersonal,
    /// Nothing: a feasible grasp is drawn uniformly, and the person's best response to it is chosen.
    Random,
}

impl PlannerKind {
    /// All planners, in the order of the paper's table.
    pub const ALL: [Self; 4] = [Self::Comfort, Self::Peripersonal, Self::Muscular, Self::Random];

    /// The objective of this planner: `settings` as a weighted sum, with a weight of 0 for the comfort that the planner
    /// ignores.
    #[must_use]
    pub fn objective(self, settings: ComfortSettings) -> ComfortSettings {
        let [weight_muscular, weight_peripersonal] = match self {
            Self::Comfort | Self::Random => settings.weights(),
            // Dividing one comfort by its optimum does not move its maximum.
            Self::Muscular | Self::Peripersonal if settings.peripersonal_share.is_some() => [1.0, 1.0],
            Self::Muscular | Self::Peripersonal => settings.weights(),
        };
        let settings = ComfortSettings {
            weight_muscular,
            weight_peripersonal,
            peripersonal_share: None,
            optima: None,
            ..settings
        };
        match self {
            Self::Comfort | Self::Random => settings,
            Self::Muscular => ComfortSettings { weight_peripersonal: 0.0, ..settings },
            Self::Peripersonal => ComfortSettings { weight_muscular: 0.0, ..settings },
        }
    }
}

impl std::fmt::Display for PlannerKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Comfort => "comfort",
            Self::Muscular => "muscular",
            Self::Peripersonal => "peripersonal",
            Self::Random => "random",
        })
    }
}

/// The search budget.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Budget {
    /// For replanning while the person moves.
    Fast,
    /// For one plan.
    #[default]
    Default,
    /// A hundred times the default; a reference for the other two.
    Exhaustive,
}

/// The stability criterion of a plan (`docs/method.md#6-stability`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StabilityKind {
    /// The load factor only, as in the paper (`docs/method.md#65-load-factor`).
    Paper,
    /// Also the compliant load factor and the predicted deflection (`docs/method.md#69-compliant-load-factor`).
    Compliant,
}

/// Settings of the planner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlannerSettings {
    /// What the planner maximises.
    pub kind: PlannerKind,
    /// The stability criterion.
    pub stability: StabilityKind,
    /// Seed of the search.
    pub seed: u64,
    /// The search budget.
    #[serde(skip_serializing_if = "is_default")]
    pub budget: Budget,
    /// Largest number of candidates that the search evaluates, if that is less than the budget allows. The two searches for
    /// the optima of a normalised objective may each evaluate as many.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
    /// A plan file that is simulated instead of planning; relative to the scenario file's folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
}

impl Default for PlannerSettings {
    fn default() -> Self {
        Self {
            kind: PlannerKind::Comfort,
            stability: StabilityKind::Compliant,
            seed: 1,
            budget: Budget::Default,
            evaluations: None,
            plan: None,
        }
    }
}

/// Grip force and friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Grip {
    /// The force that closes each finger, N.
    pub force_n: f64,
    /// Coulomb friction coefficient of pads and board.
    pub friction: f64,
}

impl Default for Grip {
    /// The default grip force and friction (`docs/method.md#76-robot-figures`).
    fn default() -> Self {
        Self { force_n: 30.0, friction: 0.6 }
    }
}

/// The simulation's phases and time step (`docs/method.md#74-phases`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationSettings {
    /// Duration before the load, s: the grippers close, in at most a tenth of it, then the arms carry the board.
    pub settle_s: f64,
    /// Duration of the ramp, s: the load grows from zero to the full wrench.
    pub ramp_s: f64,
    /// Duration of the hold, s: the full wrench acts.
    pub hold_s: f64,
    /// Duration of the release phase, s: the load is removed.
    pub release_s: f64,
    /// Time step, s.
    pub timestep_s: f64,
}

impl SimulationSettings {
    /// The longest time step, s. Beyond it contacts of a light board penetrate too deeply for a valid result.
    pub const MAX_TIMESTEP_S: f64 = 0.004;
    /// The largest number of steps: 200 s at 2 ms, a trace of about 100 MB.
    pub const MAX_STEPS: usize = 100_000;
    /// The fewest steps of the hold phase: creep is a slope over its second half.
    pub const MIN_HOLD_STEPS: usize = 10;
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self { settle_s: 0.5, ramp_s: 1.0, hold_s: 1.0, release_s: 0.5, timestep_s: 0.002 }
    }
}

/// The limits of a hold (`docs/method.md#8-judgement`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Translation of a hand relative to the board, mm.
    pub slip_mm: f64,
    /// Rotation of a hand relative to the board, degrees.
    pub slip_deg: f64,
    /// Displacement of the board's tool point under the load, mm.
    pub deflection_mm: f64,
    /// Displacement of the board's tool point under the board's weight, mm: from the hand-over to the load.
    #[serde(default = "default_sag_mm")]
    pub sag_mm: f64,
    /// Rate of slip in the second half of the hold phase, mm/s.
    pub creep_mm_s: f64,
    /// Demanded joint torque divided by its limit.
    pub torque_ratio: f64,
    /// Smallest predicted load factor of a plan; the planner requires 1.1 times this value of the compliant load factor.
    pub load_factor: f64,
    /// Least distance of the robot from itself and from the board that the planner keeps, mm. At 0 they must only not touch in
    /// the planned pose.
    #[serde(default = "usual_clearance_mm")]
    pub clearance_mm: f64,
    /// Largest RULA score of the person's posture; no limit by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rula: Option<u8>,
    /// Largest RULA score of arm and wrist; no limit by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rula_arm: Option<u8>,
    /// Largest REBA score of the person's posture; no limit by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reba: Option<u8>,
}

/// The default of [`Limits::sag_mm`].
fn default_sag_mm() -> f64 {
    Limits::USUAL.sag_mm
}

impl Limits {
    /// The default limits but for cuts (`docs/method.md#810-default-limits`).
    pub const USUAL: Self = Self {
        slip_mm: 1.0,
        slip_deg: 2.0,
        deflection_mm: 5.0,
        sag_mm: 10.0,
        creep_mm_s: 0.1,
        torque_ratio: 1.0,
        load_factor: 1.0,
        clearance_mm: 5.0,
        rula: None,
        rula_arm: None,
        reba: None,
    };

    /// The default limits of a cut, whose tool point may deflect more.
    pub const CUT: Self = Self { deflection_mm: 15.0, ..Self::USUAL };

    /// [`Limits::clearance_mm`] in m.
    #[must_use]
    pub fn clearance_m(&self) -> f64 {
        self.clearance_mm * 1e-3
    }

    /// The default limits of a kind of operation.
    #[must_use]
    pub fn of(kind: OperationKind) -> Self {
        if kind == OperationKind::Cut { Self::CUT } else { Self::USUAL }
    }
}

/// The clearance of files that do not have one.
fn usual_clearance_mm() -> f64 {
    Limits::USUAL.clearance_mm
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normalised_objective_is_a_hundred_at_both_optima_and_splits_by_its_share() {
        let optima = Some(Optima { muscular_regularised: 62.0, peripersonal_m: 1.25 });
        let with = |share| ComfortSettings { peripersonal_share: Some(share), optima, ..ComfortSettings::default() };
        for share in [0.0, 0.25, 1.0] {
            let [muscular, peripersonal] = with(share).weights();
            let rounding = 1e-12;
            assert!((muscular * 62.0 - 100.0 * (1.0 - share)).abs() < rounding);
            assert!((peripersonal * 1.25 - 100.0 * share).abs() < rounding);
        }
        // Unknown optima: the upper bound of muscular comfort, and 1 m.
        let unknown = ComfortSettings { optima: None, ..with(0.25) };
        assert_eq!(unknown.weights(), [0.75, 25.0]);
        assert_eq!(ComfortSettings::default().weights(), [1.0, 64.0]);
    }

    #[test]
    fn a_planner_of_one_comfort_has_the_weight_of_its_own_alone() {
        for peripersonal_share in [None, Some(0.0), Some(0.25), Some(1.0)] {
            let settings = ComfortSettings { peripersonal_share, ..ComfortSettings::default() };
            assert_eq!(PlannerKind::Comfort.objective(settings).weights(), settings.weights());
            let [muscular, none] = PlannerKind::Muscular.objective(settings).weights();
            assert!(muscular > 0.0 && none == 0.0, "{peripersonal_share:?}");
            let [none, peripersonal] = PlannerKind::Peripersonal.objective(settings).weights();
            assert!(none == 0.0 && peripersonal > 0.0, "{peripersonal_share:?}");
        }
    }
}
