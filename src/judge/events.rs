//! Events for the reader of a recording: the phases and the first crossing of each limit.

use nalgebra::Point3;

use super::checks::Finding;
use crate::model::{
    measures::{Event, EventKind},
    trace::{Phase, Sample, Trace},
    verdict::CheckKind,
};

/// Phases and crossings in the order of time, and the end of a trace that broke down after the deciding crossing.
pub(super) fn events(
    trace: &Trace,
    believed: &[Sample],
    judged: &[Sample],
    findings: &[Finding],
    ends_because: Option<&str>,
) -> Vec<Event> {
    let mut events = phase_events(trace, believed);
    events.extend(findings.iter().filter_map(|finding| crossing_event(judged, finding)));
    events.extend(ends_because.map(|reason| end(believed, format!("the simulation ends here: {reason}"))));
    in_order(events)
}

/// Phases and the end of a trace that allows no verdict.
pub(super) fn events_without_verdict(trace: &Trace, reason: &str) -> Vec<Event> {
    let mut events = phase_events(trace, &trace.samples);
    events.push(end(&trace.samples, format!("no verdict: {reason}")));
    in_order(events)
}

/// The end of a trace that broke down.
fn end(samples: &[Sample], text: String) -> Event {
    let time_s = samples.last().map_or(0.0, |sample| sample.time_s);
    Event { time_s, kind: EventKind::BrokeDown, text, what: String::new() }
}

fn in_order(mut events: Vec<Event>) -> Vec<Event> {
    // A stable sort: a phase comes before limits crossed at its first sample.
    events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    events
}

fn phase_events(trace: &Trace, samples: &[Sample]) -> Vec<Event> {
    let first = samples.first().into_iter();
    let changes = samples.windows(2).filter(|pair| pair[0].phase != pair[1].phase).map(|pair| &pair[1]);
    first
        .chain(changes)
        .map(|sample| Event {
            time_s: sample.time_s,
            kind: EventKind::Phase,
            what: String::new(),
            text: match sample.phase {
                Phase::Grip => "grip: the grippers close on the supported board".to_owned(),
                Phase::Settle => "settle: the arms carry the board".to_owned(),
                Phase::Ramp => format!("ramp: the load increases; the tool tip sagged {:.2} mm", sag_mm(trace, sample)),
                Phase::Hold => format!("hold: the full load, factor {:.2}", sample.load_factor),
                Phase::Release => "release: no load".to_owned(),
                Phase::Move => "move: the arms move the board".to_owned(),
                Phase::Regrasp => "regrasp: one arm changes its grasp".to_owned(),
            },
        })
        .collect()
}

/// Displacement of the tool tip under gravity until this sample, mm.
fn sag_mm(trace: &Trace, sample: &Sample) -> f64 {
    let tool_point_w = |sample: &Sample| sample.x_wo * Point3::from(trace.p_ot_m);
    trace.samples.first().map_or(0.0, |first| 1e3 * (tool_point_w(sample) - tool_point_w(first)).norm())
}

fn crossing_event(judged: &[Sample], finding: &Finding) -> Option<Event> {
    let crossing = finding.crossing.as_ref()?;
    let sample = &judged[crossing.sample];
    let happened = match finding.check.name {
        CheckKind::Slip => "slides by more than",
        CheckKind::SlipRotation => "turns by more than",
        CheckKind::Sag => "the tool tip sinks under the board's weight by more than",
        CheckKind::Deflection => "the tool tip deflects by more than",
        CheckKind::Creep => "creeps faster than",
        CheckKind::TorqueRatio => "needs more than its torque limit times",
        CheckKind::GripWrench => "lets go: its wrench exceeds the measured limits times",
        CheckKind::PadOpen => "has been open for more than",
        CheckKind::ContactLost => "no hand has touched the board for more than",
        CheckKind::Drop => "has dropped the board: it slid by more than",
        CheckKind::PersonOverlap => "overlap by more than",
        CheckKind::Clearance => "are closer to each other than",
        CheckKind::Penetration
        | CheckKind::EnergyCreated
        | CheckKind::ForceResidual
        | CheckKind::CouplingDrift
        | CheckKind::Chatter => "the simulation violates the laws of mechanics by more than",
    };
    let unit = match finding.check.name {
        CheckKind::TorqueRatio | CheckKind::GripWrench => String::new(),
        _ => format!(" {}", finding.check.unit),
    };
    let what = if crossing.what.is_empty() { String::new() } else { format!("{} ", crossing.what) };
    let text = format!("{what}{happened} {}{unit} at load factor {:.2}", finding.check.limit, sample.load_factor);
    let kind = EventKind::LimitCrossed(finding.check.name);
    Some(Event { time_s: sample.time_s, kind, text, what: crossing.what.clone() })
}
