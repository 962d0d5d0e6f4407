//! The section `[sweep]` of a scenario file.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    InputError,
    check::Checker,
    load_section::{at, unreadable},
    uncertainty_section::accepted,
};
use crate::{
    input::MOST_CSV,
    model::{
        load::ForceProfile,
        scenario::{Expectation, Scenario},
        sweep::{Distribution, NAMES, Quantity, Sampling, Sweep, Variable},
    },
    robot::Robot,
    sweep::distribution::Quantiles,
};

/// The preset `workshop`: a section of variables.
const WORKSHOP: &str = include_str!("../../assets/sweep/workshop.toml");

/// The most rows of a file of measured values. A plan carries them all.
const MOST_ROWS: usize = 100_000;

/// `[sweep]`: what is uncertain. Each table is a variable; of an absolute value and a factor of one quantity there is one. Keys of
/// a variable depend on its `kind`.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SweepSection {
    /// Variables to start from; those of the scenario replace them. None by default.
    pub preset: Option<Preset>,
    /// The number of runs, 1 to 2^31; 1000 by default.
    pub runs: Option<u64>,
    /// How points are drawn: `independent`, the default, or `sobol`.
    pub sampling: Sampling,
    /// Seed of the draws; 1 by default.
    pub seed: Option<u64>,
    /// Coulomb friction coefficient of pads and board, one value an arm unless `correlation` is 1, the default.
    pub friction: Option<VariableSection>,
    /// Factor of the friction coefficient.
    pub friction_factor: Option<VariableSection>,
    /// Force that closes each finger, N, one value an arm unless `correlation` is 1; it is 0 by default.
    pub grip_force_n: Option<VariableSection>,
    /// Factor of the grip force, or of the limits of measured grippers.
    pub grip_force_factor: Option<VariableSection>,
    /// Factor of the stiffness of contacts and elastic pads.
    pub contact_stiffness_factor: Option<VariableSection>,
    /// Factor of the stiffness of all joints.
    pub joint_stiffness_factor: Option<VariableSection>,
    /// Mass of the board, kg.
    pub board_mass_kg: Option<VariableSection>,
    /// Factor of the mass of the board.
    pub board_mass_factor: Option<VariableSection>,
    /// Thickness of the board, mm.
    pub board_thickness_mm: Option<VariableSection>,
    /// What the board is thicker than planned, mm.
    pub board_thickness_offset_mm: Option<VariableSection>,
    /// The tool's force, N; moments grow with it.
    pub force_n: Option<VariableSection>,
    /// Factor of the tool's wrench.
    pub force_factor: Option<VariableSection>,
    /// Tilt of the tool's wrench, degrees, drawn for each of two axes.
    pub tool_tilt_deg: Option<VariableSection>,
    /// Displacement of the tool point in the worked face, mm, drawn along each of two axes.
    pub tool_offset_mm: Option<VariableSection>,
    /// Displacement of the person on the floor, mm, drawn along each of two axes.
    pub person_offset_mm: Option<VariableSection>,
    /// Error of the joints' angles, degrees, drawn for each joint.
    pub joint_offset_deg: Option<VariableSection>,
    /// Factor of the duration of the ramp.
    pub ramp_factor: Option<VariableSection>,
}

/// Variables that come with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// A workshop with usual care.
    Workshop,
}

/// The kind of a variable's distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VariableKind {
    /// Leaves out the preset's variable.
    None,
    /// The normal distribution: `mean`, `sd`.
    Normal,
    /// The uniform distribution: `low`, `high`.
    Uniform,
    /// The distribution of a value whose logarithm is normal: `median`, `sd_log`.
    LogNormal,
    /// The triangular distribution: `low`, `mode`, `high`.
    Triangular,
    /// Some values: `values`, `weights`.
    Discrete,
    /// Measured values from a CSV file: `file`, `column`.
    Csv,
}

/// A table of `[sweep]`: `kind` determines which other keys are allowed.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariableSection {
    /// `normal`, `uniform`, `log-normal`, `triangular`, `discrete`, `csv`, or `none` to leave out the preset's variable.
    pub kind: VariableKind,
    /// For `normal`: the mean.
    pub mean: Option<f64>,
    /// For `normal`: the standard deviation.
    pub sd: Option<f64>,
    /// For `log-normal`: the median.
    pub median: Option<f64>,
    /// For `log-normal`: the standard deviation of the natural logarithm.
    pub sd_log: Option<f64>,
    /// For `uniform` and `triangular`: the smallest value.
    pub low: Option<f64>,
    /// For `triangular`: the most likely value.
    pub mode: Option<f64>,
    /// For `uniform` and `triangular`: the largest value.
    pub high: Option<f64>,
    /// For `discrete`: the values.
    pub values: Option<Vec<f64>>,
    /// For `discrete`: their weights; equal by default.
    pub weights: Option<Vec<f64>>,
    /// For `csv`: a CSV file with a header, relative to the scenario file's folder.
    pub file: Option<PathBuf>,
    /// For `csv`: the column; may be left out if the file has only one.
    pub column: Option<String>,
    /// Values below this are not drawn.
    pub min: Option<f64>,
    /// Values above this are not drawn.
    pub max: Option<f64>,
    /// Of friction and grip force: the correlation of the arms' values, 0 to 1.
    pub correlation: Option<f64>,
    /// Where the figures are from; a remark for people.
    pub source: Option<String>,
}

impl SweepSection {
    /// The variables of [`NAMES`], in its order.
    fn variables(&self) -> [&Option<VariableSection>; NAMES.len()] {
        [
            &self.friction,
            &self.friction_factor,
            &self.grip_force_n,
            &self.grip_force_factor,
            &self.contact_stiffness_factor,
            &self.joint_stiffness_factor,
            &self.board_mass_kg,
            &self.board_mass_factor,
            &self.board_thickness_mm,
            &self.board_thickness_offset_mm,
            &self.force_n,
            &self.force_factor,
            &self.tool_tilt_deg,
            &self.tool_offset_mm,
            &self.person_offset_mm,
            &self.joint_offset_deg,
            &self.ramp_factor,
        ]
    }

    /// The CSV files that the variables name, relative to the scenario's folder.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.variables().into_iter().flatten().filter_map(|variable| variable.file.as_ref())
    }
}

/// The sweep that a section describes, of a scenario that is complete but for it. Files are relative to `folder`.
///
/// # Errors
/// If a key is missing or belongs to another kind, a quantity has two variables, or a CSV file is invalid.
pub fn sweep(
    check: &Checker<'_>,
    section: &SweepSection,
    scenario: &Scenario,
    robot: &Robot,
    folder: &Path,
) -> Result<Sweep, InputError> {
    let variables = variables(check, section, scenario, folder)?;
    let of_preset = match section.preset {
        Some(Preset::Workshop) => workshop(scenario)?,
        None => Vec::new(),
    };
    let has_pads = robot.arms.iter().any(|arm| arm.gripper.holding.pads().is_some());
    let is_left = |variable: &Variable| {
        let replaced = variables.iter().any(|(quantity, _)| *quantity == variable.quantity);
        !replaced && (has_pads || variable.quantity != Quantity::Friction)
    };
    let mut all: Vec<Variable> = of_preset.into_iter().filter(is_left).collect();
    all.extend(variables.into_iter().filter_map(|(_, variable)| variable));
    all.sort_by_key(|variable| variable.quantity);
    Ok(Sweep {
        runs: section.runs.unwrap_or(Sweep::RUNS),
        sampling: section.sampling,
        seed: section.seed.unwrap_or(Sweep::SEED),
        variables: all,
    })
}

/// The sweep of a scenario without one: all variables of the preset `workshop`.
///
/// # Errors
/// If the preset does not fit the scenario.
pub fn usual_sweep(scenario: &Scenario, robot: &Robot) -> Result<Sweep, InputError> {
    let section = SweepSection { preset: Some(Preset::Workshop), ..SweepSection::default() };
    sweep(&Checker::toml(Path::new("workshop"), ""), &section, scenario, robot, Path::new(""))
}

/// The variables of the preset `workshop`.
fn workshop(scenario: &Scenario) -> Result<Vec<Variable>, InputError> {
    let section: SweepSection = toml::from_str(WORKSHOP).expect("the built-in preset is valid");
    let path = Path::new("assets/sweep/workshop.toml");
    let variables = variables(&Checker::toml(path, WORKSHOP), &section, scenario, Path::new(""))?;
    Ok(variables.into_iter().filter_map(|(_, variable)| variable).collect())
}

/// The variables that a section has; `None` for those that it leaves out.
fn variables(
    check: &Checker<'_>,
    section: &SweepSection,
    scenario: &Scenario,
    folder: &Path,
) -> Result<Vec<(Quantity, Option<Variable>)>, InputError> {
    let mut found: Vec<(Quantity, Option<Variable>)> = Vec::new();
    let given = NAMES.into_iter().zip(section.variables());
    for ((name, quantity, absolute, _), section) in given {
        let Some(section) = section else { continue };
        let key = format!("sweep.{name}");
        if found.iter().any(|(other, _)| *other == quantity) {
            let other = NAMES.into_iter().find(|entry| entry.1 == quantity).map_or("", |entry| entry.0);
            return Err(check.value(&key, "a table", format!("none beside sweep.{other}: they are one quantity")));
        }
        check_keys(check, &key, section)?;
        let distribution = distribution(check, &key, section, folder)?;
        let variable = match distribution {
            Some(distribution) => Some(Variable {
                quantity,
                distribution,
                min: section.min,
                max: section.max,
                nominal: absolute.then(|| nominal(check, &key, quantity, scenario)).transpose()?,
                correlation: section.correlation.or(quantity.usual_correlation()),
                source: section.source.clone(),
            }),
            None => None,
        };
        found.push((quantity, variable));
    }
    Ok(found)
}

/// Requires that the keys of a variable belong to its kind.
fn check_keys(check: &Checker<'_>, of: &str, section: &VariableSection) -> Result<(), InputError> {
    use VariableKind::{Csv, Discrete, LogNormal, Normal, Triangular, Uniform};
    let all = [Normal, Uniform, LogNormal, Triangular, Discrete, Csv];
    let keys: [(&str, bool, &[VariableKind]); 15] = [
        ("mean", section.mean.is_some(), &[Normal]),
        ("sd", section.sd.is_some(), &[Normal]),
        ("median", section.median.is_some(), &[LogNormal]),
        ("sd_log", section.sd_log.is_some(), &[LogNormal]),
        ("low", section.low.is_some(), &[Uniform, Triangular]),
        ("mode", section.mode.is_some(), &[Triangular]),
        ("high", section.high.is_some(), &[Uniform, Triangular]),
        ("values", section.values.is_some(), &[Discrete]),
        ("weights", section.weights.is_some(), &[Discrete]),
        ("file", section.file.is_some(), &[Csv]),
        ("column", section.column.is_some(), &[Csv]),
        ("min", section.min.is_some(), &all),
        ("max", section.max.is_some(), &all),
        ("correlation", section.correlation.is_some(), &all),
        ("source", section.source.is_some(), &all),
    ];
    keys.into_iter().filter(|(_, _, kinds)| !kinds.contains(&section.kind)).try_for_each(|(key, given, kinds)| {
        let belongs_to = match kinds {
            [kind] => format!("kind = \"{}\"", name_of(*kind)),
            [kind, other] => format!("kind = \"{}\" or \"{}\"", name_of(*kind), name_of(*other)),
            _ => "a distribution".to_owned(),
        };
        check.absent(&format!("{of}.{key}"), given, &belongs_to)
    })
}

/// A kind as files have it.
fn name_of(kind: VariableKind) -> &'static str {
    match kind {
        VariableKind::None => "none",
        VariableKind::Normal => "normal",
        VariableKind::Uniform => "uniform",
        VariableKind::LogNormal => "log-normal",
        VariableKind::Triangular => "triangular",
        VariableKind::Discrete => "discrete",
        VariableKind::Csv => "csv",
    }
}

/// The distribution of a variable; `None` for the kind `none`.
fn distribution(
    check: &Checker<'_>,
    of: &str,
    section: &VariableSection,
    folder: &Path,
) -> Result<Option<Distribution>, InputError> {
    let number = |key: &str, value: Option<f64>| {
        let expected = format!("a number, since kind = \"{}\"", name_of(section.kind));
        check.present(&format!("{of}.{key}"), value, &expected)
    };
    Ok(Some(match section.kind {
        VariableKind::None => return Ok(None),
        VariableKind::Normal => {
            Distribution::Normal { mean: number("mean", section.mean)?, sd: number("sd", section.sd)? }
        }
        VariableKind::LogNormal => Distribution::LogNormal {
            median: number("median", section.median)?,
            sd_log: number("sd_log", section.sd_log)?,
        },
        VariableKind::Uniform => {
            Distribution::Uniform { low: number("low", section.low)?, high: number("high", section.high)? }
        }
        VariableKind::Triangular => Distribution::Triangular {
            low: number("low", section.low)?,
            mode: number("mode", section.mode)?,
            high: number("high", section.high)?,
        },
        VariableKind::Discrete => {
            let values = check.present(&format!("{of}.values"), section.values.clone(), "a list of numbers")?;
            Distribution::Discrete { values, weights: section.weights.clone() }
        }
        VariableKind::Csv => {
            let file = check.present(&format!("{of}.file"), section.file.as_ref(), "the path of a CSV file")?;
            let path = folder.join(file);
            let text = check.named_file(&format!("{of}.file"), &path, MOST_CSV)?;
            Distribution::Measured { values: measured(&path, &text, section.column.as_deref())? }
        }
    }))
}

/// The planned value that absolute values of a quantity are compared with.
fn nominal(check: &Checker<'_>, key: &str, quantity: Quantity, scenario: &Scenario) -> Result<f64, InputError> {
    match quantity {
        Quantity::Friction => Ok(scenario.grip.friction),
        Quantity::GripForce => Ok(scenario.grip.force_n),
        Quantity::BoardMass => Ok(scenario.object.mass_kg()),
        Quantity::BoardThickness => Ok(scenario.object.shape().thickness_m() * 1000.0),
        _ => {
            let is_measured = matches!(scenario.load.profile, ForceProfile::Measured { .. });
            let force_n = scenario.operation.wrench_o.force_n.norm();
            let expected = "sweep.force_factor, since the load is measured or has no force";
            check.that(!is_measured && force_n > 0.0, key, "a force in N", expected)?;
            Ok(force_n)
        }
    }
}

/// The measured values in a column of a CSV file with this text; by default from its only one. In increasing order.
///
/// # Errors
/// If the file does not have the column, or has a cell that is not a finite number, or fewer than two rows. The
/// error names the file and the line.
fn measured(path: &Path, text: &str, column: Option<&str>) -> Result<Vec<f64>, InputError> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut records = reader.records();
    let first = records.next().transpose().map_err(|error| unreadable(path, &error))?;
    let header: Vec<String> = first.iter().flatten().map(str::to_owned).collect();
    let place = match column {
        Some(column) => header.iter().position(|name| name == column),
        None => (header.len() == 1).then_some(0),
    };
    let Some(place) = place else {
        let expected =
            column.map_or("one column, since the scenario names none".into(), |name| format!("a column {name}"));
        return Err(at(path, Some(1), None, format!("\"{}\"", header.join(", ")), &expected));
    };
    let mut values = Vec::new();
    for record in records {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let line = record.position().map(|position| position.line() as usize);
        if record.len() != header.len() {
            let expected = format!("{}, one a column", header.len());
            return Err(at(path, line, None, format!("{} cells", record.len()), &expected));
        }
        let cell = &record[place];
        let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
        let refused = || at(path, line, Some(&header[place]), format!("\"{cell}\""), "a finite number");
        values.push(number.ok_or_else(refused)?);
    }
    if !(2..=MOST_ROWS).contains(&values.len()) {
        let expected = format!("2 to {MOST_ROWS}");
        return Err(at(path, None, None, format!("{} rows of values", values.len()), &expected));
    }
    values.sort_by(f64::total_cmp);
    Ok(values)
}

/// Checks the sweep of a resolved scenario: also one that a plan carries.
pub fn check_sweep(check: &Checker<'_>, scenario: &Scenario, robot: &Robot) -> Result<(), InputError> {
    let Some(sweep) = &scenario.sweep else { return Ok(()) };
    let expected = format!("a number from 1 to {}", Sweep::MOST_RUNS);
    check.that((1..=Sweep::MOST_RUNS).contains(&sweep.runs), "sweep.runs", sweep.runs.to_string(), &expected)?;
    let some = !sweep.variables.is_empty();
    check.that(some, "sweep", "no variable", "preset = \"workshop\" or a table such as [sweep.friction_factor]")?;
    let has_pads = robot.arms.iter().any(|arm| arm.gripper.holding.pads().is_some());
    for (place, variable) in sweep.variables.iter().enumerate() {
        // In the scenario of a plan the variables are a list.
        let whole = match check.is_nested() {
            true => format!("sweep.variables[{place}]"),
            false => format!("sweep.{}", variable.name()),
        };
        let twice = sweep.variables[..place].iter().any(|other| other.quantity == variable.quantity);
        check.that(!twice, &whole, "a quantity that another variable has", "one variable a quantity")?;
        let of_pads = variable.quantity == Quantity::Friction
            || variable.quantity == Quantity::GripForce && variable.nominal.is_some();
        check.absent(
            &whole,
            of_pads && !has_pads,
            "pads, and every gripper of this robot has measured wrench limits",
        )?;
        let quantiles = Quantiles::of(variable).map_err(|flaw| {
            let inner = if check.is_nested() && flaw.is_of_distribution() { "distribution." } else { "" };
            check.value(&format!("{whole}.{inner}{}", flaw.key), flaw.found, flaw.expected)
        })?;
        let [least, most] = quantiles.extremes();
        let [low, high] = allowed(variable, scenario, robot);
        let found = format!("values from {} to {}", short(least), short(most));
        let (low_text, high_text) = (short(low), short(high));
        let expected = format!(
            "values from {low_text} to {high_text} ({}), as the simulation takes them; min and max cut a distribution",
            variable.unit(),
        );
        check.that(low <= least && most <= high, &whole, found, &expected)?;
    }
    Ok(())
}

/// The values of a variable that the simulation accepts beside the scenario's own deviations.
fn allowed(variable: &Variable, scenario: &Scenario, robot: &Robot) -> [f64; 2] {
    let thickness_m = scenario.object.shape().thickness_m();
    let [low, high] = accepted(variable.quantity, thickness_m);
    let of = &scenario.uncertainty;
    let of_arms = |scale: &dyn Fn(usize) -> f64| (0..robot.arms.len()).map(scale).collect();
    let own: Vec<f64> = match variable.quantity {
        Quantity::Friction => of_arms(&|arm| of.friction_scale_of(arm)),
        Quantity::GripForce => of_arms(&|arm| of.grip_force_scale_of(arm)),
        Quantity::ContactStiffness => vec![of.contact_stiffness_scale],
        Quantity::JointStiffness => vec![of.joint_stiffness_scale],
        Quantity::BoardMass => vec![of.board_mass_scale],
        Quantity::Force => vec![of.force_scale],
        Quantity::RampTime => vec![of.ramp_scale],
        Quantity::BoardThickness => vec![of.board_thickness_mm],
        Quantity::ToolTilt => of.tool_tilt_deg.into(),
        Quantity::ToolOffset => of.tool_offset_mm.into(),
        Quantity::PersonOffset => of.person_offset_mm.into(),
        Quantity::JointOffset => of.joint_offset_deg.concat().into_iter().chain([0.0]).collect(),
    };
    let nominal = variable.nominal;
    let range = |own: &f64| match variable.quantity {
        Quantity::BoardThickness
        | Quantity::ToolTilt
        | Quantity::ToolOffset
        | Quantity::PersonOffset
        | Quantity::JointOffset => [low, high].map(|limit| limit - own + nominal.unwrap_or(0.0)),
        // With a factor of 0 every value gives 0.
        _ if *own == 0.0 => [0.0, f64::INFINITY],
        _ => [low, high].map(|limit| limit / own * nominal.unwrap_or(1.0)),
    };
    own.iter().map(range).fold([f64::NEG_INFINITY, f64::INFINITY], |a, b| [a[0].max(b[0]), a[1].min(b[1])])
}

/// A number of a message, to four decimals.
fn short(value: f64) -> String {
    ((value * 1e4).round() / 1e4).to_string()
}

/// Checks the probability that a sweep must show.
pub fn check_expectation(check: &Checker<'_>, scenario: &Scenario) -> Result<(), InputError> {
    let Expectation { probability, confidence, .. } = scenario.expect;
    if let Some(probability) = probability {
        let fits = probability > 0.0 && probability < 1.0;
        check.that(fits, "expect.probability", probability.to_string(), "a number above 0 and below 1")?;
    }
    check.within("expect.confidence", confidence, 0.5, 0.9999, "a probability")?;
    let is_of_a_sweep = probability.is_some() || scenario.sweep.is_some();
    let given = confidence != Expectation::CONFIDENCE;
    check.absent("expect.confidence", given && !is_of_a_sweep, "expect.probability or [sweep]")
}
