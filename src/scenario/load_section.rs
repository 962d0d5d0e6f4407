//! The section `[load]` of a scenario file, and measured forces from a CSV or an MCAP file.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[cfg(feature = "mcap")]
use crate::{
    input::MOST_MCAP,
    ros::wrench::{self, WrenchError},
};

use super::{InputError, InputErrorKind, check::Checker};
use crate::{
    check::bounds,
    input::MOST_CSV,
    model::{
        load::{ForceFrame, ForceProfile, Load},
        operation::OperationKind,
        scenario::Scenario,
    },
};

/// The header of a file of measured forces.
const HEADER: [&str; 7] = ["time_s", "fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"];

/// The largest value in each column, s, N and N m.
const MOST: [f64; 7] = {
    let (force_n, moment_nm) = (bounds::MOST_FORCE_N, bounds::MOST_MOMENT_NM);
    [bounds::MOST_TIME_S, force_n, force_n, force_n, moment_nm, moment_nm, moment_nm]
};

/// Fewest simulation steps per period of a vibration; fewer do not sample a sine.
const STEPS_PER_PERIOD: f64 = 4.0;

/// The kind of a load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LoadKind {
    /// The operation's wrench; it grows linearly in the ramp.
    #[default]
    Ramp,
    /// A drill with spindle torque, vibration and breakthrough.
    Drill,
    /// A knife that moves along a circle during the hold.
    Path,
    /// A measured wrench from a file.
    Measured,
}

/// `[load]`: `kind` determines which other keys are allowed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LoadSection {
    /// `ramp`, `drill`, `path` or `measured`; `ramp` by default.
    pub kind: LoadKind,
    /// The frame in which the wrench's direction is constant: `board`, the default, or `world`.
    pub frame: ForceFrame,
    /// Sideways part of the person's push, as a share of the operation's force, 0 to 1: in the plane perpendicular to that
    /// force, in its worst direction, for predictions, planners and simulation. 0 by default; not with `measured`.
    pub lateral_share: Option<f64>,
    /// For `drill`: torque of the spindle on the board about the tool's axis z_T, N m; 0 by default.
    pub spindle_torque_nm: Option<f64>,
    /// For `drill`: amplitude of the thrust's vibration, N; 0 by default.
    pub vibration_n: Option<f64>,
    /// For `drill`: frequency of the vibration, Hz.
    pub vibration_hz: Option<f64>,
    /// For `drill`: when the drill breaks through, s after the start of the hold; the thrust then falls to zero within 20 ms. By
    /// default it does not break through.
    pub breakthrough_s: Option<f64>,
    /// For `path`: speed of the knife along the circle, m/s.
    pub speed_m_s: Option<f64>,
    /// For `path`: the circle's centre on the worked face, m along x_O and y_O; by default the board's centre.
    pub centre_m: Option<[f64; 2]>,
    /// For `path`: force into the face as a fraction of the cutting force; 0 by default.
    pub normal_share: Option<f64>,
    /// For `measured`: a CSV file with the columns `time_s, fx_n, fy_n, fz_n, mx_nm, my_nm, mz_nm`: s since the ramp began, N,
    /// and N m about the tool tip, O axes; or an MCAP file (`.mcap`) with messages `geometry_msgs/WrenchStamped` of ROS 2 or ROS 1
    /// in the same units, axes and about the same point, the first one at the beginning of the ramp. The path is relative to the
    /// scenario file's folder.
    pub file: Option<String>,
    /// For `measured` with an MCAP file: the topic, such as `/wrench`; by default the only one with wrenches.
    pub topic: Option<String>,
}

/// The load that a section describes. The file of measured forces is relative to `folder`.
///
/// # Errors
/// If a key is missing or belongs to another kind, or the file of measured forces is invalid.
pub fn load(check: &Checker<'_>, section: &LoadSection, folder: &Path) -> Result<Load, InputError> {
    check_keys(check, section)?;
    let lateral_share = section.lateral_share.unwrap_or(0.0);
    let profile = match section.kind {
        LoadKind::Ramp => ForceProfile::Ramp,
        LoadKind::Drill => ForceProfile::Drill {
            spindle_torque_nm: section.spindle_torque_nm.unwrap_or(0.0),
            vibration_n: section.vibration_n.unwrap_or(0.0),
            vibration_hz: match section.vibration_n {
                Some(_) => check.present("load.vibration_hz", section.vibration_hz, "a frequency in Hz")?,
                None => section.vibration_hz.unwrap_or(0.0),
            },
            breakthrough_s: section.breakthrough_s,
        },
        LoadKind::Path => ForceProfile::Path {
            speed_m_s: check.present("load.speed_m_s", section.speed_m_s, "a speed in m/s")?,
            centre_m: section.centre_m.unwrap_or_default(),
            normal_share: section.normal_share.unwrap_or(0.0),
        },
        LoadKind::Measured => {
            let file = check.present("load.file", section.file.as_ref(), "the path of a CSV or an MCAP file")?;
            let path = folder.join(file);
            if is_mcap(&path) {
                return Ok(Load {
                    frame: section.frame,
                    profile: measured_mcap(check, section, &path)?,
                    lateral_share,
                });
            }
            check.absent("load.topic", section.topic.is_some(), "an MCAP file as load.file")?;
            let text = check.named_file("load.file", &path, MOST_CSV)?;
            ForceProfile::Measured { samples: measured(&path, &text)? }
        }
    };
    Ok(Load { frame: section.frame, profile, lateral_share })
}

/// True of the name of an MCAP file.
fn is_mcap(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"))
}

/// The measured forces of an MCAP file.
#[cfg(feature = "mcap")]
fn measured_mcap(check: &Checker<'_>, section: &LoadSection, path: &Path) -> Result<ForceProfile, InputError> {
    let bytes = check.named_bytes("load.file", path, MOST_MCAP)?;
    let samples = wrench::series(&bytes, section.topic.as_deref()).map_err(|error| {
        let (found, expected) = match &error {
            WrenchError::Damaged(why) => (format!("a damaged MCAP file: {why}"), "a whole one".to_owned()),
            WrenchError::Topic { found, expected } => (found.clone(), expected.clone()),
            WrenchError::Message { topic, number, found, expected } => {
                (format!("{found} in message {number} of the topic \"{topic}\""), (*expected).to_owned())
            }
        };
        at(path, None, None, found, &expected)
    })?;
    for (number, row) in (1..).zip(&samples) {
        let too_large = row.iter().zip(MOST).zip(HEADER).find(|((value, most), _)| value.abs() > *most);
        if let Some(((value, most), column)) = too_large {
            let expected = format!("a number from -{most} to {most}");
            return Err(at(path, None, Some(column), format!("{value} in message {number}"), &expected));
        }
    }
    if !loads(&samples) {
        let found = format!("{} messages without a load", samples.len());
        return Err(at(path, None, None, found, "forces that load the board"));
    }
    Ok(ForceProfile::Measured { samples })
}

/// An error: this build does not read MCAP.
#[cfg(not(feature = "mcap"))]
fn measured_mcap(check: &Checker<'_>, _: &LoadSection, path: &Path) -> Result<ForceProfile, InputError> {
    let found = format!("{}", path.display());
    Err(check.value("load.file", found, "a CSV file: this build was made without the feature mcap"))
}

fn check_keys(check: &Checker<'_>, section: &LoadSection) -> Result<(), InputError> {
    let keys = [
        ("load.spindle_torque_nm", section.spindle_torque_nm.is_some(), LoadKind::Drill),
        ("load.vibration_n", section.vibration_n.is_some(), LoadKind::Drill),
        ("load.vibration_hz", section.vibration_hz.is_some(), LoadKind::Drill),
        ("load.breakthrough_s", section.breakthrough_s.is_some(), LoadKind::Drill),
        ("load.speed_m_s", section.speed_m_s.is_some(), LoadKind::Path),
        ("load.centre_m", section.centre_m.is_some(), LoadKind::Path),
        ("load.normal_share", section.normal_share.is_some(), LoadKind::Path),
        ("load.file", section.file.is_some(), LoadKind::Measured),
        ("load.topic", section.topic.is_some(), LoadKind::Measured),
    ];
    keys.into_iter().filter(|&(_, _, kind)| kind != section.kind).try_for_each(|(key, given, kind)| {
        check.absent(key, given, &format!("kind = \"{}\"", format!("{kind:?}").to_lowercase()))
    })
}

/// The measured forces of a file with this text.
///
/// # Errors
/// If the file has other columns, a cell that is not a finite number, times that do not increase, or
/// only zero wrenches. The error names the file and the line.
pub fn measured(path: &Path, text: &str) -> Result<Vec<[f64; 7]>, InputError> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut rows: Vec<[f64; 7]> = Vec::new();
    let mut records = reader.records();
    let first = records.next().transpose().map_err(|error| unreadable(path, &error))?;
    let found = first.map(|record| record.iter().collect::<Vec<_>>().join(", ")).unwrap_or_default();
    if found != HEADER.join(", ") {
        return Err(at(path, Some(1), None, format!("\"{found}\""), &format!("the columns {}", HEADER.join(", "))));
    }
    for record in records {
        let record = record.map_err(|error| unreadable(path, &error))?;
        let line = record.position().map(|position| position.line() as usize);
        if record.len() != HEADER.len() {
            return Err(at(path, line, None, format!("{} cells", record.len()), "7, one a column"));
        }
        let mut row = [0.0; 7];
        for (((value, cell), column), most) in row.iter_mut().zip(&record).zip(HEADER).zip(MOST) {
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            let unlike = |expected: &str| at(path, line, Some(column), format!("\"{cell}\""), expected);
            *value = number.ok_or_else(|| unlike("a finite number"))?;
            if value.abs() > most {
                return Err(unlike(&format!("a number from -{most} to {most}")));
            }
        }
        if let Some(last) = rows.last().filter(|last| last[0] >= row[0]) {
            let expected = format!("a time after {}, that of the row before", last[0]);
            return Err(at(path, line, Some(HEADER[0]), row[0].to_string(), &expected));
        }
        rows.push(row);
    }
    if !loads(&rows) {
        return Err(at(path, None, None, format!("{} rows without a load", rows.len()), "forces that load the board"));
    }
    Ok(rows)
}

/// True if at least one row has a nonzero wrench.
fn loads(rows: &[[f64; 7]]) -> bool {
    rows.iter().any(|row| row[1..].iter().any(|&component| component != 0.0))
}

/// An error of a CSV file.
pub(super) fn at(path: &Path, line: Option<usize>, column: Option<&str>, found: String, expected: &str) -> InputError {
    let kind = InputErrorKind::Value { found, expected: expected.to_owned() };
    InputError { file: path.to_owned(), line, key: column.map(str::to_owned), kind }
}

/// An error of the reader of CSV files.
pub(super) fn unreadable(path: &Path, error: &csv::Error) -> InputError {
    let line = error.position().map(|position| position.line() as usize);
    InputError { file: path.to_owned(), line, key: None, kind: InputErrorKind::Syntax(error.to_string()) }
}

/// Checks the load of a resolved scenario against its operation and phases.
pub fn check_load(check: &Checker<'_>, scenario: &Scenario) -> Result<(), InputError> {
    let kind = scenario.operation.kind;
    check_lateral(check, scenario)?;
    match &scenario.load.profile {
        ForceProfile::Ramp => Ok(()),
        ForceProfile::Drill { spindle_torque_nm, vibration_n, vibration_hz, breakthrough_s } => {
            let found = format!("\"drill\" for an operation that is to {kind}");
            check.that(kind == OperationKind::Drill, "load.kind", found, "an operation of the kind \"drill\"")?;
            check.within("load.spindle_torque_nm", *spindle_torque_nm, -100.0, 100.0, "N m")?;
            check.not_negative("load.vibration_n", *vibration_n, bounds::MOST_FORCE_N, "N")?;
            let most_hz = 1.0 / (STEPS_PER_PERIOD * scenario.simulation.timestep_s);
            check.within("load.vibration_hz", *vibration_hz, 0.0, most_hz, "Hz, four time steps a period")?;
            let Some(breakthrough_s) = *breakthrough_s else { return Ok(()) };
            check.within("load.breakthrough_s", breakthrough_s, 0.0, scenario.simulation.hold_s, "s, within the hold")
        }
        ForceProfile::Path { .. } => {
            let found = format!("\"path\" for an operation that is to {kind}");
            check.that(kind == OperationKind::Cut, "load.kind", found, "an operation of the kind \"cut\"")?;
            check_path(check, scenario)
        }
        ForceProfile::Measured { samples } => {
            let ordered = samples.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            let is_within = |row: &[f64; 7]| row.iter().zip(MOST).all(|(figure, most)| figure.abs() <= most);
            let fine = ordered && loads(samples) && samples.iter().all(is_within);
            let expected = format!("rows in the order of time, with some load: {}", bounds::wrench_in_words());
            check.that(fine, "load.profile.samples", format!("{} rows", samples.len()), &expected)
        }
    }
}

/// Requires a sideways share of a force that there is. A measured wrench has its sideways part already.
fn check_lateral(check: &Checker<'_>, scenario: &Scenario) -> Result<(), InputError> {
    const KEY: &str = "load.lateral_share";
    let Load { profile, lateral_share, .. } = &scenario.load;
    check.within(KEY, *lateral_share, 0.0, 1.0, "a share of the operation's force")?;
    if *lateral_share == 0.0 {
        return Ok(());
    }
    let found = lateral_share.to_string();
    let is_measured = matches!(profile, ForceProfile::Measured { .. });
    check.that(!is_measured, KEY, found.clone(), "0 with a measured force, which has its sideways part already")?;
    let has_force = scenario.operation.wrench_o.force_n.norm() > 0.0;
    check.that(has_force, KEY, found, "0 for an operation without a force")
}

/// Requires a knife that does not start at the circle's centre and stays on the board.
fn check_path(check: &Checker<'_>, scenario: &Scenario) -> Result<(), InputError> {
    let ForceProfile::Path { speed_m_s, centre_m, normal_share } = scenario.load.profile else { return Ok(()) };
    check.within("load.speed_m_s", speed_m_s, 0.0, 10.0, "m/s")?;
    check.within("load.normal_share", normal_share, -10.0, 10.0, "a share of the cutting force")?;
    check.place("load.centre_m", &centre_m)?;
    let x_ot = scenario.operation.x_ot;
    let p_ot_m = x_ot.translation.vector;
    let radius_m = libm::hypot(p_ot_m.x - centre_m[0], p_ot_m.y - centre_m[1]);
    check.that(radius_m > 1e-6, "load.centre_m", "the tool point", "a centre beside the tool point")?;
    let force_o_n = scenario.operation.wrench_o.force_n;
    let turned = |time_s| ForceProfile::travel_angle_rad(speed_m_s, centre_m, &p_ot_m, &force_o_n, time_s);
    let whole_rad = turned(scenario.simulation.hold_s).clamp(-std::f64::consts::TAU, std::f64::consts::TAU);
    let centre = Vector3::new(centre_m[0], centre_m[1], 0.0);
    let board = scenario.object.shape();
    // At every 360th of the path.
    (0..=360).try_for_each(|part| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), whole_rad * f64::from(part) / 360.0);
        let mut x_ot = x_ot;
        x_ot.translation.vector = centre + turn * (p_ot_m - centre);
        check.on_board("load.centre_m", &x_ot, &board)
    })
}
