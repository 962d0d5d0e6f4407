//! Data over time outside the scene: the judge's series with their limits, phases, events.

use rerun::{
    Scalars, SeriesLines, SeriesPoints, StateChange, StateConfiguration, TextLog, TextLogLevel, components::MarkerShape,
};

use super::{entity::entity, error::RecordError, input::RecordingInput, messages::Messages, palette};
use crate::model::{
    measures::{EventKind, JointMeasures, axis_top},
    trace::{Phase, Sample},
    verdict::CheckKind,
};

/// Number of joints in the torque plot: those with the highest torque ratios. The file contains all.
pub(super) const JOINTS_SHOWN: usize = 4;

/// Name of the series of a limit.
pub(super) const LIMIT: &str = "limit";

/// Name of the series of the first crossing of a limit.
pub(super) const FAILURE: &str = "first crossing";

/// End of the name of a series after the last judged sample.
pub(super) const NOT_JUDGED: &str = ", not judged";

/// The plot of the load factor, which has no limit.
pub(super) const LOAD: &str = "load";

/// The plots of checks: the folder of the series, and the check.
pub(super) const PLOTS: [(&str, CheckKind); 6] = [
    ("slip", CheckKind::Slip),
    ("rotation", CheckKind::SlipRotation),
    ("sag", CheckKind::Sag),
    ("deflection", CheckKind::Deflection),
    ("torque", CheckKind::TorqueRatio),
    ("clearance", CheckKind::Clearance),
];

/// Logs the plots, the phases and the events.
pub(super) fn log(messages: &mut Messages, input: &RecordingInput) -> Result<(), RecordError> {
    let measures = input.measures;
    let mut series = |plot, name: &str, colour, values: &[f64]| {
        let judged = measures.judged.min(values.len());
        log_series(messages, [plot, name], &measures.time_s[..judged], &values[..judged], (colour, 2.0, name))?;
        // The last judged value again, so that the two lines meet.
        let rest = judged.saturating_sub(1);
        if judged == values.len() {
            return Ok(());
        }
        let later = format!("{name}{NOT_JUDGED}");
        let style = (palette::not_judged(), 1.0, later.as_str());
        log_series(messages, [plot, &later], &measures.time_s[rest..], &values[rest..], style)
    };
    for (arm, hand) in measures.hands.iter().enumerate() {
        series("slip", &format!("{} hand", hand.name), palette::hand(arm), &hand.slip_mm)?;
        series("rotation", &format!("{} hand", hand.name), palette::hand(arm), &hand.slip_deg)?;
    }
    if !measures.sag_mm.is_empty() {
        series("sag", "tool point", palette::board(), &measures.sag_mm)?;
    }
    if !measures.deflection_mm.is_empty() {
        series("deflection", "tool point", palette::board(), &measures.deflection_mm)?;
    }
    if !measures.clearance_mm.is_empty() {
        series("clearance", "least distance", palette::board(), &measures.clearance_mm)?;
    }
    for (joint, colour) in by_torque(input) {
        series("torque", &joint.name, colour, &joint.torque_ratio)?;
    }
    if !measures.load_factor.is_empty() {
        series(LOAD, "load factor", palette::load(), &measures.load_factor)?;
    }
    for (plot, kind) in PLOTS {
        log_limit(messages, input, plot, kind)?;
        log_failure(messages, input, plot, kind)?;
    }
    log_phases(messages, &input.trace.samples)?;
    log_events(messages, input)
}

/// The joints by torque ratio, highest first, with shades of their arm's colour, brightest first.
pub(super) fn by_torque<'a>(input: &RecordingInput<'a>) -> Vec<(&'a JointMeasures, rerun::Color)> {
    let peak = |joint: &JointMeasures| input.verdict.peak_torque_ratio.get(&joint.name).copied().unwrap_or(0.0);
    let mut joints: Vec<&JointMeasures> = input.measures.joints.iter().collect();
    joints.sort_by(|a, b| peak(b).total_cmp(&peak(a)));
    let arm_of =
        |joint: &JointMeasures| input.trace.arms.iter().position(|arm| arm.joints.contains(&joint.name)).unwrap_or(0);
    let mut seen = vec![0_u8; input.trace.arms.len().max(1)];
    joints
        .into_iter()
        .map(|joint| {
            let arm = arm_of(joint);
            seen[arm] += 1;
            (joint, palette::shade(arm, (0.2 * f32::from(seen[arm] - 1)).min(0.6)))
        })
        .collect()
}

/// Logs a line of a plot; `style` is its colour, width and name.
fn log_series(
    messages: &mut Messages,
    path: [&str; 2],
    times_s: &[f64],
    values: &[f64],
    style: (rerun::Color, f32, &str),
) -> Result<(), RecordError> {
    let path = entity(&["plots", path[0], path[1]]);
    let (colour, width, name) = style;
    let line = SeriesLines::new().with_colors([colour]).with_widths([width]).with_names([name]);
    messages.log_static(&path, &line)?;
    let scalars = Scalars::new(values.iter().copied());
    messages.log_columns(&path, times_s, scalars.columns_of_unit_batches().map_err(RecordError::encode)?)
}

/// Logs a horizontal line at the limit, from the hand-over to the end of the trace.
fn log_limit(messages: &mut Messages, input: &RecordingInput, plot: &str, kind: CheckKind) -> Result<(), RecordError> {
    let (Some(check), [first_s, .., last_s]) = (input.verdict.check(kind), input.measures.time_s.as_slice()) else {
        return Ok(());
    };
    let ends = [check.limit; 2];
    let unit = if kind.unit() == "1" { String::new() } else { format!(" {}", kind.unit()) };
    let name = format!("{LIMIT} {}{unit}", check.limit);
    log_series(messages, [plot, LIMIT], &[*first_s, *last_s], &ends, (palette::limit_line(), 2.0, &name))
}

/// The top of a plot's axis, chosen so that the limit is visible even if the values of a lost board are far above it.
pub(super) fn top(input: &RecordingInput, kind: CheckKind) -> f64 {
    let peak = input.measures.series(kind).into_iter().flatten().copied().fold(0.0, f64::max);
    axis_top(peak, input.verdict.check(kind).map(|check| check.limit))
}

/// Logs a point at the first crossing of all, on the series with the largest value.
fn log_failure(
    messages: &mut Messages,
    input: &RecordingInput,
    plot: &str,
    kind: CheckKind,
) -> Result<(), RecordError> {
    let Some(failure) = input.verdict.first_failure.as_ref().filter(|failure| failure.check == kind) else {
        return Ok(());
    };
    let Some(index) = input.measures.time_s.iter().position(|&time_s| time_s == failure.time_s) else { return Ok(()) };
    let worst = input.measures.series(kind).into_iter().filter_map(|series| series.get(index)).copied();
    let worst = worst.fold(0.0, f64::max);
    let path = entity(&["plots", plot, FAILURE]);
    let point = SeriesPoints::new()
        .with_colors([palette::limit()])
        .with_marker_sizes([6.0])
        .with_markers([MarkerShape::Diamond])
        .with_names([FAILURE]);
    messages.log_static(&path, &point)?;
    let scalar = Scalars::new([worst]).columns_of_unit_batches().map_err(RecordError::encode)?;
    messages.log_columns(&path, &[failure.time_s], scalar)
}

fn log_phases(messages: &mut Messages, samples: &[Sample]) -> Result<(), RecordError> {
    let path = entity(&["phases"]);
    let phases = [Phase::Grip, Phase::Settle, Phase::Ramp, Phase::Hold, Phase::Release, Phase::Move, Phase::Regrasp];
    // Greys, because the colours have other meanings.
    let greys = [60, 90, 130, 170, 90, 110, 75].map(|v| rerun::Color::from_rgb(v, v, v));
    let style = StateConfiguration::new().with_values(phases.map(Phase::name)).with_colors(greys);
    messages.log_static(&path, &style)?;
    let starts = (0..samples.len()).filter(|&i| i == 0 || samples[i].phase != samples[i - 1].phase);
    let (times_s, names): (Vec<f64>, Vec<&str>) = starts.map(|i| (samples[i].time_s, samples[i].phase.name())).unzip();
    let states = StateChange::new().with_state(names).columns_of_unit_batches().map_err(RecordError::encode)?;
    messages.log_columns(&path, &times_s, states)
}

fn log_events(messages: &mut Messages, input: &RecordingInput) -> Result<(), RecordError> {
    let times_s: Vec<f64> = input.events.iter().map(|event| event.time_s).collect();
    let level = |kind| match kind {
        EventKind::Phase => TextLogLevel::INFO,
        EventKind::LimitCrossed(_) => TextLogLevel::WARN,
        EventKind::BrokeDown => TextLogLevel::ERROR,
    };
    let log = TextLog::update_fields()
        .with_many_text(input.events.iter().map(|event| event_text(event.time_s, &event.text)))
        .with_many_level(input.events.iter().map(|event| level(event.kind)));
    messages.log_columns(&entity(&["events"]), &times_s, log.columns_of_unit_batches().map_err(RecordError::encode)?)
}

/// The separator between time and text of an event.
const TIME_END: &str = " s  ";

/// The text with the time in front: the viewer's own column of times is too narrow.
fn event_text(time_s: f64, text: &str) -> String {
    format!("{time_s:.3}{TIME_END}{text}")
}

/// The text of an event without the time in front.
pub(super) fn without_time(text: &str) -> String {
    text.split_once(TIME_END).map_or(text, |(_, text)| text).to_owned()
}
