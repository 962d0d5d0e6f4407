//! The resolved scenario: every figure that a plan, a simulation and a verdict depend on, with every default filled in.
//!
//! A scenario file may leave most of this out; `crate::scenario` reads, checks and completes it. A plan carries the
//! resolved form, so that anyone can recompute every figure from the plan's file alone.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    load::{Load, Uncertainty},
    operation::Operation,
    verdict::VerdictKind,
};

/// A scenario with every default filled in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// The file format, 1.
    pub format: u32,
    /// A name for tables and file names.
    pub name: String,
    /// The robot, with the figures of its description that the result depends on.
    pub robot: RobotParameters,
    /// The person.
    pub human: Person,
    /// The tool in the person's hand.
    pub tool: Tool,
    /// The board.
    pub object: Board,
    /// The forceful operation.
    pub operation: Operation,
    /// How comfort is measured.
    pub comfort: ComfortSettings,
    /// How the hold is planned.
    pub planner: PlannerSettings,
    /// The grippers.
    pub grip: Grip,
    /// The simulation.
    pub simulation: SimulationSettings,
    /// How the tool loads the board over time; a ramp that turns with the board unless given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub load: Load,
    /// How far the simulation departs from what the plan counts on; not at all unless given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub uncertainty: Uncertainty,
    /// What the hold must keep to.
    pub limits: Limits,
    /// What the author expects.
    pub expect: Expectation,
}

/// The robot's name and those of its figures that the stability and the simulation use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotParameters {
    /// The name of a built-in robot, or the path of a description file.
    pub description: String,
    /// One entry an arm, in the description's order.
    pub arms: Vec<ArmParameters>,
}

/// Figures of one arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArmParameters {
    /// The arm's name.
    pub name: String,
    /// The arm's joints, from the base outward.
    pub joints: Vec<String>,
    /// Stiffness of each joint's position control, N m/rad.
    pub stiffness_nm_rad: Vec<f64>,
    /// Damping of each joint's position control, N m s/rad.
    pub damping_nm_s_rad: Vec<f64>,
    /// The largest torque of each joint, N m.
    pub effort_nm: Vec<f64>,
    /// The pads of the arm's gripper.
    pub pads: Vec<PadParameters>,
}

/// One pad of a gripper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PadParameters {
    /// The pad's name, such as `upper`.
    pub name: String,
    /// Its full sides along x_G and z_G, m.
    pub size_m: [f64; 2],
    /// Where its centre lies along x_G and z_G, m.
    pub centre_m: [f64; 2],
}

/// Male or female: selects strengths and segment masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sex {
    /// Male.
    Male,
    /// Female.
    Female,
}

/// The hand that works.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// The right hand.
    Right,
    /// The left hand: the mirror image of the right, tool included.
    Left,
}

/// The person who works.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Standing height, m.
    pub height_m: f64,
    /// Body mass, kg.
    pub mass_kg: f64,
    /// Selects strengths and segment masses.
    pub sex: Sex,
    /// The hand that holds the tool.
    pub hand: Hand,
    /// Strength percentile, 0.1 to 99.9.
    pub percentile: f64,
    /// How far the trunk leans forward about the hips, degrees; 0, upright, unless given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub lean_deg: f64,
}

/// True for what need not be written.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The tool in the hand: mass and the tip's frame T in the right hand's frame H.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Mass, kg; it acts at the palm.
    pub mass_kg: f64,
    /// Position of the tip in H, m.
    pub tip_h_m: [f64; 3],
    /// Rotation R_HT, unit quaternion, scalar last.
    pub rotation_xyzw: [f64; 4],
}

/// The board, a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Board {
    /// Width, height and thickness along x_O, y_O, z_O, m.
    pub size_m: [f64; 3],
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// The material's name.
    pub material: String,
}

impl Board {
    /// Mass of the board, kg.
    pub fn mass_kg(&self) -> f64 {
        self.size_m.iter().product::<f64>() * self.density_kg_m3
    }
}

/// How the person answers a hold, when it is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ResponseKind {
    /// The best feasible response.
    #[serde(rename = "most")]
    Best,
    /// The mean over all feasible answers of a uniform grid. The search looks for holds with the best answer and ranks the
    /// best few of them by the mean.
    #[serde(rename = "average")]
    Mean,
}

/// The form of the peripersonal metric (METHOD section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PeripersonalForm {
    /// The smallest distance.
    Min,
    /// The mean distance.
    Mean,
    /// The mean weighted towards close points.
    Weighted,
}

/// Which sign decides between the two strengths of a joint (METHOD section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StrengthDirection {
    /// The sign of the motion that the wrench drives, as the paper has it.
    Paper,
    /// The sign of the joint's torque.
    Torque,
}

/// How comfort is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ComfortSettings {
    /// Best or mean answer of the person.
    pub person: ResponseKind,
    /// Form of the peripersonal metric.
    pub peripersonal: PeripersonalForm,
    /// The distance beyond which the robot's being farther away is no more comfortable, m: every distance `d` of the
    /// peripersonal metric is replaced by `min(d, saturation_m)`. As in the paper, none unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturation_m: Option<f64>,
    /// Which sign selects a strength.
    pub direction: StrengthDirection,
    /// Weight of the regularised muscular comfort.
    pub weight_muscular: f64,
    /// Weight of the peripersonal comfort, 1/m.
    pub weight_peripersonal: f64,
    /// In place of the two weights: the share `s` of the peripersonal comfort, from 0 to 1, in the normalised objective
    /// `100 ((1 - s) muscular_regularised / optima.muscular_regularised + s peripersonal_m / optima.peripersonal_m)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peripersonal_share: Option<f64>,
    /// What the comforts are over in the normalised objective. Unless given, the planner `comfort` finds it: what the
    /// planners of either comfort alone reach. The others do not look for it: where `random` chooses the person's answer,
    /// and where they state the objective, 100 and 1 m stand in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub optima: Option<Optima>,
}

/// The best of each comfort that can be had when the other does not count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Optima {
    /// `1 / (||alpha||^2 + 0.01)`.
    pub muscular_regularised: f64,
    /// The peripersonal metric, m.
    pub peripersonal_m: f64,
}

impl Optima {
    /// Stands in where optima are not known: the bound of the muscular comfort, and 1 m.
    const FALLBACK: Self = Self { muscular_regularised: 100.0, peripersonal_m: 1.0 };
}

impl ComfortSettings {
    /// The weights of the regularised muscular comfort and of the peripersonal one (1/m) in the objective, which is their
    /// weighted sum in either form.
    pub fn weights(&self) -> [f64; 2] {
        let Some(share) = self.peripersonal_share else { return [self.weight_muscular, self.weight_peripersonal] };
        let Optima { muscular_regularised, peripersonal_m } = self.optima.unwrap_or(Optima::FALLBACK);
        // A comfort whose best is nothing cannot be weighed by it.
        let over = |share: f64, best: f64| if best > 0.0 { 100.0 * share / best } else { 0.0 };
        [over(1.0 - share, muscular_regularised), over(share, peripersonal_m)]
    }
}

impl Default for ComfortSettings {
    /// METHOD section 5: the weights of the paper's combined metric, 64 being the number of body points.
    fn default() -> Self {
        Self {
            person: ResponseKind::Best,
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

/// What a planner looks for (METHOD section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PlannerKind {
    /// The best of both comforts together, weighted.
    Comfort,
    /// The best muscular comfort; the peripersonal one has no weight.
    Muscular,
    /// The best peripersonal comfort; the muscular one has no weight.
    Peripersonal,
    /// Any hold, drawn uniformly; the person answers it as best they can.
    Random,
}

impl PlannerKind {
    /// All planners, in the order of the paper's table.
    pub const ALL: [Self; 4] = [Self::Comfort, Self::Peripersonal, Self::Muscular, Self::Random];

    /// The comfort that this planner maximises: `settings` as a weighted sum, with the weight of what it does not look at
    /// set to zero.
    pub fn objective(self, settings: ComfortSettings) -> ComfortSettings {
        let [weight_muscular, weight_peripersonal] = match self {
            Self::Comfort | Self::Random => settings.weights(),
            // What is over its own optimum is best where it is best by itself, whatever its share.
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

/// How much work a search may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Budget {
    /// For a robot that replans while the person moves.
    Fast,
    /// For one plan.
    #[default]
    Default,
    /// A hundred times the default: what the others are measured against.
    Exhaustive,
}

/// Which stability a plan must show (METHOD section 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StabilityKind {
    /// The load factor of the cone program alone, as the paper has it.
    Paper,
    /// Also the compliant load factor and the predicted deflection.
    Compliant,
}

/// How the hold is planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlannerSettings {
    /// The objective.
    pub kind: PlannerKind,
    /// The stability that a plan must show.
    pub stability: StabilityKind,
    /// Seed of the search.
    pub seed: u64,
    /// How much work the search may do.
    #[serde(skip_serializing_if = "is_default")]
    pub budget: Budget,
    /// The largest number of candidates that the search may look at, if that ends it before the budget does. The searches for
    /// the optima of a normalised objective may look at as many each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
    /// A plan file to judge in place of planning, relative to the scenario's file.
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

/// The grippers' squeeze and friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Grip {
    /// Force with which each finger is pushed, N.
    pub force_n: f64,
    /// Coulomb friction between pad and board.
    pub friction: f64,
}

impl Default for Grip {
    /// METHOD section 7.
    fn default() -> Self {
        Self { force_n: 30.0, friction: 0.6 }
    }
}

/// The simulation's phases and step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationSettings {
    /// Time under gravity alone before the load, s.
    pub settle_s: f64,
    /// Time in which the load grows from nothing to the whole wrench, s.
    pub ramp_s: f64,
    /// Time under the whole wrench, s.
    pub hold_s: f64,
    /// Time after the load is taken away, s.
    pub release_s: f64,
    /// Time step, s.
    pub timestep_s: f64,
}

impl SimulationSettings {
    /// The longest time step, s: beyond it contacts sink in so far that a light board's hold loses its meaning.
    pub const MAX_TIMESTEP_S: f64 = 0.004;
    /// The largest number of steps: 200 s at 2 ms, a trace of about 100 MB.
    pub const MAX_STEPS: usize = 100_000;
    /// The fewest steps of a hold: creep is a slope over its second half.
    pub const MIN_HOLD_STEPS: usize = 10;
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self { settle_s: 0.5, ramp_s: 1.0, hold_s: 1.0, release_s: 0.5, timestep_s: 0.002 }
    }
}

/// What the hold must keep to (METHOD section 8).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Translation of a hand on the board, mm.
    pub slip_mm: f64,
    /// Rotation of a hand on the board, degrees.
    pub slip_deg: f64,
    /// Displacement of the tool point of the board, mm.
    pub deflection_mm: f64,
    /// Rate of slip in the second half of the hold, mm/s.
    pub creep_mm_s: f64,
    /// Demanded joint torque over its limit.
    pub torque_ratio: f64,
    /// The load factor that a plan must be predicted to stand.
    pub load_factor: f64,
}

/// What the author of a scenario expects of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Expectation {
    /// The verdict that counts as success.
    pub verdict: VerdictKind,
}

impl Default for Expectation {
    fn default() -> Self {
        Self { verdict: VerdictKind::Holds }
    }
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
        // Where optima are not known, the bound of the muscular comfort and 1 m.
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
