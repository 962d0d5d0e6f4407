//! `benchdog inspect`: prints the contents of a recording and judges its trace again with other limits.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    args::{InspectArgs, LimitArgs},
    exit::{CliError, Exit},
    format::Format,
    output,
};
use crate::{
    judge::{fingerprint, judge},
    model::{
        scenario::{Expectation, Limits},
        verdict::{Verdict, VerdictKind},
    },
    pipeline::versions::versions,
    record::{RecordError, RecordedRun, RecordedSummary, Recording},
    report::{columns, console},
    scenario,
};

/// Prints a recording's contents. If its trace is judged again, the new verdict determines the exit code.
pub fn inspect(args: &InspectArgs) -> Result<Exit, CliError> {
    let recording = Recording::read(&args.recording)?;
    let summary = recording.summary()?;
    let rejudged = if wants_check(args) { Some(judge_again(args, recording.run()?)?) } else { None };
    match args.format {
        Format::Human => output::report(&text(&summary, rejudged.as_ref()))?,
        Format::Json => output::print(&json(&summary, rejudged.as_ref()))?,
    }
    Ok(rejudged.as_ref().map_or(Exit::Met, Exit::of))
}

fn wants_check(args: &InspectArgs) -> bool {
    let LimitArgs { slip_mm, slip_deg, sag_mm, deflection_mm, creep_mm_s, torque_ratio } = args.limits;
    let limits = [slip_mm, slip_deg, sag_mm, deflection_mm, creep_mm_s, torque_ratio];
    args.check || args.scenario.is_some() || limits.iter().any(Option::is_some)
}

/// The verdict on the stored trace under the given limits.
fn judge_again(args: &InspectArgs, recorded: RecordedRun) -> Result<Verdict, CliError> {
    let RecordedRun { scenario, verdict, trace, .. } = recorded;
    // Before it is judged: a damaged trace may be anything.
    let found = fingerprint(&trace);
    if found != verdict.fingerprint {
        let expected = verdict.fingerprint;
        let problem = format!("found a trace with fingerprint {found}, expected {expected}, that of the verdict");
        return Err(RecordError::Invalid { path: args.recording.clone(), problem }.into());
    }
    let (limits, expect) = match &args.scenario {
        Some(path) => {
            let given = scenario::load(path)?.scenario;
            (given.limits, given.expect)
        }
        None => (scenario.limits, Expectation::of(verdict.expected)),
    };
    let given = with(limits, args.limits);
    let mut judgement = judge(&trace, &given);
    if given == scenario.limits {
        judgement.confirmation.clone_from(&verdict.confirmation);
        if verdict.verdict == VerdictKind::NoVerdict {
            // The reason may not be in the trace: other time steps, or the statics.
            (judgement.verdict, judgement.reason) = (verdict.verdict, verdict.reason.clone());
        }
    }
    // The muscles depend on the planned posture, not on the limits.
    let muscles = verdict.muscles.clone();
    Ok(Verdict { muscles, ..judgement.to_verdict(&verdict.name, expect.verdict, verdict.seed, versions()) })
}

fn with(limits: Limits, given: LimitArgs) -> Limits {
    Limits {
        slip_mm: given.slip_mm.unwrap_or(limits.slip_mm),
        slip_deg: given.slip_deg.unwrap_or(limits.slip_deg),
        sag_mm: given.sag_mm.unwrap_or(limits.sag_mm),
        deflection_mm: given.deflection_mm.unwrap_or(limits.deflection_mm),
        creep_mm_s: given.creep_mm_s.unwrap_or(limits.creep_mm_s),
        torque_ratio: given.torque_ratio.unwrap_or(limits.torque_ratio),
        ..limits
    }
}

fn text(summary: &RecordedSummary, rejudged: Option<&Verdict>) -> String {
    let mut text = console::details(&summary.verdict, None, None);
    let peaks = &summary.peaks;
    let by_hand = |figures: &BTreeMap<String, f64>, unit: &str| {
        let told: Vec<_> = figures.iter().map(|(hand, figure)| format!("{hand} {figure:.3} {unit}")).collect();
        told.join(", ")
    };
    let phases: Vec<_> = summary.phases.iter().map(|phase| format!("{} {:.3} s", phase.name, phase.start_s)).collect();
    let made_by: Vec<_> = summary.verdict.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    let rows = [
        ("slip peaks", by_hand(&peaks.slip_mm, "mm")),
        ("rotation peaks", by_hand(&peaks.rotation_deg, "deg")),
        ("deflection peak", format!("{:.3} mm", peaks.deflection_mm)),
        ("phases from", format!("{}, end {:.3} s", phases.join(", "), summary.end_s)),
        ("made by", made_by.join(", ")),
        ("trace", summary.verdict.fingerprint.clone()),
    ];
    text.push('\n');
    text.push_str(&columns::aligned(&rows.map(|(name, value)| vec![name.to_owned(), value]), 2));
    text.push_str("\nevents\n");
    for (time_s, event) in &summary.events {
        text.push_str(&format!("{time_s:>7.3} s  {event}\n"));
    }
    if let Some(verdict) = rejudged {
        text.push_str("\njudged again\n");
        text.push_str(&console::details(verdict, None, None));
        text.push_str(&console::hint((!verdict.met).then_some(verdict.verdict)));
    }
    text
}

#[derive(Serialize)]
struct Document<'a> {
    verdict: &'a Verdict,
    peaks: Peaks<'a>,
    phases: Vec<Moment<'a>>,
    events: Vec<Moment<'a>>,
    end_s: f64,
    /// The verdict under other limits; null if the trace was not judged again.
    judged_again: Option<&'a Verdict>,
}

#[derive(Serialize)]
struct Peaks<'a> {
    slip_mm: &'a BTreeMap<String, f64>,
    rotation_deg: &'a BTreeMap<String, f64>,
    deflection_mm: f64,
    torque_ratio: &'a BTreeMap<String, f64>,
}

#[derive(Serialize)]
struct Moment<'a> {
    time_s: f64,
    text: &'a str,
}

fn json(summary: &RecordedSummary, judged_again: Option<&Verdict>) -> String {
    let peaks = &summary.peaks;
    let document = Document {
        verdict: &summary.verdict,
        peaks: Peaks {
            slip_mm: &peaks.slip_mm,
            rotation_deg: &peaks.rotation_deg,
            deflection_mm: peaks.deflection_mm,
            torque_ratio: &peaks.torque_ratio,
        },
        phases: summary.phases.iter().map(|phase| Moment { time_s: phase.start_s, text: &phase.name }).collect(),
        events: summary.events.iter().map(|(time_s, text)| Moment { time_s: *time_s, text }).collect(),
        end_s: summary.end_s,
        judged_again,
    };
    // Serialisation to a string fails only for maps whose keys are not strings.
    let text = serde_json::to_string_pretty(&document).expect("a recording's summary has only string keys");
    format!("{text}\n")
}
